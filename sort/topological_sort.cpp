// SPDX-License-Identifier: BSD-3-Clause
#include "sort/topological_sort.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>

#include "sort/depth_keys.hpp"

namespace cellproj {

namespace {

using Relations = CellGraph::Relations;

// The state of a cell in the order: more hidden cells than any other has, also after four of them have been counted down.
constexpr Relations out = 0xf0;

}  // namespace

// Arcs by the cell behind, and how many each cell in front still waits for.
struct TopologicalSort::ArcHeads {
    std::vector<OrderArc> arcs;
    std::vector<CellId> fronts;           // ascending
    std::vector<std::uint32_t> waiting;   // per front
    std::vector<bool> is_behind;          // per cell: it has an arc

    ArcHeads(std::span<const OrderArc> given, std::size_t cells) : arcs(given.begin(), given.end()) {
        if (arcs.empty()) return;
        is_behind.resize(cells);
        for (const OrderArc& arc : arcs) is_behind[arc.behind] = true;
        std::sort(arcs.begin(), arcs.end());
        fronts.reserve(arcs.size());
        for (const OrderArc& arc : arcs) fronts.push_back(arc.front);
        std::sort(fronts.begin(), fronts.end());
        std::vector<CellId> all = fronts;
        fronts.erase(std::unique(fronts.begin(), fronts.end()), fronts.end());
        waiting.reserve(fronts.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (i == 0 || all[i] != all[i - 1]) waiting.push_back(0);
            ++waiting.back();
        }
    }

    // Calls free(front) for every cell that waited for this one last.
    template <class Free>
    void release(CellId behind, Free free) {
        auto arc = std::lower_bound(arcs.begin(), arcs.end(), behind, [](const OrderArc& a, CellId cell) { return a.behind < cell; });
        for (; arc != arcs.end() && arc->behind == behind; ++arc) {
            const auto front = std::lower_bound(fronts.begin(), fronts.end(), arc->front) - fronts.begin();
            if (--waiting[static_cast<std::size_t>(front)] == 0) free(arc->front);
        }
    }
};

// Each step is free of branches that depend on the data, which would be guessed wrong every other time: all four neighbours are
// counted down by 0 or 1 and written to the stack, whose top moves on only if they became free. Nobody has a state, too.
std::span<const CellId> TopologicalSort::run(const CellGraph& graph, const Eye& eye, std::span<const OrderArc> arcs) {
    const std::size_t count = graph.size();
    state_.resize(count + 1);
    order_.resize(count + 1);
    graph.find_relations(eye, state_);
    state_[count] = out;
    ArcHeads heads(arcs, count);
    for (const CellId front : heads.fronts) state_[front] += CellGraph::one_hidden;  // all its arcs count as one

    // Local copies: a store of a state, a byte, might otherwise change any of them for all that the compiler knows.
    const std::array<CellId, 4>* const neighbours = graph.neighbours().data();
    Relations* const state = state_.data();
    CellId* const order = order_.data();
    CellId* const bottom = order + count;
    std::size_t done = 0;
    const bool has_arcs = !heads.arcs.empty();
    for (std::size_t first = 0; first < count; ++first) {
        if (state[first] >= CellGraph::one_hidden) continue;
        CellId* top = bottom;  // the stack grows downwards; its lowest element is at top + 1
        *top-- = static_cast<CellId>(first);
        while (top != bottom) {
            const CellId cell = *++top;
            const unsigned relations = state[cell];
            state[cell] = out;
            order[done++] = cell;
            const std::array<CellId, 4> beside = neighbours[cell];
            for (unsigned face = 0; face < 4; ++face) {
                const CellId neighbour = beside[face];
                const unsigned hidden = (relations >> face & 1U) << 4;
                const unsigned left = state[neighbour] - hidden;
                state[neighbour] = static_cast<Relations>(left);
                __builtin_prefetch(neighbours + neighbour);  // it may come next
                *top = neighbour;
                top -= static_cast<std::ptrdiff_t>((hidden >> 4) & static_cast<unsigned>(left < CellGraph::one_hidden));
            }
            if (has_arcs && heads.is_behind[cell]) {
                heads.release(cell, [&](CellId front) {
                    state[front] -= CellGraph::one_hidden;
                    if (state[front] < CellGraph::one_hidden) *top-- = front;
                });
            }
        }
    }
    done_ = done;
    return {order, done};
}

std::vector<CellId> TopologicalSort::stalled() const {
    std::vector<CellId> left;
    for (std::size_t place = 0; place + 1 < state_.size(); ++place) {
        if (state_[place] != out) left.push_back(static_cast<CellId>(place));
    }
    return left;
}

// Depths are keys of centroids, spread over what a DepthQueue can tell apart. The keys stand where the order will.
void TopologicalSort::find_depths(const CellGraph& graph, const Eye& eye) {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    const Range all(0, graph.size(), 4096);
    const FindKeys find_keys = centroid_keys(graph, eye, {});
    struct Extent {
        std::uint32_t low, high;
    };
    const Extent extent = oneapi::tbb::parallel_reduce(
        all, Extent{largest_key, 0},
        [&](const Range& range, Extent so_far) {
            const auto keys = std::span(order_).subspan(range.begin(), range.size());
            find_keys(range.begin(), keys);
            const auto [low, high] = std::minmax_element(keys.begin(), keys.end());
            return Extent{std::min(so_far.low, *low), std::max(so_far.high, *high)};
        },
        [](Extent a, Extent b) { return Extent{std::min(a.low, b.low), std::max(a.high, b.high)}; });
    const double scale = extent.high > extent.low ? (DepthQueue::depths - 1.0) / (extent.high - extent.low) : 0.0;
    depth_.resize(graph.size());
    oneapi::tbb::parallel_for(all, [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) depth_[i] = static_cast<std::uint16_t>((extent.high - order_[i]) * scale);
    });
}

std::span<const CellId> TopologicalSort::run_by_depth(const CellGraph& graph, const Eye& eye, std::size_t& unordered) {
    const std::size_t count = graph.size();
    state_.resize(count + 1);
    order_.resize(count + 1);
    graph.find_relations(eye, state_);
    find_depths(graph, eye);

    queue_.reset(count);
    done_ = 0;
    const auto drain = [&] {
        while (!queue_.empty()) {
            const CellId cell = queue_.pop_deepest();
            const unsigned relations = state_[cell];
            state_[cell] = out;
            order_[done_++] = cell;
            for (unsigned faces = relations & CellGraph::in_front; faces != 0; faces &= faces - 1) {
                const CellId front = graph.neighbours(cell)[static_cast<std::size_t>(std::countr_zero(faces))];
                // Already taken, to get out of a cycle?
                if (state_[front] == out || state_[front] < CellGraph::one_hidden) continue;
                state_[front] -= CellGraph::one_hidden;
                if (state_[front] < CellGraph::one_hidden) queue_.push(front, depth_[front]);
            }
        }
    };
    for (CellId place = 0; place < count; ++place) {
        if (state_[place] < CellGraph::one_hidden) queue_.push(place, depth_[place]);
    }
    drain();

    unordered = 0;
    if (done_ < count) {
        std::vector<CellId> blocked = stalled();
        std::stable_sort(blocked.begin(), blocked.end(), [&](CellId a, CellId b) { return depth_[a] > depth_[b]; });
        for (const CellId cell : blocked) {
            if (state_[cell] == out) continue;  // became free meanwhile
            ++unordered;
            state_[cell] &= CellGraph::in_front;
            queue_.push(cell, depth_[cell]);
            drain();
        }
    }
    return {order_.data(), done_};
}

}  // namespace cellproj
