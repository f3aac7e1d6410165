// SPDX-License-Identifier: BSD-3-Clause
//
// Orders of meshes with holes, pieces and cycles, judged by the sequence of cells along rays (tests/support/order_judge.hpp). The
// relations across the outside are found in two ways that share nothing but the predicates: at pixels, and pair by pair.
#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <random>
#include <set>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "sort/boundary.hpp"
#include "sort/boundary_overlaps.hpp"
#include "sort/boundary_scan.hpp"
#include "sort/convex_part.hpp"
#include "sort/cycles.hpp"
#include "sort/exact_order.hpp"
#include "sort/strong_components.hpp"
#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/order_judge.hpp"
#include "tests/support/order_meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace exact_order_test {

using namespace testing_support;

// ---- Whole orders ----

constexpr int eyes = CELLPROJ_SANITIZED ? 4 : 10;
constexpr int rays_per_eye = CELLPROJ_SANITIZED ? 100 : 512;  // cellproj_orders tries 4096
constexpr ImageSize picture{256, 256};

// Every eye, both methods: complete, said to be exact, and exact.
void expect_exact(const TetMesh& mesh, int count = eyes, int rays = rays_per_eye) {
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(7);
    for (int i = 0; i < count; ++i) {
        const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), picture);
        OrderReport report;
        ViewOrder order = sorter.order(grid.eye, &report, OrderMethod::sxmpvo, &grid);
        EXPECT_TRUE(report.exact) << "sxmpvo, eye " << i;
        EXPECT_TRUE(is_complete(mesh, order)) << "sxmpvo, eye " << i;
        EXPECT_EQ(wrong_rays(mesh, index, order, random_pixel_rays(index, grid, rays, random)), 0U) << "sxmpvo, eye " << i;

        order = sorter.order(grid.eye, &report, OrderMethod::bsp);
        EXPECT_TRUE(report.exact) << "bsp, eye " << i;
        EXPECT_TRUE(is_complete(mesh, order)) << "bsp, eye " << i;
        EXPECT_EQ(wrong_rays(mesh, index, order, random_rays(index, grid, rays, random)), 0U) << "bsp, eye " << i;
    }
}

TEST(ExactOrder, Torus) { expect_exact(torus_mesh(40)); }
TEST(ExactOrder, BoxWithFiftyCavities) { expect_exact(cavity_mesh(CELLPROJ_SANITIZED ? 8 : 14, 50)); }
TEST(ExactOrder, InterlockedSprings) { expect_exact(springs_mesh(90)); }
TEST(ExactOrder, HundredPieces) { expect_exact(pieces_mesh(100, 2)); }
TEST(ExactOrder, ThreeSticks) { expect_exact(overlapping_sticks()); }
TEST(ExactOrder, SpiralStair) { expect_exact(spiral_stair(1000)); }
TEST(ExactOrder, TwistedGrid) { expect_exact(twisted_mesh(12, 20)); }
TEST(ExactOrder, ConvexGrid) { expect_exact(grid_mesh(8, 0.2), 4); }

void expect_exact_file(const std::string& name, const std::string& solution = {}, int count = CELLPROJ_SANITIZED ? 1 : 3) {
    const std::filesystem::path file = std::string(CELLPROJ_SHARED_DATA) + "/" + name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    ReadOptions options;
    if (!solution.empty()) options.solution = std::string(CELLPROJ_SHARED_DATA) + "/" + solution;
    expect_exact(tetrahedralize(read(file, options)), count);
}

#ifdef CELLPROJ_TESTS_READ_VTK
TEST(ExactOrder, BluntFin) { expect_exact_file("bluntfin/bluntfinxyz.bin", "bluntfin/bluntfinq.bin"); }
TEST(ExactOrder, Aneurysm) { expect_exact_file("aneurysm_tets_openfoam/aneurysm_tets_internal.vtu"); }
TEST(ExactOrder, RotorDisk) {
    if (CELLPROJ_SANITIZED) GTEST_SKIP() << "too large for the sanitizers";
    expect_exact_file("rotordisk_openfoam/rotorDisk_internal.vtu", {}, 1);
}
#endif

