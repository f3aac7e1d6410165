// SPDX-License-Identifier: BSD-3-Clause
//
// Gradients of the scalar of a regular grid on its points: what shading takes for the normals of isosurfaces (EKE01 §5.3; gradient.hpp
// is their like for meshes).
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "mesh/grid.hpp"

namespace cellproj {

// Of the trilinear scalar at u in a cell of these edge lengths [scalar / mesh unit]. Continuous in the cell, not from one to the next.
glm::dvec3 trilinear_gradient(const std::array<double, 8>& corner_values, const glm::dvec3& u, const glm::dvec3& edges);

// At a point of a field on points: along each axis the slope in the middle of the parabola through it and both neighbours, which on uniform
// axes is the central difference; one-sided where a neighbour is missing (a border, or no cell that is not blanked has the edge to it), and
// 0 where both are. Exact for linear fields, and inside for quadratic ones. 0 also where float64 cannot hold it.
glm::dvec3 point_gradient(const Grid& grid, const GridCell& point);

}  // namespace cellproj
