// SPDX-License-Identifier: BSD-3-Clause
//
// What a fragment needs to cut the segment of a ray where isosurfaces cross it.
//
// A surface may neither be lost nor met twice where a ray goes from one cell to the next. So both must hold the same number for the
// scalar on their common face, to the bit: a vertex carries the faces of its cell, each made of its three corners in an order
// and about an origin that do not depend on the cell, and the fragment does the same arithmetic on each of them. Faces are those
// of the corners where the rasterizer has them, with their scalars: so no segment comes out negative, faces meet at their edges, and which
// surfaces are met is what a mesh has whose points lie up to 1/512 of a pixel beside their places. Where in the segment they are met,
// and which medium is around them, is told by the cell's own field, which stays in place.
#pragma once

#include <array>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "project/camera.hpp"

namespace cellproj {

// Depths as float32 carries them: 0 at the farthest point of the mesh and growing towards the eye, so that distant meshes keep
// their digits.
//
//   nearness    1/z − 1/z of the farthest point (perspective)   z of the farthest point − z (parallel)   [SceneUnits::length]
struct NearnessFrame {
    bool perspective;
    double far;      // depth term of the farthest point: 1/z or z
    double nearest;  // largest nearness there can be, > 0

    double nearness(double depth_term) const { return perspective ? depth_term - far : far - depth_term; }
    double far_depth() const { return perspective ? 1.0 / far : far; }
};

// A face as planes on the screen: value at the origin, change per pixel to the right and down.
struct SurfaceFace {
    float nearness[3], origin_x;
    float scalar[3], origin_y;  // scalar term (project/tet_projection.hpp); origin: a pixel centre
};

// Interpolated: position and ridges. All else is of the triangle whose last vertex it is.
struct SurfaceVertex {
    float x, y;             // clip space
    float opacity_value, opacity_slope_x;  // of an opacity field, where there is one: AffineMap, also further down
    float ridges[3];        // project/silhouette.hpp; the smallest tells the face on the other side: 1 + its number
    float opacity_slope_y;
    SurfaceFace faces[4];   // the base first
    float scalars[4];       // normalized, of the corner opposite to each face
    float first, last;      // isosurfaces that can be in the cell: first <= i < last
    float depth_range;      // largest minus smallest depth; negative when the base is the back
    float opacity_slope_z;
    struct {
        float gradient[3], scalar;
    } maps[4];              // AffineMap of each: value, slopes
};

struct FaceCorner {
    glm::dvec2 position;  // pixels
    double nearness, scalar_term;
};

// The same bits whatever the order of the corners. A face that is edge-on has no planes: the values of one corner.
SurfaceFace make_surface_face(std::array<FaceCorner, 3> corners, ImageSize size);

// The pixel of a picture nearest to a place, its centre.
glm::dvec2 nearest_pixel(const glm::dvec2& place, ImageSize size);

// What is linear in a cell.
template <class Value>
struct AffineMap {
    Value value{0.0};                // at the place from which the corners' places count
    std::array<Value, 3> slopes{};  // per length along x, y and z

    Value at(const glm::dvec3& place) const { return value + place.x * slopes[0] + place.y * slopes[1] + place.z * slopes[2]; }
};

// From what it is at the corners. In a cell so flat that float32 could not hold the slopes, the corners' mean everywhere.
//
// Gradients in any axes, all finite: up to a factor > 0 that is the same all over the cell (RKE00 §8, EKE01 §5.3).
AffineMap<glm::dvec3> make_gradient_map(const std::array<glm::dvec3, 4>& places, const std::array<glm::dvec3, 4>& gradients);
// Scalars in 0..1.
AffineMap<double> make_scalar_map(const std::array<glm::dvec3, 4>& places, const std::array<double, 4>& scalars);

}  // namespace cellproj
