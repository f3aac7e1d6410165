// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/tile_bins.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace cellproj::cpu {

namespace {

constexpr std::size_t items_per_chunk = 16384;
// Where tiles may become full. A slab costs 2 µs a tile, which a quarter of a million of cells hide.
constexpr std::size_t slabs = 16, least_slab = 4;  // least_slab: chunks

std::span<const std::uint32_t> chunk_of(std::span<const std::uint32_t> items, std::size_t chunk) {
    const std::size_t begin = chunk * items_per_chunk;
    return items.subspan(begin, std::min(items_per_chunk, items.size() - begin));
}

}  // namespace

// The order jumps about in memory, so that boxes are asked for early.
template <class Body>
void TileBins::for_each_box(std::span<const std::uint32_t> items, const Body& body) const {
    constexpr std::size_t early = 24;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i + early < items.size()) __builtin_prefetch(&boxes_[items[i + early]]);
        body(items[i], boxes_[items[i]]);
    }
}

void TileBins::find_cells(const ScreenCells& cells, const Region& region) {
    boxes_.resize(std::max(boxes_.size(), cells.tets.size()));
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, cells.tets.size(), items_per_chunk),
                              [&](const auto& range) { find_boxes(cells, region, range.begin(), range.end(), boxes_); });
    cells_found_ = true;
}

void TileBins::find_cells(const ScreenCells& cells, const Region& region, std::span<const CellId> drawn) {
    if (drawn.empty()) return find_cells(cells, region);
    boxes_.resize(std::max(boxes_.size(), cells.tets.size()));
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, drawn.size(), items_per_chunk),
                              [&](const auto& range) { find_boxes(cells, region, drawn.subspan(range.begin(), range.size()), boxes_); });
    cells_found_ = true;
}

void TileBins::begin(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items,
                     std::span<std::uint8_t> extra_drawn, bool opaque, std::span<const CellId> drawn) {
    cells_ = &cells;
    region_ = region;
    items_ = items;
    extra_drawn_ = extra_drawn;
    boxes_.resize(cells.tets.size() + cells.extra.size());
    if (!cells_found_) find_cells(cells, region, drawn);
    cells_found_ = false;
    find_boxes(cells, region, cells.tets.size(), boxes_.size(), boxes_);
    chunks_left_ = chunks_to_count_ = (items.size() + items_per_chunk - 1) / items_per_chunk;
    counts_.resize(chunks_left_);
    entries_of_chunk_.resize(chunks_left_);
    next_tile_ = drawn_ = 0;
    opaque_ = opaque;
    // What the picture does not have is full from the start.
    for (int y = 0; y < region_side; ++y)
        for (int x = 0; x < region_side; ++x) full(x, y) = x * tile_side >= region.width || y * tile_side >= region.height;
}

// Adds to counts[tile] the number of items whose box meets the tile where it is not full. Returns that of whole cells that meet such a tile
// and no region before this one; sets extra_drawn for other items.
std::size_t TileBins::count(std::span<const std::uint32_t> items, Counts& counts) {
    std::size_t drawn = 0;
    for_each_box(items, [&](std::uint32_t item, const TileBox& box) {
        bool open = false;
        for (std::uint32_t y = box.first_y; y <= box.last_y; ++y)
            for (std::uint32_t x = box.first_x; x <= box.last_x; ++x) {
                const std::size_t tile = y * region_side + x;
                counts[tile] += full_[tile] == 0;
                open |= full_[tile] == 0;
            }
        if (!open || !box.begins) return;
        if (item < cells_->tets.size()) {
            ++drawn;
        } else {
            extra_drawn_[item - cells_->tets.size()] = 1;
        }
    });
    return drawn;
}

void TileBins::count_chunks(std::size_t begin, std::size_t end) {
    std::atomic<std::size_t> drawn = 0;
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t chunk) {
        Counts& counts = counts_[chunk];
        counts.fill(0);
        drawn += count(chunk_of(items_, chunk), counts);
        entries_of_chunk_[chunk] = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    });
    drawn_ += drawn;
}

// The entries of tiles first_tile .. end_tile − 1.
void TileBins::fill(std::size_t begin, std::size_t end, std::size_t first_tile, std::size_t end_tile) {
    places_.resize(std::max(places_.size(), end - begin));
    std::array<std::uint8_t, tiles_per_region> wanted{};
    std::uint32_t place = 0;
    for (std::size_t tile = 0; tile < tiles_per_region; ++tile) {
        first_[tile] = place;
        wanted[tile] = tile >= first_tile && tile < end_tile && !full_[tile];
        if (!wanted[tile]) continue;
        for (std::size_t chunk = begin; chunk < end; ++chunk) {
            places_[chunk - begin][tile] = place;
            place += counts_[chunk][tile];
        }
    }
    first_[tiles_per_region] = place;
    entries_.resize(std::max<std::size_t>(entries_.size(), place));
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t chunk) {
        Counts& next = places_[chunk - begin];
        for_each_box(chunk_of(items_, chunk), [&](std::uint32_t item, const TileBox& box) {
            for (std::uint32_t y = box.first_y; y <= box.last_y; ++y)
                for (std::uint32_t x = box.first_x; x <= box.last_x; ++x) {
                    const std::size_t tile = y * region_side + x;
                    if (wanted[tile]) entries_[next[tile]++] = item;
                }
        });
    });
}

bool TileBins::next() {
    if (chunks_left_ == 0 || std::find(full_.begin(), full_.end(), std::uint8_t{0}) == full_.end()) return false;
    const std::size_t wanted = opaque_ ? std::max(least_slab, (counts_.size() + slabs - 1) / slabs) : chunks_left_;
    const std::size_t end = chunks_left_, least = end - std::min(wanted, end);
    if (least < chunks_to_count_) {
        count_chunks(least, std::min(chunks_to_count_, end));
        chunks_to_count_ = least;
    }
    std::size_t entries = entries_of_chunk_[--chunks_left_];
    while (chunks_left_ > least && entries + entries_of_chunk_[chunks_left_ - 1] <= budget_) entries += entries_of_chunk_[--chunks_left_];
    fill(chunks_left_, end, 0, tiles_per_region);
    return true;
}

bool TileBins::next_tiles() {
    if (next_tile_ == tiles_per_region || items_.empty()) return false;
    if (chunks_to_count_ > 0) count_chunks(0, chunks_to_count_);
    chunks_to_count_ = 0;
    const std::size_t first = next_tile_;
    for (std::size_t entries = 0; next_tile_ < tiles_per_region; ++next_tile_) {
        for (const Counts& counts : counts_) entries += counts[next_tile_];
        if (entries > budget_ && next_tile_ > first) break;
    }
    fill(0, counts_.size(), first, next_tile_);
    return true;
}

std::span<const std::uint32_t> TileBins::tile(int x, int y) const {
    const auto tile = static_cast<std::size_t>(y * region_side + x);
    return std::span(entries_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
}

}  // namespace cellproj::cpu
