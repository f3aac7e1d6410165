// SPDX-License-Identifier: BSD-3-Clause
//
// Every sign that decides something comes from here and is exact: a float64 evaluation with a proven error bound answers
// almost always, exact arithmetic (CGAL's Mpzf) answers the rest. Meshing, sorting and projection therefore agree.
//
// Conventions: right-handed coordinates. A tetrahedron (a, b, c, d) is positively oriented when det(b−a, c−a, d−a) > 0,
// that is, when a, b, c appear counter-clockwise from d.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace cellproj {

// Where a picture is seen from, as a homogeneous point: a position (w = 1) for perspective, or the direction from the
// scene towards an eye at infinity (w = 0) for parallel views. The direction need not have unit length; it must not be 0.
struct Eye {
    glm::dvec3 xyz;
    bool at_infinity;

    static Eye at(const glm::dvec3& position) { return {position, false}; }
    static Eye towards(const glm::dvec3& direction) { return {direction, true}; }
};

// Sign of det(b−a, c−a, d−a): +1, 0 or −1. Exact for all finite inputs whose products neither overflow nor underflow in
// float64 (magnitudes between 1e-100 and 1e100).
int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

// Side of the plane through a, b, c on which the eye lies: the sign of det(b−a, c−a, e − w·a), e the eye. One rule for
// perspective and parallel views. +1 is the side from which a, b, c appear counter-clockwise (the side of a positively oriented
// fourth vertex). 0: the plane is edge-on, or the triangle is degenerate. Exact as `orientation`.
int side_of_plane(const Eye& eye, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

// +1 when e lies strictly inside the sphere through a, b, c, d, −1 when strictly outside, 0 on it, for a positively oriented
// tetrahedron (the other way round for a negative one; 0 for a flat one whose plane holds e). Exact as `orientation`,
// for magnitudes between 1e-60 and 1e60.
int side_of_circumsphere(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d,
                         const glm::dvec3& e);

// det(b−a, c−a) in the plane, twice the signed area of the triangle: positive when a, b, c turn from +x towards +y. The
// value is float64 rounded, its sign (0 included) is exact as that of `orientation`.
double doubled_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

}  // namespace cellproj
