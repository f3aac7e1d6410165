// SPDX-License-Identifier: BSD-3-Clause
//
// A priority queue of cells over 65,536 depths with constant-time operations: a list per depth, and three levels of bits
// that find the deepest list in use. Among cells of one depth the last one in comes out first, which keeps face neighbours
// together in memory.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

class DepthQueue {
public:
    static constexpr std::uint32_t depths = 65536;

    // Empties the queue and makes room for cells 0 .. cells−1, each at most once.
    void reset(std::size_t cells) {
        head_.assign(depths, no_cell);
        next_.resize(cells);
        used_.fill(0);
        used_words_.fill(0);
        used_groups_ = 0;
    }

    bool empty() const { return used_groups_ == 0; }

    void push(CellId cell, std::uint16_t depth) {
        next_[cell] = head_[depth];
        head_[depth] = cell;
        used_[depth / 64U] |= bit(depth);
        used_words_[depth / 4096U] |= bit(depth / 64U);
        used_groups_ |= bit(depth / 4096U);
    }

    // A cell of the largest depth. The queue must not be empty.
    CellId pop_deepest() {
        const std::uint32_t group = highest(used_groups_);
        const std::uint32_t word = 64 * group + highest(used_words_[group]);
        const std::uint32_t depth = 64 * word + highest(used_[word]);
        const CellId cell = head_[depth];
        head_[depth] = next_[cell];
        if (head_[depth] == no_cell && (used_[word] &= ~bit(depth)) == 0 &&
            (used_words_[group] &= ~bit(word)) == 0) {
            used_groups_ &= ~bit(group);
        }
        return cell;
    }

private:
    static std::uint64_t bit(std::uint32_t i) { return std::uint64_t{1} << (i % 64U); }
    static std::uint32_t highest(std::uint64_t bits) { return 63U - static_cast<std::uint32_t>(std::countl_zero(bits)); }

    std::vector<CellId> head_;                              // per depth: its last cell
    std::vector<CellId> next_;                              // per cell: the one below it in its list
    std::array<std::uint64_t, depths / 64> used_{};         // a bit per depth
    std::array<std::uint64_t, depths / 4096> used_words_{};  // a bit per word of used_
    std::uint64_t used_groups_ = 0;                         // a bit per word of used_words_
};

}  // namespace cellproj
