// SPDX-License-Identifier: BSD-3-Clause
//
// How far lights, pixels and pictures are apart: the largest difference of a channel, absolute. What is not finite is infinitely far
// from everything, so that no bound lets it pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "classify/segment_integral.hpp"
#include "render/image.hpp"
#include "render/judge/reference.hpp"

namespace cellproj::testing_support {

inline double max_difference(const glm::dvec4& a, const glm::dvec4& b) {
    const glm::dvec4 d = glm::abs(a - b);
    const double sum = d.x + d.y + d.z + d.w;  // std::max may lose a NaN
    return std::isfinite(sum) ? std::max({d.x, d.y, d.z, d.w}) : std::numeric_limits<double>::infinity();
}

inline double distance(const Light& a, const Light& b) {
    return max_difference(glm::dvec4(a.color, a.opacity), glm::dvec4(b.color, b.opacity));
}

// Infinite for pictures of different sizes.
inline double max_difference(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) return std::numeric_limits<double>::infinity();
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        largest = std::max(largest, max_difference(glm::dvec4(a.pixels[i]), glm::dvec4(b.pixels[i])));
    return largest;
}

// Rasterizers place points on a grid of 1/256 of a pixel: the picture is one of a mesh moved by at most 1/512 of a pixel in x and y. So
// a pixel is right if its value lies between those that the truth takes within that distance of its centre; how far it
// lies outside, at most over all pixels and channels, is the error. On silhouettes, where the chord jumps, that is either side.
// `truth`: from a position on the screen [pixels] to its light, a dvec4.
template <class Truth>
double error_but_for_snapping(const Image& image, Truth truth) {
    double largest = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const glm::dvec2 center(x + 0.5, y + 0.5);
            glm::dvec4 low = truth(center), high = low;
            for (const glm::dvec2& towards : {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(1, -1), glm::dvec2(-1, -1)}) {
                const glm::dvec4 light = truth(center + rasterizer_slack * towards);
                low = glm::min(low, light);
                high = glm::max(high, light);
            }
            for (int k = 0; k < 4; ++k) {
                const double value = image.at(x, y)[k];
                const double outside = std::max(low[k] - value, value - high[k]);
                if (!(outside <= largest)) largest = outside;  // NaN is an error
            }
        }
    }
    return largest;
}

}  // namespace cellproj::testing_support
