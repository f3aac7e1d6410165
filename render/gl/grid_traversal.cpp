// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_traversal.hpp"

#include <algorithm>

namespace cellproj::gl {

std::vector<std::uint32_t> cells_back_to_front(const GridAxis& axis, double eye, bool at_infinity) {
    const auto cells = static_cast<std::uint32_t>(axis.cells());
    // The first cell that ends beyond the eye; those from it on are entered from their low side, those before it from their high one.
    std::uint32_t nearest = 0;
    if (at_infinity) {
        nearest = eye > 0 ? cells : 0;
    } else {
        const auto ends = axis.coordinates.begin() + 1;
        nearest = static_cast<std::uint32_t>(std::upper_bound(ends, axis.coordinates.end(), eye) - ends);
    }
    std::vector<std::uint32_t> sequence;
    sequence.reserve(cells);
    for (std::uint32_t c = 0; c < nearest; ++c) sequence.push_back(c);
    for (std::uint32_t c = cells; c-- > nearest;) sequence.push_back(c);
    return sequence;
}

GridTraversal::GridTraversal(const Grid& grid, const Eye& eye, std::span<const std::uint8_t> drawn) : drawn_(drawn) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        sequences_[a] = cells_back_to_front(grid.axes[a], eye.xyz[axis], eye.at_infinity);
    }
}

void GridTraversal::next(std::size_t count, std::vector<std::uint32_t>& cells) {
    const auto& [x, y, z] = sequences_;
    auto& [i, j, k] = at_;
    cells.clear();
    for (; k < z.size(); ++k, j = 0) {
        for (; j < y.size(); ++j, i = 0) {
            const std::size_t row = x.size() * (y[j] + y.size() * std::size_t{z[k]});
            for (; i < x.size(); ++i) {
                if (cells.size() == count) return;
                if (drawn_[row + x[i]]) cells.push_back(static_cast<std::uint32_t>(row + x[i]));
            }
        }
    }
}

}  // namespace cellproj::gl
