// SPDX-License-Identifier: BSD-3-Clause
#include "sort/coherent_order.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

#include "sort/depth_keys.hpp"

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;
using Relations = CellGraph::Relations;

// Room for as many raised labels between two keys. The largest key leaves the upper half of the numbers free.
constexpr int label_bits = 31;
constexpr int spacing_bits = label_bits - key_bits;

// New labels are due when as many as one of this number of cells have been raised: by then a step costs as much as its share in them.
constexpr std::size_t wear = 3;

constexpr std::size_t block = 1024;  // cells whose relations are renewed at a time

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

// A stable radix sort of a few thousand elements, on this core.
template <class Element, class LabelOf>
void sort_by_digits(std::vector<Element>& elements, LabelOf label_of) {
    constexpr int bits = 11;
    constexpr std::uint32_t digits = 1U << bits;
    std::vector<Element> sorted(elements.size());
    std::vector<std::uint32_t> place(digits);
    for (int shift = 0; shift < 32; shift += bits) {
        std::fill(place.begin(), place.end(), 0U);
        for (const Element& e : elements) ++place[label_of(e) >> shift & (digits - 1)];
        std::exclusive_scan(place.begin(), place.end(), place.begin(), 0U);
        for (const Element& e : elements) sorted[place[label_of(e) >> shift & (digits - 1)]++] = e;
        elements.swap(sorted);
    }
}

// The first place from `begin` on where `ascending` is at least `value`, found in steps that double.
std::size_t first_at_least(const std::vector<std::uint32_t>& ascending, std::size_t begin, std::uint32_t value) {
    std::size_t step = 1, low = begin;
    while (low + step < ascending.size() && ascending[low + step] < value) {
        low += step;
        step *= 2;
    }
    const auto first = ascending.begin() + static_cast<std::ptrdiff_t>(low);
    const auto last = ascending.begin() + static_cast<std::ptrdiff_t>(std::min(low + step + 1, ascending.size()));
    return static_cast<std::size_t>(std::lower_bound(first, last, value) - ascending.begin());
}

}  // namespace

bool CoherentOrder::start(const CellGraph& graph, const Eye& eye) {
    release();
    const std::size_t count = graph.size();
    eye_ = graph.scaled(eye);
    if (count > std::size_t{1} << (label_bits - 1) || !(glm::length(eye_) < farthest_eye)) return false;
    unit_ = std::max(1.0, glm::length(eye_)) / units_per_distance;
    label_by_depth(graph, eye);
    relations_.assign(count, 0);
    expiry_.assign(count, 0);
    moving_.assign(count / 64 + 1, 0);
    if (bring_up_to(graph, eye, Asked::all_relations)) return true;
    release();
    return false;
}

bool CoherentOrder::follow(const CellGraph& graph, const Eye& eye) {
    assert(relations_.size() == graph.size());
    const glm::dvec3 now = graph.scaled(eye);
    // The last terms: both ends are rounded.
    advance_clock((glm::distance(eye_, now) + 1e-15 * (1 + glm::length(now))) * (1 + 1e-12));
    eye_ = now;
    const bool worn_out = raised_ > graph.size() / wear;
    if (worn_out) label_by_depth(graph, eye);
    return bring_up_to(graph, eye, worn_out ? Asked::all_relations : Asked::new_relations) || start(graph, eye);
}

