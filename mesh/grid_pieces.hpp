// SPDX-License-Identifier: BSD-3-Clause
//
// Grids refined inside each other (WVG91 §2's octree-like hierarchies; overlapping AMR after Berger and Colella, "Local Adaptive Mesh
// Refinement for Shock Hydrodynamics", 1989): where the pieces lie among each other, in whole numbers.
//
// The lattice has the spacing of the finest pieces; the cells of a coarser level are `step` lattice cells along each axis. All pieces of
// a level have their planes on one lattice of that step. Level 0 is the coarsest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mesh/grid_axis.hpp"

namespace cellproj {

using LatticeIndex = std::array<std::int64_t, 3>;

// Lattice cells from `low` up to `high`, without it.
struct LatticeBox {
    LatticeIndex low{}, high{};

    bool is_empty() const { return low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]; }
};

LatticeBox intersection(const LatticeBox& a, const LatticeBox& b);

struct PiecePlace {
    int level = 0;
    LatticeIndex step{};  // of its cells [lattice cells]
    LatticeBox box;
};

struct Lattice {
    std::array<double, 3> origin{}, spacing{};  // of plane 0; from plane to plane [mesh units]
    std::vector<PiecePlace> pieces;             // in the order in which they were given
    int levels = 0;

    double plane(std::size_t axis, std::int64_t i) const { return origin[axis] + static_cast<double>(i) * spacing[axis]; }
};

// Where pieces lie; `names` tell them apart in messages. Planes may be off by a thousandth of the lattice's spacing, as decimals in
// files are. Throws Error (data) at `place` for no piece, an axis that is not uniform or does not ascend (grid_axis.hpp), spacings that
// are no multiples of finer ones, a piece between the planes of its level, and pieces of a level that overlap.
Lattice place_pieces(std::span<const std::array<GridAxis, 3>> axes, std::span<const std::string> names, const std::string& place);

// For each piece, which of its cells lie under finer pieces (i fastest). Throws Error (data) where finer pieces cover a part of a
// cell only.
std::vector<std::vector<bool>> covered_cells(const Lattice& lattice, std::span<const std::string> names, const std::string& place);

}  // namespace cellproj
