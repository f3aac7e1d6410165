// SPDX-License-Identifier: BSD-3-Clause
//
// Datasets to conformal tetrahedral meshes, by splitting cells. Every point of the dataset keeps its number and its
// values; new points, if any, come after them.
//
// - Curvilinear grids: five tetrahedra per hexahedron, mirrored from cell to cell by the parity of i + j + k, so that
//   neighbours agree on the diagonal of their common face (Albertelli and Crawfis 1997 call it the alternating split).
// - Cells of unstructured grids: every face is cut into a fan of triangles around its lowest point id, or, where that
// fan
//   has slivers or triangles turned over, into the triangles whose worst is best. The cut depends on the face only, so
//   neighbours agree whatever their kinds are. Where that gives neither inverted nor flat tetrahedra, the cell's lowest
//   point is joined to the triangles of the faces that do not touch it: 2 tetrahedra per pyramid, 3 per wedge, 6 per
//   hexahedron, 9 and 12 per pentagonal and hexagonal prism, no new point (Dompierre, Labbé, Vallet, Camarero, "How to
//   Subdivide Pyramids, Prisms and Hexahedra into Tetrahedra", 1999). Where a point put into the cell does better, and
//   in polyhedra always, that point is joined to all triangles: the mean of the cell's vertices, or the centroid of its
//   volume, or a point in its kernel, the first that all faces see. Its point fields are the mean of the vertices' by
//   weights that make its place their mean, too. Cells that list a vertex twice (a wedge stored as a hexahedron) give
//   fewer tetrahedra, none with a repeated vertex.
//
// Which way round a cell is stored is never trusted: exact signs decide. Faces need not be planar; the tetrahedra fill
// exactly what the triangles of the faces enclose.
#pragma once

#include <cstddef>

#include "mesh/dataset.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct TetrahedralizeReport {
    std::size_t tets = 0;
    std::size_t flipped = 0;        // tets that came out with negative volume and were turned
    std::size_t flat = 0;           // tets of exactly zero volume; they are kept
    std::size_t inverted = 0;       // tets of the other sign than their whole cell, which overlap their neighbours: the
                                    // cell is not star-shaped, or of a curvilinear grid; they are turned and kept
    std::size_t added_points = 0;   // one in each polyhedron and in each of the `centred_cells`
    std::size_t centred_cells = 0;  // other cells that a centre splits with fewer inverted or flat tets
};

// Cell fields are repeated on every tetrahedron of a cell. Throws Error (data) as `validate` does, and for a cell whose
// list of vertices or faces does not fit its kind.
TetMesh tetrahedralize(const Dataset& dataset, TetrahedralizeReport* report = nullptr);

}  // namespace cellproj
