// SPDX-License-Identifier: BSD-3-Clause
//
// Cells along a ray: against the four planes of every cell, against closed forms, and where the ray meets vertices, edges and
// faces.
#include "render/judge/ray_index.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace ray_index_test {

using testing_support::grid_mesh;
using testing_support::relabelled;
using testing_support::unit_tet;

ScreenTransform::Ray through(const glm::dvec3& point, const glm::dvec3& direction) {
    return {point, glm::normalize(direction)};
}

std::vector<Crossing> along(const RayIndex& index, const ScreenTransform::Ray& ray) {
    return index.cells_along(index.ray(ray, false));
}

double total(const std::vector<Crossing>& crossings) {
    double sum = 0;
    for (const Crossing& c : crossings)
        sum += c.length();
    return sum;
}

// The part of a line inside the unit cube.
double chord(const ScreenTransform::Ray& ray) {
    double enter = -1e9, leave = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) continue;
        const double a = -ray.origin[axis] / ray.direction[axis], b = (1 - ray.origin[axis]) / ray.direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    return std::max(0.0, leave - enter);
}

// The part of the line inside a cell, by its four planes.
double length_inside(const TetMesh& mesh, const std::array<VertexId, 4>& tet, const ScreenTransform::Ray& ray) {
    double enter = -1e9, leave = 1e9;
    for (int face = 0; face < 4; ++face) {
        const auto v = face_vertices(tet, face);
        const glm::dvec3 a = mesh.points[v[0]], outward = glm::cross(mesh.points[v[1]] - a, mesh.points[v[2]] - a);
        const double t = glm::dot(outward, a - ray.origin) / glm::dot(outward, ray.direction);
        if (glm::dot(outward, ray.direction) > 0) leave = std::min(leave, t);
        else enter = std::max(enter, t);
    }
    return std::max(0.0, leave - enter);
}

int shared_vertices(const std::array<VertexId, 4>& a, const std::array<VertexId, 4>& b) {
    return static_cast<int>(
        std::count_if(a.begin(), a.end(), [&](VertexId v) { return std::find(b.begin(), b.end(), v) != b.end(); }));
}

// In a conformal convex mesh each cell begins in the very number at which the one before it ends, behind a common face.
void expect_chain(const TetMesh& mesh, const std::vector<Crossing>& crossings) {
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        EXPECT_EQ(crossings[i].leave, crossings[i + 1].enter);
        EXPECT_EQ(shared_vertices(mesh.tets[crossings[i].cell], mesh.tets[crossings[i + 1].cell]), 3);
    }
}

ScreenTransform::Ray random_ray(std::mt19937_64& random) {
    std::uniform_real_distribution<double> inside(0, 1), any(-1, 1);
    const glm::dvec3 point(inside(random), inside(random), inside(random));
    return through(point, {any(random), any(random), any(random)});
}

TEST(RayIndex, FindsWhatEveryCellSaysForItself) {
    const TetMesh mesh = grid_mesh(6, 0.2, 3);
    const RayIndex index(mesh);
    std::mt19937_64 random(17);
    for (int i = 0; i < 300; ++i) {
        const auto ray = random_ray(random);
        const auto crossings = along(index, ray);
        std::vector<double> lengths(mesh.tets.size(), 0.0);
        for (const Crossing& c : crossings) {
            EXPECT_EQ(lengths[c.cell], 0.0);  // each cell once
            lengths[c.cell] = c.length();
        }
        // 1e-13: rounding of 1e-16, times the slant of the flattest face that a random ray meets here.
        for (std::size_t c = 0; c < mesh.tets.size(); ++c)
            EXPECT_NEAR(lengths[c], length_inside(mesh, mesh.tets[c], ray), 1e-13);
        expect_chain(mesh, crossings);
        EXPECT_NEAR(total(crossings), chord(ray), 1e-14);
        EXPECT_EQ(index.meets(index.ray(ray, false)), !crossings.empty());
    }
}

TEST(RayIndex, WeightsNameThePoint) {
    const TetMesh mesh = grid_mesh(4, 0.2, 3);
    const RayIndex index(mesh);
    std::mt19937_64 random(18);
    for (int i = 0; i < 100; ++i) {
        const ViewRay ray = index.ray(random_ray(random), false);
        for (const Crossing& c : index.cells_along(ray)) {
            for (const auto& [t, weights] : {std::pair(c.enter, c.at_enter), {c.leave, c.at_leave}}) {
                glm::dvec3 point(0);
                for (std::size_t k = 0; k < 4; ++k) {
                    EXPECT_GE(weights[k], 0.0);
                    point += weights[k] * mesh.points[mesh.tets[c.cell][k]];
                }
                EXPECT_NEAR(weights[0] + weights[1] + weights[2] + weights[3], 1.0, 1e-15);
                EXPECT_LT(glm::distance(point, index.middle() + ray.origin + t * ray.direction), 1e-13);
            }
        }
    }
}

