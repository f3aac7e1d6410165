// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/grid_gradient.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>

namespace cellproj {

namespace {

// Whether a cell that is not blanked has the edge from a point to the next one along an axis.
bool has_edge(const Grid& grid, const GridCell& low, std::size_t axis) {
    if (grid.blanked.empty()) return true;
    const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    GridCell cell = low;
    for (const std::size_t below_b : {0U, 1U}) {
        for (const std::size_t below_c : {0U, 1U}) {
            if (low[b] < below_b || low[c] < below_c) continue;
            cell[b] = low[b] - below_b;
            cell[c] = low[c] - below_c;
            if (cell[b] >= grid.axes[b].cells() || cell[c] >= grid.axes[c].cells()) continue;
            if (!grid.is_blanked(cell)) return true;
        }
    }
    return false;
}

struct Slope {
    double value, length;
};

// From a point to the next one.
std::optional<Slope> slope_above(const Grid& grid, const GridCell& low, std::size_t axis) {
    if (low[axis] >= grid.axes[axis].cells() || !has_edge(grid, low, axis)) return std::nullopt;
    const GridDimensions n = grid.dimensions();
    const std::array<std::size_t, 3> stride{1, n.ni, n.ni * n.nj};
    const std::size_t id = low[0] * stride[0] + low[1] * stride[1] + low[2] * stride[2];
    const std::vector<double>& x = grid.axes[axis].coordinates;
    const double length = x[low[axis] + 1] - x[low[axis]];
    const double slope = (grid.values[id + stride[axis]] - grid.values[id]) / length;
    if (!std::isfinite(slope)) return std::nullopt;
    return Slope{slope, length};
}

}  // namespace

glm::dvec3 trilinear_gradient(const std::array<double, 8>& corner_values, const glm::dvec3& u, const glm::dvec3& edges) {
    const auto& c = corner_values;
    glm::dvec3 result;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t bit = std::size_t{1} << axis, b = (axis + 1) % 3, d = (axis + 2) % 3;
        const double v = u[static_cast<int>(b)], w = u[static_cast<int>(d)];
        const std::size_t bit_b = std::size_t{1} << b, bit_d = std::size_t{1} << d;
        const auto difference = [&](std::size_t corner) { return c[corner | bit] - c[corner]; };
        const double sum = (1 - w) * ((1 - v) * difference(0) + v * difference(bit_b)) +
                           w * ((1 - v) * difference(bit_d) + v * difference(bit_b | bit_d));
        result[static_cast<int>(axis)] = sum / edges[static_cast<int>(axis)];
    }
    return result;
}

glm::dvec3 point_gradient(const Grid& grid, const GridCell& point) {
    assert(grid.location == FieldLocation::points);
    glm::dvec3 result(0.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::optional<Slope> above = slope_above(grid, point, axis);
        std::optional<Slope> below;
        if (point[axis] > 0) {
            GridCell low = point;
            --low[axis];
            below = slope_above(grid, low, axis);
        }
        double& slope = result[static_cast<int>(axis)];
        if (above && below) {
            const double share = below->length / (below->length + above->length);  // the nearer neighbour counts more
            slope = (1 - share) * below->value + share * above->value;
        } else if (above || below) {
            slope = above ? above->value : below->value;
        }
    }
    return result;
}

}  // namespace cellproj
