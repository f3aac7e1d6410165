// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture of a regular grid takes, in words: as plan.hpp for meshes.
#pragma once

#include <cstddef>
#include <vector>

#include "render/grid_renderer.hpp"
#include "render/plan_rules.hpp"

namespace cellproj {

// As found for a scene by the renderer that draws it.
struct GridFacts {
    bool rays;                 // walk from cell to cell (CPU), or cells and slabs are drawn (OpenGL)
    std::size_t cells, drawn;  // of the grid, and those that are not left out
    bool medium;               // whether there is light between surfaces
};

// Cells, order, segments, surfaces, gradients and rays.
std::vector<Decision> plan_of(const GridScene& scene, const GridQuality& quality, const GridFacts& facts);

}  // namespace cellproj
