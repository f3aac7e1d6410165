// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tetrahedralize.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "mesh/error.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace tetrahedralize_test {

using testing_support::cube_corners;
using testing_support::single_cell;
using testing_support::total_volume;

// The points of an ni x nj x nk grid in the order of GridDimensions, unit spacing, each moved by up to `jitter`.
std::vector<glm::dvec3> grid_points(const GridDimensions& grid, double jitter, std::mt19937_64& random) {
    std::uniform_real_distribution<double> moved(-jitter, jitter);
    std::vector<glm::dvec3> points;
    for (std::size_t k = 0; k < grid.nk; ++k) {
        for (std::size_t j = 0; j < grid.nj; ++j) {
            for (std::size_t i = 0; i < grid.ni; ++i) {
                points.emplace_back(static_cast<double>(i) + moved(random), static_cast<double>(j) + moved(random),
                                    static_cast<double>(k) + moved(random));
            }
        }
    }
    return points;
}

// The vertex orders under which a hexahedron stays itself: the 24 rotations of the cube, as corner numbers of VTK.
std::vector<std::array<std::size_t, 8>> cube_rotations() {
    constexpr std::array<std::size_t, 8> identity{0, 1, 2, 3, 4, 5, 6, 7};
    constexpr std::array<std::size_t, 8> about_z{1, 2, 3, 0, 5, 6, 7, 4};
    constexpr std::array<std::size_t, 8> about_x{3, 2, 6, 7, 0, 1, 5, 4};
    const auto apply = [](const auto& first, const auto& then) {
        std::array<std::size_t, 8> result{};
        for (std::size_t i = 0; i < 8; ++i)
            result[i] = first[then[i]];
        return result;
    };
    std::vector<std::array<std::size_t, 8>> all{identity};
    for (std::size_t n = 0; n < all.size(); ++n) {
        for (const auto& turned : {apply(all[n], about_z), apply(all[n], about_x)}) {
            if (std::find(all.begin(), all.end(), turned) == all.end()) all.push_back(turned);
        }
    }
    return all;
}

Dataset curvilinear(const GridDimensions& grid, double jitter, std::mt19937_64& random) {
    Dataset dataset;
    dataset.source = "grid";
    dataset.points = grid_points(grid, jitter, random);
    dataset.grid = grid;
    return dataset;
}

// The same block as unstructured hexahedra: point ids randomly permuted, each cell randomly rotated.
Dataset shuffled_hexahedra(const GridDimensions& grid, double jitter, std::mt19937_64& random) {
    Dataset dataset;
    dataset.source = "block";
    const std::vector<glm::dvec3> points = grid_points(grid, jitter, random);
    std::vector<VertexId> new_id(points.size());
    std::iota(new_id.begin(), new_id.end(), 0U);
    std::shuffle(new_id.begin(), new_id.end(), random);
    dataset.points.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p)
        dataset.points[new_id[p]] = points[p];

    const auto rotations = cube_rotations();
    constexpr std::array<std::array<std::size_t, 3>, 8> corners{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    dataset.cells.offsets = {0};
    for (std::size_t c = 0; c < grid.cells(); ++c) {
        const std::size_t i = c % (grid.ni - 1);
        const std::size_t j = c / (grid.ni - 1) % (grid.nj - 1);
        const std::size_t k = c / ((grid.ni - 1) * (grid.nj - 1));
        for (const std::size_t corner : rotations[random() % rotations.size()]) {
            const auto& d = corners[corner];
            dataset.cells.vertices.push_back(new_id[i + d[0] + grid.ni * (j + d[1] + grid.nj * (k + d[2]))]);
        }
        dataset.cells.kinds.push_back(CellKind::hexahedron);
        dataset.cells.offsets.push_back(dataset.cells.vertices.size());
    }
    return dataset;
}

// Two triangles for each quadrilateral on the surface of the block.
std::size_t surface_triangles(const GridDimensions& grid) {
    const std::size_t a = grid.ni - 1, b = grid.nj - 1, c = grid.nk - 1;
    return 4 * (a * b + b * c + c * a);
}

void expect_conformal(const TetMesh& mesh, const GridDimensions& grid) {
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(adjacency.overused_faces, 0U);
    EXPECT_EQ(boundary_faces(adjacency).size(), surface_triangles(grid));
}

// Sums of n volumes below 1 in float64 are off by less than n·n·2^-53; the largest n here is 2000.
constexpr double volume_tolerance = 1e-9;

TEST(CubeRotations, AreTwentyFour) {
    EXPECT_EQ(cube_rotations().size(), 24U);
}

TEST(TetrahedralizeGrid, CutsACellIntoFive) {
    std::mt19937_64 random(1);
    const GridDimensions grid{2, 2, 2};
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(curvilinear(grid, 0.0, random), &report);
    EXPECT_EQ(report.tets, 5U);
    EXPECT_EQ(report.flipped, 0U);
    EXPECT_EQ(report.flat, 0U);
    std::vector<double> volumes;
    for (CellId t = 0; t < 5; ++t)
        volumes.push_back(signed_volume(mesh, t));
    std::sort(volumes.begin(), volumes.end());
    for (int t = 0; t < 4; ++t)
        EXPECT_DOUBLE_EQ(volumes[static_cast<std::size_t>(t)], 1.0 / 6.0);
    EXPECT_DOUBLE_EQ(volumes[4], 1.0 / 3.0);
}

