// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture of a regular grid takes, in words: as plan.hpp for meshes.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "render/grid_renderer.hpp"
#include "render/plan_rules.hpp"

namespace cellproj {

// As found for a scene by the renderer that draws it.
struct GridFacts {
    bool rays;                 // walk from cell to cell (CPU), or cells and slabs are drawn (OpenGL)
    std::size_t cells = 0, drawn = 0;    // of the grid, and those that are not left out
    bool medium = true;                  // whether there is light between surfaces
    bool front_to_back = false;          // OpenGL: what lies behind opaque tiles is left out
    bool smaller_than_a_pixel = false;   // OpenGL: all cells in the picture
};

// The opacity above which what lies behind is left out: it would add less than 1e-4 to any channel. Nothing where rays are not expected to
// come to it: the largest extinction all along the diagonal of the grid and two crossings of each isosurface do not suffice, or sums in float32
// do not tell it from 1. `transfer`: of the scene, over scalars 0..1 and lengths of GridUnits.
std::optional<float> hiding_opacity(const TransferFunction& transfer, const SurfaceScene* surfaces);

// Cells, order, segments, surfaces, gradients and rays.
std::vector<Decision> plan_of(const GridScene& scene, const GridQuality& quality, const GridFacts& facts);

}  // namespace cellproj
