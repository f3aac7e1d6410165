// SPDX-License-Identifier: BSD-3-Clause
//
// What stands between cells that see each other across the outside: the boundary faces, and along a ray the step from one that
// it leaves a cell by to the next one that it enters a cell by.
#pragma once

#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// The faces of the cells with volume behind which there is no cell with volume: nothing, or a flat cell, which is no obstacle.
// In cell order. Parallel.
std::vector<BoundaryFace> order_boundary(const TetMesh& mesh, const Adjacency& adjacency);

}  // namespace cellproj
