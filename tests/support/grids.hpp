// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids whose field is a function.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>

#include "mesh/grid.hpp"
#include "project/camera.hpp"

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

// The length of a ray in a box, in units of its direction; of what is behind the origin, too, unless it starts there.
inline double chord_in_box(const Bounds& box, const ScreenTransform::Ray& ray, bool from_origin) {
    double enter = from_origin ? 0 : -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (box.low[axis] - ray.origin[axis]) / ray.direction[axis];
        const double b = (box.high[axis] - ray.origin[axis]) / ray.direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return std::max(0.0, leave - enter);
}

// n cells along each axis.
inline Grid unit_cube(std::size_t n, const std::function<double(const glm::dvec3&)>& f) {
    const GridAxis axis = uniform_axis(0, 1.0 / static_cast<double>(n), n + 1);
    return grid_of({axis, axis, axis}, f);
}

}  // namespace cellproj::testing_support
