// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: a face to triangles. The two cells of a face list it from another start and the other way round,
// and must get the same triangles: everything here is computed from one order that both find.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

using Triangle = std::array<VertexId, 3>;

// Appends the triangles of a polygon (ids into `points`, not necessarily planar or convex), turned as it is. They are a
// fan around the lowest id, unless a triangle of the fan is turned against the face or is next to nothing of it (below
// 1 % of its area), as happens at hanging nodes; then they are the triangulation whose worst triangle is best (dynamic
// programming after Klincsek 1980; faces of more than 64 vertices keep the fan). Where a vertex is repeated, the
// triangles that would repeat it are left out.
void triangulate_face(std::span<const VertexId> face, std::span<const glm::dvec3> points,
                      std::vector<Triangle>& triangles);

}  // namespace cellproj
