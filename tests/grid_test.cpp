// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids: the same grid out of every format that holds one, and what is none told clearly.
#include "mesh/grid.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace grid_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Ten by three by two points at (1, 2, −1) + (i/2, j, 2k), valued 0, 1, 2, …
constexpr std::size_t point_count = 60;

std::string numbers(std::size_t count, bool as_text) {
    std::string list;
    for (std::size_t v = 0; v < count; ++v)
        list += as_text ? std::to_string(v) + " " : std::string(1, static_cast<char>(v));
    return list;
}

// An image as VTK XML text; `inside` goes into the tag of the image, `arrays` behind the field "v".
std::string vti(const std::string& inside, const std::string& cell_arrays, const std::string& point_arrays = "") {
    return "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 9 0 2 0 "
           "1\" " +
           inside + "><Piece Extent=\"0 9 0 2 0 1\"><PointData>" +
           "<DataArray type=\"Float64\" Name=\"v\" format=\"ascii\">" + numbers(point_count, true) + "</DataArray>" +
           point_arrays + "</PointData><CellData>" + cell_arrays + "</CellData></Piece></ImageData></VTKFile>\n";
}
const std::string placed = "Origin=\"1 2 -1\" Spacing=\"0.5 1 2\"";

std::string legacy_grid(const std::string& x, const std::string& y = "2 3 4", const std::string& z = "-1 1") {
    return "# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 10 3 2\nX_COORDINATES 10 "
           "double\n" +
           x + "\nY_COORDINATES 3 double\n" + y + "\nZ_COORDINATES 2 double\n" + z +
           "\nPOINT_DATA 60\nSCALARS v double\nLOOKUP_TABLE default\n" + numbers(point_count, true) + "\n";
}

Grid grid_of(const Dataset& dataset) {
    return make_grid(dataset, as_scalar(dataset.point_fields.at(0), FieldLocation::points));
}

Grid read_grid(const fs::path& file, const ReadOptions& options = {}) {
    return grid_of(read(file, options));
}

// The message of an Error of `make_grid` on what a file holds.
std::string grid_error(const fs::path& file) {
    const Dataset dataset = read(file);
    try {
        grid_of(dataset);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::data);
        EXPECT_NE(error.place().find(file.filename().string()), std::string::npos) << error.what();
        EXPECT_FALSE(error.advice().empty());
        return error.what();
    }
    return "no error";
}

void expect_the_grid(const Grid& grid) {
    validate(grid, "test");
    const GridDimensions n = grid.dimensions();
    ASSERT_EQ(n.ni, 10U);
    ASSERT_EQ(n.nj, 3U);
    ASSERT_EQ(n.nk, 2U);
    EXPECT_EQ(grid.cell_count(), 18U);
    EXPECT_TRUE(grid.blanked.empty());
    for (std::size_t i = 0; i < 10; ++i)
        EXPECT_EQ(grid.axes[0].coordinates[i], grid.axes[0].coordinates[0] + 0.5 * static_cast<double>(i));
    for (std::size_t v = 0; v < point_count; ++v)
        EXPECT_EQ(grid.values[v], static_cast<double>(v));
    EXPECT_EQ(grid.cell_edges({4, 1, 0}), glm::dvec3(0.5, 1, 2));
    EXPECT_EQ(grid.corner_values({4, 1, 0}), (std::array<double, 8>{14, 15, 24, 25, 44, 45, 54, 55}));
}

