// SPDX-License-Identifier: BSD-3-Clause
//
// What the judges of meshes (ray_light) and of grids (cubic_light) integrate by. Their own, not classify's: a judge shares no arithmetic with
// what it judges.
#pragma once

#include <array>

namespace cellproj {

// Gauss–Legendre on 0..1 (Abramowitz and Stegun, Table 25.4), upper halves: the nodes lie at 1/2 ± offset.
struct GaussPair {
    double offset, weight;
};
inline constexpr std::array<GaussPair, 4> eight_points{{{0.09171732124782490, 0.18134189168918099},
                                                        {0.26276620495816450, 0.15685332293894364},
                                                        {0.39833323870681336, 0.11119051722668724},
                                                        {0.48014492824876812, 0.05061426814518813}}};

// Behind this depth a stretch that adds less than `negligible` is left out.
inline constexpr double dark_depth = 40.0, negligible = 1e-16;

}  // namespace cellproj
