// SPDX-License-Identifier: BSD-3-Clause
//
// Clipping, in float64 and without loss of exactness: cells against the near plane (never dropped: a camera may stand
// inside the mesh), and projected triangles against a rectangle around the picture (a cell close to the eye can project to
// millions of pixels, where float32 positions are coarser than a pixel).
#pragma once

#include <array>
#include <cstddef>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

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
template <class Vertex>
struct ClippedPolygon {
    std::size_t count = 0;  // 0 or 3 .. 7
    std::array<Vertex, 7> vertices;
};

// The part of a polygon where side·(position[axis] − bound) ≤ 0.
template <class Vertex>
ClippedPolygon<Vertex> clip_line(const ClippedPolygon<Vertex>& polygon, int axis, double bound, double side) {
    ClippedPolygon<Vertex> kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Vertex& a = polygon.vertices[i];
        const Vertex& b = polygon.vertices[(i + 1) % polygon.count];
        const double da = side * (a.position[axis] - bound), db = side * (b.position[axis] - bound);
        if (da <= 0) kept.vertices[kept.count++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            Vertex& v = kept.vertices[kept.count++];
            v = mix(a, b, da / (da - db));
            v.position[axis] = bound;
        }
    }
    if (kept.count < 3) kept.count = 0;
    return kept;
}

// The part of a triangle inside a rectangle (Sutherland–Hodgman). A Vertex has a `position` [pixels] and a function
// mix(a, b, t) for the one between a (t = 0) and b (t = 1); when all its terms are affine in screen space, the new
// vertices are exact up to rounding.
template <class Vertex>
ClippedPolygon<Vertex> clip_to_rectangle(const std::array<Vertex, 3>& triangle, const Rectangle& rectangle) {
    ClippedPolygon<Vertex> polygon;
    polygon.count = 3;
    for (std::size_t i = 0; i < 3; ++i) polygon.vertices[i] = triangle[i];
    for (int axis = 0; axis < 2 && polygon.count > 0; ++axis) {
        polygon = clip_line(polygon, axis, rectangle.low[axis], -1.0);
        polygon = clip_line(polygon, axis, rectangle.high[axis], 1.0);
    }
    return polygon;
}

}  // namespace cellproj
