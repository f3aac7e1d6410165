// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces and lights as fragments read them, in meshes (surface_pass.hpp) and in grids (grid_slabs.hpp).
#pragma once

#include <span>
#include <string>

#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/surface_scene.hpp"

namespace cellproj::gl {

// Behind the units of the methods (segment_shader.hpp) and of those who draw surfaces.
inline constexpr unsigned int lights_unit = 13;

// Three texels each: threshold, isovalue, opacity; front; back: associated colour, opacity.
Texture surface_list(const IsoSurfaces& surfaces, std::span<const float> thresholds, std::span<const float> values);

// For a program with shaders/reflected.glsl: its variant, the lights to be bound to `lights_unit`, and what else it asks.
std::string lighting_defines(const Lighting& lighting);
Texture light_list(const Lighting& lighting);
void set_lighting(const Program& program, const Lighting& lighting);

}  // namespace cellproj::gl
