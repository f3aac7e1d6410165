// SPDX-License-Identifier: BSD-3-Clause
#include "sort/visibility_sorter.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>

#include <glm/geometric.hpp>

#include "sort/cell_graph.hpp"
#include "sort/coherent_order.hpp"
#include "sort/depth_keys.hpp"
#include "sort/exact_order.hpp"
#include "sort/mesh_facts.hpp"
#include "sort/power_keys.hpp"
#include "sort/topological_sort.hpp"

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

}  // namespace

struct VisibilitySorter::State {
    State(const TetMesh& mesh, const Adjacency& adjacency)
        : graph(mesh, adjacency), convex(fills_convex_body(graph)), exact(graph) {}

    CellGraph graph;
    bool convex;
    ExactOrder exact;
    TopologicalSort topological;
    KeySort key_sort;
    std::optional<bool> delaunay;     // once it was asked for
    std::optional<PowerKeys> powers;  // likewise
    std::vector<std::uint32_t> items;
    std::optional<Eye> last_eye;  // of the last proven order by relations, in convex meshes
    CoherentOrder coherent;
    bool coherent_fails = false;  // tried since the last view from elsewhere

    bool is_delaunay();
    void make_room_for(OrderMethod method);
    void free_items() { std::vector<std::uint32_t>().swap(items); }  // `items = {}` would not
    std::span<const CellId> order_by_centroids(const Eye& eye, std::span<const std::uint8_t> visible);
    std::span<const CellId> order_by_powers(const Eye& eye, std::span<const std::uint8_t> visible, OrderReport& report);
    std::span<const CellId> order_by_relations(const Eye& eye, OrderReport& report);
    std::span<const CellId> order_of_convex(const Eye& eye);
    bool order_coherently(const Eye& eye);
    bool close_to_last(const Eye& eye) const;
    ViewOrder only_visible(const ViewOrder& order, std::span<const std::uint8_t> visible);
    ViewOrder order_exactly(const Eye& eye, const PixelGrid* pixels, OrderReport& report);
    ViewOrder cut_cycles(const Eye& eye, OrderReport& report);
    std::span<const CellId> in_callers_numbers(std::span<const CellId> places);
    std::span<const CellId> in_place_in_callers_numbers(std::span<CellId> places);
    void renumber(std::span<const CellId> places, std::span<CellId> cells) const;
};

VisibilitySorter::VisibilitySorter(const TetMesh& mesh, const Adjacency& adjacency)
    : state_(std::make_unique<State>(mesh, adjacency)) {}

VisibilitySorter::~VisibilitySorter() = default;
VisibilitySorter::VisibilitySorter(VisibilitySorter&&) noexcept = default;
VisibilitySorter& VisibilitySorter::operator=(VisibilitySorter&&) noexcept = default;

bool VisibilitySorter::convex() const { return state_->convex; }

ViewOrder VisibilitySorter::order(const Eye& eye, OrderReport* report, std::optional<OrderMethod> method,
                                  const PixelGrid* pixels, std::span<const std::uint8_t> visible) {
    assert(visible.empty() || visible.size() == state_->graph.size());
    OrderReport found;
    found.method = method.value_or(state_->convex ? OrderMethod::mpvo : OrderMethod::sxmpvo);
    if (found.method == OrderMethod::sxmpvo && !pixels) found.method = OrderMethod::bsp;
    state_->make_room_for(found.method);
    if (found.method != OrderMethod::power) state_->powers.reset();  // stay where they only find that mpvo must take over
    if (found.method == OrderMethod::bsp || found.method == OrderMethod::sxmpvo) {
        const ViewOrder order = state_->order_exactly(eye, pixels, found);
        if (report) *report = found;
        return state_->only_visible(order, visible);
    }
    const auto cells = found.method == OrderMethod::centroid ? state_->order_by_centroids(eye, visible)
                       : found.method == OrderMethod::power  ? state_->order_by_powers(eye, visible, found)
                                                             : state_->order_by_relations(eye, found);
    // A convex body with visibility cycles: cut them.
    const bool has_cycles = found.method == OrderMethod::mpvo && state_->convex && cells.size() < state_->graph.size();
    const ViewOrder order = has_cycles ? state_->cut_cycles(eye, found) : ViewOrder{cells, {}};
    if (report) *report = found;
    const bool by_keys = found.method == OrderMethod::centroid || found.method == OrderMethod::power;  // which leave out what is not visible
    return by_keys ? order : state_->only_visible(order, visible);
}

