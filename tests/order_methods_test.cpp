// SPDX-License-Identifier: BSD-3-Clause
//
// The methods of the sorter: what each proves, and that what they report is true. Judges: exact signs over an adjacency that the
// sorter did not make, and the rays of render/order_check.hpp.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "render/order_check.hpp"
#include "sort/cell_graph.hpp"
#include "sort/depth_keys.hpp"
#include "sort/mesh_facts.hpp"
#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/order_judge.hpp"
#include "tests/support/orders.hpp"

namespace cellproj {
namespace order_methods_test {

using testing_support::count_order_violations;
using testing_support::delaunay_mesh;
using testing_support::expect_each_once;
using testing_support::grid_mesh;
using testing_support::random_eye;
using testing_support::shuffled;
using testing_support::unit_tet;

// The grid without the cells of one octant: concave.
TetMesh notched_grid(int n) {
    TetMesh mesh = grid_mesh(n);
    std::erase_if(mesh.tets, [&](const std::array<VertexId, 4>& t) {
        const glm::dvec3 c = 0.25 * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]);
        return c.x > 0.5 && c.y > 0.5 && c.z > 0.5;
    });
    return mesh;
}

// Brute force: every point on the inner side of every boundary face.
bool convex_by_brute_force(const TetMesh& mesh) {
    const Adjacency adjacency = build_adjacency(mesh);
    for (const auto& [cell, face] : boundary_faces(adjacency)) {
        const auto v = face_vertices(mesh.tets[cell], face);
        for (const auto& p : mesh.points) {
            if (orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], p) > 0) return false;
        }
    }
    return true;
}

bool found_convex(const TetMesh& mesh) { return fills_convex_body(CellGraph(mesh, build_adjacency(mesh))); }

TEST(MeshFacts, ConvexBodies) {
    for (const TetMesh& mesh : {unit_tet(), grid_mesh(4), grid_mesh(4, 0.2, 3), shuffled(grid_mesh(4), 1), delaunay_mesh(200, 4)}) {
        EXPECT_TRUE(found_convex(mesh));
        EXPECT_TRUE(convex_by_brute_force(mesh));
    }
}

TEST(MeshFacts, NotConvex) {
    EXPECT_FALSE(found_convex(notched_grid(4)));
    EXPECT_FALSE(convex_by_brute_force(notched_grid(4)));
    TetMesh hollow = grid_mesh(3);  // without its middle box: the outer surface is convex
    std::erase_if(hollow.tets, [&](const std::array<VertexId, 4>& t) {
        const glm::dvec3 c = 0.25 * (hollow.points[t[0]] + hollow.points[t[1]] + hollow.points[t[2]] + hollow.points[t[3]]);
        return std::max({std::abs(c.x - 0.5), std::abs(c.y - 0.5), std::abs(c.z - 0.5)}) < 1.0 / 6;
    });
    EXPECT_FALSE(found_convex(hollow));
    TetMesh two = unit_tet();  // two bodies, each convex
    for (const auto& p : unit_tet().points) two.points.push_back(p + glm::dvec3(3, 0, 0));
    two.tets.push_back({4, 5, 6, 7});
    EXPECT_FALSE(found_convex(two));
    TetMesh dent = unit_tet();  // a point pressed a little into the slanted face: by 1e-12, which float32 cannot see
    dent.points.emplace_back(glm::dvec3((1.0 - 1e-12) / 3));
    dent.tets = {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 3, 1, 4}};
    orient_cells(dent);
    EXPECT_FALSE(found_convex(dent));
    EXPECT_FALSE(convex_by_brute_force(dent));
}

TEST(MeshFacts, Delaunay) {
    const auto is_delaunay = [](const TetMesh& mesh) { return locally_delaunay(CellGraph(mesh, build_adjacency(mesh))); };
    EXPECT_TRUE(is_delaunay(delaunay_mesh(500, 5)));
    EXPECT_TRUE(is_delaunay(grid_mesh(4)));  // each box has one circumsphere
    EXPECT_FALSE(is_delaunay(grid_mesh(4, 0.2, 6)));
}

