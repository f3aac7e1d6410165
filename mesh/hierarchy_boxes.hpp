// SPDX-License-Identifier: BSD-3-Clause
//
// A hierarchy of grids (grid_pieces.hpp) as boxes that do not overlap, each with cells of one piece only: the finest that covers it. A
// k-d tree whose planes are planes of the lattice, so that the order of boxes is exact for any eye (Fuchs, Kedem and Naylor, "On Visible
// Surface Generation by a Priori Tree Structures", SIGGRAPH 1980).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mesh/grid_pieces.hpp"
#include "mesh/predicates.hpp"

namespace cellproj {

struct HierarchyBox {
    std::size_t piece = 0;  // into Lattice::pieces
    LatticeBox box;         // may cut cells of coarse pieces
};

class HierarchyTree {
public:
    explicit HierarchyTree(const Lattice& lattice);

    const std::vector<HierarchyBox>& boxes() const { return boxes_; }

    // The box that a lattice cell is in; nothing where no piece is.
    std::optional<std::size_t> box_at(const LatticeIndex& cell) const;

    // All boxes from front to back.
    std::vector<std::size_t> front_to_back(const Eye& eye) const;

private:
    // A half space below a plane and one above it, or a box, or nothing.
    struct Node {
        int axis = -1;
        std::int64_t split = 0;  // the plane
        double plane = 0;        // the same [mesh units]
        std::size_t below = 0, above = 0;  // nodes
        std::optional<std::size_t> box = {};
    };
    std::size_t build(const Lattice& lattice, const LatticeBox& box, const std::vector<std::size_t>& pieces);

    std::vector<HierarchyBox> boxes_;
    std::vector<Node> nodes_;  // the first one is the root
};

}  // namespace cellproj
