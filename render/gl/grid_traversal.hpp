// SPDX-License-Identifier: BSD-3-Clause
//
// The order of a grid's cells: slices, rows, cells, each axis from its ends towards the slab that holds the eye
// (parallel views: from the far end to the near one), or the other way round. Exact for every view: of two cells, the one that is farther
// along the first axis that tells them apart lies behind a plane of the grid or beside it (WVG91 §2). From back to front slices lie across
// z, rows along x: they follow each other as the values do in memory. From front to back slices lie across the axis that the view is
// closest to: the largest slice first, so that as much as possible is soon hidden.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/grid.hpp"
#include "mesh/predicates.hpp"
#include "render/gl/grid_view.hpp"

namespace cellproj::gl {

// The cells of an axis from back to front. `eye`: a coordinate, or a component of the direction towards an eye at infinity.
std::vector<std::uint32_t> cells_back_to_front(const GridAxis& axis, double eye, bool at_infinity);

struct GridOrder {
    std::array<std::size_t, 3> axes{0, 1, 2};  // along rows, across them, across slices
    bool front_to_back = false;
};
// `forward`: the viewing direction, in the axes of the grid.
GridOrder largest_slice_first(const glm::dvec3& forward);

class GridTraversal {
public:
    // `drawn`: per cell, 0 for those to leave out; must outlive this.
    GridTraversal(const Grid& grid, const Eye& eye, std::span<const std::uint8_t> drawn, const GridOrder& order = {});

    // Replaces `cells` by the ids of the next ones in the order, `count` at most; none at the end of the part.
    void next(std::size_t count, std::vector<std::uint32_t>& cells);

    // A part of the order is all of it, or the next slices of those that are left.
    std::size_t slices_left() const { return sequences_[2].size() - at_[2]; }
    // Of the next `slices`, ≥ 1, columns of bricks, each brick_side² rows of cells across the slices, are left out where `hides` says so of
    // what they hold.
    template <class Hides>
    void begin_part(std::size_t slices, Hides hides) {
        end_ = slices < slices_left() ? at_[2] + slices : sequences_[2].size();
        hidden_.clear();
        for (std::size_t j = 0; j < bricks(1); ++j) {
            for (std::size_t i = 0; i < bricks(0); ++i) hidden_.push_back(hides(brick(i, j)) ? 1 : 0);
        }
    }
    // What holds all that is left.
    CellRange rest() const;

private:
    static constexpr std::size_t brick_side = 4;
    std::size_t bricks(std::size_t axis) const { return (sequences_[axis].size() + brick_side - 1) / brick_side; }
    CellRange brick(std::size_t i, std::size_t j) const;
    void extend(CellRange& range, std::size_t axis, std::size_t begin, std::size_t end) const;

    std::array<std::size_t, 3> axes_;
    std::array<std::vector<std::uint32_t>, 3> sequences_;  // in the order of axes_
    std::array<std::size_t, 3> strides_;                   // of ids
    std::span<const std::uint8_t> drawn_;
    std::array<std::size_t, 3> at_{};  // positions in the sequences
    std::size_t end_;                  // of the part
    std::vector<std::uint8_t> hidden_;  // columns of bricks; empty: none
};

}  // namespace cellproj::gl
