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

}  // namespace cellproj
