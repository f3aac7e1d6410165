// SPDX-License-Identifier: BSD-3-Clause
//
// What stands between cells that see each other across the outside: the boundary faces, and along a ray the step from one that
// it leaves a cell by to the next one that it enters a cell by.
#pragma once

#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Whether two cells that share a face both have volume and lie on different sides of it, by exact signs. Only then can the plane of
// the face say which of them hides the other.
bool separates(const TetMesh& mesh, CellId cell, int face, CellId other);

// The faces of cells with volume that do not separate them from a neighbour: there is none, or it is flat and no obstacle, or it
// lies on the same side. In cell order. Parallel.
std::vector<BoundaryFace> order_boundary(const TetMesh& mesh, const Adjacency& adjacency);

}  // namespace cellproj
