// SPDX-License-Identifier: BSD-3-Clause
//
// What of a mesh is drawn: the convex region that planes or a box leave. Every viewing ray keeps one interval of its length, so that cells
// need not be cut: their segments are.
#pragma once

#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Keeps the side that the normal points to, and the plane itself: (p − point) · normal ≥ 0.
struct HalfSpace {
    glm::dvec3 point;   // [mesh units]
    glm::dvec3 normal;  // of any length > 0
};

// What all of them keep; none: everything. It may be empty.
struct ClipRegion {
    std::vector<HalfSpace> half_spaces;
};

// The six half spaces of a box, low < high along every axis [mesh units].
ClipRegion box_region(const Bounds& box);

// Throws Error (option) at `place` for a point or normal that is not finite and a normal without length.
void validate(const ClipRegion& region, const std::string& place);

// A normal of length 1, also where squares of its components would overflow or underflow.
glm::dvec3 unit_normal(const HalfSpace& half_space);

// Whether the region has a point of the box, within 1e-9 of its diagonal. O(n⁴) for n planes.
bool meets(const ClipRegion& region, const Bounds& box);

}  // namespace cellproj
