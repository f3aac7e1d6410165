// SPDX-License-Identifier: BSD-3-Clause
#include "sort/visibility_sorter.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <cassert>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "sort/boundary.hpp"
#include "sort/boundary_overlaps.hpp"
#include "sort/boundary_scan.hpp"
#include "sort/cycles.hpp"
#include "sort/mesh_facts.hpp"

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

constexpr std::size_t cells_per_task = 4096;
constexpr auto absent = std::numeric_limits<std::uint32_t>::max();

// Where each whole cell stands in an order.
std::vector<std::uint32_t> positions(const ViewOrder& order, std::size_t cells) {
    std::vector<std::uint32_t> position(cells, absent);
    for (std::uint32_t i = 0; i < order.items.size(); ++i) {
        if (order.items[i] < cells) position[order.items[i]] = i;
    }
    return position;
}

// Counts the faces of all cells for which `wrong(cell, face)` holds.
template <class Wrong>
std::size_t count_faces(std::size_t cells, Wrong wrong) {
    const auto count = [&](const Range& range, std::size_t so_far) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            for (int face = 0; face < 4; ++face) so_far += wrong(static_cast<CellId>(c), face) ? 1 : 0;
        }
        return so_far;
    };
    return oneapi::tbb::parallel_reduce(Range(0, cells, cells_per_task), std::size_t{0}, count, std::plus<>());
}

// Whether cells at positions a and b stand the wrong way round when the eye is on b's side (+1) or on a's (−1) of their face.
bool wrong_way_round(std::uint32_t a, std::uint32_t b, int beyond) {
    return a != absent && b != absent && beyond != 0 && (beyond > 0) != (b > a);
}

}  // namespace

VisibilitySorter::VisibilitySorter(const TetMesh& mesh, const Adjacency& adjacency)
    : graph_(mesh, adjacency), convex_(fills_convex_body(graph_)) {}

ViewOrder VisibilitySorter::order(const Eye& eye, OrderReport* report, std::optional<OrderMethod> method,
                                  const PixelGrid* pixels, std::span<const std::uint8_t> visible) {
    assert(visible.empty() || visible.size() == graph_.size());
    OrderReport found;
    found.method = method.value_or(convex_ ? OrderMethod::mpvo : OrderMethod::sxmpvo);
    if (found.method == OrderMethod::sxmpvo && !pixels) found.method = OrderMethod::bsp;
    if (found.method == OrderMethod::bsp || found.method == OrderMethod::sxmpvo ||
        (found.method == OrderMethod::mpvo && convex_)) {
        const ViewOrder exact = order_exactly(eye, found, pixels);
        if (report) *report = found;
        return exact;
    }
    std::span<const CellId> places;
    if (found.method == OrderMethod::centroid) {
        find_centroid_keys(graph_, eye, visible, key_sort_.keys(graph_.size()));
        places = key_sort_.sort();
    } else {
        found.method = OrderMethod::mpvo;
        places = order_by_relations(eye, found);
    }
    if (report) *report = found;
    return in_callers_numbers(places);
}

// Depth has to help where relations are missing, and in cycles.
std::span<const CellId> VisibilitySorter::order_by_relations(const Eye& eye, OrderReport& report) {
    return topological_.run_by_depth(graph_, eye, report.unordered);
}

// A mesh that fills a convex body has all its relations in its faces. Others get those across the outside as arcs.
ViewOrder VisibilitySorter::order_exactly(const Eye& eye, OrderReport& report, const PixelGrid* pixels) {
    std::vector<OrderArc> arcs;
    bool overlapping = graph_.folded_faces() > 0;
    if (report.method != OrderMethod::mpvo) {
        if (places_.empty()) {
            boundary_ = order_boundary(graph_.mesh(), graph_.adjacency());
            places_.resize(graph_.size());
            for (CellId place = 0; place < graph_.size(); ++place) places_[graph_.cell(place)] = place;
        }
        if (report.method == OrderMethod::sxmpvo) {
            BoundaryScan scan = scan_boundary(graph_.mesh(), boundary_, *pixels);
            arcs = std::move(scan.arcs);
            overlapping = scan.crossed_rays > 0;
        } else {
            arcs = boundary_overlaps(graph_.mesh(), boundary_, eye);
        }
        for (OrderArc& arc : arcs) arc = {places_[arc.behind], places_[arc.front]};
    }
    const ViewOrder order = sort_and_resolve(eye, report, arcs);
    report.exact = report.unordered == 0 && !overlapping;
    return order;
}

// What the topological sort does not reach waits for a cycle, and comes after all that it reaches.
ViewOrder VisibilitySorter::sort_and_resolve(const Eye& eye, OrderReport& report, std::span<const OrderArc> arcs) {
    const auto places = topological_.run(graph_, eye, arcs);
    in_callers_numbers(places);
    if (places.size() == graph_.size()) return {items_, {}};
    ResolvedCycles rest = resolve_cycles(graph_, topological_.stalled(), arcs, eye);
    items_.insert(items_.end(), rest.items.begin(), rest.items.end());
    pieces_ = std::move(rest.pieces);
    report.unordered = rest.unordered;
    report.cycles = rest.cycles;
    report.split_cells = rest.split_cells;
    return {items_, pieces_};
}

ViewOrder VisibilitySorter::in_callers_numbers(std::span<const CellId> places) {
    items_.resize(places.size());
    oneapi::tbb::parallel_for(Range(0, places.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) items_[i] = graph_.cell(places[i]);
    });
    return {items_, {}};
}

std::size_t VisibilitySorter::count_violations(const ViewOrder& order, const Eye& eye) const {
    const auto position = positions(order, graph_.size());
    return count_faces(graph_.size(), [&](CellId place, int face) {
        const CellId other = graph_.neighbours(place)[static_cast<std::size_t>(face)];
        if (other == graph_.nobody() || other < place) return false;
        return wrong_way_round(position[graph_.cell(place)], position[graph_.cell(other)], graph_.beyond(eye, place, face));
    });
}

std::vector<CellId> order_cells(const TetMesh& mesh, const Eye& eye, OrderReport* report) {
    VisibilitySorter sorter(mesh);
    const ViewOrder order = sorter.order(eye, report);
    return {order.items.begin(), order.items.end()};
}

std::size_t count_order_violations(const TetMesh& mesh, const Adjacency& adjacency, const ViewOrder& order, const Eye& eye) {
    const auto position = positions(order, mesh.tets.size());
    return count_faces(mesh.tets.size(), [&](CellId cell, int face) {
        const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
        if (other == no_cell || other < cell) return false;
        const auto v = face_vertices(mesh.tets[cell], face);
        const int beyond = side_of_plane(eye, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]);
        return wrong_way_round(position[cell], position[other], beyond);
    });
}

}  // namespace cellproj