// The judge must be able to say no.
TEST(ExactOrder, TheJudgeFindsWhatCentroidsGetWrong) {
    const TetMesh mesh = overlapping_sticks();
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(3);
    const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), 0, random), picture);
    const auto rays = random_pixel_rays(index, grid, 4096, random);
    EXPECT_GT(wrong_rays(mesh, index, sorter.order(grid.eye, nullptr, OrderMethod::centroid), rays), 0U);

    const ViewOrder order = sorter.order(grid.eye, nullptr, OrderMethod::sxmpvo, &grid);
    ASSERT_FALSE(order.pieces.empty());
    EXPECT_EQ(wrong_rays(mesh, index, order, rays), 0U);
    const std::vector<std::uint32_t> backwards(order.items.rbegin(), order.items.rend());
    EXPECT_GT(wrong_rays(mesh, index, {backwards, order.pieces}, rays), 0U);
    // A piece is lost: the cell is no longer complete, and some ray goes without it.
    const ViewOrder less{order.items.subspan(1), order.pieces};
    EXPECT_FALSE(is_complete(mesh, less));
    EXPECT_GT(wrong_rays(mesh, index, less, rays), 0U);
}

TEST(ExactOrder, ReportsCyclesAndSplitCells) {
    std::mt19937_64 random(3);
    const TetMesh sticks = overlapping_sticks();
    OrderReport report;
    const Eye along_z = Eye::towards({0, 0, 1});
    (void)VisibilitySorter(sticks).order(along_z, &report, OrderMethod::bsp);
    EXPECT_EQ(report.cycles, 1U);
    EXPECT_GE(report.split_cells, 1U);  // one cut opens the ring
    EXPECT_EQ(report.unordered, 0U);

    const TetMesh stair = spiral_stair(1000);
    const CellGraph graph(stair, build_adjacency(stair));
    std::vector<CellId> all(graph.size()), places(graph.size());
    std::iota(all.begin(), all.end(), 0U);
    for (CellId place = 0; place < graph.size(); ++place)
        places[graph.cell(place)] = place;
    auto arcs = boundary_overlaps(stair, order_boundary(graph), along_z);
    EXPECT_EQ(arcs.size(), 1000U);  // each step lies over the next one only
    for (OrderArc& arc : arcs)
        arc = {places[arc.behind], places[arc.front]};
    const ResolvedCycles resolved = resolve_cycles(graph, all, arcs, along_z);
    EXPECT_EQ(resolved.cycles, 1U);
    EXPECT_EQ(resolved.cyclic_cells, 1000U);
    EXPECT_LE(resolved.split_cells, 20U);  // few cuts open one ring
    EXPECT_EQ(resolved.unordered, 0U);

    const TetMesh twisted = twisted_mesh(12, 20);
    const CellGraph twisted_graph(twisted, build_adjacency(twisted));
    std::vector<CellId> cells(twisted.tets.size());
    std::iota(cells.begin(), cells.end(), 0U);
    EXPECT_GE(20 * resolve_cycles(twisted_graph, cells, {}, along_z).cyclic_cells, cells.size());  // one in twenty
}

// A convex mesh needs no relations across the outside; its cycles are cut in every view, also in those that follow the last one.
TEST(ExactOrder, CyclesOfAConvexMesh) {
    const TetMesh mesh = twisted_cube(10);
    VisibilitySorter sorter(mesh);
    ASSERT_TRUE(sorter.convex());
    const RayIndex index(mesh);
    std::mt19937_64 random(7);
    std::size_t cycles = 0;
    for (int i = 0; i < eyes; ++i) {
        PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), picture);
        for (int step = 0; step < 3; ++step) {
            OrderReport report;
            const ViewOrder order = sorter.order(grid.eye, &report);
            EXPECT_EQ(report.method, OrderMethod::mpvo);
            EXPECT_TRUE(report.exact) << "eye " << i;
            EXPECT_TRUE(is_complete(mesh, order)) << "eye " << i;
            EXPECT_EQ(wrong_rays(mesh, index, order, random_rays(index, grid, rays_per_eye, random)), 0U) << "eye " << i;
            cycles += report.cycles;
            grid.eye.xyz += 0.01 * glm::length(grid.eye.xyz) * glm::dvec3(1, 0.5, 0);
        }
    }
    EXPECT_GT(cycles, 0U);
}