void CoherentOrder::label_by_depth(const CellGraph& graph, const Eye& eye) {
    for (auto* last : {&label_, &cells_, &sorted_labels_}) std::vector<std::uint32_t>().swap(*last);  // frees; `= {}` would not
    const FindKeys find_keys = centroid_keys(graph, eye, {});
    {
        KeySort keys;
        keys.sort(graph.size(), find_keys);
        cells_ = keys.take_sorted();
    }
    label_.resize(graph.size());
    oneapi::tbb::parallel_for(Range(0, graph.size(), 4096), [&](const Range& range) {
        find_keys(range.begin(), std::span(label_).subspan(range.begin(), range.size()));
        for (std::size_t i = range.begin(); i != range.end(); ++i) label_[i] <<= spacing_bits;
    });
    sorted_labels_.resize(graph.size());
    oneapi::tbb::parallel_for(Range(0, graph.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            sorted_labels_[i] = label_[cells_[i]];
            cells_[i] = graph.cell(cells_[i]);
        }
    });
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
bool CoherentOrder::bring_up_to(const CellGraph& graph, const Eye& eye, Asked asked) {
    std::vector<Claim> raised;
    if (!raise(graph, find_claims(graph, eye, asked), raised)) return false;
    if (asked == Asked::all_relations) raised_ = 0;
    move_cells(graph, raised);
    return true;
}

// Brings the relations up to date. Returns the labels that they (or only those that are new) find too small.
std::vector<CoherentOrder::Claim> CoherentOrder::find_claims(const CellGraph& graph, const Eye& eye, Asked asked) {
    const auto now = static_cast<std::uint16_t>(std::ceil(clock_));
    std::array<std::vector<Claim>, parts> claims;
    for_each_part(graph.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        std::vector<Claim>* const of_new = asked == Asked::new_relations ? &claims[part] : nullptr;
        std::array<CellId, 2 * block> stale;
        std::size_t waiting = 0;
        const std::uint16_t* const expiry = expiry_.data();
        for (std::size_t from = begin; from < end; from += block) {
            const std::size_t to = std::min(from + block, end);
            std::size_t count = waiting;
            for (std::size_t i = from; i < to; ++i) {
                stale[count] = static_cast<CellId>(i);
                count += expiry[i] <= now ? 1 : 0;
            }
            waiting = count;
            if (waiting < block) continue;
            renew_relations(graph, eye, {stale.data(), block}, of_new);
            std::copy(stale.begin() + block, stale.begin() + static_cast<std::ptrdiff_t>(waiting), stale.begin());
            waiting -= block;
        }
        renew_relations(graph, eye, {stale.data(), waiting}, of_new);
        if (asked == Asked::new_relations) return;
        for (std::size_t i = begin; i < end; ++i) {
            claim(graph, static_cast<CellId>(i), relations_[i] & CellGraph::in_front, claims[part]);
        }
    });
    std::size_t count = 0;
    for (const auto& found : claims) count += found.size();
    std::vector<Claim> all;
    all.reserve(count);
    for (const auto& found : claims) all.insert(all.end(), found.begin(), found.end());
    return all;
}

void CoherentOrder::renew_relations(const CellGraph& graph, const Eye& eye, std::span<const CellId> places, std::vector<Claim>* claims) {
    std::array<Relations, block> relations;
    std::array<float, block> reach;
    struct Change {
        CellId place;
        unsigned faces;
    };
    std::array<Change, block> changed;
    std::size_t changes = 0;
    graph.find_relations(eye, places, {relations.data(), places.size()}, {reach.data(), places.size()});
    const double per_unit = (1 - 1e-15) / unit_;  // rounded down
    for (std::size_t k = 0; k < places.size(); ++k) {
        const CellId place = places[k];
        const double until = std::min(clock_ + static_cast<double>(reach[k]) * per_unit, static_cast<double>(never));
        expiry_[place] = static_cast<std::uint16_t>(static_cast<int>(until));
        const unsigned fresh = relations[k] & CellGraph::in_front & ~relations_[place];
        relations_[place] = relations[k];
        if (!claims || fresh == 0) continue;
        changed[changes++] = {place, fresh};
        __builtin_prefetch(&graph.neighbours(place));
        __builtin_prefetch(&label_[place]);
    }
    for (std::size_t i = 0; i < changes; ++i) claim(graph, changed[i].place, changed[i].faces, *claims);
}

void CoherentOrder::claim(const CellGraph& graph, CellId place, unsigned faces, std::vector<Claim>& claims) const {
    for (; faces != 0; faces &= faces - 1) {
        const CellId front = graph.neighbours(place)[static_cast<std::size_t>(std::countr_zero(faces))];
        if (label_[front] <= label_[place]) claims.push_back({front, label_[place] + 1});
    }
}

