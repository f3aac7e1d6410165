// SPDX-License-Identifier: BSD-3-Clause
//
// One tetrahedron in eye space, and rays through it by the plainest means: the judge of the projections.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"
#include "project/tet_projection.hpp"

namespace cellproj::testing_support {

using Points = std::array<glm::dvec3, 4>;

// Eye space to screen terms: parallel (x, y, z, s), perspective (x/z, y/z, 1/z, s/z).
inline std::array<ScreenVertex, 4> screen(const Points& points, const std::array<double, 4>& s, bool perspective) {
    std::array<ScreenVertex, 4> corners{};
    for (std::size_t i = 0; i < 4; ++i) {
        const double w = perspective ? 1 / points[i].z : 1.0;
        corners[i] = {{points[i].x * w, points[i].y * w}, perspective ? w : points[i].z, s[i] * w};
    }
    return corners;
}

inline double volume(const Points& p) { return std::abs(glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0])) / 6; }

// A cell at random in front of the eye, with a scalar at each corner.
struct ScalarTet {
    Points points;
    std::array<double, 4> s;
    double stretch;  // its box is 2 by 2 by 2·stretch
};

// Up to 20 times longer or shorter along the view than across. None when it has less than a thousandth of its box: the judge
// below rounds more in slivers.
inline std::optional<ScalarTet> random_tet(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    ScalarTet tet{};
    tet.stretch = std::pow(20.0, unit(random));
    for (auto& p : tet.points) p = {unit(random), unit(random), 1.2 + (1 + unit(random)) * tet.stretch};
    if (volume(tet.points) < 1e-3 * tet.stretch) return std::nullopt;
    tet.s = {unit(random), unit(random), unit(random), unit(random)};
    return tet;
}

// Corners on a grid of 5³ points: every degenerate case comes up often.
inline Points coarse_tet(std::mt19937_64& random) {
    std::uniform_int_distribution<int> coarse(0, 4);
    Points points;
    for (auto& p : points) p = glm::dvec3(coarse(random), coarse(random), coarse(random));
    return points;
}

// Weights of a triangle's corners, positive, of sum 1; no corner gets less than `least` of another.
inline std::array<double, 3> random_weights(std::mt19937_64& random, double least) {
    std::uniform_real_distribution<double> share(least, 1);
    std::array<double, 3> w{share(random), share(random), share(random)};
    const double sum = w[0] + w[1] + w[2];
    for (double& x : w) x /= sum;
    return w;
}

// The area of triangle t of a cell on the screen: a ProjectedTet or a Silhouette.
template <class CellOnScreen>
double area(const CellOnScreen& cell, std::size_t t) {
    const auto& [a, b, c] = cell.triangles[t];
    return 0.5 * std::abs(doubled_area(cell.vertices[a].position, cell.vertices[b].position, cell.vertices[c].position));
}

struct Segment {
    double front, back, s_front, s_back;  // depths along the ray's z, scalars
};

// What the affine terms of a vertex on the screen say of its ray.
inline Segment segment_of(const ProjectedVertex& v, bool perspective) {
    if (!perspective) return {v.front_depth, v.front_depth + v.thickness, v.front_scalar, v.back_scalar};
    const double back = v.front_depth - v.thickness;
    return {1 / v.front_depth, 1 / back, v.front_scalar / v.front_depth, v.back_scalar / back};
}

// The ray through (x, y) at depth 1 (perspective) or along z (parallel) against the four planes, in float64.
inline std::optional<Segment> cast(const Points& points, const std::array<double, 4>& s, const glm::dvec2& at, bool perspective) {
    const glm::dvec3 origin = perspective ? glm::dvec3(0) : glm::dvec3(at, 0);
    const glm::dvec3 direction = perspective ? glm::dvec3(at, 1) : glm::dvec3(0, 0, 1);
    const double six = glm::dot(glm::cross(points[1] - points[0], points[2] - points[0]), points[3] - points[0]);
    double front = -1e300, back = 1e300;
    glm::dvec3 gradient(0);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& f = face_corners[i];
        const auto at_corner = [&](int k) { return points[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])]; };
        const glm::dvec3 inward = -glm::cross(at_corner(1) - at_corner(0), at_corner(2) - at_corner(0)) / six;
        gradient += s[i] * inward;  // barycentric coordinate i grows from 0 on face i
        const double speed = glm::dot(inward, direction), height = glm::dot(inward, at_corner(0) - origin);
        if (speed > 0) front = std::max(front, height / speed);
        if (speed < 0) back = std::min(back, height / speed);
    }
    if (back <= front) return std::nullopt;
    const auto scalar = [&](double z) { return s[0] + glm::dot(gradient, origin + z * direction - points[0]); };
    return Segment{front, back, scalar(front), scalar(back)};
}

}  // namespace cellproj::testing_support