// Pieces in contact whose points were never merged: leaving the one comes before entering the other.
TEST(ExactOrder, PiecesInContact) {
    TetMesh mesh = grid_mesh(4, 0.0);
    const TetMesh other = moved(mesh, 1.0, 0.0);
    const auto offset = static_cast<VertexId>(mesh.points.size());
    for (const auto& p : other.points)
        mesh.points.push_back(p + glm::dvec3(1, 0.25, 0));  // faces meet faces, shifted by a box
    for (auto tet : other.tets) {
        for (auto& v : tet)
            v += offset;
        mesh.tets.push_back(tet);
    }
    expect_exact(mesh, 8);
}

// The same with coordinates rounded to float32 and turned, so that the pieces reach into each other by 1e-8 here and there.
TEST(ExactOrder, PiecesInContactUpToRounding) {
    TetMesh mesh = grid_mesh(4, 0.0);
    for (auto& p : mesh.points) {
        const auto turned = [](const glm::dvec3& q) { return glm::dvec3(0.8 * q.x - 0.6 * q.y, 0.6 * q.x + 0.8 * q.y, q.z / 3); };
        p = turned(p);
    }
    const auto cells = mesh.tets;
    const std::size_t count = mesh.points.size();
    for (std::size_t i = 0; i < count; ++i)
        mesh.points.push_back(mesh.points[i] + glm::dvec3(0.8 - 0.6 * 0.25 - 0.8e-8, 0.6 + 0.8 * 0.25 - 0.6e-8, 0));
    for (auto tet : cells) {
        for (auto& v : tet)
            v += static_cast<VertexId>(count);
        mesh.tets.push_back(tet);
    }
    for (auto& p : mesh.points)
        p = glm::dvec3(glm::vec3(p));
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(7);
    for (int i = 0; i < 8; ++i) {
        const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), picture);
        OrderReport report;
        const ViewOrder order = sorter.order(grid.eye, &report, OrderMethod::sxmpvo, &grid);
        EXPECT_TRUE(report.exact) << "eye " << i;
        EXPECT_EQ(wrong_rays(mesh, index, order, random_pixel_rays(index, grid, 1024, random)), 0U) << "eye " << i;
    }
}

// Cells that overlap have no order: sxmpvo sees it and says so.
TEST(ExactOrder, OverlapIsReported) {
    TetMesh mesh = unit_tet();
    for (const auto& p : unit_tet().points)
        mesh.points.push_back(p + 0.1);
    mesh.tets.push_back({4, 5, 6, 7});
    VisibilitySorter sorter(mesh);
    std::mt19937_64 random(4);
    for (int i = 0; i < 8; ++i) {
        const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), picture);
        OrderReport report;
        EXPECT_TRUE(is_complete(mesh, sorter.order(grid.eye, &report, OrderMethod::sxmpvo, &grid)));
        if (i % 4 == 3) continue;  // from inside it may not be in view
        EXPECT_FALSE(report.exact) << "eye " << i;
    }
}

// The same cell twice, each said to be behind the other: no plane parts them.
TEST(ExactOrder, WhatCannotBePartedIsOrderedByDepthAndCounted) {
    TetMesh mesh = unit_tet();
    mesh.tets.push_back(mesh.tets[0]);
    const CellGraph graph(mesh, Adjacency{.neighbours = {{no_cell, no_cell, no_cell, no_cell}, {no_cell, no_cell, no_cell, no_cell}}});
    const std::array<CellId, 2> places{0, 1};
    const std::array<OrderArc, 2> arcs{{{0, 1}, {1, 0}}};
    const ResolvedCycles resolved = resolve_cycles(graph, places, arcs, Eye::towards({0, 0, 1}));
    EXPECT_EQ(resolved.unordered, 2U);
    EXPECT_TRUE(is_complete(mesh, {resolved.items, resolved.pieces}));
}