TEST(Grid, OutOfEveryFormatThatHoldsOne) {
    const std::string mha =
        "ObjectType = Image\nNDims = 3\nDimSize = 10 3 2\nElementSpacing = 0.5 1 2\nOffset = 1 2 -1\n"
        "ElementType = MET_UCHAR\nElementByteOrderMSB = False\nElementDataFile = LOCAL\n";
    const std::string nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 3 2\nspacings: 0.5 1 2\nencoding: raw\n\n";
    const std::string points =
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 10 3 2\n"
        "ORIGIN 1 2 -1\nSPACING 0.5 1 2\nPOINT_DATA 60\nSCALARS v double\nLOOKUP_TABLE default\n";
    for (const fs::path& file : {write("a.mha", mha + numbers(60, false)), write("a.nrrd", nrrd + numbers(60, false)),
                                 write("a.vti", vti(placed, "")), write("a.vtk", points + numbers(60, true))}) {
        SCOPED_TRACE(file);
        const Grid grid = read_grid(file);
        expect_the_grid(grid);
        EXPECT_EQ(grid.axes[0].spacing, 0.5);
        EXPECT_EQ(grid.axes[2].spacing, 2.0);
        if (file.extension() == ".nrrd") continue;  // this one has no origin
        EXPECT_EQ(grid.bounds().low, glm::dvec3(1, 2, -1));
        EXPECT_EQ(grid.bounds().high, glm::dvec3(5.5, 4, 1));
    }
    const RawVolume raw{.dimensions = {10, 3, 2}, .spacing = {0.5, 1, 2}, .origin = {1, 2, -1}};
    expect_the_grid(read_grid(write("a.raw", numbers(60, false)), {.raw = raw}));
    const Grid rectilinear = read_grid(write("b.vtk", legacy_grid("1 1.5 2 2.5 3 3.5 4 4.5 5 5.5")));
    expect_the_grid(rectilinear);
    EXPECT_FALSE(rectilinear.axes[0].spacing);
    EXPECT_EQ(rectilinear.cell_bounds({2, 1, 0}).high, glm::dvec3(2.5, 4, 1));
}

// Numbers of two and four bytes in either order, out of every format that says which: their values tell whether they were swapped.
TEST(Grid, EveryByteOrderGivesTheSameValues) {
    const auto bytes = [](bool big, std::size_t width, bool real) {
        std::string all;
        for (std::size_t v = 0; v < point_count; ++v) {
            const auto value = static_cast<float>(1000 * v);
            const std::uint32_t bits = real ? std::bit_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(1000 * v);
            for (std::size_t b = 0; b < width; ++b) all += static_cast<char>(bits >> 8 * (big ? width - 1 - b : b) & 0xFFU);
        }
        return all;
    };
    for (const bool big : {false, true})
        for (const bool real : {false, true}) {
            const std::string data = bytes(big, real ? 4 : 2, real);
            const std::string mha =
                "ObjectType = Image\nNDims = 3\nDimSize = 10 3 2\nElementSpacing = 0.5 1 2\nOffset = 1 2 -1\nElementType = " +
                std::string(real ? "MET_FLOAT" : "MET_USHORT") + "\nElementByteOrderMSB = " + (big ? "True" : "False") + "\nElementDataFile = LOCAL\n";
            const std::string nrrd = std::string("NRRD0004\ntype: ") + (real ? "float" : "ushort") +
                                     "\ndimension: 3\nsizes: 10 3 2\nspacings: 0.5 1 2\nendian: " + (big ? "big" : "little") + "\nencoding: raw\n\n";
            const RawVolume raw{.dimensions = {10, 3, 2}, .type = real ? NumberType::float32 : NumberType::uint16, .big_endian = big};
            for (const Grid& grid : {read_grid(write("o.mha", mha + data)), read_grid(write("o.nrrd", nrrd + data)), read_grid(write("o.raw", data), {.raw = raw})}) {
                SCOPED_TRACE(big ? "big" : "little");
                ASSERT_EQ(grid.values.size(), point_count);
                for (std::size_t v = 0; v < point_count; ++v) EXPECT_EQ(grid.values[v], static_cast<double>(1000 * v));
            }
        }
}

TEST(Grid, UnevenAxesKeepTheirSteps) {
    const Grid grid = read_grid(write("b.vtk", legacy_grid("1 1.125 2 3 5 8 13 21 34 1e6")));
    EXPECT_EQ(grid.cell_edges({0, 0, 0}).x, 0.125);
    EXPECT_EQ(grid.cell_edges({8, 0, 0}).x, 1e6 - 34);
}

// Turned round with its values: the scalar at a place stays.
TEST(Grid, AxesThatDescendAreTurned) {
    const Grid grid = read_grid(write("b.vtk", legacy_grid("5.5 5 4.5 4 3.5 3 2.5 2 1.5 1", "2 3 4", "1 -1")));
    validate(grid, "test");
    EXPECT_EQ(grid.bounds().low, glm::dvec3(1, 2, -1));
    EXPECT_EQ(grid.values[0], 9 + 30);            // the file's (9, 0, 1)
    EXPECT_EQ(grid.values[9 + 10 * 2], 20 + 30);  // its (0, 2, 1)
    const RawVolume raw{.dimensions = {10, 3, 2}, .spacing = {0.5, -1, 2}, .origin = {1, 4, -1}};
    const Grid mirrored = read_grid(write("a.raw", numbers(60, false)), {.raw = raw});
    validate(mirrored, "test");
    EXPECT_EQ(mirrored.axes[1].spacing, 1.0);
    EXPECT_EQ(mirrored.axes[1].coordinates, (std::vector<double>{2, 3, 4}));
    EXPECT_EQ(mirrored.values[0], 20);
}

