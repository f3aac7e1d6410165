// SPDX-License-Identifier: BSD-3-Clause
//
// The native renderer of regular grids: one ray per pixel, tiles of the picture drawn by all cores.
#pragma once

#include <memory>

#include "render/grid_renderer.hpp"

namespace cellproj::cpu {

// `threads` ≥ 0; 0: all that the process may use.
std::unique_ptr<GridRenderer> make_grid_renderer(int threads);

}  // namespace cellproj::cpu
