// SPDX-License-Identifier: BSD-3-Clause
//
// Every kind of cell by itself: its closed-form volume, its centre, its fields.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <span>

#include "mesh/cell_faces.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace cell_split_test {

using testing_support::cube_corners;
using testing_support::single_cell;
using testing_support::total_volume;

// Volumes of a few units, from at most 30 tetrahedra of rounded coordinates.
constexpr double volume_tolerance = 1e-9;

struct Solid {
    CellKind kind;
    std::vector<glm::dvec3> points;
    double volume;
    std::size_t tets;
};

// A right prism of height 2 over a regular polygon in the unit circle, whose area is n/2 · sin(2π/n).
Solid prism(CellKind kind, std::size_t n) {
    Solid solid{kind, {}, 0.0, 3 * (n - 2)};
    const double angle = 2.0 * 3.14159265358979323846 / static_cast<double>(n);
    for (const double z : {0.0, 2.0}) {
        for (std::size_t k = 0; k < n; ++k) {
            const double turn = angle * static_cast<double>(k);
            solid.points.emplace_back(std::cos(turn), std::sin(turn), z);
        }
    }
    solid.volume = static_cast<double>(n) * std::sin(angle);
    return solid;
}

std::vector<Solid> solids() {
    return {{CellKind::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0 / 6.0, 1},
            {CellKind::pyramid, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0.5, 0.7, 3}}, 4.0, 2},
            prism(CellKind::wedge, 3),
            prism(CellKind::hexahedron, 4),
            prism(CellKind::pentagonal_prism, 5),
            prism(CellKind::hexagonal_prism, 6)};
}

std::vector<VertexId> counted(std::size_t n) {
    std::vector<VertexId> ids(n);
    std::iota(ids.begin(), ids.end(), 0U);
    return ids;
}

// The solid with its points in random order.
Dataset shuffled(const Solid& solid, std::mt19937_64& random) {
    std::vector<VertexId> ids = counted(solid.points.size());
    std::shuffle(ids.begin(), ids.end(), random);
    std::vector<glm::dvec3> points(ids.size());
    for (std::size_t p = 0; p < ids.size(); ++p)
        points[ids[p]] = solid.points[p];
    return single_cell(solid.kind, points, ids);
}

// The same cell as a polyhedron, its faces turned at random.
Dataset as_polyhedron(const Dataset& dataset, std::mt19937_64& random) {
    std::vector<VertexId> stream{0};
    for_each_face(dataset.cells.kinds[0], dataset.cells.vertices, [&](std::span<const VertexId> face) {
        ++stream[0];
        stream.push_back(static_cast<VertexId>(face.size()));
        stream.insert(stream.end(), face.begin(), face.end());
        if (random() % 2 == 0) std::reverse(stream.end() - static_cast<std::ptrdiff_t>(face.size()), stream.end());
    });
    return single_cell(CellKind::polyhedron, dataset.points, stream);
}

TEST(CellFaces, CloseEveryKind) {
    for (const Solid& solid : solids()) {
        SCOPED_TRACE(static_cast<int>(solid.kind));
        std::map<std::pair<VertexId, VertexId>, int> edges;
        for_each_face(solid.kind, counted(solid.points.size()), [&](std::span<const VertexId> face) {
            for (std::size_t n = 0; n < face.size(); ++n)
                ++edges[{face[n], face[(n + 1) % face.size()]}];
        });
        for (const auto& [edge, count] : edges) {
            EXPECT_EQ(count, 1);
            EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
        }
    }
}

TEST(TetrahedralizeKinds, HaveTheirClosedFormVolumeWhateverTheNumbering) {
    std::mt19937_64 random(7);
    for (const Solid& solid : solids()) {
        SCOPED_TRACE(static_cast<int>(solid.kind));
        for (int n = 0; n < 50; ++n) {
            Dataset dataset = shuffled(solid, random);
            if (n % 2 == 1) {
                for (glm::dvec3& p : dataset.points)
                    p.z = -p.z;  // stored inside out
            }
            TetrahedralizeReport report;
            const TetMesh mesh = tetrahedralize(dataset, &report);
            EXPECT_EQ(report.inverted, 0U);
            EXPECT_EQ(report.tets, solid.tets + (report.centred_cells > 0 ? mesh.tets.size() - solid.tets : 0));
            EXPECT_NEAR(total_volume(mesh), solid.volume, volume_tolerance);
        }
    }
}

