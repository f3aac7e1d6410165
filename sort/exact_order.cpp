// SPDX-License-Identifier: BSD-3-Clause
#include "sort/exact_order.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <cassert>
#include <utility>

#include "sort/boundary.hpp"
#include "sort/boundary_overlaps.hpp"
#include "sort/boundary_scan.hpp"

namespace cellproj {

ExactOrder::ExactOrder(const CellGraph& graph, CutLimit limit) : boundary_(order_boundary(graph)), limit_(limit) {}

// Between places. Says in the report whether no cells are seen to overlap.
std::vector<OrderArc> ExactOrder::arcs_across(const CellGraph& graph, const Eye& eye, const PixelGrid* pixels, OrderReport& report) {
    std::vector<OrderArc> arcs;
    if (report.method == OrderMethod::sxmpvo) {
        assert(pixels);
        BoundaryScan scan = scan_boundary(graph.mesh(), boundary_, *pixels);
        arcs = std::move(scan.arcs);
        report.exact = scan.crossed_rays == 0;
    } else {
        arcs = boundary_overlaps(graph.mesh(), boundary_, eye);
        report.exact = graph.folded_faces() == 0;
    }
    if (graph.keeps_order()) return arcs;
    if (places_.empty()) {
        places_.resize(graph.size());
        for (CellId place = 0; place < graph.size(); ++place)
            places_[graph.cell(place)] = place;
    }
    for (OrderArc& arc : arcs)
        arc = {places_[arc.behind], places_[arc.front]};
    return arcs;
}

void ExactOrder::release_order() {
    std::vector<CellId>().swap(places_);  // frees; `= {}` would not
    std::vector<std::uint32_t>().swap(items_);
    std::vector<CellPiece>().swap(pieces_);
}

ViewOrder ExactOrder::order(const CellGraph& graph, TopologicalSort& topological, const Eye& eye, const PixelGrid* pixels,
                            OrderReport& report) {
    const std::vector<OrderArc> arcs = arcs_across(graph, eye, pixels, report);
    topological.run(graph, eye, arcs);
    return complete(graph, topological, arcs, eye, report);
}

ViewOrder ExactOrder::cut_cycles(const CellGraph& graph, const TopologicalSort& topological, const Eye& eye, OrderReport& report) {
    report.exact = true;
    return complete(graph, topological, {}, eye, report);
}

ViewOrder ExactOrder::complete(const CellGraph& graph, const TopologicalSort& topological, std::span<const OrderArc> arcs, const Eye& eye,
                               OrderReport& report) {
    const auto places = topological.places();
    items_.resize(places.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, places.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            items_[i] = graph.cell(places[i]);
    });
    pieces_.clear();
    if (places.size() < graph.size()) {
        // What is left waits for a cycle, and comes after all that does not.
        ResolvedCycles rest = resolve_cycles(graph, topological.stalled(), arcs, eye, limit_);
        items_.insert(items_.end(), rest.items.begin(), rest.items.end());
        pieces_ = std::move(rest.pieces);
        report.unordered = rest.unordered;
        report.cycles = rest.cycles;
        report.split_cells = rest.split_cells;
    }
    report.exact = report.exact && report.unordered == 0;
    return {items_, pieces_};
}

}  // namespace cellproj
