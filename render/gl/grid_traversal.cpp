// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_traversal.hpp"

#include <algorithm>
#include <cmath>

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

GridOrder largest_slice_first(const glm::dvec3& forward) {
    GridOrder order{.front_to_back = true};
    std::stable_sort(order.axes.begin(), order.axes.end(), [&](std::size_t a, std::size_t b) {
        return std::abs(forward[static_cast<int>(a)]) < std::abs(forward[static_cast<int>(b)]);
    });
    return order;
}

GridTraversal::GridTraversal(const Grid& grid, const Eye& eye, std::span<const std::uint8_t> drawn, const GridOrder& order)
    : axes_(order.axes), drawn_(drawn) {
    const std::size_t nx = grid.axes[0].cells(), ny = grid.axes[1].cells();
    const std::array<std::size_t, 3> strides{1, nx, nx * ny};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t axis = axes_[i];
        strides_[i] = strides[axis];
        sequences_[i] = cells_back_to_front(grid.axes[axis], eye.xyz[static_cast<int>(axis)], eye.at_infinity);
        if (order.front_to_back) std::reverse(sequences_[i].begin(), sequences_[i].end());
    }
    end_ = sequences_[2].size();
}

void GridTraversal::next(std::size_t count, std::vector<std::uint32_t>& cells) {
    const auto& [x, y, z] = sequences_;
    auto& [i, j, k] = at_;
    cells.clear();
    for (; k < end_; ++k, j = 0) {
        for (; j < y.size(); ++j, i = 0) {
            const std::size_t row = y[j] * strides_[1] + z[k] * strides_[2];
            const std::uint8_t* hidden = hidden_.empty() ? nullptr : &hidden_[j / brick_side * bricks(0)];
            while (i < x.size()) {
                if (hidden && hidden[i / brick_side] != 0) {
                    i = (i / brick_side + 1) * brick_side;
                    continue;
                }
                if (cells.size() == count) return;
                const std::size_t id = row + x[i] * strides_[0];
                if (drawn_[id]) cells.push_back(static_cast<std::uint32_t>(id));
                ++i;
            }
        }
    }
}

void GridTraversal::extend(CellRange& range, std::size_t axis, std::size_t begin, std::size_t end) const {
    const auto& sequence = sequences_[axis];
    const auto [low, high] = std::minmax_element(sequence.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 sequence.begin() + static_cast<std::ptrdiff_t>(std::min(end, sequence.size())));
    range.low[axes_[axis]] = *low;
    range.high[axes_[axis]] = *high + std::size_t{1};
}

CellRange GridTraversal::brick(std::size_t i, std::size_t j) const {
    CellRange range{};
    extend(range, 0, i * brick_side, (i + 1) * brick_side);
    extend(range, 1, j * brick_side, (j + 1) * brick_side);
    extend(range, 2, at_[2], end_);
    return range;
}

CellRange GridTraversal::rest() const {
    CellRange range{};
    for (std::size_t axis = 0; axis < 3; ++axis) extend(range, axis, axis == 2 ? at_[2] : 0, sequences_[axis].size());
    return range;
}

}  // namespace cellproj::gl
