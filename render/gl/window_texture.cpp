// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/window_texture.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace cellproj::gl {

namespace {

// Behind those of methods and surfaces.
constexpr unsigned int windows_unit = 10;

constexpr double unbounded = 1e30;

// `place`: of a depth, in the numbers of the shader. `nothing`: an interval in which nothing is.
template <class Place>
std::vector<float> texels(const DepthWindow& window, Place place, const std::array<double, 2>& nothing) {
    std::vector<float> result;
    result.reserve(2 * window.pixels().size());
    const auto add = [&](double value) { result.push_back(static_cast<float>(std::clamp(value, -unbounded, unbounded))); };
    for (const DepthInterval& pixel : window.pixels()) {
        add(pixel.empty() ? nothing[0] : place(pixel.near));
        add(pixel.empty() ? nothing[1] : place(pixel.far));
    }
    return result;
}

std::vector<float> nearness_texels(const DepthWindow& window, const NearnessFrame& frame) {
    return texels(window, [&](double depth) { return frame.nearness(frame.perspective ? 1.0 / depth : depth); }, {-unbounded, unbounded});
}

std::vector<float> depth_texels(const DepthWindow& window, double reference) {
    return texels(window, [&](double depth) { return depth - reference; }, {unbounded, -unbounded});
}

}  // namespace

WindowTexture::WindowTexture(const DepthWindow& window, const NearnessFrame& frame, int width)
    : texels_(Texture::list_of_pairs(nearness_texels(window, frame))), width_(width) {}

WindowTexture::WindowTexture(const DepthWindow& window, double reference_depth, int width)
    : texels_(Texture::list_of_pairs(depth_texels(window, reference_depth))), width_(width) {}

void WindowTexture::bind(const Program& program) const {
    program.set("window_width", static_cast<float>(width_));
    texels_.bind(windows_unit);
}

}  // namespace cellproj::gl