TEST(TetrahedralizeGrid, NeighboursAgreeAndTheVolumeIsKept) {
    for (const GridDimensions grid : {GridDimensions{2, 2, 5}, GridDimensions{4, 3, 2}, GridDimensions{6, 7, 5}}) {
        std::mt19937_64 random(2);
        TetrahedralizeReport report;
        const TetMesh mesh = tetrahedralize(curvilinear(grid, 0.0, random), &report);
        EXPECT_EQ(report.tets, 5 * grid.cells());
        EXPECT_EQ(report.flipped, 0U);
        EXPECT_NEAR(total_volume(mesh), static_cast<double>(grid.cells()), volume_tolerance);
        expect_conformal(mesh, grid);
    }
}

TEST(TetrahedralizeGrid, LeftHandedGridsAreTurned) {
    std::mt19937_64 random(3);
    const GridDimensions grid{3, 4, 5};
    Dataset dataset = curvilinear(grid, 0.1, random);
    for (glm::dvec3& p : dataset.points)
        p.x = -p.x;
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    EXPECT_EQ(report.flipped, report.tets);
    EXPECT_GT(total_volume(mesh), 0.0);
    expect_conformal(mesh, grid);
}

TEST(TetrahedralizeGrid, KeepsFlatCells) {
    std::mt19937_64 random(4);
    const GridDimensions grid{3, 3, 3};
    Dataset dataset = curvilinear(grid, 0.0, random);
    for (glm::dvec3& p : dataset.points)
        p.z = 0.0;
    TetrahedralizeReport report;
    tetrahedralize(dataset, &report);
    EXPECT_EQ(report.tets, 40U);
    EXPECT_EQ(report.flat, 40U);
}

TEST(TetrahedralizeHexahedra, NeighboursAgreeWhateverTheNumbering) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random(seed);
        const GridDimensions grid{5, 4, 6};
        TetrahedralizeReport report;
        const TetMesh mesh = tetrahedralize(shuffled_hexahedra(grid, 0.0, random), &report);
        EXPECT_EQ(report.tets, 6 * grid.cells());
        EXPECT_EQ(report.flipped, 0U);
        EXPECT_EQ(report.flat, 0U);
        EXPECT_NEAR(total_volume(mesh), static_cast<double>(grid.cells()), volume_tolerance);
        expect_conformal(mesh, grid);
    }
}

TEST(TetrahedralizeHexahedra, CurvedFacesLeaveNoGapsAndNoOverlaps) {
    // Faces that are not planar: each hexahedron's volume depends on the diagonals, but what one gains its neighbour
    // loses. The block's surface is kept planar, so the sum is the block's volume.
    std::mt19937_64 random(5);
    const GridDimensions grid{5, 4, 6};
    const glm::dvec3 high(4, 3, 5);
    Dataset dataset = shuffled_hexahedra(grid, 0.2, random);
    for (glm::dvec3& p : dataset.points) {
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(p[axis]) <= 0.2) p[axis] = 0.0;
            if (std::abs(p[axis] - high[axis]) <= 0.2) p[axis] = high[axis];
        }
    }
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    EXPECT_EQ(report.flipped, 0U);  // moves of a fifth of the spacing invert no corner
    EXPECT_NEAR(total_volume(mesh), 60.0, volume_tolerance);
    expect_conformal(mesh, grid);
}

TEST(TetrahedralizeHexahedra, ACollapsedHexahedronGivesNoTetWithARepeatedVertex) {
    // A wedge stored as a hexahedron: the edges 2-3 and 6-7 have shrunk to the points 2 and 5.
    const std::vector<glm::dvec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    std::array<VertexId, 6> new_id{0, 1, 2, 3, 4, 5};
    do {
        std::vector<glm::dvec3> moved(6);
        for (std::size_t p = 0; p < 6; ++p)
            moved[new_id[p]] = points[p];
        std::vector<VertexId> cell;
        for (const std::size_t p : {0, 1, 2, 2, 3, 4, 5, 5})
            cell.push_back(new_id[p]);
        TetrahedralizeReport report;
        const TetMesh mesh = tetrahedralize(single_cell(CellKind::hexahedron, moved, cell), &report);
        EXPECT_EQ(report.tets, 3U);
        EXPECT_EQ(report.flat, 0U);
        EXPECT_EQ(report.flipped, 0U);
        EXPECT_NEAR(total_volume(mesh), 0.5, volume_tolerance);
        EXPECT_EQ(boundary_faces(build_adjacency(mesh)).size(), 8U);  // two triangles, three quadrilaterals
    } while (std::next_permutation(new_id.begin(), new_id.end()));
}

