// SPDX-License-Identifier: BSD-3-Clause
//
// What pixels should be, and which of them are asked: what the judges of meshes and of regular grids share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "classify/transfer_function.hpp"
#include "project/camera.hpp"

namespace cellproj {

struct PixelId {
    int x, y;  // column and row, from the top left

    bool operator==(const PixelId&) const = default;
};

// What a pixel should be: the light at its centre, and the range of each channel over the positions that a rasterizer may take
// for it. Both ends are the centre's light unless a slack was asked for.
struct PixelTruth {
    PixelId pixel;
    Light light;      // associated
    Light low, high;  // channel by channel
};

// The slack of Reference::pixels for pictures whose vertices were put on a rasterizer's grid of 1/256 of a pixel [pixels].
constexpr double rasterizer_slack = 1.0 / 512;

// The truth of these pixels, in their order. `light`: at a place of the picture [pixels, from its upper left corner]. Rasterizers move
// points to a grid of 1/256 of a pixel; their picture is one of a mesh moved by at most 1/512. With `slack` > 0 [pixels], low and high
// also take in the light at the four positions (±slack, ±slack) from the centre, which tells a silhouette that has moved by so little
// from an error. Costs five rays instead of one. Parallel over pixels, the same for any number of threads. Throws Error (option) for a
// pixel outside the picture.
std::vector<PixelTruth> truths_of(std::span<const PixelId> pixels, ImageSize size, double slack,
                                  const std::function<Light(const glm::dvec2&)>& light);

// `count` different pixels at whose centres something is met, spread evenly: the pixels where it is (of pictures above a million
// pixels, one in each block of k by k, k² the number of pixels in millions) are cut into `count` runs along a Morton curve, and one is
// drawn from each. All of them when there are fewer. Ascending by row, then column; depends on the seed alone.
std::vector<PixelId> sample_pixels(ImageSize size, std::size_t count, std::uint64_t seed,
                                   const std::function<bool(const glm::dvec2&)>& meets);

// Throws Error (option) for a pixel outside a picture of this size.
void require_in_picture(PixelId pixel, ImageSize size);

}  // namespace cellproj
