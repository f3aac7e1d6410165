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
// with the rasterizer's rounding of the thick vertex, and slivers show it. The base terms are affine over the triangles, too; the
// other side follows from them, since s/z (parallel: s) is an affine function of the screen plus a constant times 1/z (z).
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
    double base_depth;    // depth term on the base
    double base_scalar;   // scalar term on the base
    glm::dvec3 ridges;    // the thickness is their minimum
};

// Between a (t = 0) and b (t = 1), on the screen; all terms are affine there.
inline SilhouetteVertex mix(const SilhouetteVertex& a, const SilhouetteVertex& b, double t) {
    return {a.position + t * (b.position - a.position), a.base_depth + t * (b.base_depth - a.base_depth),
            a.base_scalar + t * (b.base_scalar - a.base_scalar), a.ridges + t * (b.ridges - a.ridges)};
}

struct Silhouette {
    std::size_t triangle_count = 0;                          // 0, 1 or 2
    std::array<SilhouetteVertex, 4> vertices{};              // the corners
    std::array<std::array<std::uint8_t, 3>, 2> triangles{};  // corners
    bool base_is_front = true;
    double scalar_slope = 0.0;  // scalar term on the other side = base_scalar + scalar_slope · thickness
};

// No triangles for a cell that is edge-on or flat: it holds no piece of any ray.
Silhouette make_silhouette(const std::array<ScreenVertex, 4>& corners, bool perspective);

}  // namespace cellproj