// The relations from float32 must be those of the exact predicate, wherever the eye is.
TEST(CellGraph, RelationsAreExact) {
    for (const double scale : {1.0, 1e-12, 1e12}) {
        for (const double offset : {0.0, 1e6}) {
            TetMesh mesh = shuffled(grid_mesh(5, 0.2, 7), 8);
            const auto moved = [&](const glm::dvec3& p) { return scale * (p + offset); };
            for (auto& p : mesh.points) p = moved(p);
            const CellGraph graph(mesh, build_adjacency(mesh));
            std::vector<CellGraph::Relations> relations(graph.size() + 1);
            std::mt19937_64 random(9);
            for (int i = 0; i < 20; ++i) {
                Eye eye = random_eye(random, i);
                if (i % 4 == 3) eye = Eye::at({0.2 * (i % 5), 0.4, 0.37});  // in planes of faces, at vertices
                if (!eye.at_infinity) eye.xyz = moved(eye.xyz);
                graph.find_relations(eye, relations);
                for (CellId place = 0; place < graph.size(); ++place) {
                    unsigned expected = 0;
                    for (int face = 0; face < 4; ++face) {
                        if (graph.neighbours(place)[static_cast<std::size_t>(face)] == graph.nobody()) continue;
                        const auto v = face_vertices(mesh.tets[graph.cell(place)], face);
                        const int side = side_of_plane(eye, mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]);
                        if (side > 0) expected |= 1U << face;
                        if (side < 0) expected += CellGraph::one_hidden;
                    }
                    ASSERT_EQ(relations[place], expected) << "eye " << i << ", place " << place;
                }
            }
        }
    }
}

// Proven orders are right, from everywhere, from each other's view and for every input order.
TEST(OrderMethods, ExactOnesRespectEveryFace) {
    for (const TetMesh& mesh : {delaunay_mesh(600, 10), shuffled(grid_mesh(7, 0.2, 11), 12), grid_mesh(6)}) {
        const Adjacency adjacency = build_adjacency(mesh);
        VisibilitySorter sorter(mesh);
        std::mt19937_64 random(13);
        for (int i = 0; i < 30; ++i) {
            const Eye eye = i < 20 ? random_eye(random, i) : Eye::at({3 * std::cos(0.02 * i), 3 * std::sin(0.02 * i), 0.3});
            for (const auto method : {std::optional<OrderMethod>(), std::optional(OrderMethod::mpvo), std::optional(OrderMethod::power)}) {
                OrderReport report;
                const ViewOrder order = sorter.order(eye, &report, method);
                expect_each_once(order.items, mesh.tets.size());
                ASSERT_TRUE(report.exact || method == OrderMethod::power) << "eye " << i;
                const std::size_t violations = count_order_violations(mesh, adjacency, order, eye);
                ASSERT_TRUE(violations == 0 || !report.exact) << "eye " << i;
                ASSERT_EQ(sorter.count_violations(order, eye), violations);
            }
        }
    }
}

TEST(OrderMethods, PowerIsProvenForDelaunayMeshesOnly) {
    const Eye eye = Eye::at({3, 2, 1});
    OrderReport report;
    const TetMesh delaunay = delaunay_mesh(CELLPROJ_SANITIZED ? 500 : 5000, 14);
    VisibilitySorter(delaunay).order(eye, &report, OrderMethod::power);
    EXPECT_EQ(report.method, OrderMethod::power);
    EXPECT_TRUE(report.exact);
    const TetMesh jittered = grid_mesh(6, 0.2, 15);
    VisibilitySorter(jittered).order(eye, &report, OrderMethod::power);
    EXPECT_EQ(report.method, OrderMethod::power);
    EXPECT_FALSE(report.exact);
    const TetMesh regular = grid_mesh(6);  // five cells on each sphere: all ties
    VisibilitySorter(regular).order(eye, &report, OrderMethod::power);
    EXPECT_EQ(report.method, OrderMethod::mpvo);
    EXPECT_TRUE(report.exact);
}

