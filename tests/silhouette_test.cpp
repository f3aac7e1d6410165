// SPDX-License-Identifier: BSD-3-Clause
#include "project/silhouette.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/support/tet_rays.hpp"

namespace cellproj {
namespace {

using testing_support::area;
using testing_support::cast;
using testing_support::coarse_tet;
using testing_support::Points;
using testing_support::random_tet;
using testing_support::random_weights;
using testing_support::screen;

class SilhouetteAgainstRays : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(ParallelAndPerspective, SilhouetteAgainstRays, testing::Bool());

// What the fragment does with the interpolated terms, in float64.
TEST_P(SilhouetteAgainstRays, TheSmallestRidgeIsTheSegmentOfTheRay) {
    const bool perspective = GetParam();
    std::mt19937_64 random(201);
    int checked = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const auto tet = random_tet(random);
        if (!tet) continue;
        const auto& [points, s, stretch] = *tet;
        const Silhouette silhouette = make_silhouette(screen(points, s, perspective), perspective);
        ASSERT_GT(silhouette.triangle_count, 0U);
        for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
            const auto w = random_weights(random, 0.001);
            SilhouetteVertex v{{0, 0}, 0, 0, {0, 0, 0}};
            for (std::size_t k = 0; k < 3; ++k) {
                const SilhouetteVertex& corner = silhouette.vertices[silhouette.triangles[t][k]];
                v.position += w[k] * corner.position;
                v.base_depth += w[k] * corner.base_depth;
                v.base_scalar += w[k] * corner.base_scalar;
                v.ridges += w[k] * corner.ridges;
            }
            const auto segment = cast(points, s, v.position, perspective);
            ASSERT_TRUE(segment) << "trial " << trial;
            const double thickness = std::min({v.ridges.x, v.ridges.y, v.ridges.z});
            const double other_scalar = v.base_scalar + silhouette.scalar_slope * thickness;
            double front = v.base_depth, back = v.base_depth;
            double s_front = silhouette.base_is_front ? v.base_scalar : other_scalar;
            double s_back = silhouette.base_is_front ? other_scalar : v.base_scalar;
            // Larger terms are nearer in perspective, farther in parallel views.
            (silhouette.base_is_front ? back : front) += silhouette.base_is_front == perspective ? -thickness : thickness;
            double length = thickness;
            if (perspective) {
                length = thickness / (front * back);
                s_front /= front;
                s_back /= back;
                front = 1 / front;
            }
            // 1e-9: rounding of 1e-16 times the condition of cells down to a thousandth of their box.
            ASSERT_NEAR(front, segment->front, 1e-9 * stretch) << "trial " << trial;
            ASSERT_NEAR(length, segment->back - segment->front, 1e-9 * stretch) << "trial " << trial;
            ASSERT_NEAR(s_front, segment->s_front, 1e-8) << "trial " << trial;
            ASSERT_NEAR(s_back, segment->s_back, 1e-8) << "trial " << trial;
            ++checked;
        }
    }
    EXPECT_GT(checked, 3000);
}

// On a coarse grid every class, degenerate ones included, comes up: the triangles have the area of the classical split.
TEST(Silhouette, CoversWhatTheClassicalTrianglesCover) {
    std::mt19937_64 random(202);
    std::array<int, 5> seen{};
    for (int trial = 0; trial < 20000; ++trial) {
        const auto corners = screen(coarse_tet(random), {1, 2, 3, 4}, false);
        const ProjectedTet tet = project_tet(corners, false);
        const Silhouette silhouette = make_silhouette(corners, false);
        const double thickness = tet.vertices[static_cast<std::size_t>(tet.thick)].thickness;
        if (tet.kind == ProjectionClass::nothing || thickness == 0) {
            ASSERT_EQ(silhouette.triangle_count, 0U);
            continue;
        }
        ++seen[tet.triangle_count()];
        double classical = 0, covered = 0;
        for (std::size_t t = 0; t < tet.triangle_count(); ++t) classical += area(tet, t);
        for (std::size_t t = 0; t < silhouette.triangle_count; ++t) covered += area(silhouette, t);
        ASSERT_NEAR(covered, classical, 1e-12) << "trial " << trial;
        for (const SilhouetteVertex& v : silhouette.vertices) {
            for (int k = 0; k < 3; ++k) ASSERT_TRUE(std::isfinite(v.ridges[k]) && v.ridges[k] >= 0);
        }
    }
    for (std::size_t triangles = 1; triangles <= 4; ++triangles) EXPECT_GT(seen[triangles], 100) << triangles;
}

// The thick vertex has the full thickness, whatever the class: a vertex in a triangle slides over an edge onto a corner.
TEST(Silhouette, StaysContinuousTowardsTheDegenerateClasses) {
    for (const double offset : {0.3, 1e-3, 1e-5, 1e-7, 1e-12, 0.0}) {
        const Points points{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, offset, 2}}};  // corner 3 nears the edge 0–1
        const Silhouette silhouette = make_silhouette(screen(points, {0, 0, 0, 1}, false), false);
        ASSERT_EQ(silhouette.triangle_count, 1U) << offset;
        // At (1, 1): barycentric coordinates 1/2, 1/4, 1/4 of corners 0, 1, 2.
        glm::dvec3 ridges(0);
        for (const auto& [corner, weight] : {std::pair{0, 0.5}, {1, 0.25}, {2, 0.25}}) {
            ridges += weight * silhouette.vertices[static_cast<std::size_t>(corner)].ridges;
        }
        const auto segment = cast(points, {0, 0, 0, 1}, {1, 1}, false);
        ASSERT_TRUE(segment);
        EXPECT_NEAR(std::min({ridges.x, ridges.y, ridges.z}), segment->back - segment->front, 1e-12) << offset;
    }
}

TEST(Silhouette, FlatAndEdgeOnCellsHaveNone) {
    const auto triangles = [](const Points& points) {
        return make_silhouette(screen(points, {1, 2, 3, 4}, false), false).triangle_count;
    };
    EXPECT_EQ(triangles({{{0, 0, 2}, {1, 1, 2}, {1, 0, 2}, {0, 1, 2}}}), 0U);
    EXPECT_EQ(triangles({{{0, 0, 0}, {1, 1, 0}, {2, 2, 5}, {3, 3, 1}}}), 0U);
    EXPECT_EQ(triangles({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}), 0U);
}

}  // namespace
}  // namespace cellproj
