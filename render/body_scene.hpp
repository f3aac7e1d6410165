// SPDX-License-Identifier: BSD-3-Clause
//
// Opaque bodies in a scene: surfaces of triangles, such as the wing in a flow. They hide what is behind them, in the volume and behind it,
// and are lit as isosurfaces are. What is clipped is the field: bodies stay whole.
#pragma once

#include <array>
#include <vector>

#include <glm/vec3.hpp>

#include "classify/lighting.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

struct Body {
    std::vector<glm::dvec3> points;                   // #P [mesh units], finite
    std::vector<std::array<VertexId, 3>> triangles;   // #F by 3, 0-based into points; both sides are seen, each planar and lit as such
    glm::dvec3 color{0.7};                            // 0..1
};

struct BodyScene {
    std::vector<Body> bodies;
    Lighting lighting = {};  // its directions in the axes of the mesh
};

// The surface's polygons as triangles. Throws Error (data) as `validate` of a surface.
Body make_body(const Surface& surface, const glm::dvec3& color);

// Throws Error (data) for a vertex id out of range or a point that is not finite, Error (option) for lights out of range.
void validate(const BodyScene& scene);

}  // namespace cellproj
