// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: cells of second order, cut into linear ones at their nodes.
//
// Each edge is halved at its node, each four-sided face cut into four around its centre and so on: a tetrahedron
// becomes 8 tetrahedra, a hexahedron 8 hexahedra, a wedge 8 wedges (4 where its upright edges have no nodes), a pyramid
// 6 pyramids and 4 tetrahedra. All nodes and their values are used, edges are bent at their nodes, and the two cells of
// a face get the same pieces of it. Centres that a cell's type lacks (of the faces of the 20-node hexahedron, say) are
// made by its own shape functions, once per face. The pieces are linear again, so a curved edge is drawn as two chords:
// its distance from them is a quarter of that from one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj {

constexpr VertexId no_node = ~VertexId{0};

// The nodes of a kind beyond its corners, in this order: one per edge (second_order_edges), one per four-sided face in
// the order of `faces_of`, and one inside a hexahedron. 0 for kinds without a second order.
std::size_t extra_nodes(CellKind kind);

// The edges of a kind, as pairs of corners, in the order of VTK's quadratic cells.
std::span<const std::array<std::uint8_t, 2>> second_order_edges(CellKind kind);

// The extra nodes of some of a dataset's cells; the corners stand in Dataset::cells.
struct CurvedCells {
    std::vector<std::size_t> cells;  // ascending
    std::vector<VertexId> nodes;     // extra_nodes(kind) for each of them; no_node where the file has none

    // `file_nodes`: all nodes of cell `cell` as the file has them; `places`: where in there each of the extra nodes
    // stands, -1 for none.
    void add(std::size_t cell, std::span<const VertexId> file_nodes, std::span<const std::int8_t> places);
};

// Replaces the curved cells by their pieces, each of which repeats the cell's row of the cell fields. New centres come
// after the points, their values from the same shape functions. Edges without nodes: only the upright ones of a wedge,
// all three of them. Throws Error (data) for more points than ids.
void subdivide_at_nodes(Dataset& dataset, const CurvedCells& curved);

}  // namespace cellproj
