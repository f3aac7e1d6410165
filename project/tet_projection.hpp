// SPDX-License-Identifier: BSD-3-Clause
//
// What one tetrahedron covers on the screen: Shirley and Tuchman, "A Polygonal Approximation to Direct Scalar Volume
// Rendering", 1990; the base of RKE00 §2. The silhouette is cut into at most four triangles, so that inside each of them the
// ray enters through one face and leaves through one face.
//
// Exact under perspective. On a planar face, with z the depth and s the scalar, 1/z and s/z are affine in screen space; in a
// parallel view z and s are. A vertex therefore carries affine *terms*
//
//   depth term    1/z (perspective)   z (parallel)
//   scalar term   s/z (perspective)   s (parallel)
//
// for the ray's entry (front) and exit (back), which may be interpolated linearly over a triangle; the pixel recovers
// s_f, s_b and the length of the segment. The difference of the depth terms is carried by itself ("thickness"): it is computed here in
// float64, so that a thin cell far from the eye keeps its thickness in float32.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec2.hpp>

namespace cellproj {

// A corner of a projected tetrahedron: position in pixels, depth term, scalar term.
struct ScreenVertex {
    glm::dvec2 position;
    double depth;
    double scalar;
};

struct ProjectedVertex {
    glm::dvec2 position;  // pixels
    double front_depth;   // depth term where the ray enters
    double thickness;     // |depth term at the exit − at the entry| ≥ 0
    double front_scalar;  // scalar term where the ray enters
    double back_scalar;   // scalar term where the ray leaves
};

// Named by what meets on the screen; the value is the number of triangles.
enum class ProjectionClass : std::uint8_t {
    nothing = 0,            // seen edge-on, or without extent: no area
    vertex_on_vertex = 1,   // two corners coincide
    vertex_on_edge = 2,     // a corner lies on the projection of an edge
    vertex_in_triangle = 3, // a corner lies inside the triangle of the others
    edges_cross = 4         // two opposite edges cross: a quadrilateral
};

// Vertices 0..3 are the corners in input order. The *thick vertex*, where the cell is thickest, is the fifth one where
// edges cross, and the corner `thick` in the other classes; at all other vertices the thickness is 0.
//
// On one side of the cell, its *base*, the thick vertex lies on the face or edge of other corners: it is the mean of the
// corners with `base_weights` (≥ 0, sum 1; three, two or one of them are not 0).
struct ProjectedTet {
    ProjectionClass kind = ProjectionClass::nothing;
    int thick = 0;
    std::array<ProjectedVertex, 5> vertices{};
    std::array<std::array<std::uint8_t, 3>, 4> triangles{};  // as many as `kind` says; each ends with the thick vertex
    std::array<double, 4> base_weights{};
    bool base_is_front = true;

    std::size_t vertex_count() const { return kind == ProjectionClass::edges_cross ? 5 : 4; }
    std::size_t triangle_count() const { return static_cast<std::size_t>(kind); }
};

// The class follows from the exact signs of the four faces' screen areas, so that it is consistent for every input, flat
// and degenerate ones included. Which side is the front is read from the depths at the thick vertex: the orientation of the
// corners does not matter. `perspective` tells the meaning of the depth terms (larger 1/z is nearer, larger z is farther).
ProjectedTet project_tet(const std::array<ScreenVertex, 4>& corners, bool perspective);

}  // namespace cellproj
