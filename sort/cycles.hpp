// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells that a topological sort could not reach: those in visibility cycles, and those that wait for them.
//
// Their relations (faces, arcs) fall into strongly connected components; these are in order among each other. A component of
// several cells is a cycle. It is resolved by a BSP of its own (Fuchs, Kedem, Naylor, SIGGRAPH 1980; for cells: Comba et al. 1999):
// the plane of a member's face parts the component, what lies on the far side comes first, and cells that the plane meets are
// cut. Each side is again brought into components, so that cutting ends as soon as no cycle is left.
//
// Why that is exact. Take a ray and the cells that it meets one after the other: each two in turn have a relation. Between two
// members of one component all cells on the ray are members, too, else there would be a way round through them. A half space
// cuts a ray in one stretch, so the same holds on each side of the plane, for the parts. So whatever relations are known for all
// consecutive cells of a ray, the parts follow each other on it as they should.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sort/cell_graph.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// A component of n cells is cut into no more than per_cell·n + spare parts; what is left of it then is ordered by depth.
struct CutLimit {
    std::size_t per_cell = 4, spare = 64;
};

struct ResolvedCycles {
    std::vector<std::uint32_t> items;  // from back to front: a cell, or #T + i for pieces[i]
    std::vector<CellPiece> pieces;
    std::size_t unordered = 0;    // cells of which some part was ordered by depth
    std::size_t cycles = 0;       // components of more than one cell with volume
    std::size_t cyclic_cells = 0;  // cells in these
    std::size_t split_cells = 0;  // cells that became pieces
};

// Orders the cells at `places`, by the relations among them: faces that they share, by exact signs, and `arcs` (between places too);
// arcs to other places are passed over. Where cells overlap there is no order: nothing fails, some cell comes first. A place stands
// once in `places`; the answer is in the mesh's own numbers.
ResolvedCycles resolve_cycles(const CellGraph& graph, std::span<const CellId> places, std::span<const OrderArc> arcs, const Eye& eye,
                              CutLimit limit = {});

}  // namespace cellproj
