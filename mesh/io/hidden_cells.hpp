// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: grids with holes.
#pragma once

#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj {

// Leaves out the cells of a curvilinear grid that are marked in `hidden`, one entry per cell (i fastest), and the
// points that no other cell has: what stands there means nothing and must not count for a field's range. The others
// become hexahedra, in their order; the number of those left out goes to `ghost_cells`, which ones to `boxes`. Nothing changes where none
// is marked. A grid of boxes of which cells were left out already may lose more.
void leave_out_cells(Dataset& dataset, const std::vector<bool>& hidden);

// The cells of a grid that touch a point marked in `hidden` (one entry per point, i fastest).
std::vector<bool> cells_touching(const GridDimensions& grid, const std::vector<bool>& hidden);

}  // namespace cellproj
