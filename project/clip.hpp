// SPDX-License-Identifier: BSD-3-Clause
//
// Clipping, in float64 and without loss of exactness: cells against the near plane (never dropped: a camera may stand
// inside the mesh), and projected triangles against a rectangle around the picture (a cell close to the eye can project to
// millions of pixels, where float32 positions are coarser than a pixel).
#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

#include "project/silhouette.hpp"

namespace cellproj {

// A point of eye space (z = depth, camera.hpp) with its scalar; quantities that are linear in space.
struct EyeVertex {
    glm::dvec3 position;
    double scalar;
};

struct ClippedTet {
    std::size_t count = 0;  // 0 .. 3
    std::array<std::array<EyeVertex, 4>, 3> tets;
};

// The part of a tetrahedron with depth ≥ near, as tetrahedra from back to front for the eye at the origin. Cells that merely
// touch the plane give nothing.
ClippedTet clip_near(const std::array<EyeVertex, 4>& corners, double near);

struct Rectangle {
    glm::dvec2 low, high;  // pixels
};

// A convex polygon: a triangle cut by up to four lines.
struct ClippedPolygon {
    std::size_t count = 0;  // 0 or 3 .. 7
    std::array<SilhouetteVertex, 7> vertices;
};

// The part of a silhouette's triangle inside a rectangle (Sutherland–Hodgman). All terms are affine in screen space, so the
// new vertices are exact up to rounding.
ClippedPolygon clip_to_rectangle(const std::array<SilhouetteVertex, 3>& triangle, const Rectangle& rectangle);

}  // namespace cellproj
