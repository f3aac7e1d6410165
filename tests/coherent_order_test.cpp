// SPDX-License-Identifier: BSD-3-Clause
//
// Orders that follow an eye: judged by exact signs over an adjacency that the sorter did not make, at every step.
#include "sort/coherent_order.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/order_judge.hpp"
#include "tests/support/orders.hpp"

namespace cellproj {
namespace coherent_order_test {

using testing_support::count_order_violations;
using testing_support::delaunay_mesh;
using testing_support::expect_each_once;
using testing_support::grid_mesh;
using testing_support::shuffled;

// A point on a tilted orbit around the unit cube, or the direction to it.
Eye on_orbit(double degrees, bool at_infinity) {
    const double a = degrees * std::numbers::pi / 180;
    const glm::dvec3 arm(2 * std::cos(a), 2 * std::sin(a), 0.7 * std::sin(1.3 * a + 0.4));
    return at_infinity ? Eye::towards(arm) : Eye::at(glm::dvec3(0.5) + arm);
}

// In and out of the cube, through points, edges and planes of the regular grid.
Eye on_path_through(double t) {
    return Eye::at({-0.2 + 1.4 * t, 0.5 + 0.3 * std::sin(9 * t), t < 0.5 ? 0.5 : 0.5 + 0.25 * (t - 0.5)});
}

template <class EyeAt>
void expect_no_violation(const TetMesh& mesh, int steps, EyeAt eye_at) {
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    ASSERT_TRUE(sorter.convex());
    for (int i = 0; i < steps; ++i) {
        const Eye eye = eye_at(i);
        OrderReport report;
        const ViewOrder order = sorter.order(eye, &report, OrderMethod::mpvo);
        ASSERT_TRUE(report.exact) << "step " << i;
        ASSERT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U) << "step " << i;
        expect_each_once(order.items, mesh.tets.size());
    }
}

constexpr int fewer = CELLPROJ_SANITIZED ? 4 : 1;  // steps in sanitized builds, by

TEST(CoherentOrder, OrbitsHaveNoViolation) {
    for (const TetMesh& mesh : {grid_mesh(10, 0.2, 1), shuffled(grid_mesh(10, 0.2, 2), 3), grid_mesh(8), delaunay_mesh(700, 4)}) {
        for (const bool at_infinity : {false, true}) {
            for (const double degrees : {0.1, 1.0, 5.0, 30.0}) {
                SCOPED_TRACE(degrees);
                expect_no_violation(mesh, 80 / fewer, [&](int i) { return on_orbit(17 + degrees * i, at_infinity); });
            }
        }
    }
}

// Long enough for labels to wear out and for the clock to be set back, on the spot and near to far.
TEST(CoherentOrder, LongOrbitsHaveNoViolation) {
    const TetMesh mesh = grid_mesh(5, 0.2, 5);
    expect_no_violation(mesh, 1200 / fewer, [](int i) { return on_orbit(1.1 * i, false); });
    expect_no_violation(mesh, 400 / fewer, [](int i) { return Eye::at(glm::dvec3(0.5) + std::pow(1.03, i % 200) * glm::dvec3(1, 0.3, 0.2)); });
    expect_no_violation(mesh, 100 / fewer, [](int) { return Eye::at({3, 2, 1}); });
}

TEST(CoherentOrder, EyesThroughTheMesh) {
    for (const TetMesh& mesh : {grid_mesh(10, 0.2, 6), grid_mesh(10), delaunay_mesh(700, 7)}) {
        const int steps = 200 / fewer;
        expect_no_violation(mesh, steps + 1, [&](int i) { return on_path_through(static_cast<double>(i) / steps); });
    }
}

// Directions in planes of the regular grid again and again, and depths that whole layers share.
TEST(CoherentOrder, DirectionsInPlanesOfFaces) {
    expect_no_violation(grid_mesh(8), 121, [](int i) { return Eye::towards({1, (i - 60) / 60.0 * 1.0, 0}); });
    expect_no_violation(grid_mesh(8), 41, [](int i) { return Eye::towards({1, 1, (i - 20) * 1e-17}); });
}

TEST(CoherentOrder, ParallelAndPerspectiveInTurns) {
    expect_no_violation(grid_mesh(8, 0.2, 8), 90, [](int i) { return on_orbit(0.5 * i, i / 7 % 2 == 1); });
}

TEST(CoherentOrder, OffsetsScalesAndFarEyes) {
    const TetMesh mesh = grid_mesh(6, 0.2, 9);
    const auto moved = [&](double scale, double offset) {
        TetMesh other = mesh;
        for (auto& p : other.points) p = scale * p + offset;
        return other;
    };
    struct Place {
        double scale, offset;
    };
    for (const Place at : {Place{1e-12, 0}, Place{1e12, 0}, Place{1e-3, 1e6}}) {
        expect_no_violation(moved(at.scale, at.offset), 60 / fewer,
                            [&](int i) { return Eye::at(at.scale * on_orbit(i, false).xyz + at.offset); });
    }
    for (const double far : {1e3, 1e8, 1e14, 1e20}) {
        SCOPED_TRACE(far);
        expect_no_violation(mesh, 30 / fewer, [&](int i) { return Eye::at(far * on_orbit(i, true).xyz); });
    }
}

// Other methods between the steps take the memory away.
TEST(CoherentOrder, MethodsInTurns) {
    const TetMesh mesh = shuffled(delaunay_mesh(700, 10), 11);
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    constexpr OrderMethod methods[] = {OrderMethod::mpvo, OrderMethod::mpvo, OrderMethod::mpvo, OrderMethod::power,
                                       OrderMethod::mpvo, OrderMethod::bsp,  OrderMethod::mpvo, OrderMethod::centroid};
    for (int i = 0; i < 64; ++i) {
        const Eye eye = on_orbit(i, false);
        OrderReport report;
        const ViewOrder order = sorter.order(eye, &report, methods[i % 8]);
        expect_each_once(order.items, mesh.tets.size());
        EXPECT_EQ(report.exact, methods[i % 8] != OrderMethod::centroid);
        if (report.exact) {
            ASSERT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U) << "step " << i;
        }
    }
}

