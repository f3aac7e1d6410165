// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/tile_bins.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace cellproj::cpu {

namespace {

constexpr std::size_t items_per_chunk = 16384;
constexpr std::size_t slab_entries = std::size_t{1} << 24;

template <class T>
std::span<T> chunk_of(std::span<T> all, std::size_t chunk) {
    const std::size_t begin = chunk * items_per_chunk;
    return all.subspan(begin, std::min(items_per_chunk, all.size() - begin));
}

}  // namespace

void TileBins::begin(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items,
                     std::span<std::uint8_t> extra_drawn) {
    items_ = items;
    boxes_.resize(items.size());
    chunks_left_ = (items.size() + items_per_chunk - 1) / items_per_chunk;
    counts_.resize(chunks_left_);
    entries_of_chunk_.resize(chunks_left_);
    std::atomic<std::size_t> drawn = 0;
    oneapi::tbb::parallel_for(std::size_t{0}, chunks_left_, [&](std::size_t chunk) {
        Counts& counts = counts_[chunk];
        counts.fill(0);
        drawn += find_boxes(cells, region, chunk_of(items, chunk), chunk_of(std::span(boxes_), chunk), counts, extra_drawn);
        entries_of_chunk_[chunk] = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    });
    drawn_ = drawn;
}

bool TileBins::next(bool all) {
    if (chunks_left_ == 0) return false;
    const std::size_t end = chunks_left_;
    std::size_t entries = entries_of_chunk_[--chunks_left_];
    while (chunks_left_ > 0 && (all || entries + entries_of_chunk_[chunks_left_ - 1] <= slab_entries))
        entries += entries_of_chunk_[--chunks_left_];
    entries_.resize(std::max(entries_.size(), entries));

    std::uint32_t place = 0;
    for (std::size_t tile = 0; tile < tiles_per_region; ++tile) {
        first_[tile] = place;
        for (std::size_t chunk = chunks_left_; chunk < end; ++chunk) {
            const std::uint32_t count = counts_[chunk][tile];
            counts_[chunk][tile] = place;
            place += count;
        }
    }
    first_[tiles_per_region] = place;
    oneapi::tbb::parallel_for(chunks_left_, end, [&](std::size_t chunk) {
        const auto items = chunk_of(items_, chunk);
        const auto boxes = chunk_of(std::span<const TileBox>(boxes_), chunk);
        Counts& next = counts_[chunk];
        for (std::size_t i = 0; i < items.size(); ++i)
            for (int y = boxes[i].first_y; y <= boxes[i].last_y; ++y)
                for (int x = boxes[i].first_x; x <= boxes[i].last_x; ++x)
                    entries_[next[static_cast<std::size_t>(y * region_side + x)]++] = items[i];
    });
    return true;
}

std::span<const std::uint32_t> TileBins::tile(int x, int y) const {
    const auto tile = static_cast<std::size_t>(y * region_side + x);
    return std::span(entries_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
}

}  // namespace cellproj::cpu