// Each method has its memory to itself: what others keep for their next view goes.
void VisibilitySorter::State::make_room_for(OrderMethod method) {
    if (method != OrderMethod::power) graph.find_points();
    const bool by_keys = method == OrderMethod::centroid || method == OrderMethod::power;
    if (by_keys) {
        topological.release();
        coherent.release();
        last_eye.reset();
    } else {
        key_sort.release();
    }
    const bool exactly = method == OrderMethod::bsp || method == OrderMethod::sxmpvo;
    if (!exactly) exact.release_order();
    if (method == OrderMethod::centroid) free_items();
}

ViewOrder VisibilitySorter::State::only_visible(const ViewOrder& order, std::span<const std::uint8_t> visible) {
    if (std::find(visible.begin(), visible.end(), std::uint8_t{0}) == visible.end()) return order;
    const std::size_t cells = graph.size();
    std::size_t count = 0;
    if (items.size() < order.items.size()) items.resize(order.items.size());  // else `order` may stand in it, and ends not later
    for (const std::uint32_t item : order.items) {
        items[count] = item;
        count += visible[item < cells ? item : order.pieces[item - cells].cell] != 0 ? 1 : 0;
    }
    return {std::span(items).first(count), order.pieces};
}

ViewOrder VisibilitySorter::State::order_exactly(const Eye& eye, const PixelGrid* pixels, OrderReport& report) {
    last_eye.reset();
    coherent.release();
    return exact.order(graph, topological, eye, pixels, report);
}

ViewOrder VisibilitySorter::State::cut_cycles(const Eye& eye, OrderReport& report) {
    free_items();
    return exact.cut_cycles(graph, topological, eye, report);
}

bool VisibilitySorter::State::is_delaunay() {
    if (!delaunay) delaunay = convex && graph.flat_cells() == 0 && locally_delaunay(graph);
    return *delaunay;
}

std::span<const CellId> VisibilitySorter::State::order_by_centroids(const Eye& eye, std::span<const std::uint8_t> visible) {
    return in_place_in_callers_numbers(key_sort.sort(graph.size(), centroid_keys(graph, eye, visible)));
}

std::span<const CellId> VisibilitySorter::State::order_by_powers(const Eye& eye, std::span<const std::uint8_t> visible,
                                                                 OrderReport& report) {
    if (!powers) powers.emplace(graph);
    auto places = key_sort.sort(graph.size(), powers->keys(graph, eye, visible));
    report.exact = is_delaunay() && powers->settle(graph, eye, places, key_sort.scratch());
    if (report.exact || !*delaunay) {
        graph.release_points();
        return in_place_in_callers_numbers(places);
    }
    if (visible.empty()) {
        make_room_for(OrderMethod::mpvo);
        return order_by_relations(eye, report);
    }
    // A relation in doubt leads through a cell that was left out: with all cells.
    const auto all = order_by_powers(eye, {}, report);
    if (report.method != OrderMethod::power) return all;
    const auto cells = key_sort.sorted();  // which `all` stands in
    const auto last = std::remove_if(cells.begin(), cells.end(), [&](CellId cell) { return visible[cell] == 0; });
    return cells.first(static_cast<std::size_t>(last - cells.begin()));
}

// In a mesh that fills a convex body any topological order will do; fewer than all when there are cycles. Elsewhere depth has to help.
std::span<const CellId> VisibilitySorter::State::order_by_relations(const Eye& eye, OrderReport& report) {
    report.method = OrderMethod::mpvo;
    if (convex) {
        const auto cells = order_of_convex(eye);
        report.exact = cells.size() == graph.size();
        last_eye = report.exact ? std::optional(eye) : std::nullopt;
        return cells;
    }
    return in_callers_numbers(topological.run_by_depth(graph, eye, report.unordered));
}