// Cycles that may be cut into less than it takes: the rest by depth, every cell once, and the report says so.
TEST(ExactOrder, WhatIsCutTooOftenIsOrderedByDepthAndCounted) {
    struct Case {
        TetMesh mesh;
        CutLimit limit;
        bool some_are_cut;
    };
    const CutLimit none{.per_cell = 1, .spare = 0};
    for (const auto& [mesh, limit, some_are_cut] :
         {Case{overlapping_sticks(), none, false}, Case{spiral_stair(100), none, false}, Case{twisted_mesh(8, 20), none, false},
          Case{cyclic_ring(12), none, false}, Case{twisted_mesh(8, 20), {.per_cell = 1, .spare = 32}, true}}) {
        const CellGraph graph(mesh, build_adjacency(mesh));
        TopologicalSort topological;
        ExactOrder enough(graph), too_little(graph, limit);
        std::size_t unordered = 0, split = 0;
        for (const Eye& eye : {Eye::towards({0, 0, 1}), Eye::towards({0.1, 0.05, -1})}) {
            OrderReport report{.method = OrderMethod::bsp};
            EXPECT_TRUE(is_complete(mesh, enough.order(graph, topological, eye, nullptr, report)));
            EXPECT_TRUE(report.exact);
            EXPECT_EQ(report.unordered, 0U);

            report = {.method = OrderMethod::bsp};
            EXPECT_TRUE(is_complete(mesh, too_little.order(graph, topological, eye, nullptr, report)));
            EXPECT_EQ(report.exact, report.unordered == 0);
            EXPECT_LE(report.unordered, mesh.tets.size());
            unordered += report.unordered;
            split += report.split_cells;
        }
        EXPECT_GE(unordered, 3U);  // cells in the shortest cycle
        EXPECT_EQ(split > 0, some_are_cut);
    }
}

// The boundary by exact signs over an adjacency that the graph did not make.
bool separates(const TetMesh& mesh, CellId cell, int face, CellId other) {
    const auto f = face_vertices(mesh.tets[cell], face);
    const auto side = [&](CellId of) {
        for (const VertexId v : mesh.tets[of]) {
            if (std::find(f.begin(), f.end(), v) == f.end()) return orientation(mesh.points[f[0]], mesh.points[f[1]], mesh.points[f[2]], mesh.points[v]);
        }
        return 0;
    };
    return side(cell) * side(other) < 0;
}

TEST(BoundaryRelations, BoundaryIsWhatSeparatesNoCells) {
    TetMesh folded = grid_mesh(2);
    folded.tets.push_back({folded.tets[3][0], folded.tets[3][1], folded.tets[3][2], folded.tets[20][3]});
    for (const TetMesh& mesh : {grid_mesh(3), cavity_mesh(8, 20), twisted_mesh(6, 10), damaged_mesh(6, 60), overlapping_sticks(), folded}) {
        const Adjacency adjacency = build_adjacency(mesh);
        std::vector<std::pair<CellId, int>> expected, found;
        for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
            const auto& t = mesh.tets[cell];
            if (orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) == 0) continue;
            for (int face = 0; face < 4; ++face) {
                const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
                if (other == no_cell || !separates(mesh, cell, face, other)) expected.emplace_back(cell, face);
            }
        }
        for (const BoundaryFace& face : order_boundary(CellGraph(mesh, adjacency))) found.emplace_back(face.cell, face.face);
        EXPECT_EQ(found, expected);
    }
}

// ---- Pictures ----

// How many pixels are off the judge's picture by more than 1/100 in a channel, where the judge is sure (not beside an edge).
std::size_t wrong_pixels(const Scene& scene, const Camera& camera, std::optional<OrderMethod> method) {
    constexpr ImageSize size{48, 48};
    Quality quality;
    quality.order = method;
    static const auto renderer = make_renderer(Backend::gl_osmesa);
    const Image image = renderer->render(scene, camera, size, quality);
    std::vector<PixelId> pixels;
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x)
            pixels.push_back({x, y});
    }
    std::size_t wrong = 0;
    for (const PixelTruth& truth : Reference(scene).pixels(camera, size, pixels, 0.01)) {
        const glm::dvec4 low(truth.low.color, truth.low.opacity), high(truth.high.color, truth.high.opacity);
        const glm::dvec4 seen(image.at(truth.pixel.x, truth.pixel.y));
        for (int k = 0; k < 4; ++k) {
            if (seen[k] >= low[k] - 0.01 && seen[k] <= high[k] + 0.01) continue;
            ++wrong;
            break;
        }
    }
    return wrong;
}

