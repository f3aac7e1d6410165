// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tet_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/predicates.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace tet_mesh_test {

using testing_support::grid_mesh;
using testing_support::total_volume;
using testing_support::unit_tet;

TEST(FaceVertices, TurnCounterClockwiseSeenFromOutside) {
    const TetMesh mesh = unit_tet();
    for (int face = 0; face < 4; ++face) {
        const auto v = face_vertices(mesh.tets[0], face);
        // The vertex opposite to the face is on the inside, from where the face appears clockwise.
        EXPECT_EQ(orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]],
                              mesh.points[mesh.tets[0][static_cast<std::size_t>(face)]]),
                  -1)
            << "face " << face;
    }
}

TEST(OrientCells, TurnsNegativeCellsAndCountsFlatOnes) {
    TetMesh mesh = unit_tet();
    mesh.points.emplace_back(1, 1, 0);
    mesh.tets = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 1, 2, 4}};
    const OrientationCounts counts = orient_cells(mesh);
    EXPECT_EQ(counts.flipped, 1U);
    EXPECT_EQ(counts.flat, 1U);
    EXPECT_GT(signed_volume(mesh, 1), 0);
    EXPECT_EQ(mesh.tets[2], (std::array<VertexId, 4>{0, 1, 2, 4}));
}

TEST(Adjacency, GridHasTheFacesOfItsSurface) {
    const int n = 5;
    const TetMesh mesh = grid_mesh(n);
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(mesh.tets.size(), 5U * n * n * n);
    EXPECT_EQ(adjacency.overused_faces, 0U);
    EXPECT_EQ(boundary_faces(adjacency).size(), 12U * n * n);  // two triangles for each square of the cube's surface
    EXPECT_NEAR(total_volume(mesh), 1.0, 1e-12);                     // rounding of 625 volumes
}

TEST(Adjacency, NeighboursShareTheFaceAndKnowEachOther) {
    const TetMesh mesh = grid_mesh(4, 0.2, 7);
    const Adjacency adjacency = build_adjacency(mesh);
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        for (int face = 0; face < 4; ++face) {
            const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
            if (other == no_cell) continue;
            const auto& back = adjacency.neighbours[other];
            const auto i = std::find(back.begin(), back.end(), cell) - back.begin();
            ASSERT_LT(i, 4);
            auto mine = face_vertices(mesh.tets[cell], face);
            auto theirs = face_vertices(mesh.tets[other], static_cast<int>(i));
            std::sort(mine.begin(), mine.end());
            std::sort(theirs.begin(), theirs.end());
            EXPECT_EQ(mine, theirs);
        }
    }
}

// The boundary of a closed mesh encloses its volume: ∫ x·n/3 over the faces (divergence theorem).
TEST(BoundaryFaces, EncloseTheVolumeOfTheCells) {
    const TetMesh mesh = grid_mesh(6, 0.2, 3);
    double enclosed = 0;
    for (const auto& [cell, face] : boundary_faces(build_adjacency(mesh))) {
        const auto v = face_vertices(mesh.tets[cell], face);
        enclosed += glm::dot(mesh.points[v[0]], glm::cross(mesh.points[v[1]], mesh.points[v[2]])) / 6;
    }
    EXPECT_NEAR(enclosed, total_volume(mesh), 1e-12);
}

TEST(Adjacency, ThreeCellsAtAFacePairOnceAndAreCounted) {
    TetMesh mesh = unit_tet();
    mesh.points.emplace_back(-1, -1, -1);
    mesh.points.emplace_back(-2, -1, -1);
    mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}};
    orient_cells(mesh);
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(adjacency.overused_faces, 1U);
    EXPECT_EQ(std::count(adjacency.neighbours[0].begin(), adjacency.neighbours[0].end(), 1U), 1);
    EXPECT_EQ(adjacency.neighbours[2], (std::array<CellId, 4>{no_cell, no_cell, no_cell, no_cell}));
}

TEST(Adjacency, ACellWithARepeatedVertexIsNotItsOwnNeighbour) {
    TetMesh mesh = unit_tet();
    mesh.tets = {{0, 1, 2, 2}};
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(adjacency.neighbours[0], (std::array<CellId, 4>{no_cell, no_cell, no_cell, no_cell}));
}

TEST(Bounds, OfPoints) {
    const Bounds box = bounds({{1, -2, 3}, {-1, 5, 0}});
    EXPECT_EQ(box.low, glm::dvec3(-1, -2, 0));
    EXPECT_EQ(box.high, glm::dvec3(1, 5, 3));
    EXPECT_EQ(box.center(), glm::dvec3(0, 1.5, 1.5));
    EXPECT_DOUBLE_EQ(box.diagonal(), std::sqrt(4.0 + 49.0 + 9.0));
}

std::string message_of(const TetMesh& mesh) {
    try {
        validate(mesh, "m.vtu");
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::data);
        return error.what();
    }
    return {};
}

TEST(Validate, AcceptsAGoodMesh) { EXPECT_EQ(message_of(unit_tet()), ""); }

TEST(Validate, NamesPlaceAndOffender) {
    const auto broken = [](const std::function<void(TetMesh&)>& damage) {
        TetMesh mesh = unit_tet();
        damage(mesh);
        return message_of(mesh);
    };
    EXPECT_NE(broken([](TetMesh& m) { m.tets.clear(); }).find("at least one volume cell"), std::string::npos);
    EXPECT_NE(broken([](TetMesh& m) { m.tets[0][2] = 4; }).find("m.vtu, tetrahedron 0"), std::string::npos);
    EXPECT_NE(broken([](TetMesh& m) { m.points[3].y = std::numeric_limits<double>::quiet_NaN(); }).find("point 3"),
              std::string::npos);
    EXPECT_NE(broken([](TetMesh& m) { m.points[1].x = std::numeric_limits<double>::infinity(); }).find("point 1"),
              std::string::npos);
    EXPECT_NE(broken([](TetMesh& m) { m.point_fields.push_back({"p", 1, {1, 2, 3}}); }).find("field \"p\""),
              std::string::npos);
    EXPECT_NE(broken([](TetMesh& m) { m.cell_fields.push_back({"q", 3, {1, 2}}); }).find("field \"q\""),
              std::string::npos);
}

}  // namespace
}  // namespace cellproj
