// SPDX-License-Identifier: BSD-3-Clause
//
// Planes through tetrahedra: every point of the plane inside the mesh once, with the field that is there, wherever the plane goes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/plane_cut.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace plane_cut_test {

using namespace testing_support;

double field_at(const glm::dvec3& p) { return 3 * p.x - 2 * p.y + p.z; }

std::vector<CutTriangle> cut(const TetMesh& mesh, const glm::dvec3& point, const glm::dvec3& normal, PlaneCutSides sides = PlaneCutSides::both) {
    return cut_by_plane(mesh, point_field(mesh, field_at), nullptr, point, glm::normalize(normal), sides);
}

double area_of(const std::vector<CutTriangle>& triangles) {
    double area = 0;
    for (const CutTriangle& t : triangles) area += 0.5 * glm::length(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
    return area;
}

// In how many triangles a point of the plane lies, those on whose edge it is aside.
int covers(const std::vector<CutTriangle>& triangles, const glm::dvec3& p, const glm::dvec3& normal) {
    int count = 0;
    for (const CutTriangle& t : triangles) {
        int left = 0, right = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const double side = glm::dot(normal, glm::cross(t.corners[(i + 1) % 3] - t.corners[i], p - t.corners[i]));
            left += side > 0;
            right += side < 0;
        }
        count += left == 3 || right == 3;
    }
    return count;
}

// The area of the unit cube cut by a plane in any place: known for these.
TEST(PlaneCut, HasTheAreaOfTheCut) {
    struct Case {
        glm::dvec3 point, normal;
        double area;
    };
    const Case cases[]{{{0.3, 0, 0}, {1, 0, 0}, 1},
                       {{0.5, 0.5, 0.5}, {1, 1, 0}, std::sqrt(2.0)},
                       {{0.5, 0.5, 0.5}, {1, 1, 1}, 0.75 * std::sqrt(3.0)},  // a hexagon
                       {{0, 0, 1}, {1, 1, 1}, std::sqrt(3.0) / 2},           // through three corners
                       {{0.5, 0, 0}, {1, 0, 0}, 1},                          // in faces and through points of the grids
                       {{0.25, 0, 0}, {-1, 0, 0}, 1},
                       {{0.5, 0.5, 0.5}, {1, -1, 0}, std::sqrt(2.0)},        // through edges, along faces
                       {{0, 0, 0}, {1, 0, 0}, 1},                            // sides of the cube, from both of theirs
                       {{0, 0, 0}, {-1, 0, 0}, 1},
                       {{1, 0, 0}, {1, 0, 0}, 1},
                       {{1, 0, 0}, {-1, 0, 0}, 1},
                       {{1, 1, 1}, {1, 1, 1}, 0},                            // a corner
                       {{1.001, 0, 0}, {1, 0, 0}, 0},
                       {{-1e-9, 0, 0}, {1, 0, 0}, 0}};
    for (const double jitter : {0.0, 0.2})
        for (const Case& c : cases) EXPECT_NEAR(area_of(cut(grid_mesh(4, jitter), c.point, c.normal)), c.area, 1e-12) << jitter << " at " << c.point.x << " towards " << c.normal.x << c.normal.y;
}

// No gaps and no doubles: each point of the plane inside the cube is in one triangle.
TEST(PlaneCut, CoversEveryPointOnce) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const TetMesh& mesh : {grid_mesh(4), grid_mesh(4, 0.2)})
        for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(1, 1, 0), glm::dvec3(1, 2, -0.5)}) {
            const auto triangles = cut(mesh, {0.5, 0.5, 0.5}, normal);
            const glm::dvec3 n = glm::normalize(normal);
            for (int i = 0; i < 200; ++i) {
                glm::dvec3 p(unit(random), unit(random), unit(random));
                p -= glm::dot(n, p - glm::dvec3(0.5)) * n;
                const bool inside = std::min({p.x, p.y, p.z}) > 0 && std::max({p.x, p.y, p.z}) < 1;
                EXPECT_EQ(covers(triangles, p, n), inside ? 1 : 0) << p.x << " " << p.y << " " << p.z;
            }
        }
}

