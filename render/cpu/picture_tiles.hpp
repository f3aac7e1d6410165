// SPDX-License-Identifier: BSD-3-Clause
//
// A picture drawn tile by tile where nothing is binned: grids and hierarchies of them.
#pragma once

#include <cstddef>
#include <functional>

#include "render/image.hpp"
#include "render/cpu/kernels.hpp"

namespace cellproj::cpu {

// `draw`: what one task draws, a tile in place in the image, and how many segments that took. Each pixel belongs to one task: the same picture
// for any number of threads. Returns all segments.
std::size_t draw_tiles(Image& image, const std::function<std::size_t(const Tile&)>& draw);

}  // namespace cellproj::cpu
