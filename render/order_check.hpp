// SPDX-License-Identifier: BSD-3-Clause
//
// An order of cells judged by those who know nothing of it: rays (render/judge/ray_index.hpp), which meet the cells one after the other.
#pragma once

#include <cstddef>

#include "project/camera.hpp"
#include "render/judge/ray_index.hpp"
#include "render/statistics.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// The pixel centres of a picture as the sorter wants them.
PixelGrid pixel_grid(const Camera& camera, ImageSize size);

// Compares an order of `cells` cells with the sequences along the rays of `rays` pixels, spread over the picture the same way every
// time; every pixel once when the picture has no more. Cells and pieces that the order leaves out are passed over, as are crossings
// shorter than 1e-9 of the largest one on the ray: a touch, whose place is a matter of rounding.
OrderCheck check_order(const RayIndex& index, std::size_t cells, const ViewOrder& order, const Camera& camera, ImageSize size,
                       std::size_t rays);

}  // namespace cellproj