// The least labels that fit do not depend on the order of the steps. `raised`: each cell once, with the label it had.
bool CoherentOrder::raise(const CellGraph& graph, std::span<const Claim> claims, std::vector<Claim>& raised) {
    constexpr std::size_t ahead = 8;  // claims, about the time that memory takes to answer
    const std::size_t most = raised_ + graph.size() / 2 + 64;
    std::vector<CellId> open;
    const auto lift = [&](CellId place, std::uint32_t label) {
        const CellId cell = graph.cell(place);
        if ((moving_[cell / 64] >> (cell % 64) & 1) == 0) {
            moving_[cell / 64] |= std::uint64_t{1} << (cell % 64);
            raised.push_back({place, label_[place]});
        }
        label_[place] = label;
        ++raised_;
        open.push_back(place);
    };
    for (std::size_t i = 0; i < claims.size(); ++i) {
        const CellId next = claims[std::min(i + ahead, claims.size() - 1)].place;
        __builtin_prefetch(&label_[next]);
        __builtin_prefetch(&relations_[next]);
        __builtin_prefetch(&graph.neighbours(next));
        if (label_[claims[i].place] < claims[i].label) lift(claims[i].place, claims[i].label);
        while (!open.empty()) {
            const CellId place = open.back();
            open.pop_back();
            const std::uint32_t above = label_[place] + 1;
            for (unsigned faces = relations_[place] & CellGraph::in_front; faces != 0; faces &= faces - 1) {
                const CellId front = graph.neighbours(place)[static_cast<std::size_t>(std::countr_zero(faces))];
                if (label_[front] < above) lift(front, above);
            }
            if (raised_ > most) return false;
        }
    }
    return true;
}

// Two lists that ascend, of cells to take out and cells to put in, and runs of cells between them that move on as they are. All in place: a label
// only grows, so a cell goes to where there is room since it was taken out.
void CoherentOrder::move_cells(const CellGraph& graph, std::span<const Claim> raised) {
    if (raised.empty()) return;
    std::vector<std::uint32_t> taken(raised.size());
    std::vector<Claim> put(raised.size());
    for (std::size_t i = 0; i < raised.size(); ++i) {
        taken[i] = raised[i].label;
        put[i] = {raised[i].place, label_[raised[i].place]};
    }
    sort_by_digits(taken, [](std::uint32_t label) { return label; });
    sort_by_digits(put, [](const Claim& claim) { return claim.label; });

    const std::size_t count = sorted_labels_.size();
    std::uint32_t* const labels = sorted_labels_.data();
    CellId* const cells = cells_.data();
    std::size_t in = first_at_least(sorted_labels_, 0, taken.front()), out = in;
    const auto move_run = [&](std::size_t end) {
        std::copy(labels + in, labels + end, labels + out);
        std::copy(cells + in, cells + end, cells + out);
        out += end - in;
        in = end;
    };
    std::size_t next = 0;
    for (const Claim& claim : put) {
        for (; next < taken.size() && taken[next] <= claim.label; ++next) {
            move_run(first_at_least(sorted_labels_, in, taken[next]));
            for (; in < count && labels[in] == taken[next]; ++in) {  // those of one label, of which some go
                const CellId cell = cells[in];
                labels[out] = labels[in];
                cells[out] = cell;
                out += ~(moving_[cell / 64] >> (cell % 64)) & 1U;
            }
        }
        move_run(first_at_least(sorted_labels_, in, claim.label + 1));
        assert(out < in);
        labels[out] = claim.label;
        cells[out++] = graph.cell(claim.place);
    }
    assert(out == in);  // the largest new label is beyond all that cells were taken out from
    for (const Claim& claim : put) {
        const CellId cell = graph.cell(claim.place);
        moving_[cell / 64] &= ~(std::uint64_t{1} << (cell % 64));
    }
}

}  // namespace cellproj
