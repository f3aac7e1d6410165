// SPDX-License-Identifier: BSD-3-Clause
//
// Datasets to conformal tetrahedral meshes, by splitting cells: no point is added, every point keeps its values.
//
// - Curvilinear grids: five tetrahedra per hexahedron, mirrored from cell to cell by the parity of i + j + k, so that
//   neighbours agree on the diagonal of their common face (Albertelli and Crawfis 1997 call it the alternating split).
// - Hexahedra of unstructured grids: six tetrahedra, all with the cell's lowest point id as apex, over the faces that do not
//   touch it, each cut through its own lowest point id. The diagonal of a face depends on its ids only, so neighbours agree
//   (Dompierre, Labbé, Vallet, Camarero, "How to Subdivide Pyramids, Prisms and Hexahedra into Tetrahedra", 1999).
//   A hexahedron that lists a vertex twice (a wedge stored as one) gives fewer: none with a repeated vertex is made.
#pragma once

#include <cstddef>

#include "mesh/dataset.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct TetrahedralizeReport {
    std::size_t tets = 0;
    std::size_t flipped = 0;  // tets that came out with negative volume and were turned
    std::size_t flat = 0;     // tets of exactly zero volume; they are kept
};

// Cell fields are repeated on every tetrahedron of a cell. Throws Error (data) as `validate` does.
TetMesh tetrahedralize(const Dataset& dataset, TetrahedralizeReport* report = nullptr);

}  // namespace cellproj
