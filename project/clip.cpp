// SPDX-License-Identifier: BSD-3-Clause
#include "project/clip.hpp"

#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

EyeVertex cut(const EyeVertex& inside, const EyeVertex& outside, double near) {
    const double t = (inside.position.z - near) / (inside.position.z - outside.position.z);
    EyeVertex v{inside.position + t * (outside.position - inside.position),
                inside.scalar + t * (outside.scalar - inside.scalar)};
    v.position.z = near;
    return v;
}

using Tet = std::array<EyeVertex, 4>;

// Whether the eye at the origin lies on the side of corner 3 of the face that the other corners span.
bool eye_beside_last(const Tet& t) {
    const auto side = [&](const glm::dvec3& eye) {
        return side_of_plane(Eye::at(eye), t[0].position, t[1].position, t[2].position);
    };
    return side({0, 0, 0}) * side(t[3].position) > 0;
}

// A wedge with the triangles (a0, a1, a2) and (b0, b1, b2), b_i joined to a_i: a chain of three tetrahedra, each pair of
// neighbours with a common face that says which of the two is in front.
ClippedTet wedge(const EyeVertex& a0, const EyeVertex& a1, const EyeVertex& a2, const EyeVertex& b0, const EyeVertex& b1,
                 const EyeVertex& b2) {
    const Tet first{a0, a1, b2, a2}, middle{a0, a1, b1, b2}, last{a0, b1, b2, b0};  // the common face first
    const bool first_in_front = eye_beside_last(first), last_in_front = eye_beside_last(last);
    ClippedTet pieces;
    const auto add = [&](const Tet& tet) { pieces.tets[pieces.count++] = tet; };
    if (!first_in_front) add(first);
    if (!last_in_front) add(last);
    add(middle);
    if (first_in_front) add(first);
    if (last_in_front) add(last);
    return pieces;
}

SilhouetteVertex mix(const SilhouetteVertex& a, const SilhouetteVertex& b, double t) {
    return {a.position + t * (b.position - a.position), a.base_depth + t * (b.base_depth - a.base_depth),
            a.base_scalar + t * (b.base_scalar - a.base_scalar), a.ridges + t * (b.ridges - a.ridges)};
}

// Keeps the part of the polygon where side·(position[axis] − bound) ≤ 0.
ClippedPolygon clip_line(const ClippedPolygon& polygon, int axis, double bound, double side) {
    ClippedPolygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const SilhouetteVertex& a = polygon.vertices[i];
        const SilhouetteVertex& b = polygon.vertices[(i + 1) % polygon.count];
        const double da = side * (a.position[axis] - bound), db = side * (b.position[axis] - bound);
        if (da <= 0) kept.vertices[kept.count++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            SilhouetteVertex& v = kept.vertices[kept.count++];
            v = mix(a, b, da / (da - db));
            v.position[axis] = bound;
        }
    }
    if (kept.count < 3) kept.count = 0;
    return kept;
}

}  // namespace

ClippedTet clip_near(const std::array<EyeVertex, 4>& corners, double near) {
    std::array<EyeVertex, 4> in, out;
    std::size_t inside = 0, outside = 0;
    for (const EyeVertex& v : corners) {
        if (v.position.z > near) in[inside++] = v;
        else out[outside++] = v;
    }
    switch (inside) {
        case 4:
            return {1, {corners}};
        case 3:
            return wedge(in[0], in[1], in[2], cut(in[0], out[0], near), cut(in[1], out[0], near),
                         cut(in[2], out[0], near));
        case 2:
            return wedge(in[0], cut(in[0], out[0], near), cut(in[0], out[1], near), in[1], cut(in[1], out[0], near),
                         cut(in[1], out[1], near));
        case 1:
            return {1, {{{in[0], cut(in[0], out[0], near), cut(in[0], out[1], near), cut(in[0], out[2], near)}}}};
        default:
            return {};
    }
}

ClippedPolygon clip_to_rectangle(const std::array<SilhouetteVertex, 3>& triangle, const Rectangle& rectangle) {
    ClippedPolygon polygon;
    polygon.count = 3;
    for (std::size_t i = 0; i < 3; ++i) polygon.vertices[i] = triangle[i];
    for (int axis = 0; axis < 2 && polygon.count > 0; ++axis) {
        polygon = clip_line(polygon, axis, rectangle.low[axis], -1.0);
        polygon = clip_line(polygon, axis, rectangle.high[axis], 1.0);
    }
    return polygon;
}

}  // namespace cellproj
