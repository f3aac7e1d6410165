// SPDX-License-Identifier: BSD-3-Clause
//
// Uniform grids refined inside each other (grid_pieces.hpp), with the scalar to draw. What is drawn of a piece are the cells that no
// finer piece covers: the others are blanked.
//
// Where levels meet, a fine piece has points on faces of coarser cells, where these interpolate. There the fine piece takes the
// coarse value, as finite elements constrain hanging nodes: the scalar is then one on both sides, so that no value between
// them is skipped and no isosurface gapes. It costs the fine side no more than the coarse side's interpolation error. Fields on cells are
// constant in each and keep their values.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mesh/grid.hpp"
#include "mesh/grid_pieces.hpp"
#include "mesh/hierarchy_boxes.hpp"

namespace cellproj {

struct GridHierarchy {
    Lattice lattice;
    std::vector<Grid> pieces;  // uniform, planes at those of the lattice; a cell is blanked that is covered, or has no value

    Bounds bounds() const;
    std::size_t visible_cells() const;
    std::size_t cell_count() const;  // those that finer ones cover, too
};

// The hierarchy of a dataset that has pieces, with one of its fields, a row per point or cell of `dataset` (as_scalar). Throws Error
// (data) as `make_grid` and `place_pieces` do, and when the dataset has no pieces. A piece that is covered as a whole stays, blanked.
GridHierarchy make_grid_hierarchy(const Dataset& dataset, const ScalarField& field);

// The same from grids made by hand: their uniform axes say where they lie. What finer ones cover is blanked here, and points between
// levels are made one. Throws Error (data), also for pieces of which some have values on points and some on cells.
GridHierarchy make_grid_hierarchy(std::vector<Grid> pieces, std::vector<std::string> names, const std::string& place);

// The part of a piece in a box of the tree as a grid of its own. Cells that the box cuts have their own scalar on the cut.
Grid grid_in_box(const GridHierarchy& hierarchy, const HierarchyBox& box);

}  // namespace cellproj
