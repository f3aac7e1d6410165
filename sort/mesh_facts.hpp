// SPDX-License-Identifier: BSD-3-Clause
//
// What is true of a mesh from every eye, and decides which method orders it exactly. All by exact signs.
#pragma once

#include "sort/cell_graph.hpp"

namespace cellproj {

// Whether the cells fill a convex body without gap or fold: the boundary is one closed surface of the topology of a sphere, nowhere
// concave across an edge, and no face has both its cells on one side. A closed surface that is locally convex everywhere bounds a convex
// body (Van Heijenoort, "On Locally Convex Manifolds", Comm. Pure Appl. Math. 5, 1952). Says no when in doubt.
bool fills_convex_body(const CellGraph& graph);

// Whether no cell is flat or inverted and no vertex of a face neighbour lies inside a cell's circumsphere: then the mesh is a Delaunay
// tetrahedralization if it fills a convex body (Delaunay's lemma). Vertices on the sphere are allowed.
bool locally_delaunay(const CellGraph& graph);

}  // namespace cellproj
