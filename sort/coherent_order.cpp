// SPDX-License-Identifier: BSD-3-Clause
#include "sort/coherent_order.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

#include "sort/depth_keys.hpp"

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;
using Relations = CellGraph::Relations;

// Room for as many raised labels between two keys. The largest key leaves the upper half of the numbers free.
constexpr int label_bits = 31;
constexpr int spacing_bits = label_bits - key_bits;

constexpr std::uint16_t never = 0xffff;
// When the clock is set back.
constexpr double noon = 0x8000;
// Of the clock, in the distance of the eye, or of the mesh's edge if that is farther: a step of 1° is 140, and 65,535 are three turns.
constexpr double units_per_distance = 8192;

// Enough for the cores of a large machine, and fixed: what is found in a part does not depend on the number of threads.
constexpr std::size_t parts = 64;

// Float32 must hold an eye times three edges.
constexpr double farthest_eye = 1e15;

template <class Body>
void for_each_part(std::size_t count, Body body) {
    oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        body(part, count * part / parts, count * (part + 1) / parts);
    });
}

void spread_keys(std::vector<std::uint32_t>& keys) {
    oneapi::tbb::parallel_for(Range(0, keys.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) keys[i] <<= spacing_bits;
    });
}

}  // namespace

bool CoherentOrder::start(const CellGraph& graph, const Eye& eye) {
    release();
    const std::size_t count = graph.size();
    eye_ = graph.scaled(eye);
    if (count > std::size_t{1} << (label_bits - 1) || !(glm::length(eye_) < farthest_eye)) return false;
    {
        KeySort keys;
        find_centroid_keys(graph, eye, {}, keys.keys(count));
        keys.sort();
        label_ = keys.take_keys();
        cells_ = keys.take_sorted();
    }
    spread_keys(label_);
    sorted_labels_.resize(count);
    oneapi::tbb::parallel_for(Range(0, count, 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            sorted_labels_[i] = label_[cells_[i]];
            cells_[i] = graph.cell(cells_[i]);
        }
    });
    unit_ = std::max(1.0, glm::length(eye_)) / units_per_distance;
    relations_.assign(count, 0);
    expiry_.assign(count, 0);
    moving_.assign(count / 64 + 1, 0);
    budget_ = count / 2 + 64;
    const bool done = bring_up_to(graph, eye);
    raised_ = 0;
    budget_ = count / 4 + 64;
    if (!done) release();
    return done;
}

bool CoherentOrder::follow(const CellGraph& graph, const Eye& eye) {
    assert(relations_.size() == graph.size());
    const glm::dvec3 now = graph.scaled(eye);
    // The last terms: both ends are rounded.
    advance_clock((glm::distance(eye_, now) + 1e-15 * (1 + glm::length(now))) * (1 + 1e-12));
    eye_ = now;
    return bring_up_to(graph, eye) || start(graph, eye);
}

void CoherentOrder::advance_clock(double distance) {
    clock_ += distance / unit_;
    if (clock_ < noon) return;
    const auto back = static_cast<std::uint16_t>(noon);
    for (std::uint16_t& at : expiry_) at = at > back ? static_cast<std::uint16_t>(at - back) : std::uint16_t{0};
    clock_ -= noon;
    if (!(clock_ < noon)) {
        std::fill(expiry_.begin(), expiry_.end(), std::uint16_t{0});
        clock_ = 0;
    }
}

// The three parts: signs, labels, order.
bool CoherentOrder::bring_up_to(const CellGraph& graph, const Eye& eye) {
    const std::vector<CellId> wrong = find_wrong(graph, eye);
    std::vector<Move> moves;
    if (!raise(graph, wrong, moves)) return false;
    move_cells(graph, moves);
    return true;
}

