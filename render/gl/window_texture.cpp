// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/window_texture.hpp"

#include <algorithm>
#include <vector>

#include "mesh/error.hpp"

namespace cellproj::gl {

namespace {

// Behind those of methods and surfaces.
constexpr unsigned int windows_unit = 10;

constexpr double unbounded = 1e30;

std::vector<float> texels(const DepthWindow& window, const NearnessFrame& frame) {
    const auto nearness = [&](double depth) {
        return static_cast<float>(std::clamp(frame.nearness(frame.perspective ? 1.0 / depth : depth), -unbounded, unbounded));
    };
    std::vector<float> result;
    result.reserve(2 * window.pixels().size());
    for (const DepthInterval& pixel : window.pixels()) {
        result.push_back(pixel.empty() ? static_cast<float>(-unbounded) : nearness(pixel.near));
        result.push_back(pixel.empty() ? static_cast<float>(unbounded) : nearness(pixel.far));
    }
    return result;
}

}  // namespace

void WindowTexture::require_drawn(const Scene& scene, const Quality& quality) {
    if (!DepthWindow::is_needed(scene) || !light_at_vertices(quality.method)) return;
    throw Error({ErrorKind::option, "--method", "one of light per pixel for a scene that is clipped or has bodies", to_string(quality.method),
                 "use integral, exact or a table"});
}

WindowTexture::WindowTexture(const DepthWindow& window, const NearnessFrame& frame, int width)
    : texels_(Texture::list_of_pairs(texels(window, frame))), width_(width) {}

void WindowTexture::bind(const Program& program) const {
    program.set("window_width", static_cast<float>(width_));
    texels_.bind(windows_unit);
}

}  // namespace cellproj::gl
