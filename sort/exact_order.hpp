// SPDX-License-Identifier: BSD-3-Clause
//
// Orders that are exact for any mesh whose cells do not overlap: the relations of face neighbours; across the outside those of all
// rays (boundary_overlaps.hpp) or of the rays of a picture (boundary_scan.hpp); a topological sort of both; and what it does not
// reach, because of a cycle, cut until there is none (cycles.hpp).
#pragma once

#include <span>
#include <vector>

#include "sort/cell_graph.hpp"
#include "sort/cycles.hpp"
#include "sort/topological_sort.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// Keeps the boundary faces and the memory of the last order. Memory: 4 bytes per cell, 8 in Morton order, and 8 per boundary face.
class ExactOrder {
public:
    // Finds the boundary. `limit`: how far cycles are cut.
    explicit ExactOrder(const CellGraph& graph, CutLimit limit = {});

    // By bsp, for all rays, or sxmpvo, for those of `pixels`, which must be there and of this eye: as the report says, of which this sets all
    // the rest. The order is said to be exact when all relations hold and no cells were seen to overlap: with bsp no faces with both cells on
    // one side, with sxmpvo no ray that enters a cell before it has left the last. The spans stay valid until the next call.
    ViewOrder order(const CellGraph& graph, TopologicalSort& topological, const Eye& eye, const PixelGrid* pixels, OrderReport& report);
    // The last order that `topological` has found without arcs in a mesh that fills a convex body, its cycles cut.
    ViewOrder cut_cycles(const CellGraph& graph, const TopologicalSort& topological, const Eye& eye, OrderReport& report);
    // The memory of the last order, but not the boundary.
    void release_order();

private:
    std::vector<OrderArc> arcs_across(const CellGraph& graph, const Eye& eye, const PixelGrid* pixels, OrderReport& report);
    ViewOrder complete(const CellGraph& graph, const TopologicalSort& topological, std::span<const OrderArc> arcs, const Eye& eye,
                       OrderReport& report);

    std::vector<BoundaryFace> boundary_;
    CutLimit limit_;
    std::vector<CellId> places_;  // #T: the place of a cell, when asked for; empty where the graph keeps the order
    std::vector<std::uint32_t> items_;
    std::vector<CellPiece> pieces_;
};

}  // namespace cellproj