// Cells that the file hides, and those that touch a value that is none, keep their places.
TEST(Grid, BlankedCellsAndMissingValues) {
    std::string ghosts, cells;
    for (std::size_t c = 0; c < 18; ++c) {
        ghosts += c == 4 || c == 17 ? "32 " : "0 ";  // vtkDataSetAttributes::HIDDENCELL
        cells += std::to_string(100 + c) + " ";
    }
    const std::string arrays = "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">" + ghosts +
                               "</DataArray><DataArray type=\"Float64\" Name=\"c\" format=\"ascii\">" + cells +
                               "</DataArray>";
    const Dataset dataset = read(write("holes.vti", vti(placed, arrays)));
    EXPECT_FALSE(dataset.grid);
    ASSERT_EQ(dataset.cell_count(), 16U);
    const Grid grid = grid_of(dataset);
    ASSERT_EQ(grid.blanked.size(), 18U);
    EXPECT_TRUE(grid.is_blanked({4, 0, 0}));
    EXPECT_TRUE(grid.is_blanked({8, 1, 0}));
    EXPECT_FALSE(grid.is_blanked({5, 0, 0}));
    EXPECT_EQ(grid.corner_values({5, 1, 0}), (std::array<double, 8>{15, 16, 25, 26, 45, 46, 55, 56}));
    EXPECT_TRUE(std::isnan(grid.values[59]));  // the last cell alone had it
    const auto number = as_scalar(field(dataset.cell_fields, "c"), FieldLocation::cells);
    const Grid constant = make_grid(dataset, number);
    EXPECT_EQ(constant.corner_values({5, 0, 0}), (std::array<double, 8>{105, 105, 105, 105, 105, 105, 105, 105}));
    EXPECT_EQ(constant.corner_values({7, 1, 0})[0], 116);

    const Dataset whole = read(write("whole.vti", vti(placed, "")));
    ScalarField broken = as_scalar(whole.point_fields[0], FieldLocation::points);
    broken.values[0] = nan;
    broken.values[15] = std::numeric_limits<double>::infinity();  // (5, 1, 0): four cells of the layer
    const Grid left = make_grid(whole, broken);
    validate(left, "test");
    EXPECT_EQ(std::count(left.blanked.begin(), left.blanked.end(), 1), 5);
    broken.values.assign(60, nan);
    EXPECT_THROW(make_grid(whole, broken), Error);
    broken.values.pop_back();
    EXPECT_THROW(make_grid(whole, broken), Error);
}

TEST(Grid, WhatIsNoneIsTold) {
    const auto x = [](const std::string& list) { return write("bad.vtk", legacy_grid(list)); };
    EXPECT_NE(
        grid_error(x("1 1.5 2 2.5 2.25 3.5 4 4.5 5 5.5")).find("axis x, point 4: expected coordinates that ascend"),
        std::string::npos);
    EXPECT_NE(grid_error(x("5 4 3 3.5 2 1.5 1.4 1.3 1 0")).find("axis x, point 3: expected coordinates that descend"),
              std::string::npos);
    EXPECT_NE(
        grid_error(x("1 1.5 2 2.5 2.5 3.5 4 4.5 5 5.5")).find("axis x, point 4: expected a coordinate other than"),
        std::string::npos);
    EXPECT_NE(grid_error(write("zero.vti", vti("Origin=\"1 2 -1\" Spacing=\"0.5 0 2\"", "")))
                  .find("axis y: expected a spacing"),
              std::string::npos);
    // Half a unit cannot be told from none beside 1e17.
    EXPECT_NE(grid_error(write("far.vti", vti("Origin=\"1e17 2 -1\" Spacing=\"0.5 1 2\"", ""))).find("another origin"),
              std::string::npos);
    const std::string turned = grid_error(write("turned.vti", vti(placed + " Direction=\"0 -1 0 1 0 0 0 0 1\"", "")));
    EXPECT_NE(turned.find("turned against the axes"), std::string::npos) << turned;
    Dataset mesh;
    mesh.source = "m";
    EXPECT_THROW(make_grid(mesh, {}), Error);
    // No volume: the reader says so.
    expect_error(
        write("flat.vtk",
              "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 10 6 1\nORIGIN 0 0 0\n"
              "SPACING 1 1 1\nPOINT_DATA 60\nSCALARS v double\nLOOKUP_TABLE default\n" +
                  numbers(60, true)),
        ErrorKind::data, "2 points in each direction");
    expect_error(write("short.raw", numbers(59, false)), ErrorKind::format, "60 bytes",
                 {.raw = RawVolume{.dimensions = {10, 3, 2}}});
}

