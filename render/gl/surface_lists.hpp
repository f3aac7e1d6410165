// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces and lights as fragments read them, in meshes (surface_pass.hpp) and in grids (grid_slabs.hpp).
#pragma once

#include <span>

#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/surface_scene.hpp"

namespace cellproj::gl {

// Behind the units of the methods (segment_shader.hpp) and of those who draw surfaces.
inline constexpr unsigned int lights_unit = 13;

// Three texels each: threshold, isovalue, opacity; front and back as layers, of associated colour and opacity.
Texture surface_list(const IsoSurfaces& surfaces, std::span<const float> thresholds, std::span<const float> values);

// As most scenes have: nothing to be read, and no middle between two directions. Then shaders/reflected.glsl wants HEADLIGHT.
bool has_one_headlight(const Lighting& lighting);

// For a program with shaders/reflected.glsl: the lights to be bound to `lights_unit`, and what else it asks.
Texture light_list(const Lighting& lighting);
void set_lighting(const Program& program, const Lighting& lighting);

}  // namespace cellproj::gl
