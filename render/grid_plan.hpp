// SPDX-License-Identifier: BSD-3-Clause
//
// What a picture of a regular grid was drawn by and why, as plan.hpp tells it of a mesh.
#pragma once

#include <cstddef>
#include <vector>

#include "render/grid_renderer.hpp"
#include "render/plan_rules.hpp"

namespace cellproj {

// In the order of the work: cells, sampling, field, axes, order, method. `culled`: cells that were not looked at. Either OpenGL backend
// stands for both.
std::vector<Decision> grid_decisions(const GridScene& scene, const GridQuality& quality, Backend backend, std::size_t culled);

}  // namespace cellproj
