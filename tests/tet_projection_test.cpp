// SPDX-License-Identifier: BSD-3-Clause
#include "project/tet_projection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"
#include "tests/support/tet_rays.hpp"

namespace cellproj {
namespace tet_projection_test {

using testing_support::area;
using testing_support::cast;
using testing_support::coarse_tet;
using testing_support::Points;
using testing_support::random_tet;
using testing_support::random_weights;
using testing_support::screen;
using testing_support::volume;

ProjectedTet parallel(const Points& points) { return project_tet(screen(points, {1, 2, 3, 4}, false), false); }

TEST(ProjectionClass, VertexInTriangle) {
    // Corner 3 behind the triangle of the others, over its centroid.
    const ProjectedTet tet = parallel({{{0, 0, 1}, {3, 0, 2}, {0, 3, 3}, {1, 1, 5}}});
    ASSERT_EQ(tet.kind, ProjectionClass::vertex_in_triangle);
    EXPECT_EQ(tet.thick, 3);
    const ProjectedVertex& v = tet.vertices[3];
    EXPECT_DOUBLE_EQ(v.front_depth, 2);  // the mean of 1, 2, 3
    EXPECT_DOUBLE_EQ(v.thickness, 3);
    EXPECT_DOUBLE_EQ(v.front_scalar, 2);
    EXPECT_DOUBLE_EQ(v.back_scalar, 4);
}

TEST(ProjectionClass, VertexInTriangleInFront) {
    const ProjectedTet tet = parallel({{{0, 0, 1}, {3, 0, 2}, {0, 3, 3}, {1, 1, -1}}});
    ASSERT_EQ(tet.kind, ProjectionClass::vertex_in_triangle);
    const ProjectedVertex& v = tet.vertices[3];
    EXPECT_DOUBLE_EQ(v.front_depth, -1);
    EXPECT_DOUBLE_EQ(v.thickness, 3);
    EXPECT_DOUBLE_EQ(v.front_scalar, 4);
    EXPECT_DOUBLE_EQ(v.back_scalar, 2);
}

TEST(ProjectionClass, EdgesCross) {
    // Edge 0–1 in front along x, edge 2–3 behind it along y; they cross at (1, 0), a quarter and a half along.
    const ProjectedTet tet = parallel({{{0, 0, 0}, {4, 0, 4}, {1, -1, 3}, {1, 1, 5}}});
    ASSERT_EQ(tet.kind, ProjectionClass::edges_cross);
    EXPECT_EQ(tet.vertex_count(), 5U);
    const ProjectedVertex& v = tet.vertices[4];
    EXPECT_DOUBLE_EQ(v.position.x, 1);
    EXPECT_DOUBLE_EQ(v.position.y, 0);
    EXPECT_DOUBLE_EQ(v.front_depth, 1);
    EXPECT_DOUBLE_EQ(v.thickness, 3);
    EXPECT_DOUBLE_EQ(v.front_scalar, 1.25);
    EXPECT_DOUBLE_EQ(v.back_scalar, 3.5);
}

TEST(ProjectionClass, VertexOnEdge) {
    const ProjectedTet tet = parallel({{{0, 0, 0}, {4, 0, 4}, {1, 0, 3}, {1, 2, 5}}});
    ASSERT_EQ(tet.kind, ProjectionClass::vertex_on_edge);
    EXPECT_EQ(tet.thick, 2);
    EXPECT_DOUBLE_EQ(tet.vertices[2].front_depth, 1);
    EXPECT_DOUBLE_EQ(tet.vertices[2].thickness, 2);
    EXPECT_DOUBLE_EQ(tet.vertices[2].front_scalar, 1.25);
    EXPECT_DOUBLE_EQ(tet.vertices[2].back_scalar, 3);
}

TEST(ProjectionClass, VertexOnVertex) {
    const ProjectedTet tet = parallel({{{0, 0, 0}, {4, 0, 0}, {1, 3, 2}, {1, 3, 7}}});
    ASSERT_EQ(tet.kind, ProjectionClass::vertex_on_vertex);
    const auto& v = tet.vertices[static_cast<std::size_t>(tet.thick)];
    EXPECT_DOUBLE_EQ(v.front_depth, 2);
    EXPECT_DOUBLE_EQ(v.thickness, 5);
    EXPECT_DOUBLE_EQ(v.front_scalar, 3);
    EXPECT_DOUBLE_EQ(v.back_scalar, 4);
}

TEST(ProjectionClass, Nothing) {
    EXPECT_EQ(parallel({{{0, 0, 0}, {1, 1, 0}, {2, 2, 5}, {3, 3, 1}}}).kind, ProjectionClass::nothing);  // edge-on
    EXPECT_EQ(parallel({{{1, 1, 0}, {1, 1, 1}, {1, 1, 2}, {3, 3, 1}}}).kind, ProjectionClass::nothing);
    EXPECT_EQ(parallel({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}).kind, ProjectionClass::nothing);  // a point
}

// A flat cell seen from the front covers pixels with thickness 0: it adds no light.
TEST(ProjectionClass, FlatCellsHaveNoThickness) {
    const ProjectedTet square = parallel({{{0, 0, 2}, {1, 1, 2}, {1, 0, 2}, {0, 1, 2}}});
    EXPECT_EQ(square.kind, ProjectionClass::edges_cross);
    EXPECT_EQ(square.vertices[4].thickness, 0);
    const ProjectedTet inner = parallel({{{0, 0, 2}, {3, 0, 2}, {0, 3, 2}, {1, 1, 2}}});
    EXPECT_EQ(inner.kind, ProjectionClass::vertex_in_triangle);
    EXPECT_EQ(inner.vertices[3].thickness, 0);
}

// Thickness is affine in each triangle and 0 at the silhouette: its integral is area · thickness / 3, and that of the whole
// footprint is the volume. Sizes over 12 decades, any position and shape.
TEST(ProjectTet, ThicknessIntegratesToTheVolume) {
    std::mt19937_64 random(101);
    std::uniform_real_distribution<double> unit(-1, 1), decade(-6, 6);
    for (int trial = 0; trial < 20000; ++trial) {
        const double size = std::pow(10, decade(random));
        const glm::dvec3 stretch(std::pow(10, unit(random)), std::pow(10, unit(random)), std::pow(10, unit(random)));
        Points points;
        for (auto& p : points) p = size * stretch * glm::dvec3(unit(random), unit(random), unit(random));
        const ProjectedTet tet = parallel(points);
        double integral = 0;
        for (std::size_t t = 0; t < tet.triangle_count(); ++t) {
            integral += area(tet, t) * tet.vertices[static_cast<std::size_t>(tet.thick)].thickness / 3;
        }
        // Slivers cancel: the bound is relative to the box of the cell, not to its volume.
        const double box = size * size * size * stretch.x * stretch.y * stretch.z;
        ASSERT_NEAR(integral, volume(points), 1e-13 * box + 1e-11 * volume(points)) << "trial " << trial;
    }
}

// The triangles tile the silhouette: together they have the area of the convex hull of the corners, which is half of what the
// faces' areas sum to.
TEST(ProjectTet, TrianglesTileTheSilhouette) {
    std::mt19937_64 random(102);
    std::array<int, 5> seen{};
    for (int trial = 0; trial < 20000; ++trial) {
        const Points points = coarse_tet(random);
        const ProjectedTet tet = parallel(points);
        ++seen[tet.triangle_count()];
        double triangles = 0, faces = 0;
        for (std::size_t t = 0; t < tet.triangle_count(); ++t) {
            EXPECT_GT(area(tet, t), 0) << "trial " << trial;
            triangles += area(tet, t);
        }
        for (const auto& f : face_corners) {
            const auto at = [&](int i) { return glm::dvec2(points[static_cast<std::size_t>(i)]); };
            faces += 0.5 * std::abs(doubled_area(at(f[0]), at(f[1]), at(f[2])));
        }
        ASSERT_NEAR(triangles, faces / 2, 1e-12) << "trial " << trial;
        for (const ProjectedVertex& v : tet.vertices) {
            ASSERT_TRUE(std::isfinite(v.front_depth) && std::isfinite(v.back_scalar) && v.thickness >= 0);
        }
    }
    for (const int count : seen) EXPECT_GT(count, 100);  // all classes came up
}

// Interpolates the terms linearly over the triangles, as a rasterizer does, and compares with the ray.
class AgainstRays : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(ParallelAndPerspective, AgainstRays, testing::Bool());

TEST_P(AgainstRays, InterpolatedTermsAreTheSegmentOfTheRay) {
    const bool perspective = GetParam();
    std::mt19937_64 random(103);
    int checked = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        const auto cell = random_tet(random);
        if (!cell) continue;
        const auto& [points, s, stretch] = *cell;
        const ProjectedTet tet = project_tet(screen(points, s, perspective), perspective);
        for (std::size_t t = 0; t < tet.triangle_count(); ++t) {
            const auto w = random_weights(random, 0.01);
            ProjectedVertex v{{0, 0}, 0, 0, 0, 0};
            for (std::size_t k = 0; k < 3; ++k) {
                const ProjectedVertex& corner = tet.vertices[tet.triangles[t][k]];
                v.position += w[k] * corner.position;
                v.front_depth += w[k] * corner.front_depth;
                v.thickness += w[k] * corner.thickness;
                v.front_scalar += w[k] * corner.front_scalar;
                v.back_scalar += w[k] * corner.back_scalar;
            }
            const auto segment = cast(points, s, v.position, perspective);
            ASSERT_TRUE(segment) << "trial " << trial;
            const auto found = testing_support::segment_of(v, perspective);
            // 1e-9: rounding of 1e-16 times the condition of cells down to a thousandth of their box.
            ASSERT_NEAR(found.front, segment->front, 1e-9 * stretch) << "trial " << trial;
            ASSERT_NEAR(found.back - found.front, segment->back - segment->front, 1e-9 * stretch) << "trial " << trial;
            ASSERT_NEAR(found.s_front, segment->s_front, 1e-9) << "trial " << trial;
            ASSERT_NEAR(found.s_back, segment->s_back, 1e-9) << "trial " << trial;
            ++checked;
        }
    }
    EXPECT_GT(checked, 5000);
}

TEST(ProjectTet, TheOrderOfTheCornersDoesNotMatter) {
    const Points points{{{0, 0, 0}, {4, 0, 4}, {1, -1, 3}, {1, 1, 5}}};
    const std::array<double, 4> s{1, 2, 3, 4};
    std::array<std::size_t, 4> permutation{0, 1, 2, 3};
    do {
        Points permuted;
        std::array<double, 4> scalars{};
        for (std::size_t i = 0; i < 4; ++i) {
            permuted[i] = points[permutation[i]];
            scalars[i] = s[permutation[i]];
        }
        const ProjectedTet tet = project_tet(screen(permuted, scalars, false), false);
        ASSERT_EQ(tet.kind, ProjectionClass::edges_cross);
        EXPECT_DOUBLE_EQ(tet.vertices[4].front_depth, 1);
        EXPECT_DOUBLE_EQ(tet.vertices[4].thickness, 3);
        EXPECT_DOUBLE_EQ(tet.vertices[4].front_scalar, 1.25);
        EXPECT_DOUBLE_EQ(tet.vertices[4].back_scalar, 3.5);
    } while (std::next_permutation(permutation.begin(), permutation.end()));
}

}  // namespace
}  // namespace cellproj
