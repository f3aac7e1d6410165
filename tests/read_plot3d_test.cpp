// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/read.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "mesh/error.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace read_plot3d_test {

struct Plot3dForm {
    bool big_endian, records, block_count, double_precision, iblank;
};

class Plot3dWriter {
public:
    explicit Plot3dWriter(const Plot3dForm& form) : form_(form) {}

    void integer(std::int32_t value) { append(value); }
    void real(double value) {
        if (form_.double_precision) {
            append(value);
        } else {
            append(static_cast<float>(value));
        }
    }
    void end_group() {
        const auto length = static_cast<std::int32_t>(group_.size());
        std::string group;
        std::swap(group, group_);
        if (form_.records) integer(length);
        bytes_ += std::exchange(group_, "") + group;
        if (form_.records) integer(length);
        bytes_ += std::exchange(group_, "");
    }
    const std::string& bytes() const { return bytes_; }

    void header(const std::vector<std::array<int, 3>>& blocks) {
        if (form_.block_count) {
            integer(static_cast<std::int32_t>(blocks.size()));
            end_group();
        }
        for (const auto& dims : blocks) {
            for (const int n : dims)
                integer(n);
        }
        end_group();
    }

private:
    template <class T>
    void append(T value) {
        std::string bytes(sizeof value, '\0');
        std::memcpy(bytes.data(), &value, sizeof value);
        if (form_.big_endian == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
        group_ += bytes;
    }

    Plot3dForm form_;
    std::string group_, bytes_;
};

constexpr std::array<int, 3> dims{3, 4, 5};

// Point (i, j, k) at (i, 10 j, 100 k); IBLANK as given everywhere but at point 7, which gets `seventh`.
std::string plot3d_grid(const Plot3dForm& form, int seventh = 1,
                        const std::vector<std::array<int, 3>>& blocks = {dims}) {
    Plot3dWriter writer(form);
    writer.header(blocks);
    for (const auto& [ni, nj, nk] : blocks) {
        const int count = ni * nj * nk;
        for (int p = 0; p < count; ++p)
            writer.real(p % ni);
        for (int p = 0; p < count; ++p)
            writer.real(10 * (p / ni % nj));
        for (int p = 0; p < count; ++p)
            writer.real(100 * (p / (ni * nj)));
        for (int p = 0; form.iblank && p < count; ++p)
            writer.integer(p == 7 ? seventh : 1);
        writer.end_group();
    }
    return writer.bytes();
}

// Density 1 + p, momentum (2 p, 0, 0), stagnation energy 50.
std::string plot3d_solution(const Plot3dForm& form, const std::vector<std::array<int, 3>>& blocks = {dims}) {
    Plot3dWriter writer(form);
    writer.header(blocks);
    for (const std::array<int, 3>& size : blocks) {
        for (const double free_stream : {2.0, 0.0, 1e6, 0.0})
            writer.real(free_stream);
        writer.end_group();
        const int count = size[0] * size[1] * size[2];
        for (int p = 0; p < count; ++p)
            writer.real(1 + p);
        for (int p = 0; p < count; ++p)
            writer.real(2 * p);
        for (int p = 0; p < 2 * count; ++p)
            writer.real(0);
        for (int p = 0; p < count; ++p)
            writer.real(50);
        writer.end_group();
    }
    return writer.bytes();
}

constexpr Plot3dForm plain{true, false, false, false, false};

const Field& field_named(const Dataset& dataset, const std::string& name) {
    for (const Field& field : dataset.point_fields) {
        if (field.name == name) return field;
    }
    throw std::logic_error("no field " + name);
}

TEST(ReadPlot3d, FindsOutEveryLayout) {
    for (int bits = 0; bits < 32; ++bits) {
        const Plot3dForm form{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0, (bits & 16) != 0};
        SCOPED_TRACE("layout " + std::to_string(bits));
        const fs::path grid = write("grid.xyz", plot3d_grid(form));
        const fs::path solution = write("solution.q", plot3d_solution(form));
        const Dataset dataset = read(grid, {solution});
        EXPECT_EQ(dataset.format, "PLOT3D curvilinear grid");
        ASSERT_TRUE(dataset.grid);
        EXPECT_EQ(dataset.grid->ni, 3U);
        EXPECT_EQ(dataset.grid->nj, 4U);
        EXPECT_EQ(dataset.grid->nk, 5U);
        EXPECT_EQ(dataset.cell_count(), 24U);
        ASSERT_EQ(dataset.points.size(), 60U);
        EXPECT_EQ(dataset.points[2 + 3 * (1 + 4 * 3)], glm::dvec3(2, 10, 300));
        ASSERT_EQ(dataset.point_fields.size(), 6U);
        EXPECT_EQ(field_named(dataset, "Density").values[7], 8.0);
        EXPECT_EQ(field_named(dataset, "Momentum").components, 3);
        EXPECT_EQ(field_named(dataset, "Momentum").values[21], 14.0);
        EXPECT_EQ(field_named(dataset, "StagnationEnergy").values[7], 50.0);
        // Ideal gas, gamma 1.4: p = 0.4 (e - rho v²/2), a² = 1.4 p/rho. VTK computes in the file's precision.
        const double v = 14.0 / 8.0, p = 0.4 * (50.0 - 0.5 * 8.0 * v * v);
        const double tolerance = 1e-5;  // relative, some ten float32 roundings of 6e-8
        EXPECT_NEAR(field_named(dataset, "Pressure").values[7], p, tolerance * p);
        EXPECT_NEAR(field_named(dataset, "VelocityMagnitude").values[7], v, tolerance * v);
        EXPECT_NEAR(field_named(dataset, "Mach").values[7], v / std::sqrt(1.4 * p / 8.0), tolerance);
        EXPECT_TRUE(read(grid).point_fields.empty());
    }
}

TEST(ReadPlot3d, IsTakenForItsSuffixesOrForASolution) {
    for (const char* name : {"a.xyz", "a.X", "a.p3d", "a.g", "a.bin"}) {
        EXPECT_TRUE(read(write(name, plot3d_grid(plain))).grid) << name;
    }
    const fs::path other = write("a.grid", plot3d_grid(plain));
    const fs::path solution = write("a.q", plot3d_solution(plain));
    EXPECT_EQ(error_of(other).kind(), ErrorKind::format);
    EXPECT_TRUE(read(other, {solution}).grid);
    expect_error(solution, ErrorKind::format, "a PLOT3D grid", {solution});  // a solution is no grid
}

TEST(ReadPlot3dErrors, GridsWhoseSizeDoesNotFit) {
    const std::string whole = plot3d_grid(plain);
    for (const std::size_t size :
         {std::size_t{1}, std::size_t{11}, std::size_t{12}, whole.size() / 2, whole.size() - 1}) {
        expect_error(write("cut.xyz", whole.substr(0, size)), ErrorKind::format, std::to_string(size) + " bytes");
    }
    expect_error(write("long.xyz", whole + "x"), ErrorKind::format, "3 x 4 x 5");
    expect_error(write("text.x", "3 4 5\n0.0 1.0 2.0\n"), ErrorKind::format, "found 6 numbers");
    expect_error(write("huge.x", std::string(400, '\x7f')), ErrorKind::format, "400 bytes");
    expect_error(write("zero.x", std::string(400, '\0')), ErrorKind::format, "400 bytes");
}

TEST(ReadPlot3dErrors, GridsWithoutVolume) {
    const Plot3dForm counted{false, true, true, false, false};
    expect_error(write("flat.xyz", plot3d_grid(plain, 1, {{3, 4, 1}})), ErrorKind::data, "3 x 4 x 1");
    expect_error(write("flats.xyz", plot3d_grid(counted, 1, {{3, 4, 1}, {1, 4, 5}})), ErrorKind::data,
                 "1 more without");
    const Plot3dForm blanked{true, false, false, false, true};
    expect_error(write("blank.xyz", plot3d_grid(blanked, 0, {{2, 2, 2}})), ErrorKind::data, "blanked as a whole");
}

// ---- Several blocks, holes and text ----

double total_volume(const Dataset& dataset) {
    const TetMesh mesh = tetrahedralize(dataset);
    double sum = 0;
    for (CellId t = 0; t < mesh.tets.size(); ++t)
        sum += signed_volume(mesh, t);
    return sum;
}

TEST(ReadPlot3d, BlocksOfAllLayoutsBecomeOneMesh) {
    const std::vector<std::array<int, 3>> blocks{{3, 4, 5}, {3, 1, 2}, {2, 2, 7}};
    for (int bits = 0; bits < 16; ++bits) {
        const Plot3dForm form{(bits & 1) != 0, (bits & 2) != 0, true, (bits & 4) != 0, (bits & 8) != 0};
        SCOPED_TRACE("layout " + std::to_string(bits));
        const fs::path grid = write("grid.xyz", plot3d_grid(form, 1, blocks));
        const fs::path solution = write("solution.q", plot3d_solution(form, blocks));
        const Dataset both = read(grid, {solution});
        EXPECT_EQ(both.blocks, (std::vector<std::string>{"block 1", "block 3"}));
        EXPECT_EQ(both.skipped_blocks, 1U);
        EXPECT_EQ(both.points.size(), 60U + 28U);
        EXPECT_EQ(both.cells.size(), 24U + 6U);
        EXPECT_EQ(both.points[60 + 27], glm::dvec3(1, 10, 600));
        EXPECT_EQ(field_named(both, "Density").values[60 + 27], 28.0);  // each block counts anew
        EXPECT_NEAR(total_volume(both), 1000.0 * (24 + 6), 1e-9);       // boxes of 1 by 10 by 100; 150 roundings of 3e4
        const Dataset last = read(grid, {.solution = solution, .blocks = {"block 3"}});
        ASSERT_TRUE(last.grid);
        EXPECT_EQ(last.grid->nk, 7U);
        EXPECT_EQ(field_named(last, "Density").values[27], 28.0);
    }
    const Plot3dForm counted{false, true, true, false, false};
    const fs::path grid = write("grid.xyz", plot3d_grid(counted, 1, blocks));
    expect_error(grid, ErrorKind::option, "\"block 1\", \"block 3\"", {.blocks = {"block 2"}});
    const Error other = error_of(grid, {write("other.q", plot3d_solution(counted, {{3, 4, 5}, {3, 1, 2}, {2, 2, 6}}))});
    EXPECT_NE(std::string(other.what()).find("2 x 2 x 7 points of block 3, found one for 2 x 2 x 6"), std::string::npos)
        << other.what();
    const Error fewer = error_of(grid, {write("fewer.q", plot3d_solution(counted, {{3, 4, 5}, {3, 1, 2}}))});
    EXPECT_NE(std::string(fewer.what()).find("2 blocks"), std::string::npos) << fewer.what();
}

TEST(ReadPlot3d, LeavesOutTheCellsAroundHoles) {
    const Plot3dForm blanked{true, false, false, true, true};
    const fs::path solution = write("solution.q", plot3d_solution(blanked));
    for (const int value : {1, 2, -3}) {  // the field, a wall, a point interpolated from block 3
        const Dataset whole = read(write("whole.xyz", plot3d_grid(blanked, value)), {solution});
        EXPECT_TRUE(whole.grid) << value;
        EXPECT_EQ(whole.ghost_cells, 0U) << value;
    }
    // Point 7 is (1, 2, 0) of 3 by 4 by 5: inside the bottom face, a corner of four cells.
    const Dataset holed = read(write("holed.xyz", plot3d_grid(blanked, 0)), {solution});
    EXPECT_FALSE(holed.grid);
    EXPECT_EQ(holed.cells.size(), 20U);
    EXPECT_EQ(holed.ghost_cells, 4U);
    EXPECT_NEAR(total_volume(holed), 1000.0 * 20, 1e-9);
    EXPECT_EQ(holed.points.size(), 60U - 6U);  // (0..2, 2..3, 0) belong to these cells only
    EXPECT_EQ(field_named(holed, "Density").values.size(), holed.points.size());
    for (std::size_t p = 0; p < holed.points.size(); ++p) {
        const glm::dvec3 x = holed.points[p];
        EXPECT_EQ(field_named(holed, "Density").values[p], 1 + x.x + 3 * (x.y / 10 + 4 * x.z / 100));
    }
}

TEST(ReadPlot3d, Text) {
    std::string grid = "2\n2 2 2\n3, 2, 2\n", solution = grid;
    for (const int ni : {2, 3}) {
        const int count = 4 * ni;
        for (int axis = 0; axis < 3; ++axis) {
            for (int p = 0; p < count; ++p)
                grid += std::to_string(axis == 0 ? p % ni : axis == 1 ? p / ni % 2 : p / (2 * ni)) + ".0d0 ";
            grid += "\n";
        }
        grid += ni == 2 ? "8*1\n" : "1 1 0 9*-2\n";
        solution += "2.0 0 +1.0E6 0\n" + std::to_string(count) + "*1.5 " + std::to_string(3 * count) + "*0 " +
                    std::to_string(count) + "*2.5e0\n";
    }
    const Dataset dataset = read(write("text.xyz", grid), {write("text.q", solution)});
    EXPECT_EQ(dataset.format, "PLOT3D curvilinear grid, text");
    EXPECT_EQ(dataset.blocks.size(), 2U);
    EXPECT_EQ(dataset.cells.size(), 2U);  // of three: one touches the hole
    EXPECT_EQ(dataset.ghost_cells, 1U);
    EXPECT_NEAR(total_volume(dataset), 2.0, 1e-15);
    EXPECT_EQ(field_named(dataset, "Density").values, std::vector<double>(16, 1.5));
    EXPECT_EQ(field_named(dataset, "Pressure").values, std::vector<double>(16, (1.4 - 1.0) * 2.5));
    EXPECT_EQ(field_named(dataset, "Mach").values, std::vector<double>(16, 0.0));
    expect_error(write("text.xyz", grid + " 7"), ErrorKind::format, "numbers");
    expect_error(write("text.xyz", grid + std::string(5000, ' ') + "x"), ErrorKind::format,
                 "line 12: expected nothing but numbers, found \"x\"");
    expect_error(write("text.xyz", "2 2 2\n999999999999*0.5\n"), ErrorKind::format, "line 2");
    const Error mixed = error_of(write("text.xyz", grid), {write("binary.q", plot3d_solution(plain))});
    EXPECT_NE(std::string(mixed.what()).find("written as its grid was"), std::string::npos) << mixed.what();
}

TEST(ReadPlot3dErrors, SolutionsThatDoNotFit) {
    const fs::path grid = write("grid.xyz", plot3d_grid(plain));
    const auto refused = [&](const std::string& bytes, ErrorKind kind, const std::string& words) {
        const fs::path solution = write("solution.q", bytes);
        const Error error = error_of(grid, {solution});
        EXPECT_EQ(error.kind(), kind) << error.what();
        EXPECT_EQ(error.place(), solution.string());
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    };
    const std::string whole = plot3d_solution(plain);
    refused(plot3d_solution(plain, {{3, 5, 4}}), ErrorKind::data, "one for 3 x 5 x 4");
    refused(whole.substr(0, whole.size() - 4), ErrorKind::format, "cut off");
    refused(whole + std::string(60 * 4, '\0'), ErrorKind::format, "five variables");
    refused(plot3d_solution({false, false, false, false, false}), ErrorKind::format, "byte order");
    refused("short", ErrorKind::format, "no such header");
    refused("", ErrorKind::format, "0 bytes");
    EXPECT_EQ(read(grid, {write("solution.q", whole + "trailing")}).point_fields.size(), 6U);
    EXPECT_EQ(error_of(grid, {scratch_folder() / "missing.q"}).kind(), ErrorKind::file);
}

TEST(ReadPlot3dErrors, PointsThatAreNotFinite) {
    std::string bytes = plot3d_grid(plain);
    bytes.replace(12 + 4 * 5, 4, "\x7f\xc0\x00\x01", 4);
    expect_error(write("nan.xyz", bytes), ErrorKind::data, "point 5");
}

// Cut at 20 places and with 200 random bytes each: an Error that names the file, or a dataset that can be cut up.
TEST(ReadPlot3dErrors, DamageIsSurvived) {
    const Plot3dForm blanked{false, true, true, false, true};
    std::string text = "1\n3 3 3\n";
    for (int number = 0; number < 108; ++number)
        text += std::to_string(number) + (number % 9 == 8 ? "\n" : " ");
    std::mt19937 random(11);
    for (const std::string& good : {plot3d_grid(plain), plot3d_grid(blanked, 0, {{3, 4, 5}, {2, 2, 7}}), text}) {
        const auto survive = [](const std::string& bytes) {
            const fs::path file = write("damaged.xyz", bytes);
            try {
                tetrahedralize(read(file));
            } catch (const Error& error) {
                EXPECT_NE(error.place().find("damaged.xyz"), std::string::npos) << error.what();
            }
        };
        EXPECT_GT(read(write("good.xyz", good)).cell_count(), 0U);
        for (std::size_t i = 0; i < 20; ++i)
            survive(good.substr(0, good.size() * i / 20));
        for (int i = 0; i < 200; ++i) {
            std::string bytes = good;
            bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
            survive(bytes);
        }
    }
}

TEST_F(ReadSharedData, BluntFin) {
    const Dataset dataset = read(data / "bluntfin/bluntfinxyz.bin", {data / "bluntfin/bluntfinq.bin"});
    EXPECT_EQ(dataset.points.size(), 40960U);
    EXPECT_EQ(dataset.cell_count(), 37479U);
    const ScalarRange density = range(field_named(dataset, "Density").values);
    EXPECT_EQ(static_cast<float>(density.low), 0.1926F);
    EXPECT_EQ(static_cast<float>(density.high), 4.9775F);
    // data/SOURCES.md, computed there from the bytes; given with 6 digits.
    EXPECT_NEAR(range(field_named(dataset, "Pressure").values).high, 10.0127, 5e-5);
    EXPECT_NEAR(range(field_named(dataset, "Mach").values).high, 3.38545, 5e-6);
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    EXPECT_EQ(report.tets, 187395U);
    EXPECT_EQ(report.flat, 77U);
    EXPECT_EQ(report.flipped, 0U);
    EXPECT_EQ(build_adjacency(mesh).overused_faces, 0U);
}

TEST_F(ReadSharedData, Combustor) {
    const Dataset dataset = read(data / "combustor/combxyz.bin", {data / "combustor/combq.bin"});
    const ScalarRange mach = range(field_named(dataset, "Mach").values);
    EXPECT_EQ(mach.not_finite, 47025U);  // the energy is 0: no real sound speed anywhere, and that is kept
    TetrahedralizeReport report;
    tetrahedralize(dataset, &report);
    EXPECT_EQ(report.tets, 215040U);
    EXPECT_EQ(report.flat, 0U);
    EXPECT_EQ(report.flipped, 0U);
}

}  // namespace
}  // namespace cellproj