std::span<const CellId> VisibilitySorter::State::order_of_convex(const Eye& eye) {
    if (order_coherently(eye)) return coherent.cells();
    coherent.release();
    return in_callers_numbers(topological.run(graph, eye));
}

// One view alone is ordered faster without what the next one would start from: it begins with the second of two that are close.
bool VisibilitySorter::State::order_coherently(const Eye& eye) {
    const bool close = last_eye && close_to_last(eye);
    if (!close) coherent_fails = false;
    if (!close || coherent_fails) return false;
    if (coherent.empty()) {
        topological.release();
        free_items();
    }
    coherent_fails = !(coherent.empty() ? coherent.start(graph, eye) : coherent.follow(graph, eye));
    return !coherent_fails;
}

// Within a few degrees around the mesh: beyond, more changes than stays.
bool VisibilitySorter::State::close_to_last(const Eye& eye) const {
    if (eye.at_infinity != last_eye->at_infinity) return false;
    const glm::dvec3 now = graph.scaled(eye), then = graph.scaled(*last_eye);
    return glm::distance(now, then) < 0.1 * std::max(1.0, glm::length(now));
}

std::span<const CellId> VisibilitySorter::State::in_callers_numbers(std::span<const CellId> places) {
    if (graph.keeps_order()) return places;
    items.resize(places.size());
    renumber(places, items);
    return items;
}

std::span<const CellId> VisibilitySorter::State::in_place_in_callers_numbers(std::span<CellId> places) {
    if (!graph.keeps_order()) renumber(places, places);
    return places;
}

void VisibilitySorter::State::renumber(std::span<const CellId> places, std::span<CellId> cells) const {
    oneapi::tbb::parallel_for(Range(0, places.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) cells[i] = graph.cell(places[i]);
    });
}

std::size_t VisibilitySorter::count_violations(const ViewOrder& order, const Eye& eye) const {
    const CellGraph& graph = state_->graph;
    const auto position = positions(order, graph.size());
    const auto wrong_way_round = [&](CellId place, int face) {
        const CellId other = graph.neighbours(place)[static_cast<std::size_t>(face)];
        if (other == graph.nobody() || other < place) return false;
        const std::uint32_t here = position[graph.cell(place)], there = position[graph.cell(other)];
        if (here == absent || there == absent) return false;
        const int beyond = graph.beyond(eye, place, face);
        return beyond != 0 && (beyond > 0) != (there > here);
    };
    const auto count = [&](const Range& range, std::size_t so_far) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (int face = 0; face < 4; ++face) so_far += wrong_way_round(static_cast<CellId>(i), face) ? 1 : 0;
        }
        return so_far;
    };
    return oneapi::tbb::parallel_reduce(Range(0, graph.size(), cells_per_task), std::size_t{0}, count, std::plus<>());
}

std::vector<CellId> order_cells(const TetMesh& mesh, const Eye& eye, OrderReport* report) {
    VisibilitySorter sorter(mesh);
    OrderReport found;
    const ViewOrder order = sorter.order(eye, &found);
    std::vector<CellId> cells;
    cells.reserve(mesh.tets.size());
    std::vector<bool> is_there(order.pieces.empty() ? 0 : mesh.tets.size());
    for (const std::uint32_t item : order.items) {
        if (item < mesh.tets.size()) {
            cells.push_back(item);
            continue;
        }
        const CellId cell = order.pieces[item - mesh.tets.size()].cell;
        if (is_there[cell]) continue;
        is_there[cell] = true;
        cells.push_back(cell);
    }
    if (!order.pieces.empty()) {
        found.exact = false;
        found.unordered += found.split_cells;
        found.split_cells = 0;
    }
    if (report) *report = found;
    return cells;
}

}  // namespace cellproj