TEST(Grid, ValidateNamesWhatIsWrong) {
    const Grid sound{
        {uniform_axis(0, 1, 2), uniform_axis(0, 1, 3), uniform_axis(0, 1, 2)}, FieldLocation::cells, {1, 2}, {}};
    validate(sound, "hand");
    const auto expect = [&](const std::string& words, auto change) {
        Grid grid = sound;
        change(grid);
        try {
            validate(grid, "hand");
            FAIL() << words;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    expect("axis y: expected at least 2 points", [](Grid& g) { g.axes[1] = uniform_axis(0, 1, 1); });
    expect("axis z: expected coordinates that ascend", [](Grid& g) { g.axes[2] = uniform_axis(0, -1, 2); });
    expect("axis x, point 1: expected a finite", [](Grid& g) {
        g.axes[0].coordinates[1] = nan;
        g.axes[0].spacing.reset();
    });
    expect("2 values", [](Grid& g) { g.values.push_back(3); });
    expect("a mark for each", [](Grid& g) { g.blanked = {1}; });
    expect("cell 1: expected finite", [](Grid& g) { g.values[1] = nan; });
    Grid blanked = sound;
    blanked.values[1] = nan;
    blanked.blanked = {0, 1};
    validate(blanked, "hand");
}

TEST(Grid, CornerWeightsAreTrilinear) {
    EXPECT_EQ(corner_weights({1, 0, 1}), (std::array<double, 8>{0, 0, 0, 0, 0, 1, 0, 0}));
    EXPECT_EQ(corner_weights({0.25, 1, 0}), (std::array<double, 8>{0, 0, 0.75, 0.25, 0, 0, 0, 0}));
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < 100; ++trial) {
        const glm::dvec3 u(unit(random), unit(random), unit(random));
        const auto f = [](double x, double y, double z) { return 1 + x - 2 * y * z + 3 * x * y * z; };
        const std::array<double, 8> corners{f(0, 0, 0), f(1, 0, 0), f(0, 1, 0), f(1, 1, 0),
                                            f(0, 0, 1), f(1, 0, 1), f(0, 1, 1), f(1, 1, 1)};
        EXPECT_NEAR(interpolate(corners, u), f(u.x, u.y, u.z), 1e-14);  // a few roundings of numbers below 8
    }
}

// The real files: the grid has the points of the mesh that is drawn as tetrahedra, with the values there.
class SharedGrids : public ReadSharedData {};

TEST_F(SharedGrids, TheGridIsThatOfTheTetrahedra) {
    std::size_t uneven = 0;
    for (const char* name : {"volumes/hydrogen.vti", "volumes/RectGrid2.vtk", "volumes/neghip.slc",
                             "volumes/HeadMRVolume.mhd", "volumes/nrrd/BallBinary30x30x30_gz.nrrd"}) {
        SCOPED_TRACE(name);
        const Dataset dataset = read(data / name);
        ASSERT_TRUE(dataset.boxes);
        ASSERT_FALSE(dataset.point_fields.empty());
        const ScalarField scalar = as_scalar(dataset.point_fields[0], FieldLocation::points);
        const Grid grid = make_grid(dataset, scalar);
        validate(grid, name);
        EXPECT_EQ(grid.values, scalar.values);
        const GridDimensions n = grid.dimensions();
        ASSERT_EQ(dataset.points.size(), n.ni * n.nj * n.nk);
        std::size_t p = 0, wrong = 0;
        for (std::size_t k = 0; k < n.nk; ++k) {
            for (std::size_t j = 0; j < n.nj; ++j) {
                for (std::size_t i = 0; i < n.ni; ++i)
                    wrong += dataset.points[p++] != glm::dvec3(grid.axes[0].coordinates[i], grid.axes[1].coordinates[j],
                                                               grid.axes[2].coordinates[k]);
            }
        }
        EXPECT_EQ(wrong, 0U);
        uneven += grid.axes[0].spacing ? 0 : 1;
    }
    EXPECT_EQ(uneven, 1U);
}

}  // namespace
}  // namespace cellproj
