// SPDX-License-Identifier: BSD-3-Clause
//
// Orders are judged by the relations of face neighbours and, independently of any adjacency, by the sequence in which
// random rays meet the cells.
#include "sort/visibility_sorter.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "sort/depth_queue.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/order_judge.hpp"
#include "tests/support/orders.hpp"

namespace cellproj {
namespace visibility_sorter_test {

using testing_support::count_order_violations;
using testing_support::delaunay_mesh;
using testing_support::expect_each_once;
using testing_support::grid_mesh;
using testing_support::random_direction;
using testing_support::random_eye;
using testing_support::unit_tet;

struct Interval {
    double enter, leave;
};

// Where a ray is inside a cell, by clipping it with the four planes; nothing if shorter than 1e-9 (a touch).
std::optional<Interval> ray_in_cell(const TetMesh& mesh, CellId cell, const glm::dvec3& origin, const glm::dvec3& direction) {
    Interval inside{-1e9, 1e9};
    for (int face = 0; face < 4; ++face) {
        const auto v = face_vertices(mesh.tets[cell], face);
        const glm::dvec3 a = mesh.points[v[0]];
        const glm::dvec3 outward = glm::cross(mesh.points[v[1]] - a, mesh.points[v[2]] - a);
        const double speed = glm::dot(outward, direction), height = glm::dot(outward, a - origin);
        if (speed > 0) inside.leave = std::min(inside.leave, height / speed);
        if (speed < 0) inside.enter = std::max(inside.enter, height / speed);
        if (speed == 0 && height < 0) return std::nullopt;
    }
    if (inside.leave - inside.enter < 1e-9) return std::nullopt;
    return inside;
}

// Pairs of cells that a ray from the eye meets in the other order than the sorted one.
std::size_t wrong_along_rays(const TetMesh& mesh, std::span<const CellId> order, const Eye& eye, int rays,
                             std::mt19937_64& random) {
    std::size_t wrong = 0;
    for (int i = 0; i < rays; ++i) {
        const glm::dvec3 target = glm::dvec3(0.5) + 0.45 * random_direction(random);
        const glm::dvec3 origin = eye.at_infinity ? target : eye.xyz;
        const glm::dvec3 direction = eye.at_infinity ? -glm::normalize(eye.xyz) : glm::normalize(target - eye.xyz);
        std::optional<double> previous;  // back to front: each cell is left before the last one was entered
        for (const CellId cell : order) {
            const auto inside = ray_in_cell(mesh, cell, origin, direction);
            if (!inside || (!eye.at_infinity && inside->leave < 0)) continue;
            if (previous && inside->leave > *previous + 1e-9) ++wrong;
            previous = inside->enter;
        }
    }
    return wrong;
}

class DelaunayOrder : public testing::TestWithParam<int> {};

// 12k and 200k cells, 100 eyes each.
TEST_P(DelaunayOrder, HasNoViolationFromAnyEye) {
    const TetMesh mesh = delaunay_mesh(GetParam(), 11);
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    std::mt19937_64 random(12);
    for (int i = 0; i < 100; ++i) {
        const Eye eye = random_eye(random, i);
        OrderReport report;
        const auto order = sorter.order(eye, &report);
        ASSERT_EQ(report.unordered, 0U) << "eye " << i;
        ASSERT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U) << "eye " << i;
        if (i < 4) expect_each_once(order.items, mesh.tets.size());
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, DelaunayOrder, testing::Values(1850, CELLPROJ_SANITIZED ? 5000 : 30000),
                         [](const auto& size) { return std::to_string(size.param) + "points"; });

TEST(VisibilitySorter, MeetsTheCellsInTheOrderOfTheRay) {
    const TetMesh mesh = delaunay_mesh(400, 21);
    VisibilitySorter sorter(mesh);
    std::mt19937_64 random(22);
    for (int i = 0; i < 20; ++i) {
        const Eye eye = random_eye(random, i);
        EXPECT_EQ(wrong_along_rays(mesh, sorter.order(eye).items, eye, 50, random), 0U) << "eye " << i;
    }
}

// The judge itself must be able to say no.
TEST(VisibilitySorter, TheJudgesCatchAReversedOrder) {
    const TetMesh mesh = grid_mesh(4, 0.2, 5);
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    const Eye eye = Eye::at({3, 2, 1});
    auto order = order_cells(mesh, eye);
    EXPECT_EQ(count_order_violations(mesh, adjacency, {order, {}}, eye), 0U);
    std::reverse(order.begin(), order.end());
    std::mt19937_64 random(23);
    EXPECT_GT(count_order_violations(mesh, adjacency, {order, {}}, eye), 500U);
    EXPECT_GT(wrong_along_rays(mesh, order, eye, 20, random), 20U);
}

TEST(VisibilitySorter, OneCellAndTwo) {
    EXPECT_EQ(order_cells(unit_tet(), Eye::at({5, 5, 5})), (std::vector<CellId>{0}));
    TetMesh two = unit_tet();
    two.points.emplace_back(1, 1, 1);
    two.tets.push_back({1, 2, 3, 4});
    orient_cells(two);
    EXPECT_EQ(order_cells(two, Eye::towards({1, 1, 1})), (std::vector<CellId>{0, 1}));
    EXPECT_EQ(order_cells(two, Eye::towards({-1, -1, -1})), (std::vector<CellId>{1, 0}));
    EXPECT_EQ(order_cells(two, Eye::at({0.1, 0.1, 0.1})), (std::vector<CellId>{1, 0}));
}

// Eyes in the planes of many faces at once, on edges and at vertices of a regular grid.
TEST(VisibilitySorter, EyesInThePlanesOfFaces) {
    const TetMesh mesh = grid_mesh(6);
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    for (const Eye& eye : {Eye::towards({1, 0, 0}), Eye::towards({1, 1, 0}), Eye::towards({1, 1, 1}), Eye::at({0.5, 0.5, 0.5}),
                           Eye::at({0, 0, 0}), Eye::at({1.0 / 6, 1.0 / 6, 0.25}), Eye::at({2, 0.5, 0.5})}) {
        OrderReport report;
        const auto order = sorter.order(eye, &report);
        expect_each_once(order.items, mesh.tets.size());
        EXPECT_EQ(report.unordered, 0U);
        EXPECT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U);
    }
}

TEST(VisibilitySorter, ScaleAndOffsetDoNotMatter) {
    TetMesh mesh = grid_mesh(8, 0.2, 31);
    const auto eye = Eye::at({3, -2, 1.5});
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter reference(mesh);
    for (const double scale : {1e-12, 1e12}) {
        TetMesh scaled = mesh;
        for (auto& p : scaled.points) p *= scale;
        VisibilitySorter sorter(scaled);
        const auto order = sorter.order(Eye::at(eye.xyz * scale));
        EXPECT_EQ(count_order_violations(scaled, adjacency, order, Eye::at(eye.xyz * scale)), 0U);
        EXPECT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U);
    }
    TetMesh moved = mesh;
    for (auto& p : moved.points) p = 1e-3 * p + 1e6;  // cells of 1e-4 at 1e6: 1e-10 between float64 numbers
    const auto moved_eye = Eye::at(1e-3 * eye.xyz + 1e6);
    VisibilitySorter sorter(moved);
    OrderReport report;
    EXPECT_EQ(count_order_violations(moved, adjacency, sorter.order(moved_eye, &report), moved_eye), 0U);
    EXPECT_EQ(report.unordered, 0U);
}

