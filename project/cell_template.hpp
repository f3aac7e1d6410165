// SPDX-License-Identifier: BSD-3-Clause
//
// What a box covers on the screen: the projection template of Wilhelms and Van Gelder, "A Coherent Projection Approach
// for Direct Volume Rendering", SIGGRAPH 1991, §2–3 and Fig. 1. The edges in front and those behind cut the silhouette
// into polygons in which every ray enters through one face and leaves through one face. In a parallel view all cells of
// the same edge lengths have the same template: it is derived once and moved from cell to cell.
//
//   visible faces   polygons, parallel   polygons, perspective
//   1               1                    3 to 5
//   2               2 or 3               4 to 7
//   3               6 or 7               6 or 7
//
// Derivation. Measure each visible axis i from the face in front, and let g_i be the distance of the eye's plane
// (parallel to the face) from the front face and G_i that from the back face; parallel: both are the direction's
// component |d_i|. With edge lengths h_i, let a be the visible axis with the largest g_i/h_i. A ray from the nearest
// corner, or to the farthest one, leaves or enters through a face across a, since it crosses the cell along a sooner
// than along any other axis. So
//
//   nearest corner      leaves at u_a = 1, u_i = g_i h_a / (g_a h_i)
//   farthest corner     is entered at u_a = 0, u_i = 1 − G_i h_a / (G_a h_i) = (g_a h_i − g_i h_a) / (G_a h_i)
//
// and where an edge in front crosses one behind, it has a coordinate of each kind. All these *interior* pairs lie on
// the two faces across a, hence share one thickness: the length h_a |d| / |d_a|, or in perspective the ratio of depths
// G_a / g_a. Which faces are seen and which axes tie for a is decided by exact signs of g_i h_j − g_j h_i: seven
// positions of the farthest corner over the nearest, on a face (one axis), on an edge (two), on the corner itself
// (three).
//
// Perspective differs from Fig. 1 (which is for parallel views) only by faces behind that a parallel view sees edge-on:
// where the eye lies between the planes of an axis, both its faces are back faces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"
#include "project/camera.hpp"
#include "project/tet_projection.hpp"

namespace cellproj {

// A pair of points on one ray, in the cell: u in [0, 1]³ from the low to the high end of each axis (mesh/grid.hpp,
// whose corner_weights give what lies there: linear on edges, bilinear on faces). Coordinates on faces are exactly 0
// or 1.
struct TemplateVertex {
    glm::dvec3 front;       // where the ray enters
    glm::dvec3 back;        // where it leaves
    bool interior = false;  // has the template's thickness; otherwise front = back, a corner on the silhouette
};

// A face of a cell is numbered 2·axis, plus 1 for the one at the high end.
struct TemplatePolygon {
    std::uint8_t count = 0;                  // 3 or 4; convex
    std::array<std::uint8_t, 4> vertices{};  // counter-clockwise as the eye sees them, if x, y, z are right-handed
    std::uint8_t front_face = 0;             // through which all its rays enter
    std::uint8_t back_face = 0;              // through which they leave

    std::span<const std::uint8_t> corners() const { return {vertices.data(), count}; }
};

struct CellTemplate {
    int visible_faces = 0;          // 0: the eye lies inside the cell or on its border, there is no silhouette
    std::uint8_t crossed_axes = 0;  // bit i: the interior rays cross axis i from end to end (the ties for a)
    double interior_thickness = 0;  // parallel: length [mesh units]; perspective: (z_b − z_f) / z_b, z the depth; > 0
    std::size_t vertex_count = 0;
    std::size_t polygon_count = 0;
    std::array<TemplateVertex, 10> vertex_storage{};
    std::array<TemplatePolygon, 7> polygon_storage{};

    std::span<const TemplateVertex> vertices() const { return {vertex_storage.data(), vertex_count}; }
    std::span<const TemplatePolygon> polygons() const { return {polygon_storage.data(), polygon_count}; }
};

// The template of all cells with these edge lengths [mesh units, > 0] in a parallel view. `towards_eye` as in Eye; not
// 0, any length. Exact for magnitudes whose products neither overflow nor underflow (predicates.hpp).
CellTemplate parallel_template(const glm::dvec3& towards_eye, const glm::dvec3& edges);

// The template of one cell, low < high in each axis, for an eye at a place. No polygons for an eye in the cell or on
// its border.
CellTemplate perspective_template(const glm::dvec3& eye, const Bounds& cell);

// A vertex of a template on the screen, for a cell with these scalars at its corners. Depth terms are affine over each
// polygon and exact; the scalar is exact at the vertices and, over the whole polygon, where it is linear in the cell.
// In perspective every corner of the cell must lie in front of the eye (depth > 0) and the template be that of this
// cell and eye. A cell that the near plane cuts must be cut first (clip.hpp does that for tetrahedra).
ProjectedVertex project(const TemplateVertex& vertex, const CellTemplate& shape, const Bounds& cell,
                        const std::array<double, 8>& corner_scalars, const ScreenTransform& transform);

}  // namespace cellproj