// Linear in space, so linear on the plane.
TEST(PlaneCut, HasTheScalarsOfTheField) {
    for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(1, 2, -0.5)})
        for (const CutTriangle& t : cut(grid_mesh(5, 0.2), {0.5, 0.5, 0.5}, normal))
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(t.scalars[i], field_at(t.corners[i]), 1e-14);
                EXPECT_NEAR(glm::dot(glm::normalize(normal), t.corners[i] - glm::dvec3(0.5)), 0, 1e-15);
            }
}

// Where the field jumps in the plane: the cell above, which is that of a clip region; without one, the cell below, or nothing.
TEST(PlaneCut, AFaceInThePlaneBelongsToTheCellAboveIt) {
    const TetMesh mesh = grid_mesh(2);
    ScalarField field{"c", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) {
        double x = 0;
        for (const VertexId v : tet) x += 0.25 * mesh.points[v].x;
        field.values.push_back(x < 0.5 ? 1 : 2);
    }
    const auto values = [&](double x, double direction, PlaneCutSides sides) {
        std::vector<double> found;
        for (const CutTriangle& t : cut_by_plane(mesh, field, nullptr, {x, 0, 0}, {direction, 0, 0}, sides)) found.insert(found.end(), t.scalars.begin(), t.scalars.end());
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    };
    using Values = std::vector<double>;
    for (const PlaneCutSides sides : {PlaneCutSides::above, PlaneCutSides::both}) {
        EXPECT_EQ(values(0.5, 1, sides), Values{2});
        EXPECT_EQ(values(0.5, -1, sides), Values{1});
        EXPECT_EQ(values(0, 1, sides), Values{1});
        EXPECT_EQ(values(1, -1, sides), Values{2});
    }
    EXPECT_EQ(values(0, -1, PlaneCutSides::both), Values{1});
    EXPECT_EQ(values(0, -1, PlaneCutSides::above), Values{});
    EXPECT_EQ(values(1, 1, PlaneCutSides::above), Values{});
    // Without the cells above, those below.
    for (std::size_t i = 0; i < field.values.size(); ++i)
        if (field.values[i] == 2) field.values[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(values(0.5, 1, PlaneCutSides::both), Values{1});
    EXPECT_EQ(values(0.5, 1, PlaneCutSides::above), Values{});
}

// Flat cells, points in one place, huge and tiny meshes, planes at the end of the numbers: no NaN, and the same cut.
TEST(PlaneCut, AtItsLimits) {
    TetMesh flat = grid_mesh(3);
    const auto point_id = [&](const glm::dvec3& p) { return static_cast<VertexId>(std::ranges::find(flat.points, p) - flat.points.begin()); };
    flat.tets.push_back({point_id({0, 0, 0}), point_id({1, 0, 0}), point_id({0, 1, 0}), point_id({1, 1, 0})});
    flat.tets.push_back({0, 0, 0, 0});
    EXPECT_NEAR(area_of(cut(flat, {0, 0, 0.5}, {0, 0, 1})), 1, 1e-12);
    for (const double scale : {1e-12, 1e12}) {
        TetMesh mesh = grid_mesh(3, 0.2);
        for (glm::dvec3& p : mesh.points) p *= scale;
        EXPECT_NEAR(area_of(cut(mesh, glm::dvec3(0.5 * scale), {1, 1, 1})) / (scale * scale), 0.75 * std::sqrt(3.0), 1e-12);
    }
    for (const double far : {1e160, 1.7e308})
        for (const glm::dvec3& normal : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 1, 3)}) EXPECT_TRUE(cut(flat, glm::dvec3(far, -far, far), normal).empty()) << far;
}

TEST(PlaneCut, IsTheSameForAnyOrderOfThePoints) {
    std::mt19937_64 random(5);
    const TetMesh mesh = grid_mesh(5, 0.2), other = relabelled(mesh, random);
    EXPECT_NEAR(area_of(cut(mesh, {0.5, 0.5, 0.5}, {1, 2, -0.5})), area_of(cut(other, {0.5, 0.5, 0.5}, {1, 2, -0.5})), 1e-13);
}

}  // namespace
}  // namespace cellproj
