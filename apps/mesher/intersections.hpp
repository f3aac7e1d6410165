// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Facets that cross or touch each other where they should not.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Which facets a set of triangles was made of.
struct FacetTriangles {
    std::vector<std::array<VertexId, 3>> corners;  // none of them degenerate
    std::vector<std::uint32_t> facets;             // one for each triangle
};

// The pairs of facets of which two triangles share more than their common corners and edges; ascending, each pair once.
// Points are the same only when their ids are. Exact predicates.
std::vector<std::array<std::uint32_t, 2>> intersecting_facets(const std::vector<glm::dvec3>& points,
                                                              const FacetTriangles& triangles);

}  // namespace cellproj
