// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_renderer.hpp"

#include "mesh/error.hpp"
#include "render/cpu/cpu_grid_renderer.hpp"
#include "render/gl/egl_context.hpp"
#include "render/gl/grid_gl_renderer.hpp"
#include "render/gl/osmesa_context.hpp"
#include "render/surface_method.hpp"

namespace cellproj {

void require_grid_drawn(Backend backend, const GridQuality& quality, const GridShading& shading) {
    if (backend != Backend::cpu) return gl::require_grid_drawn(quality, shading);
    const auto refuse = [](const char* option, const char* expected, const std::string& found, const char* advice) {
        throw Error({ErrorKind::option, option, expected, found, advice});
    };
    const char* as_tets = "draw the grid as tetrahedra (--as tets)";
    if (light_at_vertices(quality.method))
        refuse("--method", "a method of light per pixel for a regular grid", to_string(quality.method), as_tets);
    if (quality.target != TargetFormat::rgba32f) refuse("--target", "rgba32f for a regular grid", to_string(quality.target), as_tets);
    if (quality.sampling.cut != GridSampling::Cut::cells)
        refuse("--sampling", "cells for a regular grid on the CPU", to_string(quality.sampling), "use the OpenGL backend (--backend gl)");
    if ((shading.isosurfaces || shading.lit_medium) && !takes_surfaces(quality.method))
        refuse("--method", "a method of light per pixel, blended once, for isosurfaces and lit media", to_string(quality.method), "leave it out");
}

void require_grid_cut(const GridQuality& quality, const RayCuts& cuts) {
    if (!cuts.any()) return;
    const auto refuse = [&](const char* option, const char* expected, const std::string& found, const char* advice) {
        throw Error({ErrorKind::option, option, std::string(expected) + " for a regular grid with " + describe(cuts), found, advice});
    };
    if (quality.sampling.cut != GridSampling::Cut::cells) refuse("--sampling", "cells", to_string(quality.sampling), "leave it out");
    if (light_at_vertices(quality.method)) refuse("--method", "a method of light per pixel", to_string(quality.method), "use integral");
}

std::unique_ptr<GridRenderer> make_grid_renderer(Backend backend, const RendererOptions& options) {
    switch (backend) {
        case Backend::gl_osmesa:
            return std::make_unique<gl::GlGridRenderer>(std::make_unique<gl::OsmesaContext>(options.osmesa_library), options.rules);
        case Backend::gl_egl: return std::make_unique<gl::GlGridRenderer>(std::make_unique<gl::EglContext>(options.egl_library), options.rules);
        case Backend::cpu: break;
    }
    return cpu::make_grid_renderer(options.threads);
}

}  // namespace cellproj
