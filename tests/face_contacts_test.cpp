// SPDX-License-Identifier: BSD-3-Clause
//
// Faces that lie on each other without sharing their points. What must be found is counted by hand on grids; it must not
// depend on where the grids are, how large they are, how they are turned, and what rounding did to them.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "mesh/box_tree.hpp"
#include "mesh/check.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace face_contacts_test {

using testing_support::grid_mesh;

using Map = std::function<glm::dvec3(const glm::dvec3&)>;

TetMesh mapped(TetMesh mesh, const Map& map) {
    for (glm::dvec3& p : mesh.points) p = map(p);
    return mesh;
}

TetMesh moved(const TetMesh& mesh, const glm::dvec3& by) {
    return mapped(mesh, [&](const glm::dvec3& p) { return p + by; });
}

// Both, each with its own points.
TetMesh together(TetMesh a, const TetMesh& b) {
    const auto first = static_cast<VertexId>(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const auto& t : b.tets) a.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
    return a;
}

// One point per place.
TetMesh with_points_merged(const TetMesh& mesh) {
    TetMesh result;
    std::map<std::tuple<double, double, double>, VertexId> ids;
    std::vector<VertexId> renamed;
    for (const glm::dvec3& p : mesh.points) {
        const auto [at, is_new] = ids.try_emplace({p.x, p.y, p.z}, static_cast<VertexId>(result.points.size()));
        if (is_new) result.points.push_back(p);
        renamed.push_back(at->second);
    }
    for (const auto& t : mesh.tets) result.tets.push_back({renamed[t[0]], renamed[t[1]], renamed[t[2]], renamed[t[3]]});
    return result;
}

MeshCheck check_mesh(TetMesh mesh) {
    orient_cells(mesh);
    return check(mesh, build_adjacency(mesh));
}

struct Expected {
    std::size_t hanging = 0, crossing = 0, seams = 0;
};

void expect(const TetMesh& mesh, const Expected& expected) {
    const MeshCheck result = check_mesh(mesh);
    EXPECT_EQ(result.hanging_points.count, expected.hanging);
    EXPECT_EQ(result.crossing_faces.count, expected.crossing);
    EXPECT_EQ(result.seam_faces.count, expected.seams);
    EXPECT_EQ(result.overlapping_cells.count, 0U);
    EXPECT_EQ(result.faithful(), expected.hanging + expected.crossing == 0);
}

glm::dmat3 rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const glm::dvec3 x = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 z = glm::normalize(glm::cross(x, glm::dvec3(normal(random), normal(random), normal(random))));
    return {x, glm::cross(z, x), z};
}

std::vector<std::pair<std::string, Map>> placements() {
    std::vector<std::pair<std::string, Map>> maps{
        {"as it is", [](const glm::dvec3& p) { return p; }},
        {"far", [](const glm::dvec3& p) { return 1e-3 * p + glm::dvec3(1e6, -1e6, 1e6); }},
        {"tiny", [](const glm::dvec3& p) { return 1e-9 * p; }},
        {"huge", [](const glm::dvec3& p) { return 1e9 * p; }},
        {"stretched", [](const glm::dvec3& p) { return p * glm::dvec3(1e-3, 1.0, 30.0); }}};
    std::mt19937_64 random(7);
    for (int i = 0; i < 6; ++i) {
        const glm::dmat3 turn = rotation(random);
        maps.emplace_back("turned", [=](const glm::dvec3& p) { return turn * p; });
        maps.emplace_back("turned, far", [=](const glm::dvec3& p) { return 1e-3 * (turn * p) + glm::dvec3(1e6, 2e5, -1e6); });
        maps.emplace_back("turned, float32", [=](const glm::dvec3& p) { return glm::dvec3(glm::vec3(turn * p + 3.0)); });
    }
    return maps;
}

void expect_everywhere(const TetMesh& mesh, const Expected& expected) {
    for (const auto& [name, map] : placements()) {
        SCOPED_TRACE(name);
        expect(mapped(mesh, map), expected);
    }
}