// An order without some cells is the order of all, less those, whatever the eye did before.
TEST(OrderMethods, CellsThatAreNotVisibleAreLeftOut) {
    for (const TetMesh& mesh : {delaunay_mesh(500, 16), shuffled(grid_mesh(6, 0.2, 17), 18), notched_grid(6)}) {
        VisibilitySorter some(mesh), all(mesh);
        std::vector<std::uint8_t> visible(mesh.tets.size());
        for (std::size_t cell = 0; cell < mesh.tets.size(); ++cell) visible[cell] = cell % 3 == 0;
        std::mt19937_64 random(28);
        for (int i = 0; i < 20; ++i) {
            const Eye eye = i < 10 ? random_eye(random, i) : Eye::at({0.5 + 0.05 * i, 2.5, 1});
            for (const OrderMethod method : {OrderMethod::centroid, OrderMethod::power, OrderMethod::bsp, OrderMethod::mpvo}) {
                OrderReport report, report_of_all;
                const ViewOrder order = some.order(eye, &report, method, nullptr, visible);
                const ViewOrder whole = all.order(eye, &report_of_all, method);
                std::vector<std::uint32_t> wanted(whole.items.begin(), whole.items.end());
                std::erase_if(wanted, [&](std::uint32_t item) { return item < visible.size() && visible[item] == 0; });
                EXPECT_EQ(report.method, report_of_all.method);
                EXPECT_EQ(report.exact, report_of_all.exact);
                EXPECT_TRUE(whole.pieces.empty());
                if (method == OrderMethod::power) {  // relations that were settled between other cells may leave ties another way round
                    EXPECT_TRUE(!report.exact || some.count_violations(order, eye) == 0U);
                    EXPECT_EQ(order.items.size(), wanted.size());
                } else {
                    EXPECT_EQ(std::vector<std::uint32_t>(order.items.begin(), order.items.end()), wanted) << to_string(method);
                }
            }
            for (int step = 0; step < 3; ++step) {  // followed
                const Eye near = {eye.xyz + glm::dvec3(0.01 * step, 0, 0), eye.at_infinity};
                const auto items = some.order(near, nullptr, OrderMethod::mpvo, nullptr, visible).items;
                const auto whole = all.order(near, nullptr, OrderMethod::mpvo).items;
                std::vector<std::uint32_t> wanted(whole.begin(), whole.end());
                std::erase_if(wanted, [&](std::uint32_t item) { return visible[item] == 0; });
                EXPECT_EQ(std::vector<std::uint32_t>(items.begin(), items.end()), wanted);
            }
        }
    }
}

TEST(OrderMethods, CentroidsComeFromFarToNear) {
    const TetMesh mesh = shuffled(grid_mesh(6, 0.2, 17), 18);
    const auto centroid = [&](CellId cell) {
        const auto& t = mesh.tets[cell];
        return 0.25 * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]);
    };
    VisibilitySorter sorter(mesh);
    for (const Eye& eye : {Eye::at({0.4, 0.5, 0.6}), Eye::at({1.5, 0.5, 0.6}), Eye::at({1e9, 2e9, 1e9}), Eye::towards({1e-5, 2e-5, 0})}) {
        OrderReport report;
        const ViewOrder order = sorter.order(eye, &report, OrderMethod::centroid);
        EXPECT_FALSE(report.exact);
        expect_each_once(order.items, mesh.tets.size());
        double last = 1e300;
        const glm::dvec3 direction = glm::normalize(eye.xyz);
        for (const std::uint32_t cell : order.items) {
            const bool far_away = eye.at_infinity || glm::length(eye.xyz) > 1e6;
            const double distance = far_away ? -glm::dot(direction, centroid(cell)) : glm::distance(eye.xyz, centroid(cell));
            EXPECT_LE(distance, last + 5e-6);  // keys have 22 bits over a range of about 6
            last = std::min(last, distance);
        }
    }
}

// Meshes that the proof does not cover say so; every cell still comes once.
TEST(OrderMethods, OtherMeshesAreOrderedButNotProven) {
    const TetMesh mesh = notched_grid(6);
    const Adjacency adjacency = build_adjacency(mesh);
    VisibilitySorter sorter(mesh);
    EXPECT_FALSE(sorter.convex());
    std::mt19937_64 random(19);
    for (int i = 0; i < 10; ++i) {
        const Eye eye = random_eye(random, i);
        OrderReport report;
        const ViewOrder order = sorter.order(eye, &report, OrderMethod::mpvo);
        EXPECT_FALSE(report.exact);
        EXPECT_EQ(report.unordered, 0U);
        EXPECT_EQ(count_order_violations(mesh, adjacency, order, eye), 0U);
        expect_each_once(order.items, mesh.tets.size());
    }
}