TEST(TetrahedralizeCells, TetrahedraStayAsTheyAre) {
    const Dataset dataset = single_cell(CellKind::tetrahedron, cube_corners, {7, 0, 1, 3});
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    ASSERT_EQ(mesh.tets.size(), 1U);
    EXPECT_EQ(mesh.tets[0][0], 7U);
    EXPECT_EQ(report.flipped, 1U);
    EXPECT_GT(signed_volume(mesh, 0), 0.0);
}

TEST(TetrahedralizeFields, CellRowsAreRepeatedAndPointRowsKept) {
    Dataset dataset;
    dataset.source = "mixed";
    dataset.points = cube_corners;
    dataset.points.push_back({0.5, 0.5, 2});
    dataset.cells = {{CellKind::tetrahedron, CellKind::hexahedron, CellKind::tetrahedron},
                     {0, 4, 12, 16},
                     {4, 5, 7, 8, 0, 1, 2, 3, 4, 5, 6, 7, 5, 6, 7, 8}};
    dataset.point_fields = {{"s", 1, {0, 1, 2, 3, 4, 5, 6, 7, 8}}};
    dataset.cell_fields = {{"v", 2, {10, 11, 20, 21, 30, 31}}};
    const TetMesh mesh = tetrahedralize(dataset);
    EXPECT_EQ(mesh.point_fields[0].values, dataset.point_fields[0].values);
    std::vector<double> expected{10, 11};
    for (int n = 0; n < 6; ++n)
        expected.insert(expected.end(), {20, 21});
    expected.insert(expected.end(), {30, 31});
    EXPECT_EQ(mesh.cell_fields[0].name, "v");
    EXPECT_EQ(mesh.cell_fields[0].components, 2);
    EXPECT_EQ(mesh.cell_fields[0].values, expected);
}

TEST(TetrahedralizeFields, GridCellRowsAreRepeatedFiveTimes) {
    std::mt19937_64 random(6);
    Dataset dataset = curvilinear({3, 2, 2}, 0.0, random);
    dataset.cell_fields = {{"c", 1, {1, 2}}};
    EXPECT_EQ(tetrahedralize(dataset).cell_fields[0].values, (std::vector<double>{1, 1, 1, 1, 1, 2, 2, 2, 2, 2}));
}

ErrorKind kind_of_error(const Dataset& dataset) {
    try {
        tetrahedralize(dataset);
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(dataset.source), std::string::npos);
        return error.kind();
    }
    throw std::logic_error("no error was thrown");
}

TEST(TetrahedralizeErrors, UnusableDatasetsAreRefused) {
    Dataset empty;
    empty.source = "empty";
    empty.cells.offsets = {0};
    EXPECT_EQ(kind_of_error(empty), ErrorKind::data);
    EXPECT_EQ(kind_of_error(single_cell(CellKind::tetrahedron, cube_corners, {0, 1, 2, 8})), ErrorKind::data);
    Dataset not_finite = single_cell(CellKind::tetrahedron, cube_corners, {0, 1, 3, 4});
    not_finite.points[6].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(kind_of_error(not_finite), ErrorKind::data);
    Dataset short_cell_field = single_cell(CellKind::hexahedron, cube_corners, {0, 1, 2, 3, 4, 5, 6, 7});
    short_cell_field.cell_fields = {{"c", 3, {1, 2}}};
    EXPECT_EQ(kind_of_error(short_cell_field), ErrorKind::data);
    Dataset short_point_field = single_cell(CellKind::hexahedron, cube_corners, {0, 1, 2, 3, 4, 5, 6, 7});
    short_point_field.point_fields = {{"s", 1, {1, 2}}};
    EXPECT_EQ(kind_of_error(short_point_field), ErrorKind::data);
    EXPECT_EQ(kind_of_error(single_cell(CellKind::wedge, cube_corners, {0, 1, 2, 3, 4})), ErrorKind::data);
    const std::vector<std::vector<VertexId>> broken_streams{
        {}, {4, 3, 0, 1, 2}, {1, 3, 0, 1}, {1, 2, 0, 1, 2}, {1, 0xffffffffU, 0}, {1, 3, 0, 1, 8}};
    for (const auto& stream : broken_streams)
        EXPECT_EQ(kind_of_error(single_cell(CellKind::polyhedron, cube_corners, stream)), ErrorKind::data);
}

// The mean of such points is infinite, and an infinite point has no sign on any side.
TEST(Tetrahedralize, ACentreThatOverflowsIsAnError) {
    std::vector<glm::dvec3> huge;
    for (const glm::dvec3& p : cube_corners)
        huge.push_back(1.5e308 * p);
    const std::vector<VertexId> stream{6, 4, 0, 3, 2, 1, 4, 4, 5, 6, 7, 4, 0, 1, 5, 4,
                                       4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 0, 4, 7};
    EXPECT_EQ(kind_of_error(single_cell(CellKind::polyhedron, huge, stream)), ErrorKind::data);
}

}  // namespace
}  // namespace cellproj