TEST(CoherentOrder, SameForAnyNumberOfThreads) {
    const TetMesh mesh = grid_mesh(16, 0.2, 12);
    const auto with_threads = [&](std::size_t threads) {
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
        VisibilitySorter sorter(mesh);
        for (int i = 0; i < 30; ++i) sorter.order(on_orbit(i, false), nullptr, OrderMethod::mpvo);
        const auto items = sorter.order(on_orbit(30, false), nullptr, OrderMethod::mpvo).items;
        return std::vector<std::uint32_t>(items.begin(), items.end());
    };
    const auto one = with_threads(1);
    EXPECT_EQ(one, with_threads(2));
    EXPECT_EQ(one, with_threads(4));
}

// Sticks that lean on each other like the leaves of a camera's shutter have a cycle: labels would grow without end.
TEST(CoherentOrder, GivesUpOnACycle) {
    const TetMesh mesh = testing_support::cyclic_ring(12);
    const CellGraph graph(mesh, build_adjacency(mesh));
    CoherentOrder order;
    EXPECT_FALSE(order.start(graph, Eye::towards({0, 0, 1})));
    EXPECT_TRUE(order.empty());
    ASSERT_TRUE(order.start(graph, Eye::towards({1, 0.1, 0})));
    bool follows = true;
    for (int i = 1; i <= 18 && follows; ++i) {
        const double a = i * 5 * std::numbers::pi / 180;
        follows = order.follow(graph, Eye::towards({std::cos(a), 0.1, std::sin(a)}));
    }
    EXPECT_FALSE(follows);
    EXPECT_TRUE(order.empty());
}

// What a cell's reach promises: within it, nothing changes. Moves go right up to it, straight at the planes of the cell's faces.
TEST(CoherentOrder, RelationsHoldWithinTheirReach) {
    std::mt19937_64 random(13);
    std::normal_distribution<double> normal;
    const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
    for (int trial = 0; trial < 40 / fewer; ++trial) {
        TetMesh mesh = grid_mesh(4, 0.2, 100 + static_cast<std::uint64_t>(trial));
        const double flat = std::pow(10.0, -trial % 9), scale = std::pow(10.0, trial % 25 - 12);
        for (auto& p : mesh.points) p = scale * glm::dvec3(p.x, p.y, flat * p.z);
        const CellGraph graph(mesh, build_adjacency(mesh));
        const bool at_infinity = trial % 2 == 1;
        const glm::dvec3 e = direction() * std::pow(10.0, 2 * (trial % 3) - 1.0);
        // An eye whose scaled coordinates are the given ones, up to rounding: ends that `scaled` itself gives.
        const glm::dvec3 center = 0.5 * (bounds(mesh.points).low + bounds(mesh.points).high);
        const double unit = glm::length(graph.scaled(Eye::at(center + glm::dvec3(scale, 0, 0))));
        const auto eye_of = [&](const glm::dvec3& at) { return at_infinity ? Eye::towards(at) : Eye::at(center + scale / unit * at); };
        const Eye eye = eye_of(e);
        std::vector<CellId> places(graph.size());
        std::iota(places.begin(), places.end(), 0U);
        std::vector<CellGraph::Relations> then(graph.size()), all(graph.size() + 1);
        std::vector<float> reach(graph.size());
        graph.find_relations(eye, places, then, reach);
        graph.find_relations(eye, all);
        std::size_t some = 0;
        for (const CellId place : places) {
            ASSERT_EQ(then[place], all[place]);
            ASSERT_GE(reach[place], 0.0F);
            if (reach[place] == 0.0F || !(reach[place] < 1e6F)) continue;
            ++some;
            for (int face = -1; face < 4; ++face) {
                glm::dvec3 along = direction();
                if (face >= 0) {
                    const auto v = face_vertices(mesh.tets[graph.cell(place)], face);
                    const glm::dvec3 a = mesh.points[v[0]];
                    along = glm::normalize(glm::cross(mesh.points[v[1]] - a, mesh.points[v[2]] - a));
                }
                for (const double sign : {-1.0, 1.0}) {
                    const Eye moved = eye_of(graph.scaled(eye) + sign * 0.999999 * static_cast<double>(reach[place]) * along);
                    if (!(glm::distance(graph.scaled(moved), graph.scaled(eye)) < reach[place])) continue;
                    CellGraph::Relations now;
                    float unused;
                    graph.find_relations(moved, {&place, 1}, {&now, 1}, {&unused, 1});
                    ASSERT_EQ(now, then[place]) << "trial " << trial << " cell " << place << " face " << face;
                }
            }
        }
        EXPECT_GT(some, graph.size() / 8) << "trial " << trial;
    }
}

}  // namespace
}  // namespace cellproj
