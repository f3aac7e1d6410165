// SPDX-License-Identifier: BSD-3-Clause
//
// Kahn's algorithm over the relations of one view: a cell is free when all that it hides are out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sort/cell_graph.hpp"
#include "sort/depth_queue.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// Keeps its memory from view to view until it is released: 5 bytes per cell, 6 more by depth.
class TopologicalSort {
public:
    // Finds the relations of a view and sorts: places of cells, back to front, the last one freed first. `arcs`, between places, are
    // relations that the graph does not know; they need not be sorted. Fewer than #T where cycles stand in the way.
    std::span<const CellId> run(const CellGraph& graph, const Eye& eye, std::span<const OrderArc> arcs = {});
    // The same without arcs, the farthest centroid of the free cells first. Where no cell is free, the farthest one left is taken
    // against its relations and counted in `unordered`.
    std::span<const CellId> run_by_depth(const CellGraph& graph, const Eye& eye, std::size_t& unordered);

    // The last order again.
    std::span<const CellId> places() const { return std::span(order_).first(done_); }
    // What is left when `run` returns fewer than all: the places that are not in the order, ascending.
    std::vector<CellId> stalled() const;
    void release() { *this = {}; }

private:
    struct ArcHeads;

    void find_depths(const CellGraph& graph, const Eye& eye);

    std::vector<CellGraph::Relations> state_;  // #T + 1: relations, the number of hidden ones counted down; `out` when in the order
    std::vector<CellId> order_;                // #T + 1: the order grows from the front, a stack of free cells from the end
    std::size_t done_ = 0;
    std::vector<std::uint16_t> depth_;         // #T: larger is farther
    DepthQueue queue_;
};

}  // namespace cellproj
