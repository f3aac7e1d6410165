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

// Where tiles may become full, that is, in scenes that can be opaque, slabs are sixteenths of the order: cells that meet full tiles
// only are left out, and when all tiles are full there is no further slab.
//
// A slab holds at most `budget` entries of 4 bytes, or what a single chunk of 16,384 items needs where that is more (at most 64 MB,
// when every one of them covers all tiles of a region). Besides 4 bytes per cell or extra tetrahedron and 4 KB per chunk of the order. Memory
// is kept from view to view. The same lists for any number of threads.
class TileBins {
public:
    explicit TileBins(std::size_t budget = std::size_t{1} << 24) : budget_(budget) {}

    // The boxes of all whole cells over the region of the next begin(), which else finds them: this may run while the order is
    // still to be found. In the order of memory, where points of one cell are near those of the next.
    void find_cells(const ScreenCells& cells, const Region& region);
    // The same of the only ones that are drawn.
    void find_cells(const ScreenCells& cells, const Region& region, std::span<const CellId> drawn);
    // Items, back to front, over a region; cells only of those that are `drawn`, which is all of them where there are none. The arguments must
    // outlive the slabs. `opaque`: whether tiles may become full.
    void begin(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items,
               std::span<std::uint8_t> extra_drawn, bool opaque, std::span<const CellId> drawn = {});
    // The next slab towards the back; all cores take part. False when there is none left.
    bool next();
    // The same for tiles that want all of their items at once: the next tiles, as many as the budget allows, at least one. Not to
    // be mixed with next() for one region.
    bool next_tiles();
    // The slab's items that meet a tile of the region, back to front.
    std::span<const std::uint32_t> tile(int x, int y) const;
    // For the tile's drawer to set to 1: nothing behind can be seen in it. Further slabs leave it out.
    std::uint8_t& full(int x, int y) { return full_[static_cast<std::size_t>(y * region_side + x)]; }
    // Whole cells that the slabs so far count as drawn: they meet a tile that is not full, in the first region that they meet.
    std::size_t drawn() const { return drawn_; }

private:
    using Counts = std::array<std::uint32_t, tiles_per_region>;

    template <class Body>
    void for_each_box(std::span<const std::uint32_t> items, const Body& body) const;
    std::size_t count(std::span<const std::uint32_t> items, Counts& counts);
    void count_chunks(std::size_t begin, std::size_t end);
    void fill(std::size_t begin, std::size_t end, std::size_t first_tile, std::size_t end_tile);

    std::size_t budget_;                       // entries
    const ScreenCells* cells_ = nullptr;
    Region region_{};
    std::span<const std::uint32_t> items_;
    std::span<std::uint8_t> extra_drawn_;
    std::vector<TileBox> boxes_;               // #T + #extra
    bool cells_found_ = false;                 // by find_cells, for the next begin()
    std::vector<Counts> counts_;               // per chunk
    std::vector<std::size_t> entries_of_chunk_;
    std::vector<Counts> places_;               // per chunk of a slab: where its next entry goes
    std::size_t chunks_left_ = 0;              // the slabs go from the last chunk, the nearest, to the first
    std::size_t chunks_to_count_ = 0;          // the first ones, not counted so far
    bool opaque_ = false;
    std::size_t next_tile_ = 0;                // of next_tiles
    std::vector<std::uint32_t> entries_;       // of the slab, tile by tile
    std::array<std::uint32_t, tiles_per_region + 1> first_{};
    std::array<std::uint8_t, tiles_per_region> full_{};
    std::size_t drawn_ = 0;
};

}  // namespace cellproj::cpu