// Pieces are drawn with the light of their cells: dense media of many colours, in which any wrong order shows.
TEST(ExactOrder, PicturesOfCyclesAreRight) {
    const TransferFunction dense{OpticalModel::density, {{0, {1, 0, 0}}, {0.5, {0, 1, 0}}, {1, {0, 0, 1}}}, {{0, 40}}};
    // A pixel beside several edges may see a cell that the judge's five positions miss.
    constexpr std::size_t allowed = 2;
    for (const TetMesh& mesh : {overlapping_sticks(), CELLPROJ_SANITIZED ? spiral_stair(30) : twisted_mesh(8, 20)}) {
        std::mt19937_64 random(5);
        ScalarField field{"f", FieldLocation::cells, {}};
        for (std::size_t c = 0; c < mesh.tets.size(); ++c)
            field.values.push_back(mesh.tets.size() == 3 ? 0.5 * static_cast<double>(c) : std::uniform_real_distribution<double>()(random));
        const Scene scene = scene_of(mesh, field, dense);
        for (const int eye : {0, 5}) {  // along z
            const Camera camera = judging_camera(bounds(mesh.points), eye, random);
            EXPECT_LE(wrong_pixels(scene, camera, {}), allowed);
            EXPECT_GT(wrong_pixels(scene, camera, OrderMethod::centroid), allowed);
        }
    }
}

// ---- Robustness ----

struct Damage {
    double scale, offset;
};
class DamagedOrder : public testing::TestWithParam<Damage> {};

// 300 bad cells among 10k, at the ends of the scale and far from the origin: nothing is lost, nothing stalls, rays stay right.
TEST_P(DamagedOrder, IsComplete) {
    const auto [scale, offset] = GetParam();
    const TetMesh mesh = moved(damaged_mesh(CELLPROJ_SANITIZED ? 6 : 12, 50), scale, offset);
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(7);
    for (int i = 0; i < 8; ++i) {
        const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), {64, 64});
        for (const OrderMethod method : {OrderMethod::sxmpvo, OrderMethod::bsp}) {
            OrderReport report;
            const ViewOrder order = sorter.order(grid.eye, &report, method, &grid);
            EXPECT_TRUE(is_complete(mesh, order)) << to_string(method) << ", eye " << i;
            EXPECT_EQ(report.method, method);
            const auto wrong = wrong_rays(mesh, index, order, random_pixel_rays(index, grid, 200, random));
            EXPECT_TRUE(!report.exact || wrong == 0) << to_string(method) << ", eye " << i;
            EXPECT_TRUE(report.exact || offset != 0) << to_string(method) << ", eye " << i << " wrong " << wrong << " unordered " << report.unordered << " cycles " << report.cycles << " split " << report.split_cells;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Places, DamagedOrder, testing::Values(Damage{1, 0}, Damage{1e-12, 0}, Damage{1e12, 0}, Damage{1, 1e6}),
                         [](const auto& suite) { return "Place" + std::to_string(suite.index); });

// Eyes in planes of faces, on edges and at vertices.
TEST(ExactOrder, EyesInDegeneratePlaces) {
    const TetMesh mesh = cavity_mesh(8, 10);
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(9);
    for (int i = 0; i < (CELLPROJ_SANITIZED ? 8 : 24); ++i) {
        const auto& t = mesh.tets[random() % mesh.tets.size()];
        const glm::dvec3 a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
        Camera camera;
        camera.eye = i % 4 == 0 ? a : i % 4 == 1 ? 0.5 * (a + b) : i % 4 == 2 ? a + 2.0 * (b - a) : 0.25 * a + 0.25 * b + 0.5 * c;
        camera.center = i % 3 == 0 ? b : glm::dvec3(0.51, 0.47, 0.53);
        camera.up = {0.3, 0.2, 0.9};
        camera.fov_y_degrees = 60;
        camera.height = 1;
        camera.projection = i % 2 ? Camera::Projection::parallel : Camera::Projection::perspective;
        if (glm::distance(camera.eye, camera.center) < 1e-9) continue;
        const PixelGrid grid = pixel_grid(camera, {65, 65});  // the middle of a pixel looks at the center
        for (const OrderMethod method : {OrderMethod::sxmpvo, OrderMethod::bsp}) {
            OrderReport report;
            const ViewOrder order = sorter.order(grid.eye, &report, method, &grid);
            EXPECT_TRUE(report.exact) << to_string(method) << ", eye " << i;
            EXPECT_TRUE(is_complete(mesh, order));
            EXPECT_EQ(wrong_rays(mesh, index, order, random_pixel_rays(index, grid, 300, random)), 0U) << to_string(method) << ", eye " << i;
        }
    }
}

