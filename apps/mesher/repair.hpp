// SPDX-License-Identifier: AGPL-3.0-or-later
//
// From the polygons of a file to a boundary that TetGen can fill, and back from what it filled to what is inside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

// Merges coincident points and equal polygons, turns the polygons to agree, joins open edges that coincide and
// triangulates: the facets of the result are triangles, closed, without intersections, all 2-manifold. With
// `fill_holes`, what is still open is capped. Throws Error (data), naming the surface, for one that is flat, open,
// non-manifold or intersects itself; facets are told by `facet_of`. `intersections` gets the pairs of facets that cross or
// touch each other, also when they are refused.
PiecewiseLinearComplex closed_boundary(const Surface& surface, bool fill_holes,
                                       std::vector<std::array<std::uint32_t, 2>>& intersections);

// The same without a demand for a manifold or a closed one: inner walls stay, nothing is turned or joined, and what is
// open is left to TetGen. Holes and regions stay behind.
PiecewiseLinearComplex enclosing_facets(const Surface& surface,
                                        std::vector<std::array<std::uint32_t, 2>>& intersections);

// Keeps the cells of the regions (cell field "region") that an odd number of sheets of the boundary separates from
// infinity, so that a closed sheet within another is a cavity, whichever way its facets face. Drops the field and the
// points that no cell uses.
void keep_inside(TetMesh& mesh, const PiecewiseLinearComplex& boundary);

}  // namespace cellproj