// 300 flat, needle, point and inverted cells among 2,000; scales and offsets; eyes at vertices, on edges and in planes.
TEST(OrderMethods, NothingStallsOnBadCells) {
    std::mt19937_64 random(20);
    for (const double scale : {1e-12, 1.0, 1e12}) {
        TetMesh mesh = grid_mesh(CELLPROJ_SANITIZED ? 5 : 8, 0.2, 21);
        std::uniform_int_distribution<VertexId> any(0, static_cast<VertexId>(mesh.points.size() - 1));
        for (int i = 0; i < 300; ++i) {
            const VertexId a = any(random), b = any(random), c = any(random);
            mesh.tets.push_back(i % 3 == 0 ? std::array{a, a, a, a} : i % 3 == 1 ? std::array{a, b, a, b} : std::array{a, b, c, c});
        }
        for (std::size_t i = 0; i < 300; ++i) std::swap(mesh.tets[5 * i % 600][0], mesh.tets[5 * i % 600][1]);
        for (auto& p : mesh.points) p = scale * (p + 1e6 * (scale == 1.0 ? 1.0 : 0.0));
        VisibilitySorter sorter(mesh);
        for (int i = 0; i < 12; ++i) {
            const Eye eye = i < 8 ? random_eye(random, i) : i % 2 ? Eye::at(mesh.points[any(random)]) : Eye::at(0.5 * (mesh.points[0] + mesh.points[1]));
            for (const OrderMethod method : {OrderMethod::centroid, OrderMethod::power, OrderMethod::mpvo}) {
                OrderReport report;
                expect_each_once(sorter.order(eye, &report, method).items, mesh.tets.size());
                EXPECT_FALSE(report.exact);
            }
        }
    }
}

// A flat cell between two others passes their relation on; an inverted one is as good as it was.
TEST(CellGraph, FlatAndInvertedCellsTakePartAsTheyLie) {
    TetMesh mesh = grid_mesh(5, 0.2, 22);
    const Eye eye = Eye::at({2, 1.5, 1.2});
    const auto order = order_cells(mesh, eye);
    for (std::size_t i = 0; i < mesh.tets.size(); i += 3) std::swap(mesh.tets[i][0], mesh.tets[i][1]);
    const CellGraph graph(mesh, build_adjacency(mesh));
    EXPECT_EQ(graph.folded_faces(), 0U);
    VisibilitySorter sorter(mesh);
    EXPECT_EQ(sorter.count_violations({order, {}}, eye), 0U);
    EXPECT_EQ(sorter.count_violations(sorter.order(eye), eye), 0U);

    // Below, a flat square of two by two triangles, above.
    TetMesh flat{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, -1}, {0.5, 0.5, 1}},
                 {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 2, 3}, {0, 1, 3, 5}, {1, 2, 3, 5}}, {}, {}};
    orient_cells(flat);
    for (const double height : {3.0, -3.0}) {
        const auto items = order_cells(flat, Eye::at({0.4, 0.6, height}));
        const auto place = [&](std::uint32_t cell) { return std::find(items.begin(), items.end(), cell) - items.begin(); };
        for (const std::uint32_t below : {0U, 1U}) EXPECT_EQ(place(below) < place(2), height > 0);
        for (const std::uint32_t above : {3U, 4U}) EXPECT_EQ(place(above) > place(2), height > 0);
    }
}

TEST(OrderMethods, SameForAnyNumberOfThreads) {
    const TetMesh mesh = shuffled(delaunay_mesh(3000, 23), 24);
    const auto with_threads = [&](std::size_t threads) {
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
        VisibilitySorter sorter(mesh);
        std::vector<std::uint32_t> all;
        for (const OrderMethod method : {OrderMethod::centroid, OrderMethod::power, OrderMethod::mpvo}) {
            for (const double y : {1.0, 1.05}) {
                const ViewOrder order = sorter.order(Eye::at({3, y, 2}), nullptr, method);
                all.insert(all.end(), order.items.begin(), order.items.end());
            }
        }
        return all;
    };
    const auto one = with_threads(1);
    EXPECT_EQ(one, with_threads(2));
    EXPECT_EQ(one, with_threads(4));
}

// An orbit: each view starts from the order before, and each is exact.
TEST(OrderMethods, AnOrbitStaysExact) {
    const TetMesh mesh = grid_mesh(CELLPROJ_SANITIZED ? 6 : 12, 0.2, 25);
    VisibilitySorter sorter(mesh);
    for (int i = 0; i < 90; ++i) {
        const double angle = 0.0175 * i;
        const Eye eye = Eye::at({0.5 + 2 * std::cos(angle), 0.5 + 2 * std::sin(angle), 0.7});
        OrderReport report;
        const ViewOrder order = sorter.order(eye, &report, OrderMethod::mpvo);
        ASSERT_TRUE(report.exact);
        ASSERT_EQ(sorter.count_violations(order, eye), 0U);
    }
}