TEST(VisibilitySorter, SameOrderForAnyNumberOfThreads) {
    const TetMesh mesh = grid_mesh(20, 0.2, 41);
    const auto eye = Eye::at({3, 2, 1});
    const auto with_threads = [&](std::size_t threads) {
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
        return order_cells(mesh, eye);
    };
    const auto one = with_threads(1);
    EXPECT_EQ(one, with_threads(2));
    EXPECT_EQ(one, with_threads(4));
}

TEST(VisibilitySorter, ACycleIsLeftByDepthAndCounted) {
    const TetMesh mesh = testing_support::cyclic_ring(12);
    const Eye above = Eye::towards({0, 0, 1});
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    OrderReport report;
    const auto order = sorter.order(above, &report, OrderMethod::mpvo);
    expect_each_once(order.items, mesh.tets.size());
    EXPECT_GE(report.unordered, 1U);
    EXPECT_FALSE(report.exact);
    EXPECT_GE(count_order_violations(mesh, adjacency, order, above), 1U);  // no order can respect a cycle
    EXPECT_LE(count_order_violations(mesh, adjacency, order, above), report.unordered * 4);
    sorter.order(Eye::towards({1, 0.1, 0}), &report, OrderMethod::mpvo);  // from the side there is none
    EXPECT_EQ(report.unordered, 0U);

    // The exact methods cut it.
    EXPECT_FALSE(sorter.order(above, &report).pieces.empty());
    EXPECT_TRUE(report.exact);
    EXPECT_EQ(report.cycles, 1U);
    // Without pieces the cells that were cut are whole again, and counted.
    expect_each_once(order_cells(mesh, above, &report), mesh.tets.size());
    EXPECT_GE(report.unordered, 1U);
    EXPECT_FALSE(report.exact);
}

TEST(VisibilitySorter, FlatNeedleAndPointCellsDoNotStallIt) {
    TetMesh mesh = grid_mesh(8, 0.2, 51);
    std::mt19937_64 random(52);
    std::uniform_int_distribution<VertexId> any(0, static_cast<VertexId>(mesh.points.size() - 1));
    for (int i = 0; i < 300; ++i) {
        const VertexId a = any(random), b = any(random), c = any(random);
        mesh.tets.push_back(i % 3 == 0 ? std::array{a, a, a, a} : i % 3 == 1 ? std::array{a, b, a, b} : std::array{a, b, c, c});
    }
    VisibilitySorter sorter(mesh);
    for (int i = 0; i < 10; ++i) expect_each_once(sorter.order(random_eye(random, i)).items, mesh.tets.size());
}

TEST(DepthQueue, GivesTheDeepestFirstAndTheLatestAmongEquals) {
    DepthQueue queue;
    queue.reset(6);
    EXPECT_TRUE(queue.empty());
    queue.push(0, 5);
    queue.push(1, 65535);
    queue.push(2, 5);
    queue.push(3, 0);
    queue.push(4, 64);
    std::vector<CellId> out;
    while (!queue.empty()) {
        out.push_back(queue.pop_deepest());
        if (out.size() == 2) queue.push(5, 4096);
    }
    EXPECT_EQ(out, (std::vector<CellId>{1, 4, 5, 2, 0, 3}));
}

// Against the plainest queue there is: a sort by depth.
TEST(DepthQueue, SortsRandomDepths) {
    std::mt19937_64 random(61);
    DepthQueue queue;
    queue.reset(5000);
    std::vector<std::uint16_t> depth(5000);
    for (CellId cell = 0; cell < 5000; ++cell) {
        depth[cell] = static_cast<std::uint16_t>(random());
        queue.push(cell, depth[cell]);
    }
    std::vector<std::uint16_t> popped;
    while (!queue.empty()) popped.push_back(depth[queue.pop_deepest()]);
    std::sort(depth.begin(), depth.end(), std::greater<>());
    EXPECT_EQ(popped, depth);
}

}  // namespace
}  // namespace cellproj