// A regular grid: its vertices lie at multiples of 1/4, exact in float64, and so do its faces, edges and diagonals.
TEST(RayIndex, ThroughVerticesEdgesAndFaces) {
    const TetMesh mesh = grid_mesh(4);
    const RayIndex index(mesh);
    const std::vector<glm::dvec3> directions{{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0},
                                             {1, 0, 1}, {0, 1, -1}, {1, 1, 1}, {1, -1, 1}, {-1, 1, 1},
                                             {2, 1, 0}, {1, 2, -1}, {3, 1, 2}, {1, 1, 2},  {-1, -1, 1}};
    // A vertex, the middle of an edge, of a face's diagonal and of a box; points in faces; one in general position.
    const std::vector<glm::dvec3> points{{0.5, 0.5, 0.5},     {0.25, 0.5, 0.75},     {0.375, 0.5, 0.5},
                                         {0.375, 0.375, 0.5}, {0.375, 0.375, 0.375}, {0.5, 0.30, 0.60},
                                         {0.30, 0.5, 0.41},   {0.31, 0.31, 0.5},     {0.31, 0.47, 0.62}};
    for (const glm::dvec3& direction : directions) {
        for (const glm::dvec3& point : points) {
            const auto ray = through(point, direction);
            const auto crossings = along(index, ray);
            EXPECT_NEAR(total(crossings), chord(ray), 1e-14);
            // Vertices on the ray are rounded, so cells around it may be met with lengths of an ulp or two.
            for (std::size_t i = 0; i + 1 < crossings.size(); ++i)
                EXPECT_NEAR(crossings[i].leave, crossings[i + 1].enter, 4e-16);
            EXPECT_NEAR(total(along(index, through(point, -direction))), chord(ray), 1e-14);
        }
    }
}

// Along the boundary a ray is inside or outside, as a whole.
TEST(RayIndex, AlongTheBoundary) {
    const RayIndex index(grid_mesh(4));
    for (const glm::dvec3& point : {glm::dvec3(0, 0.3, 0.3), glm::dvec3(1, 0.3, 0.3), glm::dvec3(0, 0.25, 0.5),
                                    glm::dvec3(0, 0, 0.5), glm::dvec3(1, 1, 0.5)}) {
        for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
            const double length = total(along(index, through(point, direction)));
            EXPECT_TRUE(std::abs(length) < 1e-15 || std::abs(length - 1) < 1e-14) << length;
        }
    }
}

TEST(RayIndex, AnyNumberingAndOrientationIsTheSame) {
    const TetMesh mesh = grid_mesh(5, 0.2, 8);
    std::mt19937_64 random(3);
    TetMesh other = relabelled(mesh, random);
    for (auto& tet : other.tets)
        std::shuffle(tet.begin(), tet.end(), random);
    const RayIndex a(mesh), b(other);
    for (int i = 0; i < 200; ++i) {
        const auto ray = random_ray(random);
        const auto x = along(a, ray), y = along(b, ray);
        ASSERT_EQ(x.size(), y.size());
        for (std::size_t k = 0; k < x.size(); ++k) {
            EXPECT_EQ(x[k].cell, y[k].cell);
            EXPECT_NEAR(x[k].enter, y[k].enter, 1e-15);
        }
    }
}

// The points of a mesh of size 1e-3 near 1e6 are multiples of 1e-10. What they say is found to 1e-16 of the size.
TEST(RayIndex, SmallAndFarAway) {
    TetMesh near = grid_mesh(5, 0.2, 4);
    for (auto& p : near.points)
        p *= 1e-3;
    TetMesh far = near;
    for (auto& p : far.points)
        p += 1e6;
    for (std::size_t v = 0; v < near.points.size(); ++v)
        near.points[v] = far.points[v] - 1e6;  // as far as they could be kept
    const RayIndex a(near), b(far);
    std::mt19937_64 random(12);
    for (int i = 0; i < 100; ++i) {
        auto ray = random_ray(random);
        ray.origin = std::ldexp(1.0, -10) * glm::round(ray.origin * 1024.0) *
                     glm::dvec3(std::ldexp(1.0, -10));  // multiples of 2⁻²⁰: exact near 1e6
        auto shifted = ray;
        shifted.origin += 1e6;
        const auto x = along(a, ray), y = along(b, shifted);
        ASSERT_EQ(x.size(), y.size());
        for (std::size_t k = 0; k < x.size(); ++k) {
            EXPECT_EQ(x[k].cell, y[k].cell);
            EXPECT_NEAR(x[k].length(), y[k].length(), 1e-16);  // 1e-13 of the size
        }
    }
}