// Brings the relations up to date. Returns the places of the cells that a cell newly in front of them has no larger label than.
std::vector<CellId> CoherentOrder::find_wrong(const CellGraph& graph, const Eye& eye) {
    const auto now = static_cast<std::uint16_t>(std::ceil(clock_));
    std::array<std::vector<CellId>, parts> wrong;
    for_each_part(graph.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        constexpr std::size_t block = 1024;
        std::array<CellId, 2 * block> stale;
        std::array<Relations, block> relations;
        std::array<float, block> reach;
        std::size_t waiting = 0;
        const auto renew = [&](std::size_t count) {
            graph.find_relations(eye, {stale.data(), count}, {relations.data(), count}, {reach.data(), count});
            for (std::size_t k = 0; k < count; ++k) {
                const CellId place = stale[k];
                const double until = std::min(clock_ + reach[k] / unit_, static_cast<double>(never));
                expiry_[place] = static_cast<std::uint16_t>(until);
                unsigned fresh = relations[k] & CellGraph::in_front & ~relations_[place];
                relations_[place] = relations[k];
                for (; fresh != 0; fresh &= fresh - 1) {
                    const CellId front = graph.neighbours(place)[static_cast<std::size_t>(std::countr_zero(fresh))];
                    if (label_[front] > label_[place]) continue;
                    wrong[part].push_back(place);
                    break;
                }
            }
        };
        for (std::size_t from = begin; from < end; from += block) {
            const std::size_t to = std::min(from + block, end);
            for (std::size_t i = from; i < to; ++i) {
                stale[waiting] = static_cast<CellId>(i);
                waiting += expiry_[i] <= now ? 1 : 0;
            }
            if (waiting < block) continue;
            renew(block);
            std::copy(stale.begin() + block, stale.begin() + static_cast<std::ptrdiff_t>(waiting), stale.begin());
            waiting -= block;
        }
        renew(waiting);
    });
    std::vector<CellId> all;
    for (const auto& found : wrong) all.insert(all.end(), found.begin(), found.end());
    return all;
}

// The least labels that fit do not depend on the order of the steps.
bool CoherentOrder::raise(const CellGraph& graph, std::span<const CellId> behind, std::vector<Move>& moves) {
    std::vector<CellId> open;
    for (const CellId first : behind) {
        open.push_back(first);
        while (!open.empty()) {
            const CellId place = open.back();
            open.pop_back();
            const std::uint32_t label = label_[place];
            for (unsigned faces = relations_[place] & CellGraph::in_front; faces != 0; faces &= faces - 1) {
                const CellId front = graph.neighbours(place)[static_cast<std::size_t>(std::countr_zero(faces))];
                if (label_[front] > label) continue;
                const CellId cell = graph.cell(front);
                if ((moving_[cell / 64] >> (cell % 64) & 1) == 0) {
                    moving_[cell / 64] |= std::uint64_t{1} << (cell % 64);
                    moves.push_back({label_[front], 0, front});
                }
                label_[front] = label + 1;
                open.push_back(front);
                if (++raised_ > budget_) return false;
            }
        }
    }
    for (Move& move : moves) move.to = label_[move.place];
    oneapi::tbb::parallel_sort(moves.begin(), moves.end(),
                               [](const Move& a, const Move& b) { return a.to != b.to ? a.to < b.to : a.place < b.place; });
    return true;
}

// In place: a label only grows, so a cell goes to where there is room since it was taken out.
void CoherentOrder::move_cells(const CellGraph& graph, std::span<const Move> moves) {
    if (moves.empty()) return;
    std::uint32_t first = moves.front().from;
    for (const Move& move : moves) first = std::min(first, move.from);

    std::uint32_t* const labels = sorted_labels_.data();
    CellId* const cells = cells_.data();
    std::size_t in = static_cast<std::size_t>(std::lower_bound(sorted_labels_.begin(), sorted_labels_.end(), first) - sorted_labels_.begin());
    std::size_t out = in;
    for (const Move& move : moves) {
        while (in < sorted_labels_.size() && labels[in] <= move.to) {
            const CellId cell = cells[in];
            labels[out] = labels[in++];
            cells[out] = cell;
            out += ~(moving_[cell / 64] >> (cell % 64)) & 1U;
        }
        assert(out < in);
        labels[out] = move.to;
        cells[out++] = graph.cell(move.place);
    }
    assert(out == in);  // the last label to grow is beyond all that cells were taken out from
    for (const Move& move : moves) {
        const CellId cell = graph.cell(move.place);
        moving_[cell / 64] &= ~(std::uint64_t{1} << (cell % 64));
    }
}

}  // namespace cellproj
