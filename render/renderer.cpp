// SPDX-License-Identifier: BSD-3-Clause
#include "render/renderer.hpp"

#include "render/gl/gl_renderer.hpp"

namespace cellproj {

std::unique_ptr<Renderer> make_renderer(Backend backend, const RendererOptions& options) {
    switch (backend) {
        case Backend::gl_osmesa:
            return std::make_unique<gl::GlRenderer>(gl::OsmesaContext(options.osmesa_library));
    }
    return nullptr;
}

}  // namespace cellproj
