// SPDX-License-Identifier: BSD-3-Clause
//
// Sorting cells by one number each: a stable radix sort of 22-bit keys, on all cores, in two passes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "sort/cell_graph.hpp"

namespace cellproj {

inline constexpr int key_bits = 22;
inline constexpr std::uint32_t largest_key = (1U << key_bits) - 1;
inline constexpr std::uint32_t no_key = 0xffffffffU;  // leave the element out

// Finds the keys of the elements first, first + 1, …; called for runs of them, from many threads.
using FindKeys = std::function<void(std::size_t first, std::span<std::uint32_t> keys)>;

// How often each part of a list has each digit, then where the part's next element with that digit goes.
class DigitCounts {
public:
    void reset(std::size_t parts, std::size_t digits) {
        digits_ = digits;
        counts_.assign(parts * digits, 0);
    }
    std::span<std::uint32_t> of(std::size_t part) { return std::span(counts_).subspan(part * digits_, digits_); }
    // From counts to places: behind all smaller digits and the earlier parts. Returns the number of elements.
    std::size_t find_places();

private:
    std::size_t digits_ = 0;
    std::vector<std::uint32_t> counts_;  // #parts by digits_
    std::vector<std::uint32_t> sums_;    // of all parts
};

// Sorts elements by key. Keeps its memory from view to view until it is released: 8 bytes per element.
class KeySort {
public:
    // The numbers of those elements of 0, 1, …, count − 1 whose key is not `no_key`, by ascending key; equal ones by number. The same for any
    // number of threads.
    std::span<std::uint32_t> sort(std::size_t count, const FindKeys& find_keys);
    // The last result again.
    std::span<std::uint32_t> sorted() { return std::span(keys_).first(sorted_); }
    // Room for a number per element, of use to anybody until the next sort.
    std::span<std::uint32_t> scratch() { return entries_; }
    // The last result, for good; all elements had a key.
    std::vector<std::uint32_t> take_sorted() { return std::move(keys_); }
    void release() { *this = {}; }

private:
    std::vector<std::uint32_t> keys_;     // #elements; from the second pass on, the result
    std::vector<std::uint32_t> entries_;  // #elements, in the order of the first pass
    std::size_t sorted_ = 0;              // how many
    DigitCounts low_, high_;
};

// Keys that grow from far to near, by the distance of the centroids from the eye, linear over the mesh's box; `no_key` for cells (in the
// caller's numbers) that are not visible. `visible` is #T or empty. What is given must outlive the answer.
FindKeys centroid_keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible);

// After `keys` of the cells at first, first + 1, …: those that are not visible have none.
void leave_out(const CellGraph& graph, std::span<const std::uint8_t> visible, std::size_t first, std::span<std::uint32_t> keys);

}  // namespace cellproj
