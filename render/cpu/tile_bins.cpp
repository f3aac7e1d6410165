// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/tile_bins.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace cellproj::cpu {

namespace {

constexpr std::size_t items_per_chunk = 16384;
// Where tiles may become full. A slab costs 2 µs a tile, which a quarter of a million of cells hide.
constexpr std::size_t slabs = 16, least_slab = 4;  // least_slab: chunks
template <class T>
std::span<T> chunk_of(std::span<T> all, std::size_t chunk) {
    const std::size_t begin = chunk * items_per_chunk;
    return all.subspan(begin, std::min(items_per_chunk, all.size() - begin));
}

}  // namespace

void TileBins::begin(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items,
                     std::span<std::uint8_t> extra_drawn, bool opaque) {
    cells_ = &cells;
    region_ = region;
    items_ = items;
    extra_drawn_ = extra_drawn;
    boxes_.resize(items.size());
    chunks_left_ = chunks_to_find_ = (items.size() + items_per_chunk - 1) / items_per_chunk;
    counts_.resize(chunks_left_);
    entries_of_chunk_.resize(chunks_left_);
    next_tile_ = drawn_ = 0;
    opaque_ = opaque;
    // What the picture does not have is full from the start.
    for (int y = 0; y < region_side; ++y)
        for (int x = 0; x < region_side; ++x) full(x, y) = x * tile_side >= region.width || y * tile_side >= region.height;
}

void TileBins::find(std::size_t begin, std::size_t end) {
    std::atomic<std::size_t> drawn = 0;
    oneapi::tbb::parallel_for(begin, end, [&](std::size_t chunk) {
        Counts& counts = counts_[chunk];
        counts.fill(0);
        drawn += find_boxes(*cells_, region_, chunk_of(items_, chunk), full_, chunk_of(std::span(boxes_), chunk), counts, extra_drawn_);
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
        const auto items = chunk_of(items_, chunk);
        const auto boxes = chunk_of(std::span<const TileBox>(boxes_), chunk);
        Counts& next = places_[chunk - begin];
        for (std::size_t i = 0; i < items.size(); ++i)
            for (int y = boxes[i].first_y; y <= boxes[i].last_y; ++y)
                for (int x = boxes[i].first_x; x <= boxes[i].last_x; ++x) {
                    const auto tile = static_cast<std::size_t>(y * region_side + x);
                    if (wanted[tile]) entries_[next[tile]++] = items[i];
                }
    });
}

bool TileBins::next() {
    if (chunks_left_ == 0 || std::find(full_.begin(), full_.end(), std::uint8_t{0}) == full_.end()) return false;
    const std::size_t wanted = opaque_ ? std::max(least_slab, (counts_.size() + slabs - 1) / slabs) : chunks_left_;
    const std::size_t end = chunks_left_, least = end - std::min(wanted, end);
    if (least < chunks_to_find_) {
        find(least, std::min(chunks_to_find_, end));
        chunks_to_find_ = least;
    }
    std::size_t entries = entries_of_chunk_[--chunks_left_];
    while (chunks_left_ > least && entries + entries_of_chunk_[chunks_left_ - 1] <= budget_) entries += entries_of_chunk_[--chunks_left_];
    fill(chunks_left_, end, 0, tiles_per_region);
    return true;
}

bool TileBins::next_tiles() {
    if (next_tile_ == tiles_per_region || items_.empty()) return false;
    if (chunks_to_find_ > 0) find(0, chunks_to_find_);
    chunks_to_find_ = 0;
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
