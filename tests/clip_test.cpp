// SPDX-License-Identifier: BSD-3-Clause
#include "project/clip.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/predicates.hpp"
#include "project/silhouette.hpp"
#include "tests/support/tet_rays.hpp"

namespace cellproj {
namespace clip_test {

using Corners = std::array<EyeVertex, 4>;

double volume(const Corners& c) {
    return std::abs(glm::dot(glm::cross(c[1].position - c[0].position, c[2].position - c[0].position),
                             c[3].position - c[0].position)) / 6;
}

double volume(const ClippedTet& pieces) {
    double sum = 0;
    for (std::size_t i = 0; i < pieces.count; ++i) sum += volume(pieces.tets[i]);
    return sum;
}

Corners mirrored(Corners corners) {
    for (auto& v : corners) v.position.z = -v.position.z;
    return corners;
}

// What lies before and what lies behind the plane is the whole, for every number of corners on either side.
TEST(ClipNear, BothSidesTogetherAreTheCell) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::array<int, 4> pieces{};
    for (int trial = 0; trial < 5000; ++trial) {
        Corners corners;
        for (auto& v : corners) v = {{unit(random), unit(random), unit(random)}, unit(random)};
        const double near = 0.3 * unit(random);
        const ClippedTet in_front = clip_near(corners, near), behind = clip_near(mirrored(corners), -near);
        ++pieces[in_front.count];
        ASSERT_NEAR(volume(in_front) + volume(behind), volume(corners), 1e-14) << "trial " << trial;
        for (std::size_t i = 0; i < in_front.count; ++i) {
            for (const EyeVertex& v : in_front.tets[i]) EXPECT_GE(v.position.z, near);
        }
    }
    EXPECT_GT(pieces[0], 0);
    EXPECT_GT(pieces[1], 0);
    EXPECT_GT(pieces[3], 0);
}

TEST(ClipNear, ScalarsStayLinear) {
    const auto f = [](const glm::dvec3& p) { return 3 * p.x - 2 * p.y + 5 * p.z + 1; };
    Corners corners{{{{0, 0, -1}, 0}, {{2, 0, 1}, 0}, {{0, 3, 2}, 0}, {{-1, -1, 1.5}, 0}}};
    for (auto& v : corners) v.scalar = f(v.position);
    const ClippedTet pieces = clip_near(corners, 0.1);
    ASSERT_EQ(pieces.count, 3U);
    for (const auto& piece : pieces.tets) {
        for (const EyeVertex& v : piece) EXPECT_NEAR(v.scalar, f(v.position), 1e-14);
    }
}

// Along every ray from the eye each piece ends where the one drawn after it begins, or is not met.
TEST(ClipNear, PiecesComeBackToFront) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    int met = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        Corners corners;
        for (auto& v : corners) v = {{unit(random), unit(random), unit(random)}, 0};
        const ClippedTet pieces = clip_near(corners, 0.05);
        for (int ray = 0; ray < 10 && pieces.count == 3; ++ray) {
            const glm::dvec2 at(unit(random), unit(random));
            double entered = 1e300;
            for (const auto& piece : pieces.tets) {
                testing_support::Points points;
                for (std::size_t i = 0; i < 4; ++i) points[i] = piece[i].position;
                if (orientation(points[0], points[1], points[2], points[3]) < 0) std::swap(points[2], points[3]);
                const auto segment = testing_support::cast(points, {0, 0, 0, 0}, at, true);
                if (!segment || segment->back - segment->front < 1e-9) continue;
                EXPECT_LE(segment->back, entered + 1e-9) << "trial " << trial;
                entered = segment->front;
                ++met;
            }
        }
    }
    EXPECT_GT(met, 1000);
}

TEST(ClipNear, ACellThatTouchesThePlaneGivesNothing) {
    const Corners behind{{{{0, 0, 1}, 0}, {{1, 0, 0}, 0}, {{0, 1, 0}, 0}, {{0, 0, 0}, 0}}};
    EXPECT_EQ(clip_near(behind, 1.0).count, 0U);
    EXPECT_NEAR(volume(clip_near(behind, 0.0)), volume(behind), 1e-16);
}

SilhouetteVertex affine(const glm::dvec2& p) {
    return {p, {2 * p.y, 3 - p.x, p.x - p.y}};
}

TEST(ClipToRectangle, KeepsTheAffineTermsAndTheArea) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> coordinate(-3, 3);
    const Rectangle whole{{-3, -3}, {3, 3}};
    for (int trial = 0; trial < 2000; ++trial) {
        const double x = coordinate(random) / 2, y = coordinate(random) / 2;
        std::array<SilhouetteVertex, 3> triangle;
        for (auto& v : triangle) v = affine({coordinate(random), coordinate(random)});
        // The four parts of the plane around (x, y) together hold the triangle.
        double area = 0;
        for (const Rectangle& part : {Rectangle{whole.low, {x, y}}, Rectangle{{x, y}, whole.high},
                                      Rectangle{{x, whole.low.y}, {whole.high.x, y}}, Rectangle{{whole.low.x, y}, {x, whole.high.y}}}) {
            const ClippedPolygon polygon = clip_to_rectangle(triangle, part);
            for (std::size_t i = 0; i < polygon.count; ++i) {
                const SilhouetteVertex& v = polygon.vertices[i];
                const SilhouetteVertex exact = affine(v.position);
                ASSERT_NEAR(glm::distance(v.ridges, exact.ridges), 0, 1e-12);
                ASSERT_TRUE(v.position.x >= part.low.x && v.position.x <= part.high.x);
                ASSERT_TRUE(v.position.y >= part.low.y && v.position.y <= part.high.y);
                if (i >= 2) {
                    area += 0.5 * std::abs(doubled_area(polygon.vertices[0].position, polygon.vertices[i - 1].position, v.position));
                }
            }
        }
        const double expected = 0.5 * std::abs(doubled_area(triangle[0].position, triangle[1].position, triangle[2].position));
        ASSERT_NEAR(area, expected, 1e-11) << "trial " << trial;
    }
}

// From the eye's own cell corners project to millions of pixels; what remains fits.
TEST(ClipToRectangle, BringsHugeTrianglesToThePicture) {
    const std::array<SilhouetteVertex, 3> triangle{affine({-1e9, -2e9}), affine({3e9, 1e8}), affine({-5e8, 2e9})};
    const ClippedPolygon polygon = clip_to_rectangle(triangle, {{-512, -512}, {1024, 1024}});
    ASSERT_EQ(polygon.count, 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        // 1e-6: the terms at 1e9 pixels carry 1e-16 relative, that is 1e-7.
        EXPECT_NEAR(glm::distance(polygon.vertices[i].ridges, affine(polygon.vertices[i].position).ridges), 0, 2e-6);
    }
}

}  // namespace
}  // namespace cellproj
