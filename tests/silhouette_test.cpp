// SPDX-License-Identifier: BSD-3-Clause
#include "project/silhouette.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "tests/support/tet_rays.hpp"

namespace cellproj {
namespace silhouette_test {

using testing_support::area;
using testing_support::cast;
using testing_support::coarse_tet;
using testing_support::Points;
using testing_support::random_tet;
using testing_support::random_weights;
using testing_support::screen;

const glm::dvec2 origin(0.3, -0.2);  // anywhere

// Of corners that stay where they are.
Silhouette make_silhouette(const std::array<ScreenVertex, 4>& corners, bool perspective) {
    return cellproj::make_silhouette(corners, {}, origin, perspective);
}

double at(const ScreenPlane& plane, const glm::dvec2& place) { return plane.value + glm::dot(plane.gradient, place - origin); }

// What the fragment does with the terms, in float64, at a place inside a triangle.
struct Place {
    glm::dvec2 position{0.0, 0.0};
    glm::dvec3 ridges{0.0};
};

Place place_in(const Silhouette& silhouette, std::size_t triangle, const std::array<double, 3>& weights) {
    Place place;
    for (std::size_t k = 0; k < 3; ++k) {
        const SilhouetteVertex& corner = silhouette.vertices[silhouette.triangles[triangle][k]];
        place.position += weights[k] * corner.position;
        place.ridges += weights[k] * corner.ridges;
    }
    return place;
}

testing_support::Segment segment_at(const Silhouette& silhouette, std::size_t triangle, const Place& place, bool perspective) {
    const SilhouetteTerms& terms = silhouette.terms[triangle];
    const glm::dvec3& r = place.ridges;
    const std::size_t ridge = r.x <= r.y && r.x <= r.z ? 0 : r.y <= r.z ? 1 : 2;
    const double thickness = at(terms.thickness[ridge], place.position), base = at(terms.base_depth, place.position);
    const double scalar = at(terms.base_scalar, place.position), other_scalar = scalar + silhouette.scalar_slope * thickness;
    // Larger terms are nearer in perspective, farther in parallel views.
    const double other = silhouette.base_is_front == perspective ? base - thickness : base + thickness;
    testing_support::Segment segment{base, other, scalar, other_scalar};
    if (!silhouette.base_is_front) segment = {other, base, other_scalar, scalar};
    if (!perspective) return segment;
    return {1 / segment.front, 1 / segment.back, segment.s_front / segment.front, segment.s_back / segment.back};
}

// 1e-9: rounding of 1e-16 times the condition of cells down to a thousandth of their box, and of faces seen under as little.
void expect_same(const testing_support::Segment& found, const testing_support::Segment& expected, double stretch) {
    ASSERT_NEAR(found.front, expected.front, 1e-9 * stretch);
    ASSERT_NEAR(found.back, expected.back, 1e-9 * stretch);
    ASSERT_NEAR(found.s_front, expected.s_front, 1e-8);
    ASSERT_NEAR(found.s_back, expected.s_back, 1e-8);
}

class SilhouetteAgainstRays : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(ParallelAndPerspective, SilhouetteAgainstRays, testing::Bool());

TEST_P(SilhouetteAgainstRays, TheSmallestRidgeTellsTheSegmentOfTheRay) {
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
            const Place place = place_in(silhouette, t, random_weights(random, 0.001));
            const auto segment = cast(points, s, place.position, perspective);
            ASSERT_TRUE(segment) << "trial " << trial;
            const auto found = segment_at(silhouette, t, place, perspective);
            ASSERT_NO_FATAL_FAILURE(expect_same(found, *segment, stretch)) << "trial " << trial;
            ++checked;
        }
    }
    EXPECT_GT(checked, 3000);
}

// Away from the edges, a ray meets the cell as it was before its corners were moved.
TEST_P(SilhouetteAgainstRays, MovedCornersKeepDepthsAndScalars) {
    const bool perspective = GetParam();
    constexpr double most = 1e-3;
    std::mt19937_64 random(203);
    std::uniform_real_distribution<double> move(-most, most);
    int checked = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const auto tet = random_tet(random);
        if (!tet) continue;
        const auto& [points, s, stretch] = *tet;
        auto corners = screen(points, s, perspective);
        std::array<glm::dvec2, 4> moved;
        for (std::size_t c = 0; c < 4; ++c) {
            moved[c] = {move(random), move(random)};
            corners[c].position += moved[c];
        }
        double narrowest = 1e9;  // faces seen nearly edge-on are taken as they were moved
        for (std::size_t face = 0; face < 4; ++face) {
            const auto& f = face_corners[face];
            const auto place = [&](int k) { return corners[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])].position; };
            const double longest = std::max({glm::distance(place(0), place(1)), glm::distance(place(1), place(2)), glm::distance(place(2), place(0))});
            narrowest = std::min(narrowest, std::abs(doubled_area(place(0), place(1), place(2))) / longest);
        }
        if (narrowest < 32 * most) continue;
        const Silhouette silhouette = cellproj::make_silhouette(corners, moved, origin, perspective);
        for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
            const Place place = place_in(silhouette, t, random_weights(random, 0.1));
            std::array<double, 3> ridges{place.ridges.x, place.ridges.y, place.ridges.z};
            std::sort(ridges.begin(), ridges.end());
            // Away from the edges of the other side as well, by heights over the base.
            double thickest = 0;
            for (const SilhouetteVertex& v : silhouette.vertices) thickest = std::max({thickest, v.ridges.x, v.ridges.y, v.ridges.z});
            if (ridges[0] < 0.05 * thickest || ridges[1] - ridges[0] < 0.05 * thickest) continue;
            const auto segment = cast(points, s, place.position, perspective);
            ASSERT_TRUE(segment) << "trial " << trial;
            const auto found = segment_at(silhouette, t, place, perspective);
            ASSERT_NO_FATAL_FAILURE(expect_same(found, *segment, stretch)) << "trial " << trial;
            ++checked;
        }
    }
    EXPECT_GT(checked, 200);
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

// Where two edges cross, two ridges tell the thickness: the third must not win there by rounding.
TEST(Silhouette, AMissingRidgeIsNeverTheSmallest) {
    const Silhouette silhouette = make_silhouette(screen({{{-1, 0, 0}, {1, 0, 0}, {0, -1, 1}, {0, 1, 1}}}, {0, 0, 0, 1}, false), false);
    ASSERT_EQ(silhouette.triangle_count, 2U);
    for (const SilhouetteVertex& v : silhouette.vertices) EXPECT_EQ(v.ridges.z, 2.0);
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
