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
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "classify/segment_integral.hpp"
#include "render/image.hpp"

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

}  // namespace cellproj::testing_support
