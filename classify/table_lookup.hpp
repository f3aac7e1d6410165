// SPDX-License-Identifier: BSD-3-Clause
//
// Linear interpolation in a table of one to three axes, as texture units do it. Private to classify/.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/vec4.hpp>
#include <span>

#include "classify/table_encoding.hpp"

namespace cellproj {

// The table has `size` ≥ 2 texels of four floats per axis, the first axis fastest; fraction 0 is its first texel, 1 the
// last one. Fractions are clamped to that; none may be NaN.
template <std::size_t Axes>
glm::dvec4 interpolate(std::span<const float> texels, int size, const std::array<double, Axes>& fractions,
                       const TableEncoding& encoding) {
    std::array<std::size_t, Axes> first{};  // the texel at or before the place, on each axis
    std::array<double, Axes> rest{};        // how far it is to the next one
    for (std::size_t axis = 0; axis < Axes; ++axis) {
        assert(!std::isnan(fractions[axis]));
        const double position = std::clamp(fractions[axis], 0.0, 1.0) * (size - 1);
        const int texel = std::min(static_cast<int>(position), size - 2);
        first[axis] = static_cast<std::size_t>(texel);
        rest[axis] = position - texel;
    }
    glm::dvec4 sum(0.0);
    for (std::size_t corner = 0; corner < std::size_t{1} << Axes; ++corner) {
        std::size_t index = 0;
        double weight = 1.0;
        for (std::size_t axis = Axes; axis-- > 0;) {
            const std::size_t next = corner >> axis & 1U;
            index = index * static_cast<std::size_t>(size) + first[axis] + next;
            weight *= next == 1 ? rest[axis] : 1.0 - rest[axis];
        }
        sum += weight * encoding.value(&texels[4 * index]);
    }
    return sum;
}

}  // namespace cellproj