TEST(KeySort, SortsStablyAndLeavesOut) {
    std::mt19937_64 random(26);
    KeySort sort;
    // One cell, one part, many parts; more cells than numbers within a part of one thread.
    for (const std::size_t count : {0U, 1U, 31U, 100000U, CELLPROJ_SANITIZED ? 600000U : 5000000U, 100U}) {
        std::vector<std::uint32_t> keys(count), expected;
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t few = i % 3 == 0 ? largest_key : i % 3 == 1 ? 0xffU : 0U;
            keys[i] = random() % 5 == 0 ? no_key : static_cast<std::uint32_t>(random()) & few;
            if (keys[i] != no_key) expected.push_back(i);
        }
        std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
        for (const std::size_t threads : {1U, 2U, 4U}) {
            const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
            const auto sorted = sort.sort(count, [&](std::size_t first, std::span<std::uint32_t> some) {
                std::copy_n(keys.begin() + static_cast<std::ptrdiff_t>(first), some.size(), some.begin());
            });
            ASSERT_EQ(std::vector<std::uint32_t>(sorted.begin(), sorted.end()), expected) << count << " by " << threads;
        }
    }
    // All have one key, or none.
    for (const std::uint32_t key : {std::uint32_t{0}, largest_key, no_key}) {
        const auto sorted = sort.sort(50000, [&](std::size_t, std::span<std::uint32_t> some) { std::fill(some.begin(), some.end(), key); });
        ASSERT_EQ(sorted.size(), key == no_key ? 0U : 50000U);
        for (std::uint32_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
    }
}

TEST(OrderCheck, CountsWrongRaysAndOnlyThose) {
    const TetMesh mesh = grid_mesh(4, 0.2, 27);
    const RayIndex index(mesh);
    VisibilitySorter sorter(mesh);
    for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
        const Camera camera = frame_bounds(bounds(mesh.points), projection, {-1, -2, 1}, {0, 0, 1}, 1.0);
        const ImageSize size{64, 48};
        const ViewOrder order = sorter.order(camera.viewpoint());
        OrderCheck check = check_order(index, mesh.tets.size(), order, camera, size, 500);
        EXPECT_EQ(check.rays, 500U);
        EXPECT_EQ(check.wrong_rays, 0U);
        check = check_order(index, mesh.tets.size(), order, camera, size, 1000000);
        EXPECT_EQ(check.rays, 64U * 48U);
        EXPECT_EQ(check.wrong_rays, 0U);

        std::vector<std::uint32_t> reversed(order.items.rbegin(), order.items.rend());
        check = check_order(index, mesh.tets.size(), {reversed, {}}, camera, size, 500);
        EXPECT_GT(check.wrong_rays, 100U);
        EXPECT_GE(check.wrong_pairs, check.wrong_rays);
    }
}

// A cell as two pieces, cut through the edge 0–1: right in one order, wrong in the other, and nothing without them.
TEST(OrderCheck, PiecesAreJudgedByTheirOwnStretches) {
    const TetMesh mesh = unit_tet();
    const RayIndex index(mesh);
    const glm::dvec4 a(1, 0, 0, 0), b(0, 1, 0, 0), c(0, 0, 1, 0), d(0, 0, 0, 1), middle(0.5, 0.5, 0, 0);
    const std::vector<CellPiece> pieces{{0, {a, middle, c, d}}, {0, {middle, b, c, d}}};
    Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::parallel, {1, 0, 0}, {0, 0, 1}, 1.0);  // b is nearer
    const std::vector<std::uint32_t> right{1, 2}, wrong{2, 1}, none{};
    EXPECT_EQ(check_order(index, 1, {right, pieces}, camera, {64, 64}, 4096).wrong_rays, 0U);
    EXPECT_GT(check_order(index, 1, {wrong, pieces}, camera, {64, 64}, 4096).wrong_rays, 500U);
    EXPECT_EQ(check_order(index, 1, {none, pieces}, camera, {64, 64}, 4096).wrong_rays, 0U);
}

// Rays of the grid of pixels pass where those of the camera do.
TEST(OrderCheck, PixelGridHasTheRaysOfTheCamera) {
    for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
        const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, projection, {-1, -2, 1}, {0, 0, 1}, 1.5);
        const PixelGrid grid = pixel_grid(camera, {60, 40});
        const ScreenTransform transform(camera, {60, 40});
        for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), glm::dvec2(59.5, 20.5), glm::dvec2(13.5, 39.5)}) {
            const auto ray = transform.ray(at);
            const glm::dvec3 point = grid.corner + at.x * grid.dx + at.y * grid.dy;
            EXPECT_LT(glm::length(glm::cross(point - ray.origin, ray.direction)), 1e-13);
            EXPECT_EQ(grid.eye.at_infinity, projection == Camera::Projection::parallel);
        }
    }
}

}  // namespace
}  // namespace cellproj
