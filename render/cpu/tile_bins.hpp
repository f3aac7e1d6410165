// SPDX-License-Identifier: BSD-3-Clause
//
// The cells of an order by tiles of the picture, in slabs that fit a memory budget, nearest first.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/cpu/kernels.hpp"

namespace cellproj::cpu {

// A slab holds at most 16 Mi entries (64 MB), or what a single chunk of 16,384 items needs where that is more (at most 64 MB,
// when every one of them covers all tiles of a region). Besides 4 bytes per item and 4 KB per chunk. Memory is kept from view to
// view. The same lists for any number of threads.
class TileBins {
public:
    // Bins items, back to front, over a region. All cores take part. Both arguments must outlive the slabs.
    void begin(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items,
               std::span<std::uint8_t> extra_drawn);
    // The next slab towards the back. False when there is none left. `all`: the rest in one, whatever it takes.
    bool next(bool all = false);
    // The slab's items that meet a tile of the region, back to front.
    std::span<const std::uint32_t> tile(int x, int y) const;
    // Whole cells that the region counts as drawn (find_boxes).
    std::size_t drawn() const { return drawn_; }

private:
    using Counts = std::array<std::uint32_t, tiles_per_region>;

    std::span<const std::uint32_t> items_;
    std::vector<TileBox> boxes_;               // #items
    std::vector<Counts> counts_;               // per chunk; in a slab: where its next entry goes
    std::vector<std::size_t> entries_of_chunk_;
    std::size_t chunks_left_ = 0;              // the slabs go from the last chunk, the nearest, to the first
    std::vector<std::uint32_t> entries_;       // of the slab, tile by tile
    std::array<std::uint32_t, tiles_per_region + 1> first_{};
    std::size_t drawn_ = 0;
};

}  // namespace cellproj::cpu