const glm::dvec3 beside{1, 0, 0};

TEST(FaceContacts, GoodMeshesHaveNone) {
    expect_everywhere(grid_mesh(3), {});
    expect(grid_mesh(5, 0.2, 9), {});
}

// A box stays convex when its sides are no longer planes to the last bit.
TEST(FaceContacts, RoundingMakesNoDents) {
    for (const auto& [name, map] : placements()) EXPECT_TRUE(check_mesh(mapped(grid_mesh(3), map)).convex) << name;
    const Map dent = [](const glm::dvec3& p) { return p.z == 1.0 && p.x > 0 && p.x < 1 ? p - glm::dvec3(0, 0, 1e-4) : p; };
    EXPECT_FALSE(check_mesh(mapped(grid_mesh(3), dent)).convex);
}

// All points of the interface hang but the common ones: 25 − 9 where one grid refines the other, (9 − 4) + (16 − 4) where
// only the corners meet.
TEST(FaceContacts, HangingPointsOfGridsThatDoNotMatch) {
    expect_everywhere(together(grid_mesh(2), moved(grid_mesh(4), beside)), {.hanging = 16});
    expect_everywhere(together(grid_mesh(2), moved(grid_mesh(3), beside)), {.hanging = 17});
    expect(with_points_merged(together(grid_mesh(2), moved(grid_mesh(4), beside))), {.hanging = 16});
}

TEST(FaceContacts, HangingPointsAreToldById) {
    const TetMesh mesh = together(grid_mesh(1), moved(grid_mesh(2), beside));
    const MeshCheck result = check_mesh(mesh);
    ASSERT_EQ(result.hanging_points.count, 5U);
    for (const std::size_t v : result.hanging_points.first) {
        EXPECT_EQ(mesh.points[v].x, 1.0);
        EXPECT_TRUE(mesh.points[v].y == 0.5 || mesh.points[v].z == 0.5);
    }
}

// The alternating split of a grid of odd size does not fit to its own copy: two faces on each side of each quadrangle.
TEST(FaceContacts, DisagreeingDiagonals) {
    expect_everywhere(together(grid_mesh(1), moved(grid_mesh(1), beside)), {.crossing = 4});
    const TetMesh pair = together(grid_mesh(3), moved(grid_mesh(3), beside));
    expect_everywhere(pair, {.crossing = 36});
    expect(with_points_merged(pair), {.crossing = 36});
    EXPECT_EQ(check_mesh(with_points_merged(pair)).components, 2U);
}

// Quadrangles that are not planar, where the two cuts leave gaps and overlaps between them.
TEST(FaceContacts, DisagreeingDiagonalsOfWarpedFaces) {
    const auto warped = [](const TetMesh& mesh) {
        return mapped(mesh, [](const glm::dvec3& p) { return p + glm::dvec3(0.1 * std::sin(4 * p.y) * std::sin(5 * p.z), 0, 0); });
    };
    const TetMesh odd = warped(together(grid_mesh(3), moved(grid_mesh(3), beside)));
    expect(odd, {.crossing = 36});
    expect(with_points_merged(odd), {.crossing = 36});
    expect(warped(together(grid_mesh(2), moved(grid_mesh(2), beside))), {.seams = 8});
}

TEST(FaceContacts, SeamsOfBlocksThatMatch) {
    const TetMesh seam = together(grid_mesh(2), moved(grid_mesh(2), beside));
    expect_everywhere(seam, {.seams = 8});
    const MeshCheck result = check_mesh(seam);
    EXPECT_TRUE(result.faithful());
    EXPECT_FALSE(result.convex);
    EXPECT_EQ(result.components, 2U);
    EXPECT_EQ(result.cavities, 0U);
    EXPECT_EQ(result.coincident_points.count, 9U);
    // Joined, nothing is left of it.
    expect(with_points_merged(seam), {});
    EXPECT_TRUE(check_mesh(with_points_merged(seam)).convex);
}

