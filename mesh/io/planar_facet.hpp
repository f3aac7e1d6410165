// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: a facet of several polygons, some of them around holes, as triangles.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// What TetGen means by a facet: polygons in one plane, which may lie within each other or side by side but do not cross.
// The triangles cover all that they enclose, but for what a hole seed lies in: that part ends at the next polygons around
// it and within it. They use every vertex, also those within an edge, so that they fit to other facets; they face as the
// largest polygon does. `loops` have at least 3 vertices each. Signs are exact, in the projection along the axis nearest to
// the normal. None when the polygons cross or have no area. O(n²) for usual facets of n vertices.
std::optional<std::vector<std::array<VertexId, 3>>> triangulate_facet(const std::vector<glm::dvec3>& points,
                                                                      const std::vector<std::vector<VertexId>>& loops,
                                                                      const std::vector<glm::dvec3>& holes);

}  // namespace cellproj
