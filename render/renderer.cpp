// SPDX-License-Identifier: BSD-3-Clause
#include "render/renderer.hpp"

#include <optional>

#include "mesh/error.hpp"
#include "render/cpu/cpu_renderer.hpp"
#include "render/gl/egl_context.hpp"
#include "render/gl/gl_renderer.hpp"
#include "render/gl/osmesa_context.hpp"

namespace cellproj {

namespace {

// Why a backend cannot draw so; nothing when it can.
std::optional<Error> refusal(Backend backend, const Quality& quality, FieldsRead fields) {
    const auto instead = [](const char* option, const char* expected, const std::string& found, const char* advice) {
        return Error({ErrorKind::option, option, expected, found, advice});
    };
    const char* use_gl = "use the OpenGL backend (--backend gl)";
    if (fields == FieldsRead::two) {
        if (!takes_opacity_field(quality.method))
            return instead("--method", "one that takes opacity from another field than colour", to_string(quality.method),
                           "use integral, exact, linear:N, homogeneous, stein or average");
        if (backend == Backend::cpu)
            return instead("--opacity-field", "colour and opacity from one field for the CPU backend", "another field", use_gl);
    }
    if (backend != Backend::cpu) {
        if (!quality.order_per_pixel) return std::nullopt;
        return instead("--order", "an order of cells for the OpenGL backend", "pixel", "use the CPU backend (--backend cpu)");
    }
    if (light_at_vertices(quality.method))
        return instead("--method", "a method of light per pixel for the CPU backend", to_string(quality.method), use_gl);
    if (quality.surfaces.kind != SurfaceMethodKind::exact)
        return instead("--iso-method", "exact for the CPU backend", to_string(quality.surfaces), use_gl);
    if (quality.target != TargetFormat::rgba32f)
        return instead("--target", "rgba32f for the CPU backend", to_string(quality.target), use_gl);
    return std::nullopt;
}

}  // namespace

std::string to_string(Backend backend) {
    switch (backend) {
        case Backend::cpu: return "cpu";
        case Backend::gl_egl: return "gl_egl";
        case Backend::gl_osmesa: break;
    }
    return "gl_osmesa";
}

bool draws(Backend backend, const Quality& quality, FieldsRead fields) { return !refusal(backend, quality, fields); }

void require_drawn(Backend backend, const Quality& quality, FieldsRead fields) {
    if (const auto error = refusal(backend, quality, fields)) throw *error;
}

Backend usual_backend(const Quality& quality, FieldsRead fields, const Gpu& gpu) {
    if (gpu.found && draws(Backend::gl_egl, quality, fields)) return Backend::gl_egl;
    return quality.order_per_pixel || draws(Backend::cpu, quality, fields) ? Backend::cpu : Backend::gl_osmesa;
}

Gpu find_gpu(const RendererOptions& options) { return gl::find_gpu(options.egl_library); }

std::unique_ptr<Renderer> make_renderer(Backend backend, const RendererOptions& options) {
    switch (backend) {
        case Backend::gl_osmesa:
            return std::make_unique<gl::GlRenderer>(std::make_unique<gl::OsmesaContext>(options.osmesa_library), options.rules);
        case Backend::gl_egl:
            return std::make_unique<gl::GlRenderer>(std::make_unique<gl::EglContext>(options.egl_library), options.rules);
        case Backend::cpu:
            return cpu::make_renderer(options.threads, options.rules);
    }
    return nullptr;
}

}  // namespace cellproj