// A view along the axes of a grid: rays through vertices and edges and in faces, all exactly.
TEST(ExactOrder, RaysThroughVerticesAndInFaces) {
    const TetMesh mesh = carved(grid_mesh(8, 0.0), [](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(0.5)) > 0.3; });
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    std::mt19937_64 random(9);
    for (const glm::dvec3& towards : {glm::dvec3(0, 0, 1), glm::dvec3(0, -1, 0), glm::dvec3(1, 1, 0), glm::dvec3(1, 1, 1)}) {
        // Pixel centres on the points of the grid: of 32 along x, every fourth.
        const PixelGrid grid{Eye::towards(towards), glm::dvec3(-0.5 / 32) + 2.0 * towards, {1.0 / 32, 0, 0},
                             towards.y == 0 ? glm::dvec3(0, 1.0 / 32, 0) : glm::dvec3(0, 0, 1.0 / 32), 33, 33};
        OrderReport report;
        const ViewOrder order = sorter.order(grid.eye, &report, OrderMethod::sxmpvo, &grid);
        EXPECT_TRUE(report.exact);
        EXPECT_EQ(wrong_rays(mesh, index, order, random_rays(index, grid, 500, random)), 0U);
    }
}

TEST(ExactOrder, IsTheSameForAnyNumberOfThreads) {
    const TetMesh mesh = twisted_mesh(10, 20);
    std::mt19937_64 random(7);
    const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), 0, random), picture);
    for (const OrderMethod method : {OrderMethod::sxmpvo, OrderMethod::bsp}) {
        std::vector<std::uint32_t> expected;
        for (const std::size_t threads : {1U, 2U, 4U}) {
            const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
            VisibilitySorter sorter(mesh);
            const auto items = sorter.order(grid.eye, nullptr, method, &grid).items;
            if (expected.empty()) expected.assign(items.begin(), items.end());
            EXPECT_TRUE(std::equal(items.begin(), items.end(), expected.begin(), expected.end())) << to_string(method) << ' ' << threads;
        }
    }
}

// ---- Relations across the outside ----

// What the scan sees at pixels is among the pairs that overlap; at a fine picture of few faces it is all that is not implied.
TEST(BoundaryRelations, TwoWaysAgree) {
    for (const TetMesh& mesh : {springs_mesh(60), pieces_mesh(30, 2), cavity_mesh(8, 20), twisted_mesh(8, 10)}) {
        const auto boundary = order_boundary(CellGraph(mesh, build_adjacency(mesh)));
        std::mt19937_64 random(7);
        for (int i = 0; i < (CELLPROJ_SANITIZED ? 4 : 8); ++i) {
            const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), picture);
            const BoundaryScan scan = scan_boundary(mesh, boundary, grid);
            EXPECT_EQ(scan.crossed_rays, 0U);
            const auto pairs = boundary_overlaps(mesh, boundary, grid.eye);
            EXPECT_TRUE(std::includes(pairs.begin(), pairs.end(), scan.arcs.begin(), scan.arcs.end())) << "eye " << i;
            // Two cells, both convex, cannot each be behind the other.
            for (const OrderArc& arc : pairs)
                EXPECT_FALSE(std::binary_search(pairs.begin(), pairs.end(), OrderArc{arc.front, arc.behind}));
        }
    }
}

// ---- Cutting ----

double volume(const std::array<glm::dvec4, 4>& tet) { return std::abs(glm::determinant(glm::dmat4(tet[0], tet[1], tet[2], tet[3]))); }

