// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: VTK's Lagrange cells, cut into linear ones at their nodes.
#pragma once

#include <cstddef>
#include <span>

#include "mesh/dataset.hpp"

namespace cellproj {

// The order of a tetrahedron, hexahedron or wedge of so many nodes, the same in all directions; 1 where there is none.
int order_of_lagrange_cell(CellKind kind, std::size_t nodes);

// Appends the order³ pieces between neighbouring nodes: all of the cell's kind. A face is cut the same way from both of
// its sides. `nodes` in VTK's order, as many as the order wants.
void append_lagrange_pieces(CellKind kind, int order, std::span<const VertexId> nodes, CellList& cells);

}  // namespace cellproj
