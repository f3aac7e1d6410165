// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/support/meshes.hpp"

namespace cellproj {
namespace check_test {

using testing_support::delaunay_mesh;
using testing_support::grid_mesh;
using testing_support::unit_tet;

MeshCheck check_mesh(const TetMesh& mesh) { return check(mesh, build_adjacency(mesh)); }

// n³ boxes without those that `leave_out` names.
TetMesh grid_without(int n, const std::function<bool(const glm::dvec3&)>& leave_out) {
    TetMesh mesh = grid_mesh(n);
    std::erase_if(mesh.tets, [&](const auto& tet) {
        glm::dvec3 centroid(0);
        for (const VertexId v : tet) centroid += 0.25 * mesh.points[v];
        return leave_out(centroid);
    });
    return mesh;
}

TEST(Check, AGoodMesh) {
    const MeshCheck result = check_mesh(grid_mesh(4));
    EXPECT_TRUE(result.faithful());
    EXPECT_TRUE(result.convex);
    EXPECT_EQ(result.components, 1U);
    EXPECT_EQ(result.boundary_components, 1U);
    EXPECT_EQ(result.flat_cells.count + result.repeated_vertices.count + result.overlapping_cells.count, 0U);
    EXPECT_EQ(result.isolated_points.count + result.coincident_points.count, 0U);
    // The five-tetrahedra split: four corners of a sixth of the box, an inner one of a third.
    EXPECT_NEAR(result.volumes[0], 1.0 / 6 / 64, 1e-15);
    EXPECT_NEAR(result.volumes[2], 1.0 / 3 / 64, 1e-15);
    EXPECT_DOUBLE_EQ(result.edges[0], 0.25);
    EXPECT_DOUBLE_EQ(result.edges[1], 0.25 * std::sqrt(2.0));
    EXPECT_TRUE(result.conforming());
    EXPECT_EQ(result.cavities, 0U);
}

TEST(Check, DelaunayIsToldFromOthers) {
    EXPECT_TRUE(check_mesh(delaunay_mesh(300, 5)).delaunay);
    EXPECT_TRUE(check_mesh(grid_mesh(3)).delaunay);              // all corners of a box lie on one sphere
    EXPECT_FALSE(check_mesh(grid_mesh(6, 0.25, 3)).delaunay);    // jittered: the split does not follow
}

TEST(Check, HolesCavitiesAndPieces) {
    const auto in = [](double x, double a, double b) { return x > a && x < b; };
    const MeshCheck cavity = check_mesh(grid_without(6, [&](const glm::dvec3& p) {
        return in(p.x, 0.33, 0.67) && in(p.y, 0.33, 0.67) && in(p.z, 0.33, 0.67);
    }));
    EXPECT_EQ(cavity.components, 1U);
    EXPECT_EQ(cavity.boundary_components, 2U);
    EXPECT_EQ(cavity.cavities, 1U);
    EXPECT_FALSE(cavity.convex);
    EXPECT_EQ(cavity.isolated_points.count, 1U);  // the point in the middle of the 2×2×2 boxes left out

    const MeshCheck notch = check_mesh(grid_without(4, [](const glm::dvec3& p) { return p.x > 0.5 && p.y > 0.5; }));
    EXPECT_EQ(notch.boundary_components, 1U);
    EXPECT_FALSE(notch.convex);

    const MeshCheck two = check_mesh(grid_without(6, [&](const glm::dvec3& p) { return in(p.x, 0.33, 0.67); }));
    EXPECT_EQ(two.components, 2U);
    EXPECT_EQ(two.boundary_components, 2U);
    EXPECT_EQ(two.cavities, 0U);
    EXPECT_FALSE(two.convex);
}

TEST(Check, OverlapsAndSharedFaces) {
    TetMesh mesh = unit_tet();
    mesh.points.emplace_back(0.1, 0.1, 0.5);  // on the same side of the face 0, 1, 2 as vertex 3
    mesh.tets.push_back({0, 1, 2, 4});
    orient_cells(mesh);
    MeshCheck result = check_mesh(mesh);
    EXPECT_EQ(result.overlapping_cells.count, 1U);
    EXPECT_EQ(result.overlapping_cells.first, (std::vector<std::size_t>{0}));
    EXPECT_FALSE(result.faithful());

    mesh.points.emplace_back(0.2, 0.2, -1);
    mesh.tets.push_back({0, 2, 1, 5});
    orient_cells(mesh);
    result = check_mesh(mesh);
    EXPECT_EQ(result.overused_faces.count, 1U);
    EXPECT_EQ(result.overused_faces.first, (std::vector<std::size_t>{2}));  // the two before it are a pair
}

TEST(Check, FlatCellsAndPoints) {
    TetMesh mesh = unit_tet();
    mesh.points.emplace_back(1, 0, 0);     // 4, where 1 is
    mesh.points.emplace_back(0.3, 0.3, 0);  // 5, in the plane of 0, 1, 2
    mesh.points.emplace_back(9, 9, 9);     // 6, alone
    mesh.tets.push_back({0, 1, 2, 5});
    mesh.tets.push_back({0, 4, 4, 5});
    mesh.point_fields.push_back({"p", 1, {0, 1, 2, 3, 1.5, 0, 0}});
    mesh.point_fields.push_back({"q", 1, {0, 0, 0, std::numeric_limits<double>::quiet_NaN(), 0, 0, 0}});
    const MeshCheck result = check_mesh(mesh);
    EXPECT_EQ(result.flat_cells.first, (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(result.repeated_vertices.first, (std::vector<std::size_t>{2}));
    EXPECT_EQ(result.isolated_points.first, (std::vector<std::size_t>{6}));
    EXPECT_EQ(result.coincident_points.first, (std::vector<std::size_t>{4}));
    EXPECT_DOUBLE_EQ(result.coincident_difference, 0.5);
    EXPECT_EQ(result.coincident_field, "p");
    ASSERT_EQ(result.not_finite.size(), 1U);
    EXPECT_EQ(result.not_finite[0].name, "q");
    EXPECT_EQ(result.not_finite[0].values, 1U);
    EXPECT_FALSE(result.faithful());
}

TEST(Check, OnlyTheFirstPlacesAreKept) {
    TetMesh mesh = unit_tet();
    for (int i = 0; i < 20; ++i) mesh.points.emplace_back(5 + i, 0, 0);
    const MeshCheck result = check_mesh(mesh);
    EXPECT_EQ(result.isolated_points.count, 20U);
    EXPECT_EQ(result.isolated_points.first, (std::vector<std::size_t>{4, 5, 6, 7, 8}));
}

}  // namespace
}  // namespace cellproj