double volume(const ConvexPart& part) {
    double sum = 0;
    for (const auto& tet : tetrahedra(part))
        sum += volume(tet);
    return sum;
}

// Parts of parts of a cell fill it, whatever the planes; heights of 0 put planes through vertices, edges and faces.
TEST(ConvexParts, FillTheCell) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> height(-1, 1);
    std::bernoulli_distribution exact(0.25);
    for (int run = 0; run < 300; ++run) {
        std::vector<ConvexPart> parts{whole_cell()};
        for (int cuts = 0; cuts < 6; ++cuts) {
            CornerHeights heights;
            for (double& h : heights)
                h = exact(random) ? 0.0 : height(random);
            std::vector<ConvexPart> next;
            for (ConvexPart& part : parts) {
                const PlaneSides side = sides(part, heights);
                if (side.below && side.above) {
                    CutPart two = cut(part, heights);
                    EXPECT_FALSE(sides(two.below, heights).above);
                    EXPECT_FALSE(sides(two.above, heights).below);
                    EXPECT_NEAR(volume(two.below) + volume(two.above), volume(part), 1e-12);
                    next.push_back(std::move(two.below));
                    next.push_back(std::move(two.above));
                } else {
                    next.push_back(std::move(part));
                }
            }
            parts = std::move(next);
        }
        double sum = 0;
        for (const ConvexPart& part : parts) {
            // Euler: vertices − edges + faces = 2.
            std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
            for (const auto& face : part.faces) {
                for (std::size_t i = 0; i < face.size(); ++i)
                    edges.insert(std::minmax(face[i], face[(i + 1) % face.size()]));
            }
            EXPECT_EQ(part.vertices.size() + part.faces.size(), edges.size() + 2) << "run " << run;
            sum += volume(part);
        }
        EXPECT_NEAR(sum, 1.0, 1e-12) << "run " << run;
    }
}

// The middle of three cells between two planes: a truncated tetrahedron of known volume.
TEST(ConvexParts, KnownVolumes) {
    const CutPart tip = cut(whole_cell(), {3, -1, -1, -1});  // a quarter of the way down from vertex 0... at weight 1/4
    EXPECT_NEAR(volume(tip.above), 27.0 / 64, 1e-15);
    EXPECT_NEAR(volume(tip.below), 37.0 / 64, 1e-15);
    const CutPart halves = cut(whole_cell(), {1, 1, -1, -1});  // a quadrangle between opposite edges
    EXPECT_NEAR(volume(halves.above), 0.5, 1e-15);
    EXPECT_EQ(halves.above.vertices.size(), 6U);
}

// ---- Components ----

TEST(StrongComponents, AgreeWithReachability) {
    std::mt19937_64 random(6);
    for (int run = 0; run < 200; ++run) {
        const std::uint32_t n = 1 + static_cast<std::uint32_t>(random() % 12);
        std::vector<NodeArc> arcs(random() % (2 * n + 1));
        std::vector<std::vector<bool>> reaches(n, std::vector<bool>(n, false));
        for (auto& arc : arcs) {
            arc = {static_cast<std::uint32_t>(random() % n), static_cast<std::uint32_t>(random() % n)};
            reaches[arc.from][arc.to] = true;
        }
        for (std::uint32_t k = 0; k < n; ++k) {
            for (std::uint32_t i = 0; i < n; ++i) {
                for (std::uint32_t j = 0; j < n; ++j) {
                    if (reaches[i][k] && reaches[k][j]) reaches[i][j] = true;
                }
            }
        }
        const Components found = strong_components(to_rows(arcs, n));
        std::vector<std::size_t> component(n, n);
        for (std::size_t k = 0; k < found.size(); ++k) {
            for (const std::uint32_t node : found[k])
                component[node] = k;
        }
        for (std::uint32_t i = 0; i < n; ++i) {
            ASSERT_LT(component[i], found.size());
            for (std::uint32_t j = 0; j < n; ++j) {
                EXPECT_EQ(component[i] == component[j], i == j || (reaches[i][j] && reaches[j][i]));
                EXPECT_TRUE(!reaches[i][j] || component[i] <= component[j]);
            }
        }
    }
}

}  // namespace
}  // namespace cellproj
