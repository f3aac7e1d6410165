// SPDX-License-Identifier: BSD-3-Clause
//
// The order of a grid's cells: slices along z, rows along y, cells along x, each axis from its ends towards the slab that holds the eye
// (parallel views: from the far end to the near one). Exact for every view: of two cells, the one that is farther along the first
// axis that tells them apart lies behind a plane of the grid or beside it (WVG91 §2). Slices follow each other as the values do in memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/grid.hpp"
#include "mesh/predicates.hpp"

namespace cellproj::gl {

// The cells of an axis from back to front. `eye`: a coordinate, or a component of the direction towards an eye at infinity.
std::vector<std::uint32_t> cells_back_to_front(const GridAxis& axis, double eye, bool at_infinity);

class GridTraversal {
public:
    // `drawn`: per cell, 0 for those to leave out; must outlive this.
    GridTraversal(const Grid& grid, const Eye& eye, std::span<const std::uint8_t> drawn);

    // Replaces `cells` by the ids of the next ones in the order, `count` at most; none at the end.
    void next(std::size_t count, std::vector<std::uint32_t>& cells);

private:
    std::array<std::vector<std::uint32_t>, 3> sequences_;
    std::span<const std::uint8_t> drawn_;
    std::array<std::size_t, 3> at_{};  // positions in the sequences
};

}  // namespace cellproj::gl
