// SPDX-License-Identifier: AGPL-3.0-or-later
//
// From the polygons of a file to a boundary that TetGen can fill, and back from what it filled to what is inside.
#pragma once

#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

// Merges coincident points and equal polygons, turns the polygons to agree, joins open edges that coincide and
// triangulates: the facets of the result are triangles, closed, without intersections, all 2-manifold. With
// `fill_holes`, what is still open is capped. Throws Error (data), naming the surface, for one that is flat, open,
// non-manifold or intersects itself; facets are told by their index in `surface`, from 0.
PiecewiseLinearComplex closed_boundary(const Surface& surface, bool fill_holes);

// Keeps the cells of the regions (cell field "region") that an odd number of sheets of the boundary separates from
// infinity, so that a closed sheet within another is a cavity, whichever way its facets face. Drops the field and the
// points that no cell uses.
void keep_inside(TetMesh& mesh, const PiecewiseLinearComplex& boundary);

}  // namespace cellproj
