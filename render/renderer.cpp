// SPDX-License-Identifier: BSD-3-Clause
#include "render/renderer.hpp"

#include "render/cpu/cpu_renderer.hpp"
#include "render/gl/gl_renderer.hpp"

namespace cellproj {

bool draws(Backend backend, const Quality& quality) {
    if (backend == Backend::gl_osmesa) return !quality.order_per_pixel;
    return !light_at_vertices(quality.method) && quality.target == TargetFormat::rgba32f;
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
