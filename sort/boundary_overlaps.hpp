// SPDX-License-Identifier: BSD-3-Clause
//
// The relations between cells that see each other across the outside, for all rays of an eye: a boundary face by which rays leave a
// cell, and one by which rays enter another, that overlap as seen from the eye, the first behind the second.
//
// With the relations of face neighbours an order that keeps them is exact for every ray, for any mesh whose cells do not overlap:
// on a ray, each cell is followed by a neighbour or, across the outside, by such a pair.
//
// This stands where BSP-XMPVO (Comba et al., EG 1999) has a BSP of the boundary. Its traversal orders all fragments of boundary
// faces one after the other, which is more than is true: of two faces that do not overlap neither is behind, and with relations
// like that between whole cells even acyclic meshes show cycles (hence the paper's list of partially projected cells). Asking the
// pairs costs a search for each view, but needs no preparation, cuts no face, and every answer is a sign of the exact predicates.
#pragma once

#include <span>
#include <vector>

#include "sort/view_order.hpp"

namespace cellproj {

// `boundary`: order_boundary(graph). Each arc once, ascending by (behind, front); the same for any number of threads. Time: a grid over
// what is seen, then every pair of faces whose boxes meet there: about linear where few faces lie one behind the other.
std::vector<OrderArc> boundary_overlaps(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const Eye& eye);

}  // namespace cellproj
