// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/picture_tiles.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>

#include <algorithm>
#include <atomic>

namespace cellproj::cpu {

std::size_t draw_tiles(Image& image, const std::function<std::size_t(const Tile&)>& draw) {
    const int columns = (image.width + tile_side - 1) / tile_side, rows = (image.height + tile_side - 1) / tile_side;
    std::atomic<std::size_t> segments = 0;
    oneapi::tbb::parallel_for(
        0, columns * rows,
        [&](int index) {
            const int x = index % columns * tile_side, y = index / columns * tile_side;
            segments += draw({x, y, std::min(tile_side, image.width - x), std::min(tile_side, image.height - y), &image.at(x, y),
                              static_cast<std::size_t>(image.width)});
        },
        oneapi::tbb::simple_partitioner());
    return segments;
}

}  // namespace cellproj::cpu
