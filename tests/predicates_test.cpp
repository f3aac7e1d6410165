// SPDX-License-Identifier: BSD-3-Clause
//
// The judge is integer arithmetic: coordinates that are integers below 2⁴⁰ have determinants below 2¹²⁶, exact in 128 bits.
#include "mesh/predicates.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

namespace cellproj {
namespace predicates_test {

__extension__ using Wide = __int128;
using Integers = std::array<std::int64_t, 3>;

int sign(Wide x) { return (x > 0) - (x < 0); }

glm::dvec3 point(const Integers& p) {
    return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

int integer_side(const Integers& e, bool subtract, const Integers& a, const Integers& b, const Integers& c) {
    Wide u[3], v[3], w[3];
    for (int k = 0; k < 3; ++k) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = subtract ? e[k] - a[k] : e[k];
    }
    return sign((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
                (u[0] * v[1] - u[1] * v[0]) * w[2]);
}

TEST(Orientation, KnownTetrahedra) {
    const glm::dvec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    EXPECT_EQ(orientation(o, x, y, z), 1);
    EXPECT_EQ(orientation(o, y, x, z), -1);
    EXPECT_EQ(orientation(o, x, y, {0.25, 0.5, 0}), 0);
    EXPECT_EQ(orientation(o, o, y, z), 0);
}

// Points of one plane, in integers, then moved off it by at most one unit: most of these defeat rounded arithmetic.
TEST(Orientation, AgreesWithIntegersNearThePlane) {
    std::mt19937_64 random(20001);
    std::uniform_int_distribution<std::int64_t> coordinate(-(1LL << 38), 1LL << 38);
    std::uniform_int_distribution<int> small(-3, 3), nudge(-1, 1);
    int zeros = 0, rounded_wrong = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        Integers a, b, c, d;
        const std::int64_t m = small(random), n = small(random);
        for (int k = 0; k < 3; ++k) {
            a[k] = coordinate(random) / 8;
            b[k] = coordinate(random) / 8;
            c[k] = coordinate(random) / 8;
            d[k] = a[k] + m * (b[k] - a[k]) + n * (c[k] - a[k]) + (trial % 2 ? nudge(random) : 0);
        }
        const int exact = integer_side(d, true, a, b, c);
        ASSERT_EQ(orientation(point(a), point(b), point(c), point(d)), exact) << "trial " << trial;
        zeros += exact == 0;
        const glm::dvec3 u = point(b) - point(a), v = point(c) - point(a), w = point(d) - point(a);
        const double rounded = (u.y * v.z - u.z * v.y) * w.x + (u.z * v.x - u.x * v.z) * w.y + (u.x * v.y - u.y * v.x) * w.z;
        rounded_wrong += (rounded > 0) - (rounded < 0) != exact;
    }
    EXPECT_GT(zeros, 5000);          // the test meets what it is about
    EXPECT_GT(rounded_wrong, 1000);  // and plain float64 would fail it
}

TEST(SideOfPlane, OneRuleForBothKindsOfEyes) {
    std::mt19937_64 random(20002);
    std::uniform_int_distribution<std::int64_t> coordinate(-1000, 1000);
    for (int trial = 0; trial < 20000; ++trial) {
        Integers a, b, c, e;
        for (int k = 0; k < 3; ++k) {
            a[k] = coordinate(random) % 4;  // small numbers: many edge-on planes
            b[k] = coordinate(random) % 4;
            c[k] = coordinate(random) % 4;
            e[k] = coordinate(random) % 4;
        }
        EXPECT_EQ(side_of_plane(Eye::at(point(e)), point(a), point(b), point(c)), integer_side(e, true, a, b, c));
        if (e != Integers{0, 0, 0}) {
            EXPECT_EQ(side_of_plane(Eye::towards(point(e)), point(a), point(b), point(c)),
                      integer_side(e, false, a, b, c));
        }
    }
}

TEST(SideOfPlane, ChangesSignWithTheOrderOfTheVertices) {
    std::mt19937_64 random(20003);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    const auto any = [&] { return glm::dvec3(coordinate(random), coordinate(random), coordinate(random)); };
    for (int trial = 0; trial < 5000; ++trial) {
        const glm::dvec3 a = any(), b = any(), c = any();
        // An eye in the plane, up to rounding: the sign is a matter of the last bits.
        const Eye eye = Eye::at(a + coordinate(random) * (b - a) + coordinate(random) * (c - a));
        const int side = side_of_plane(eye, a, b, c);
        EXPECT_EQ(side_of_plane(eye, b, c, a), side);
        EXPECT_EQ(side_of_plane(eye, b, a, c), -side);
        EXPECT_EQ(side_of_plane(eye, c, b, a), -side);
    }
}

TEST(SideOfPlane, HoldsOverManyDecades) {
    for (const double scale : {1e-90, 1e-30, 1e-9, 1.0, 1e9, 1e30, 1e90}) {
        const glm::dvec3 a{scale, 0, 0}, b{0, scale, 0}, c{0, 0, scale};
        const double third = scale / 3;  // in the plane x + y + z = scale up to rounding
        EXPECT_EQ(side_of_plane(Eye::at({0, 0, 0}), a, b, c), -1) << scale;
        EXPECT_EQ(side_of_plane(Eye::at({scale, scale, scale}), a, b, c), 1) << scale;
        EXPECT_EQ(side_of_plane(Eye::at({third * (1 + 1e-15), third, third}), a, b, c), 1) << scale;
        EXPECT_EQ(side_of_plane(Eye::at({third * (1 - 1e-15), third, third}), a, b, c), -1) << scale;
    }
}

// The grid of Kettner, Mehlhorn, Pion, Schirra, Yap, "Classroom Examples of Robustness Problems", 2008: a point moved by ulps
// around a line.
TEST(DoubledArea, SignIsExactOnAGridOfUlps) {
    const double ulp = std::ldexp(1.0, -53);
    const auto units = [](double x) { return static_cast<Wide>(std::ldexp(x, 53)); };
    const glm::dvec2 b{12, 12}, c{24, 24};
    int zeros = 0;
    for (int i = 0; i < 128; ++i) {
        for (int j = 0; j < 128; ++j) {
            const glm::dvec2 a{0.5 + i * ulp, 0.5 + j * ulp};
            const Wide exact = (units(b.x) - units(a.x)) * (units(c.y) - units(a.y)) -
                               (units(b.y) - units(a.y)) * (units(c.x) - units(a.x));
            const double area = doubled_area(a, b, c);
            ASSERT_EQ((area > 0) - (area < 0), sign(exact)) << i << ", " << j;
            zeros += sign(exact) == 0;
        }
    }
    EXPECT_EQ(zeros, 128);  // exactly the diagonal
}

TEST(DoubledArea, ValueIsTwiceTheArea) {
    EXPECT_DOUBLE_EQ(doubled_area({0, 0}, {3, 0}, {0, 5}), 15);
    EXPECT_DOUBLE_EQ(doubled_area({0, 0}, {0, 5}, {3, 0}), -15);
}

// Points of a grid: spheres through grid points meet many others exactly. The judge expands the determinant in integers.
TEST(SideOfCircumsphere, AgreesWithIntegers) {
    std::mt19937_64 random(20004);
    std::uniform_int_distribution<std::int64_t> coordinate(-3, 3);
    int inside = 0, on = 0, outside = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::array<Integers, 5> p;
        for (auto& q : p) q = {coordinate(random), coordinate(random), coordinate(random)};
        if (orientation(point(p[0]), point(p[1]), point(p[2]), point(p[3])) <= 0) continue;
        // Inside if the power of e with respect to the sphere is negative: with the centre from Cramer's rule, all integers.
        Wide m[3][3], r[3];
        for (std::size_t i = 0; i < 3; ++i) {
            r[i] = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                m[i][k] = 2 * (p[i + 1][k] - p[0][k]);
                r[i] += p[i + 1][k] * p[i + 1][k] - p[0][k] * p[0][k];
            }
        }
        const auto det = [](const Wide a[3][3]) {
            return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                   a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
        };
        const Wide d = det(m);
        Wide from_a = 0, from_e = 0;  // squared distances to the centre, times d²
        for (std::size_t k = 0; k < 3; ++k) {
            Wide n[3][3];
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t j = 0; j < 3; ++j) n[i][j] = j == k ? r[i] : m[i][j];
            const Wide c = det(n);
            from_a += (p[0][k] * d - c) * (p[0][k] * d - c);
            from_e += (p[4][k] * d - c) * (p[4][k] * d - c);
        }
        const int expected = sign(from_a - from_e);
        ASSERT_EQ(side_of_circumsphere(point(p[0]), point(p[1]), point(p[2]), point(p[3]), point(p[4])), expected) << trial;
        (expected > 0 ? inside : expected < 0 ? outside : on)++;
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(outside, 1000);
    EXPECT_GT(on, 50);
}

}  // namespace
}  // namespace cellproj
