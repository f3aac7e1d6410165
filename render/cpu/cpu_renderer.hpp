// SPDX-License-Identifier: BSD-3-Clause
//
// Cell projection without OpenGL: the faces of the cells are evaluated at pixel centres, in tiles of the picture, by SIMD and on
// all cores. Order and classification are those of the other backends.
#pragma once

#include <memory>

#include "render/renderer.hpp"

namespace cellproj::cpu {

// `threads`: how many to use at most, 0 for all that the process may use. The same picture, bit for bit, for any number. What
// does not depend on the view is kept; a second picture allocates nothing but itself.
//
// Draws isosurfaces (render/README.md), and every method that finds light for each pixel; Error (option) for light at vertices and for other targets than rgba32f.
std::unique_ptr<Renderer> make_renderer(int threads, const PlanRules& rules = {});

}  // namespace cellproj::cpu
