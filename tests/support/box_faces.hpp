// SPDX-License-Identifier: BSD-3-Clause
//
// A box on the screen by the plainest means: its faces, each projected as a whole, cut with one another. The judge of
// the templates of project/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj::testing_support {

using Polygon = std::vector<glm::dvec2>;

inline double area(const Polygon& p) {
    double sum = 0;
    for (std::size_t i = 2; i < p.size(); ++i) {
        const glm::dvec2 u = p[i - 1] - p[0], v = p[i] - p[0];
        sum += 0.5 * (u.x * v.y - u.y * v.x);
    }
    return sum;
}

inline glm::dvec3 point_in(const Bounds& cell, const glm::dvec3& u) {
    return (1.0 - u) * cell.low + u * cell.high;
}

inline glm::dvec3 corner(const Bounds& cell, unsigned c) {
    return {(c & 1U) != 0 ? cell.high.x : cell.low.x, (c & 2U) != 0 ? cell.high.y : cell.low.y,
            (c & 4U) != 0 ? cell.high.z : cell.low.z};
}

// A plane of projection: x × y points to the eye, so what the eye sees counter-clockwise has positive area.
struct Plane {
    glm::dvec3 x, y, depth;
    std::optional<glm::dvec3> eye;  // none: parallel

    Plane(const glm::dvec3& towards_eye, std::optional<glm::dvec3> from) : eye(from) {
        const glm::dvec3 n = glm::normalize(towards_eye);
        x = glm::normalize(glm::cross(std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), n));
        y = glm::cross(n, x);
        depth = -n;
    }
    double depth_of(const glm::dvec3& p) const { return glm::dot(p - eye.value_or(glm::dvec3(0)), depth); }
    glm::dvec2 operator()(const glm::dvec3& p) const {
        const glm::dvec3 r = p - eye.value_or(glm::dvec3(0));
        return glm::dvec2(glm::dot(r, x), glm::dot(r, y)) / (eye ? depth_of(p) : 1.0);
    }
};

// Corners of face 2·axis + end, round about.
inline std::array<glm::dvec3, 4> face_corners_of(const Bounds& cell, std::size_t face) {
    const auto axis = static_cast<int>(face / 2), next = (axis + 1) % 3, last = (axis + 2) % 3;
    std::array<glm::dvec3, 4> corners{};
    for (std::size_t i = 0; i < 4; ++i) {
        corners[i][axis] = face % 2 == 1 ? cell.high[axis] : cell.low[axis];
        corners[i][next] = i == 1 || i == 2 ? cell.high[next] : cell.low[next];
        corners[i][last] = i >= 2 ? cell.high[last] : cell.low[last];
    }
    return corners;
}

// Positive when the eye sees it from outside.
inline double seen_from_outside(const Bounds& cell, std::size_t face, const Plane& plane) {
    const auto axis = static_cast<int>(face / 2);
    const double out = face % 2 == 1 ? 1.0 : -1.0;
    if (!plane.eye) return -plane.depth[axis] * out;
    return out * ((*plane.eye)[axis] - (face % 2 == 1 ? cell.high[axis] : cell.low[axis]));
}

inline Polygon counter_clockwise(Polygon p) {
    if (area(p) < 0) std::reverse(p.begin(), p.end());
    return p;
}

inline Polygon cut(const Polygon& p, const glm::dvec2& from, const glm::dvec2& to) {
    Polygon kept;
    const auto side = [&](const glm::dvec2& q) {
        return (to.x - from.x) * (q.y - from.y) - (to.y - from.y) * (q.x - from.x);
    };
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 &a = p[i], &b = p[(i + 1) % p.size()];
        const double sa = side(a), sb = side(b);
        if (sa >= 0) kept.push_back(a);
        if ((sa < 0 && sb > 0) || (sa > 0 && sb < 0)) kept.push_back(a + sa / (sa - sb) * (b - a));
    }
    return kept;
}

// Pairs of a front and a back face that share more than the share 1e-9 of the silhouette.
inline std::size_t overlaps(const Bounds& cell, const Plane& plane, double silhouette) {
    std::size_t count = 0;
    for (std::size_t front = 0; front < 6; ++front) {
        if (seen_from_outside(cell, front, plane) <= 0) continue;
        for (std::size_t back = 0; back < 6; ++back) {
            if (seen_from_outside(cell, back, plane) >= 0) continue;
            Polygon f, b;
            for (const glm::dvec3& p : face_corners_of(cell, front))
                f.push_back(plane(p));
            for (const glm::dvec3& p : face_corners_of(cell, back))
                b.push_back(plane(p));
            f = counter_clockwise(f);
            b = counter_clockwise(b);
            for (std::size_t i = 0; i < 4 && !f.empty(); ++i)
                f = cut(f, b[i], b[(i + 1) % 4]);
            count += area(f) > 1e-9 * silhouette ? 1 : 0;
        }
    }
    return count;
}

// The area of the convex hull of the corners (Andrew's monotone chain).
inline double hull_area(const Bounds& cell, const Plane& plane) {
    Polygon points, hull;
    for (unsigned c = 0; c < 8; ++c)
        points.push_back(plane(corner(cell, c)));
    std::sort(points.begin(), points.end(),
              [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
    const auto chain = [&](auto begin, auto end) {
        const std::size_t first = hull.size();
        for (auto p = begin; p != end; ++p) {
            while (hull.size() >= first + 2 && doubled_area(hull[hull.size() - 2], hull.back(), *p) <= 0)
                hull.pop_back();
            hull.push_back(*p);
        }
        hull.pop_back();
    };
    chain(points.begin(), points.end());
    chain(points.rbegin(), points.rend());
    return area(hull);
}

}  // namespace cellproj::testing_support
