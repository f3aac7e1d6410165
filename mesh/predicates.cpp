// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/predicates.hpp"

#include <CGAL/Mpzf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// Error bounds of Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997:
// the rounding error of a determinant over rounded differences is below the bound times its permanent (the same sum with
// all terms positive).
constexpr double half_ulp = std::numeric_limits<double>::epsilon() / 2;
constexpr double bound_2d = (3.0 + 16.0 * half_ulp) * half_ulp;
constexpr double bound_3d = (7.0 + 56.0 * half_ulp) * half_ulp;
// His 16 for insphere counts a balanced sum; ours adds one term after the other.
constexpr double bound_sphere = (20.0 + 280.0 * half_ulp) * half_ulp;
// Below this, products may have lost bits to underflow, and the bounds above do not hold.
constexpr double smallest_permanent = 1e-280;

bool certain(double determinant, double permanent, double bound) {
    return permanent > smallest_permanent && std::abs(determinant) > bound * permanent;
}

using Exact = CGAL::Mpzf;  // exact ring arithmetic on float64 values

int sign_of(const Exact& x) { return static_cast<int>(CGAL::sign(x)); }

// det(b−a, c−a, e − w·a) with w = 0 or 1.
int exact_side(const glm::dvec3& e, bool subtract_a, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const auto difference = [](double x, double y) { return Exact(x) - Exact(y); };
    const Exact ux = difference(b.x, a.x), uy = difference(b.y, a.y), uz = difference(b.z, a.z);
    const Exact vx = difference(c.x, a.x), vy = difference(c.y, a.y), vz = difference(c.z, a.z);
    const glm::dvec3 o = subtract_a ? a : glm::dvec3(0.0);
    const Exact wx = difference(e.x, o.x), wy = difference(e.y, o.y), wz = difference(e.z, o.z);
    return sign_of((uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz);
}

int side(const glm::dvec3& e, bool subtract_a, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 u = b - a, v = c - a;
    const glm::dvec3 w = subtract_a ? e - a : e;
    const double yz = u.y * v.z, zy = u.z * v.y;
    const double zx = u.z * v.x, xz = u.x * v.z;
    const double xy = u.x * v.y, yx = u.y * v.x;
    const double determinant = (yz - zy) * w.x + (zx - xz) * w.y + (xy - yx) * w.z;
    const double permanent = (std::abs(yz) + std::abs(zy)) * std::abs(w.x) +
                             (std::abs(zx) + std::abs(xz)) * std::abs(w.y) +
                             (std::abs(xy) + std::abs(yx)) * std::abs(w.z);
    if (certain(determinant, permanent, bound_3d)) return determinant > 0 ? 1 : -1;
    return exact_side(e, subtract_a, a, b, c);
}

// The lifted determinant |x, y, z, x² + y² + z²| of a, b, c, d relative to e (Shewchuk's insphere), with the sign that makes
// "inside" positive for our orientation. Number: float64 or exact; `permanent` gets the sum of the magnitudes.
template <class Number>
Number lifted_determinant(const std::array<glm::dvec3, 4>& points, const glm::dvec3& e, Number* permanent) {
    std::array<std::array<Number, 3>, 4> r;
    for (std::size_t i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) r[i][static_cast<std::size_t>(k)] = Number(points[i][k]) - Number(e[k]);
    }
    const auto magnitude = [](const Number& x) { return x < Number(0) ? -x : x; };
    const auto minor = [&](std::size_t i, std::size_t j) { return r[i][0] * r[j][1] - r[j][0] * r[i][1]; };
    const auto minor_size = [&](std::size_t i, std::size_t j) {
        return magnitude(r[i][0] * r[j][1]) + magnitude(r[j][0] * r[i][1]);
    };
    Number determinant(0);
    for (std::size_t i = 0; i < 4; ++i) {
        // Cofactor of the lift of point i: the determinant of the other three.
        const std::size_t j = (i + 1) % 4, k = (i + 2) % 4, l = (i + 3) % 4;
        const Number lift = r[i][0] * r[i][0] + r[i][1] * r[i][1] + r[i][2] * r[i][2];
        const Number cofactor = r[j][2] * minor(k, l) + r[k][2] * minor(l, j) + r[l][2] * minor(j, k);
        determinant = i % 2 == 0 ? determinant + lift * cofactor : determinant - lift * cofactor;
        if (permanent) {
            *permanent = *permanent + lift * (magnitude(r[j][2]) * minor_size(k, l) + magnitude(r[k][2]) * minor_size(l, j) +
                                              magnitude(r[l][2]) * minor_size(j, k));
        }
    }
    return determinant;
}

}  // namespace

int side_of_circumsphere(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d,
                         const glm::dvec3& e) {
    const std::array points{a, b, c, d};
    double permanent = 0.0;
    const double determinant = lifted_determinant<double>(points, e, &permanent);
    if (certain(determinant, permanent, bound_sphere)) return determinant > 0 ? 1 : -1;
    return sign_of(lifted_determinant<Exact>(points, e, nullptr));
}

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    return side(d, true, a, b, c);
}

int side_of_plane(const Eye& eye, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return side(eye.xyz, !eye.at_infinity, a, b, c);
}

double doubled_area(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    const glm::dvec2 u = b - a, v = c - a;
    const double left = u.x * v.y, right = u.y * v.x;
    const double determinant = left - right;
    if (certain(determinant, std::abs(left) + std::abs(right), bound_2d)) return determinant;

    const auto difference = [](double x, double y) { return Exact(x) - Exact(y); };
    const Exact exact = difference(b.x, a.x) * difference(c.y, a.y) - difference(b.y, a.y) * difference(c.x, a.x);
    const double magnitude = std::max(std::abs(determinant), std::numeric_limits<double>::min());
    return sign_of(exact) * magnitude;
}

}  // namespace cellproj
