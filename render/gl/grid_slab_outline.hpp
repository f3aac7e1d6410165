// SPDX-License-Identifier: BSD-3-Clause
//
// What the part of a box between two parallel planes covers on the screen.
#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"
#include "render/gl/grid_view.hpp"

namespace cellproj::gl {

// The corners of what of the box lies where low ≤ normal·p ≤ high, in any order, some of them twice; none where it is empty.
std::vector<glm::dvec3> slab_corners(const Bounds& box, const glm::dvec3& normal, double low, double high);

// The convex hull of points, in the order of a polygon: without corners on its edges, fewer than three where all lie on a line.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points);

// What has a corner nearer to the eye than this [scene units] may cover all of the picture.
inline constexpr double near_depth = 1e-3;

// The rasterizer rounds positions to 1/256 of a pixel; rays find out by themselves what of them lies inside.
inline constexpr double outline_margin = 1.0 / 64;

// What the convex hull of places about the view's reference point may cover [pixels], as a polygon with a margin around it; all of
// the picture where one of them comes close to the eye. Fewer than three corners: nothing.
std::vector<glm::dvec2> outline_on_screen(const GridView& view, std::span<const glm::dvec3> corners);

// A pixel position to clip space.
glm::vec2 clip_space(const GridView& view, const glm::dvec2& pixel);

}  // namespace cellproj::gl
