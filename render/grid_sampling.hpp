// SPDX-License-Identifier: BSD-3-Clause
//
// What cuts the rays through a regular grid into segments: its cells (WVG91), or slabs between slices (Engel, Kraus and Ertl, "High-Quality
// Pre-Integrated Volume Rendering Using Hardware-Accelerated Pixel Shading", 2001, §4; Rezk-Salama et al. 2000).
#pragma once

#include <string>
#include <string_view>

namespace cellproj {

struct GridSampling {
    enum class Cut {
        cells,
        object,  // slices across the axis of the grid that the view is closest to
        view     // slices across the viewing direction
    };
    // What a slab shows. The method (classify/method.hpp) is that of the picture in the first two.
    enum class Light {
        segment,  // the scalar between its slices is linear: pre-integrated classification
        post,     // classified from the scalar in the middle, which is that of all of it
        pre       // the points of the grid are classified, and emission and extinction interpolated
    };

    Cut cut = Cut::cells;
    int slabs = 0;  // 1 .. 16384, of equal thickness: over the grid's extent along that axis, or over the diagonal of its box
    Light light = Light::segment;
    int per_polygon = 1;  // 1 .. 16: slabs that one polygon draws (RS00: several slices by multi-texturing)

    bool operator==(const GridSampling&) const = default;
};

// From "cells", "object:N", "view:N", behind the number "pre" or "post" and "xM" for M slabs a polygon, in any order. Throws Error (option),
// naming `place`, for what is unknown or out of range.
GridSampling parse_grid_sampling(std::string_view text, const std::string& place = "sampling");

// The text that parse_grid_sampling turns into this.
std::string to_string(const GridSampling& sampling);

}  // namespace cellproj
