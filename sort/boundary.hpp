// SPDX-License-Identifier: BSD-3-Clause
//
// What stands between cells that see each other across the outside: the boundary faces, and along a ray the step from one that
// it leaves a cell by to the next one that it enters a cell by.
#pragma once

#include <vector>

#include "sort/cell_graph.hpp"

namespace cellproj {

// The faces of cells with volume that do not separate them from a neighbour: there is none, or it is flat and no obstacle, or it
// lies on the same side. In the caller's numbers, in cell order.
std::vector<BoundaryFace> order_boundary(const CellGraph& graph);

}  // namespace cellproj
