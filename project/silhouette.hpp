// SPDX-License-Identifier: BSD-3-Clause
//
// A projected tetrahedron as its silhouette, one or two triangles, instead of the three or four of Shirley and Tuchman.
//
// The thickness over the silhouette is concave and piecewise linear: 0 along the border and largest, t, at the thick vertex.
// It is therefore the smallest of at most three affine functions, the *ridges*, one for each corner c on which the base
// leans with a weight w_c ≠ 0 (ProjectedTet::base_weights): ridge c is t/w_c at corner c and 0 at the others. The pixel takes
// the minimum.
//
//   vertex in triangle, on edge, on vertex   the base is the face opposite to the thick corner: one triangle
//   edges cross                              the base is one of the two edges and the two faces at it: two triangles
//
// Nothing is approximated: the minimum is exact between the corners, whereas the inner edges of the classical split move
// with the rasterizer's rounding of the thick vertex, and slivers show it. The terms are affine over the triangles, too, and given
// as planes about a point nearby, so that float32 serves steep ones; the scalar on the other side follows from them, since s/z (parallel: s) is an affine function of the screen plus a constant times 1/z (z).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "project/tet_projection.hpp"

namespace cellproj {

struct SilhouetteVertex {
    glm::dvec2 position;  // pixels
    glm::dvec3 ridges;    // the smallest tells through which face the ray goes on the other side
};

// Between a (t = 0) and b (t = 1), on the screen; ridges are affine there.
inline SilhouetteVertex mix(const SilhouetteVertex& a, const SilhouetteVertex& b, double t) {
    return {a.position + t * (b.position - a.position), a.ridges + t * (b.ridges - a.ridges)};
}

// An affine function on the screen.
struct ScreenPlane {
    double value = 0.0;            // at the silhouette's origin
    glm::dvec2 gradient{0.0, 0.0}; // per pixel
};

// Over one triangle of a silhouette, which belongs to one face as the base.
struct SilhouetteTerms {
    ScreenPlane base_depth, base_scalar;     // depth term and scalar term on the base
    std::array<ScreenPlane, 3> thickness{};  // where this ridge is the smallest: |depth term on the other side − on the base|
};

struct Silhouette {
    std::size_t triangle_count = 0;                          // 0, 1 or 2
    std::array<SilhouetteVertex, 4> vertices{};              // the corners
    std::array<std::array<std::uint8_t, 3>, 2> triangles{};  // corners; the last one is in no other triangle
    std::array<std::uint8_t, 3> ridge_corners{};             // where a ridge is the smallest, the face opposite to its corner is there
    std::size_t ridge_count = 0;                             // 1 .. 3
    std::array<SilhouetteTerms, 2> terms{};                  // of the triangles
    glm::dvec2 origin{0.0, 0.0};                             // pixels
    bool base_is_front = true;
    double scalar_slope = 0.0;  // scalar term on the other side = base_scalar + scalar_slope · thickness
};

// The silhouette of a cell whose corners were moved on the screen, by `moved` [pixels], to places where the rasterizer can have
// them. `origin` [pixels]: about which the terms are given; best close to where they are asked for.
//
// What the cell covers, and through which of its faces a ray goes, follows the moved corners, so that the cells of a mesh still
// follow each other along every ray. Depths and scalars on a face are those of the plane it had before. So both cells of a face agree
// on it, and light is as if nothing had moved, but for rays that pass an edge closer than it was moved. There the faces are
// extended beyond it: a segment may come out negative, to be taken back from what its neighbours have too much. What is left is of second
// order, since the field is continuous: a piece of the ray no longer than that extension has the scalar of a neighbour. Faces seen so
// nearly edge-on that a depth on them would change by more than an eighth of theirs are taken as they were moved.
//
// No triangles for a cell that is edge-on or flat after its corners were moved: it holds no piece of any ray.
Silhouette make_silhouette(const std::array<ScreenVertex, 4>& corners, const std::array<glm::dvec2, 4>& moved,
                           const glm::dvec2& origin, bool perspective);

// The same without terms and slope, for what is drawn from the faces themselves. Cells that are flat but not edge-on have their
// triangles here: between their faces lies a place, though no length. Of those the ridges are relative.
Silhouette make_outline(const std::array<ScreenVertex, 4>& corners, bool perspective);

// The corner that a triangle of the silhouette leaves out: that opposite to its base.
inline std::uint8_t base_corner(const std::array<std::uint8_t, 3>& triangle) {
    return static_cast<std::uint8_t>(6 - triangle[0] - triangle[1] - triangle[2]);
}

}  // namespace cellproj