// Both sides written by different programs: nearly the same points.
TEST(FaceContacts, SeamsUpToRounding) {
    const auto placed = [](const glm::dvec3& p) { return (p + 0.1) / 7.0; };
    const auto placed_alike = [](const glm::dvec3& p) { return p * (1.0 / 7.0) + 0.1 / 7.0; };
    const TetMesh left = mapped(grid_mesh(2), placed), right = mapped(moved(grid_mesh(2), beside), placed_alike);
    expect(together(left, right), {.seams = 8});
    EXPECT_LT(check_mesh(together(left, right)).coincident_points.count, 9U);  // some differ in the last bit
}

TEST(FaceContacts, BoxesThatTouchInParts) {
    const TetMesh box = grid_mesh(1);
    expect_everywhere(together(box, moved(box, {1, 1, 1})), {});     // a vertex
    expect_everywhere(together(box, moved(box, {1, 1, 0})), {});     // an edge
    expect_everywhere(together(box, moved(box, {1, 1, 0.5})), {});   // part of an edge
    expect_everywhere(together(box, moved(box, {1, 0.5, 0.25})), {.hanging = 2});  // a corner of each lies in a face of the other
}

TEST(FaceContacts, GapsAndThinPlatesAreNoContacts) {
    const TetMesh box = grid_mesh(2);
    expect(together(box, moved(box, {1 + 1e-4, 0, 0})), {});
    const Map opened = [](const glm::dvec3& p) { return p + glm::dvec3(1e-3 * p.z, 0, 0); };  // a wedge of air between them
    expect(together(box, mapped(moved(box, beside), opened)), {});
    expect(mapped(grid_mesh(2), [](const glm::dvec3& p) { return p * glm::dvec3(1, 1, 1e-5); }), {});
    expect(mapped(grid_mesh(2), [](const glm::dvec3& p) { return p * glm::dvec3(1, 1, 1e-12); }), {});
}

// A missing cell is a cavity, not a face cut twice.
TEST(FaceContacts, AMissingTetrahedronIsACavity) {
    TetMesh mesh = grid_mesh(3);
    std::erase_if(mesh.tets, [&](const auto& tet) {
        glm::dvec3 centroid(0);
        for (const VertexId v : tet) centroid += 0.25 * mesh.points[v];
        return glm::distance(centroid, glm::dvec3(0.5)) < 1e-6;
    });
    expect(mesh, {});
    EXPECT_EQ(check_mesh(mesh).cavities, 1U);
}

TEST(FaceContacts, MeshesInEachOtherOverlap) {
    const TetMesh box = grid_mesh(1);
    const MeshCheck twice = check_mesh(together(box, box));
    EXPECT_EQ(twice.overlapping_cells.count, 4U);  // the cells that hold the box's faces
    EXPECT_FALSE(twice.faithful());
    EXPECT_GT(check_mesh(together(box, moved(box, {0.5, 0, 0}))).overlapping_cells.count, 0U);
}

TEST(BoxTree, FindsWhatTouches) {
    std::mt19937_64 random(3);
    std::uniform_int_distribution<int> coarse(0, 20), size(0, 4);  // integers: boxes that just touch are common
    std::vector<Bounds> boxes;
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 low(coarse(random), coarse(random), coarse(random));
        boxes.push_back({low, low + glm::dvec3(size(random), size(random), size(random))});
    }
    const BoxTree tree(boxes);
    for (const Bounds& box : boxes) {
        std::vector<std::size_t> found, expected;
        tree.visit_touching(box, [&](std::size_t i) { found.push_back(i); });
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            bool touch = true;
            for (int k = 0; k < 3; ++k) touch = touch && boxes[i].low[k] <= box.high[k] && box.low[k] <= boxes[i].high[k];
            if (touch) expected.push_back(i);
        }
        std::sort(found.begin(), found.end());
        ASSERT_EQ(found, expected);
    }
    BoxTree({}).visit_touching(boxes[0], [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace cellproj
