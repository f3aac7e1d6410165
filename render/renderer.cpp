// SPDX-License-Identifier: BSD-3-Clause
#include "render/renderer.hpp"

#include "mesh/error.hpp"
#include "render/cpu/cpu_renderer.hpp"
#include "render/gl/gl_renderer.hpp"

namespace cellproj {

bool draws(Backend backend, const Quality& quality, FieldsRead fields) {
    const bool one_field = fields == FieldsRead::one;
    if (backend == Backend::gl_osmesa) return !quality.order_per_pixel && (one_field || takes_opacity_field(quality.method));
    return one_field && !light_at_vertices(quality.method) && quality.target == TargetFormat::rgba32f;
}

void require_drawn(Backend backend, const Quality& quality, FieldsRead fields) {
    if (draws(backend, quality, fields)) return;
    if (fields == FieldsRead::two) {
        require_takes_opacity_field(quality.method, "--method");
        if (backend == Backend::cpu) {
            throw Error({ErrorKind::option, "--opacity-field", "colour and opacity from one field for the CPU backend", "another field",
                         "use the OpenGL backend (--backend gl)"});
        }
    }
    if (backend == Backend::gl_osmesa) {
        throw Error({ErrorKind::option, "--order", "an order of cells for the OpenGL backend", "pixel",
                     "use the CPU backend (--backend cpu)"});
    }
    if (light_at_vertices(quality.method)) {
        throw Error({ErrorKind::option, "--method", "a method of light per pixel for the CPU backend", to_string(quality.method),
                     "use the OpenGL backend (--backend gl)"});
    }
    throw Error({ErrorKind::option, "--target", "rgba32f for the CPU backend", to_string(quality.target),
                 "use the OpenGL backend (--backend gl)"});
}

std::unique_ptr<Renderer> make_renderer(Backend backend, const RendererOptions& options) {
    switch (backend) {
        case Backend::gl_osmesa:
            return std::make_unique<gl::GlRenderer>(gl::OsmesaContext(options.osmesa_library));
        case Backend::cpu:
            return cpu::make_renderer(options.threads);
    }
    return nullptr;
}

}  // namespace cellproj
