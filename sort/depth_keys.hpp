// SPDX-License-Identifier: BSD-3-Clause
//
// Sorting cells by one number each: a stable radix sort of 22-bit keys, on all cores, in two passes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sort/cell_graph.hpp"

namespace cellproj {

inline constexpr int key_bits = 22;
inline constexpr std::uint32_t largest_key = (1U << key_bits) - 1;
inline constexpr std::uint32_t no_key = 0xffffffffU;  // leave the element out

// Sorts by key and keeps its memory from view to view until it is released: 16 bytes per element.
class KeySort {
public:
    // Where the caller puts the keys: one per element.
    std::span<std::uint32_t> keys(std::size_t count) {
        keys_.resize(count);
        return keys_;
    }
    // The numbers of the elements whose key is not `no_key`, by ascending key; equal ones by number. The same for any number of threads.
    // `names`: what to write instead of the numbers, one per element.
    std::span<std::uint32_t> sort(std::span<const std::uint32_t> names = {});
    // The last result again.
    std::span<std::uint32_t> sorted() { return sorted_; }
    // The keys and the last result, for good.
    std::vector<std::uint32_t> take_keys() { return std::move(keys_); }
    std::vector<std::uint32_t> take_sorted() { return std::move(sorted_); }
    void release() { *this = {}; }

private:
    struct Entry {
        std::uint32_t key, element;
    };
    std::vector<std::uint32_t> keys_, sorted_;
    std::vector<Entry> entries_;
};

// Keys that grow from far to near, by the distance of the centroids from the eye, linear over the mesh's box; `no_key` for cells (in the
// caller's numbers) that are not visible. `visible` is #T or empty.
void find_centroid_keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible,
                        std::span<std::uint32_t> keys);

}  // namespace cellproj
