// SPDX-License-Identifier: BSD-3-Clause
//
// The judges of orders: the sequence of cells along rays, found with no order and no neighbours (render/judge/ray_index.hpp), and the sides of
// faces.
#pragma once

#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "project/camera.hpp"
#include "render/order_check.hpp"
#include "render/judge/ray_index.hpp"
#include "sort/view_order.hpp"

namespace cellproj::testing_support {

// Eye i of those that see a box: parallel when i is even; every fourth perspective one stands inside the box and looks out at a wide
// angle; every fifth eye looks along z, the others in random directions.
Camera judging_camera(const Bounds& box, int i, std::mt19937_64& random);

// Rays through `count` pixels at random, with repeats.
std::vector<ViewRay> random_pixel_rays(const RayIndex& index, const PixelGrid& grid, int count, std::mt19937_64& random);

// Rays through `count` random places of the picture.
std::vector<ViewRay> random_rays(const RayIndex& index, const PixelGrid& grid, int count, std::mt19937_64& random);

// How many rays meet two cells or pieces in another order than the given one, or miss a part of a cell that was split: what is
// seen first along a ray must come last. Stretches shorter than 1e-9 of the mesh's size do not count: rounding of the judge's rays
// and of the corners of pieces. A ray that runs in a face passes now on one side of it, now on the other by rounding: it counts only
// when the four rays beside it, 1e-9 of the mesh's size away, are wrong as well.
std::size_t wrong_rays(const TetMesh& mesh, const RayIndex& index, const ViewOrder& order, std::span<const ViewRay> rays);

// How many pairs of face neighbours of an adjacency stand the wrong way round, by the exact predicate alone; every cell positively
// oriented. Pairs with a cell that is split or left out do not count.
std::size_t count_order_violations(const TetMesh& mesh, const Adjacency& adjacency, const ViewOrder& order, const Eye& eye);

// Whether each cell is there exactly once, as a whole or as pieces that fill it to 1e-9 of its volume.
bool is_complete(const TetMesh& mesh, const ViewOrder& order);

}  // namespace cellproj::testing_support
