// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids whose field is a function.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>

#include "mesh/grid.hpp"

namespace cellproj::testing_support {

inline Grid grid_of(std::array<GridAxis, 3> axes, const std::function<double(const glm::dvec3&)>& f) {
    Grid grid{std::move(axes), FieldLocation::points, {}, {}};
    for (const double z : grid.axes[2].coordinates) {
        for (const double y : grid.axes[1].coordinates) {
            for (const double x : grid.axes[0].coordinates)
                grid.values.push_back(f({x, y, z}));
        }
    }
    return grid;
}

// n cells along each axis.
inline Grid unit_cube(std::size_t n, const std::function<double(const glm::dvec3&)>& f) {
    const GridAxis axis = uniform_axis(0, 1.0 / static_cast<double>(n), n + 1);
    return grid_of({axis, axis, axis}, f);
}

}  // namespace cellproj::testing_support
