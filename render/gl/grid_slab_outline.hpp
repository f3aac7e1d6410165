// SPDX-License-Identifier: BSD-3-Clause
//
// What the part of a box between two parallel planes covers on the screen.
#pragma once

#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj::gl {

// The corners of what of the box lies where low ≤ normal·p ≤ high, in any order, some of them twice; none where it is empty.
std::vector<glm::dvec3> slab_corners(const Bounds& box, const glm::dvec3& normal, double low, double high);

// The convex hull of points, in the order of a polygon: without corners on its edges, fewer than three where all lie on a line.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points);

}  // namespace cellproj::gl
