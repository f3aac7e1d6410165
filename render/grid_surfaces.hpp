// SPDX-License-Identifier: BSD-3-Clause
//
// What backends need of isosurfaces in a regular grid and no view changes, in the units they count in (GridUnits).
//
// The level of a scalar is how many isovalues it is not below (classify/isosurface.hpp). A ray crosses the surfaces between the levels of two
// of its places; where the scalar on a face is one number for both cells, each is met exactly as often as the ray changes sides.
#pragma once

#include <vector>

#include <glm/vec3.hpp>

#include "render/grid_scene.hpp"

namespace cellproj {

// Isovalues against scalars as GridUnits::kept has them: ascending; outside of 0..1 those that the field does not cross. A point whose
// scalar is the isovalue stays on it.
std::vector<float> kept_isovalues(const IsoSurfaces& surfaces, const GridUnits& units);

// mesh/grid_gradient.hpp at all points, in the axes of the grid [field range / GridUnits::length]; 0 for a constant field. Parallel.
std::vector<glm::vec3> kept_gradients(const Grid& grid, const GridUnits& units);

}  // namespace cellproj