TEST(RayIndex, ScalesWithTheMesh) {
    const TetMesh mesh = grid_mesh(5, 0.2, 4);
    const RayIndex reference(mesh);
    for (const double scale : {1e-12, 1e-9, 1e9, 1e12}) {
        TetMesh scaled = mesh;
        for (auto& p : scaled.points)
            p *= scale;
        const RayIndex index(scaled);
        std::mt19937_64 random(13);
        for (int i = 0; i < 50; ++i) {
            auto ray = random_ray(random);
            const double expected = chord(ray);
            ray.origin *= scale;
            const auto crossings = along(index, ray);
            expect_chain(scaled, crossings);
            EXPECT_NEAR(total(crossings) / scale, expected, 1e-14);
        }
    }
}

TEST(RayIndex, StartsAtTheEye) {
    const RayIndex index(grid_mesh(3));
    const glm::dvec3 eye(0.4, 0.55, 0.2);
    for (const glm::dvec3& direction : {glm::dvec3(0, 0, 1), glm::dvec3(0.3, 0.1, 1), glm::dvec3(-1, 0.2, 0.3)}) {
        const auto ray = through(eye, direction);
        const auto crossings = index.cells_along(index.ray(ray, true));
        const double forward = total(crossings), backward = total(index.cells_along(index.ray(through(eye, -direction), true)));
        EXPECT_NEAR(forward + backward, chord(ray), 1e-14);
        glm::dvec3 there(0);
        const TetMesh mesh = grid_mesh(3);
        for (std::size_t k = 0; k < 4; ++k)
            there += crossings[0].at_enter[k] * mesh.points[mesh.tets[crossings[0].cell][k]];
        EXPECT_LT(glm::distance(there, eye), 1e-14);
    }
    EXPECT_TRUE(index.cells_along(index.ray(through({0.5, 0.5, 1.5}, {0, 0, 1}), true)).empty());
}

// Cells without volume have no length on any ray, and take nothing from the others. Nearly flat ones have what is theirs.
TEST(RayIndex, FlatNeedleAndPointCells) {
    TetMesh mesh = grid_mesh(4);
    const std::size_t whole = mesh.tets.size();
    std::mt19937_64 random(21);
    std::uniform_int_distribution<VertexId> any(0, static_cast<VertexId>(mesh.points.size() - 1));
    for (int i = 0; i < 400; ++i) {
        const VertexId a = any(random), b = any(random), c = any(random);
        mesh.tets.push_back(i % 3 == 0 ? std::array{a, a, a, a} : i % 3 == 1 ? std::array{a, b, a, b} : std::array{a, b, c, c});
    }
    // Four corners of a square: flat, with four different vertices.
    mesh.tets.push_back({0, 1, 5, 6});
    const RayIndex index(mesh);
    for (int i = 0; i < 200; ++i) {
        const auto ray = random_ray(random);
        const auto crossings = along(index, ray);
        for (const Crossing& c : crossings)
            EXPECT_TRUE(c.cell < whole || c.length() < 1e-15);
        EXPECT_NEAR(total(crossings), chord(ray), 1e-14);
    }

    // A needle 1e-13 thick, seen along its thickness and across it.
    TetMesh needle;
    needle.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-13}};
    needle.tets = {{0, 1, 2, 3}};
    EXPECT_NEAR(total(along(RayIndex(needle), through({0.25, 0.25, 0}, {0, 0, 1}))), 0.5e-13, 1e-28);
    EXPECT_NEAR(total(along(RayIndex(needle), through({0, 0.25, 0.5e-13}, {1, 0, 0}))), 0.25,
                1e-3);  // the height is rounded, 1e-16 of 1e-13
}

TEST(RayIndex, OneCellAndNone) {
    const RayIndex index(unit_tet());
    const auto crossings = along(index, through({0.25, 0.25, 0.25}, {0, 0, 1}));
    ASSERT_EQ(crossings.size(), 1U);
    EXPECT_NEAR(crossings[0].length(), 0.5, 1e-15);
    EXPECT_TRUE(along(index, through({0.9, 0.9, 0.9}, {0, 0, 1})).empty());
    EXPECT_FALSE(index.meets(index.ray(through({0.9, 0.9, 0.9}, {0, 0, 1}), false)));
    EXPECT_THROW(RayIndex(TetMesh{}), Error);
}

TEST(RayIndex, TheSameForAnyNumberOfThreads) {
    const TetMesh mesh = grid_mesh(14, 0.2, 6);
    const RayIndex parallel(mesh);
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const RayIndex serial(mesh);
    std::mt19937_64 random(31);
    for (int i = 0; i < 100; ++i) {
        const auto ray = random_ray(random);
        const auto a = along(parallel, ray), b = along(serial, ray);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t k = 0; k < a.size(); ++k) {
            EXPECT_EQ(a[k].cell, b[k].cell);
            EXPECT_EQ(a[k].enter, b[k].enter);
        }
    }
}

}  // namespace
}  // namespace cellproj