TEST(TetrahedralizeKinds, PolyhedraGetACentreAndTheirFacesMayBeTurnedAnyhow) {
    std::mt19937_64 random(8);
    for (const Solid& solid : solids()) {
        SCOPED_TRACE(static_cast<int>(solid.kind));
        for (int n = 0; n < 50; ++n) {
            const Dataset dataset = as_polyhedron(shuffled(solid, random), random);
            TetrahedralizeReport report;
            const TetMesh mesh = tetrahedralize(dataset, &report);
            EXPECT_EQ(report.added_points, 1U);
            EXPECT_EQ(report.centred_cells, 0U);
            EXPECT_EQ(report.inverted, 0U);
            EXPECT_NEAR(total_volume(mesh), solid.volume, volume_tolerance);
        }
    }
}

// A wedge of cheese seen from above: an L, whose inner corner is at (1, 1). Its vertices' mean, (7/6, 7/6), lies
// outside of it and its kernel is the unit square at the origin.
Dataset l_shaped_prism() {
    Dataset dataset = single_cell(CellKind::hexagonal_prism, {}, counted(12));
    for (const double z : {0.0, 1.0}) {
        for (const glm::dvec3& p : {glm::dvec3(0, 0, z), glm::dvec3(3, 0, z), glm::dvec3(3, 1, z), glm::dvec3(1, 1, z),
                                    glm::dvec3(1, 3, z), glm::dvec3(0, 3, z)}) {
            dataset.points.push_back(p);
        }
    }
    return dataset;
}

TEST(TetrahedralizeKinds, ACentreIsFoundWhereTheMeanSeesNotAllFaces) {
    std::mt19937_64 random(9);
    Dataset dataset = as_polyhedron(l_shaped_prism(), random);
    // Reproduced: what is linear in space, wherever the centre comes to lie.
    dataset.point_fields = {{"linear", 2, {}}};
    const auto linear = [](const glm::dvec3& p) { return 1.0 + 2.0 * p.x - 3.0 * p.y + 4.0 * p.z; };
    for (const glm::dvec3& p : dataset.points) {
        dataset.point_fields[0].values.push_back(linear(p));
        dataset.point_fields[0].values.push_back(5.0);
    }
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    EXPECT_EQ(report.inverted, 0U);
    EXPECT_NEAR(total_volume(mesh), 5.0, volume_tolerance);
    ASSERT_EQ(mesh.points.size(), 13U);
    EXPECT_LT(mesh.points[12].x, 1.0);
    EXPECT_LT(mesh.points[12].y, 1.0);
    EXPECT_NEAR(mesh.point_fields[0].values[24], linear(mesh.points[12]), 1e-12);
    EXPECT_NEAR(mesh.point_fields[0].values[25], 5.0, 1e-12);
}

TEST(TetrahedralizeKinds, AHangingNodeGivesNoSliver) {
    // The unit cube with a point in the middle of an edge, moved a little inwards and outwards: two faces have five
    // vertices.
    for (const double depth : {0.0, 1e-9, -1e-9, 1e-3, -1e-3}) {
        std::vector<glm::dvec3> points = cube_corners;
        points.insert(points.begin(),
                      {0.5, depth, depth});  // between 1 and 2, the lowest id: every fan would start here
        const std::vector<VertexId> stream{6, 5, 1, 4, 3, 2, 0, 4, 5, 6, 7, 8, 5, 1, 0, 2, 6,
                                           5, 4, 2, 3, 7, 6, 4, 3, 4, 8, 7, 4, 4, 1, 5, 8};
        TetrahedralizeReport report;
        const TetMesh mesh = tetrahedralize(single_cell(CellKind::polyhedron, points, stream), &report);
        EXPECT_EQ(report.inverted, 0U) << depth;
        EXPECT_EQ(report.flat, 0U) << depth;
        EXPECT_NEAR(total_volume(mesh), 1.0, 2e-3);
        EXPECT_EQ(build_adjacency(mesh).overused_faces, 0U);
    }
}

TEST(TetrahedralizeFields, TheCentreGetsTheMeanOfTheVertices) {
    std::mt19937_64 random(10);
    Dataset dataset = as_polyhedron(single_cell(CellKind::hexahedron, cube_corners, counted(8)), random);
    dataset.point_fields = {{"s", 1, {0, 1, 2, 3, 4, 5, 6, 15}}};
    dataset.cell_fields = {{"c", 1, {7}}};
    const TetMesh mesh = tetrahedralize(dataset);
    ASSERT_EQ(mesh.points.size(), 9U);
    EXPECT_EQ(mesh.points[8], glm::dvec3(0.5));
    EXPECT_DOUBLE_EQ(mesh.point_fields[0].values[8], 4.5);
    EXPECT_EQ(mesh.cell_fields[0].values, std::vector<double>(12, 7.0));
}

}  // namespace
}  // namespace cellproj
