// SPDX-License-Identifier: BSD-3-Clause
//
// The readers of our own. One small mesh is written in every format and must come back the same; the real files are
// held against numbers found in another way; damage ends in a dataset or in an error that names the file.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/text_formats.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/text_meshes.hpp"

namespace cellproj {

namespace text_formats_test {

namespace fs = std::filesystem;
using namespace testing_support;
using Reader = Dataset (*)(const fs::path&);

fs::path write(const std::string& name, const std::string& bytes) {
    const fs::path file = scratch_folder() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

const Field& field(const std::vector<Field>& fields, const std::string& name) {
    const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
    if (found == fields.end()) throw std::runtime_error("no field " + name);
    return *found;
}

std::pair<double, double> range(const Field& values, int component = 0) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t i = static_cast<std::size_t>(component); i < values.values.size();
         i += static_cast<std::size_t>(values.components)) {
        low = std::min(low, values.values[i]);
        high = std::max(high, values.values[i]);
    }
    return {low, high};
}

std::map<CellKind, std::size_t> kinds(const Dataset& dataset) {
    std::map<CellKind, std::size_t> counts;
    for (const CellKind kind : dataset.cells.kinds)
        ++counts[kind];
    return counts;
}

double tet_volume(const Dataset& dataset, const VertexId* v) {
    const glm::dvec3 a = dataset.points[v[0]], b = dataset.points[v[1]], c = dataset.points[v[2]];
    return std::abs(glm::dot(glm::cross(b - a, c - a), dataset.points[v[3]] - a)) / 6.0;
}

// Tetrahedra, and pyramids as two of them.
double volume(const Dataset& dataset) {
    double sum = 0.0;
    for (std::size_t c = 0; c < dataset.cells.size(); ++c) {
        const VertexId* v = dataset.cells.vertices.data() + dataset.cells.offsets[c];
        if (dataset.cells.kinds[c] == CellKind::tetrahedron) {
            sum += tet_volume(dataset, v);
        } else {
            const std::array<VertexId, 4> first{v[0], v[1], v[2], v[4]}, second{v[0], v[2], v[3], v[4]};
            sum += tet_volume(dataset, first.data()) + tet_volume(dataset, second.data());
        }
    }
    return sum;
}

// The faces of tetrahedra that are used once bound the same volume (divergence theorem): the surface integral of the
// position over them, a third of it.
double boundary_volume(const Dataset& dataset) {
    std::map<std::array<VertexId, 3>, std::pair<int, double>> faces;
    for (std::size_t c = 0; c < dataset.cells.size(); ++c) {
        const VertexId* v = dataset.cells.vertices.data() + dataset.cells.offsets[c];
        for (int opposite = 0; opposite < 4; ++opposite) {
            std::array<VertexId, 3> face{};
            std::remove_copy(v, v + 4, face.begin(), v[opposite]);
            std::sort(face.begin(), face.end());
            const glm::dvec3 a = dataset.points[face[0]], b = dataset.points[face[1]], d = dataset.points[face[2]];
            const glm::dvec3 normal = glm::cross(b - a, d - a);
            const bool outward = glm::dot(normal, dataset.points[v[opposite]] - a) < 0.0;
            auto& [uses, integral] = faces[face];
            ++uses;
            integral = glm::dot(normal, a) / 6.0 * (outward ? 1.0 : -1.0);
        }
    }
    double sum = 0.0;
    for (const auto& [face, use] : faces) {
        EXPECT_LE(use.first, 2);
        if (use.first == 1) sum += use.second;
    }
    return sum;
}

void expect_sample(const Dataset& dataset) {
    const Dataset expected = sample_mesh();
    EXPECT_EQ(dataset.points, expected.points);
    EXPECT_EQ(dataset.cells.kinds, expected.cells.kinds);
    EXPECT_EQ(dataset.cells.offsets, expected.cells.offsets);
    EXPECT_EQ(dataset.cells.vertices, expected.cells.vertices);
    EXPECT_EQ(dataset.skipped_cells, 2U);
}

void expect_error(Reader reader, const fs::path& file, ErrorKind kind, const std::string& words) {
    try {
        reader(file);
        ADD_FAILURE() << "no error: " << words;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        EXPECT_NE(error.place().find(file.stem().string()), std::string::npos) << error.what();
        EXPECT_FALSE(error.advice().empty());
    }
}

// ---- One mesh in every format ----

class GmshSample : public testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(GmshSample, IsTheSameInEveryVersion) {
    const auto [version, binary] = GetParam();
    for (const std::uint64_t gap : {1U, 3U, 100000U}) {  // without gaps, with some, and so many that no table is made
        SCOPED_TRACE(gap);
        const Dataset dataset = read_gmsh(write("sample.msh", gmsh_file(version, binary, gap)));
        expect_sample(dataset);
        EXPECT_EQ(field(dataset.cell_fields, "physical").values, (std::vector<double>{7, 7, 7, 8}));
        EXPECT_EQ(field(dataset.cell_fields, "entity").values, (std::vector<double>{1, 1, 1, 2}));
        const Field& potential = field(dataset.point_fields, "potential, V");
        for (std::size_t i = 0; i < dataset.points.size(); ++i) {
            EXPECT_EQ(potential.values[i], sample_potential(dataset.points[i]));
        }
        const Field& flux = field(dataset.cell_fields, "flux step 2");
        ASSERT_EQ(flux.components, 3);
        EXPECT_EQ(flux.values[3], 1.5);  // the second cell, the only one with values
        EXPECT_TRUE(std::isnan(flux.values[0]));
        EXPECT_EQ(dataset.point_fields.size(), 1U);
        EXPECT_EQ(dataset.cell_fields.size(), 3U);
    }
}

INSTANTIATE_TEST_SUITE_P(Gmsh, GmshSample, testing::Combine(testing::Values(2, 4), testing::Bool()));

TEST(Gmsh, ErrorsTellTheLine) {
    const std::string good = gmsh_file(2, false, 1);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return write("bad.msh", text.replace(text.find(from), from.size(), to));
    };
    using enum ErrorKind;
    expect_error(read_gmsh, with("2.2 0 8", "1.0 0 8"), format, "line 2: expected version 2.2 or 4.1, found \"1.0\"");
    expect_error(read_gmsh, with("2.2 0 8", "4 0 8"), format, "version");
    expect_error(read_gmsh, with("$Nodes\n12", "$Nodes\n12000000000"), format, "line 9: expected the number of nodes");
    expect_error(read_gmsh, with("$Nodes\n12", "$Nodes\n11"), format, "$EndNodes");
    expect_error(read_gmsh, with("\n8 1 0 0\n", "\n8 1 nan 0\n"), data, "finite");
    expect_error(read_gmsh, with("\n8 1 0 0\n", "\n7 1 0 0\n"), data, "all different");
    expect_error(read_gmsh, with("$Elements\n6\n1 2 ", "$Elements\n6\n1 35 "), format, "element type");
    expect_error(read_gmsh, with(" 18\n", " 99\n"), data, "99");
    expect_error(read_gmsh, write("empty.msh", ""), format, "empty");
    expect_error(read_gmsh, scratch_folder() / "absent.msh", file, "check the path");
}

TEST(Gmsh, RefusesTheOtherByteOrder) {
    std::string text = gmsh_file(4, true, 1);
    std::reverse(text.begin() + 20, text.begin() + 24);  // the number 1 behind "$MeshFormat\n4.1 1 8\n"
    expect_error(read_gmsh, write("swapped.msh", text), ErrorKind::format, "byte order");
}

TEST(Medit, Sample) {
    write("sample.sol", medit_solutions());
    const Dataset dataset = read_medit(write("sample.mesh", medit_file()));
    expect_sample(dataset);
    EXPECT_EQ(field(dataset.cell_fields, "region").values, (std::vector<double>{7, 7, 7, 8}));
    const Field& potential = field(dataset.point_fields, "solution_1");
    for (std::size_t i = 0; i < dataset.points.size(); ++i) {
        EXPECT_EQ(potential.values[i], sample_potential(dataset.points[i]));
    }
    EXPECT_EQ(field(dataset.point_fields, "solution_2").components, 3);
    EXPECT_EQ(range(field(dataset.point_fields, "solution_2"), 2), std::pair(5.0, 5.0));
}

TEST(Medit, Errors) {
    const std::string good = medit_file();
    using enum ErrorKind;
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return write("bad.mesh", text.replace(text.find(from), from.size(), to));
    };
    expect_error(read_medit, with("Dimension 3", "Dimension 2"), data, "line 2: expected the dimension 3");
    expect_error(read_medit, with("Vertices\n12", "Vertices\n4000000000"), format, "fits the rest of the file");
    expect_error(read_medit, with("\nEnd\n", "\n"), format, "keyword End");
    expect_error(read_medit, with("1 2 3 4 5 6 7 8 7", "0 2 3 4 5 6 7 8 7"), data, "from 1 on");
    expect_error(read_medit, with("1 2 3 4 5 6 7 8 7", "1 2 3 4 5 6 7 88 7"), data, "one of the 12 points, found 88");
    write("other.sol", "MeshVersionFormatted 1\nDimension 3\nSolAtVertices\n1\n1 1\n0.5\nEnd\n");
    expect_error(read_medit, write("other.mesh", good), data, "other.sol, line 4");
}

TEST(Su2, Sample) {
    const Dataset dataset = read_su2(write("sample.su2", su2_file()));
    expect_sample(dataset);
    EXPECT_TRUE(dataset.point_fields.empty());
    EXPECT_TRUE(dataset.cell_fields.empty());
}

TEST(Su2, Errors) {
    const std::string good = su2_file();
    using enum ErrorKind;
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return write("bad.su2", text.replace(text.find(from), from.size(), to));
    };
    expect_error(read_su2, with("NDIME= 3", "NDIME= 2"), data, "line 2: expected the dimension 3");
    expect_error(read_su2, with("NPOIN=", "NPOIM="), format, "a line NPOIN=");
    expect_error(read_su2, with("NELEM= 4", "NELEM= 5"), format, "line 8: expected the type of an element");
    expect_error(read_su2, with("14 4 5 6 7 8", "15 4 5 6 7 8"), format, "line 5: expected an element type");
    expect_error(read_su2, with("14 4 5 6 7 8", "14 4 5 6 7 12"), data, "line 5: expected a vertex id");
    expect_error(read_su2, write("zones.su2", good + good), data, "one zone per file");
}

class TetGenSample : public testing::TestWithParam<int> {};

TEST_P(TetGenSample, IdsStartAtZeroOrOne) {
    const fs::path nodes = write("sample.node", tetgen_nodes(GetParam()));
    const fs::path elements = write("sample.ele", tetgen_elements(GetParam()));
    for (const fs::path& file : {nodes, elements}) {
        const Dataset dataset = read_tetgen(file);
        EXPECT_EQ(dataset.points.size(), 5U);
        EXPECT_EQ(dataset.cells.vertices, (std::vector<VertexId>{0, 1, 2, 3, 4, 1, 2, 3}));
        EXPECT_EQ(field(dataset.point_fields, "attribute_1").values, (std::vector<double>{0, 1, 2, 3, 4}));
        EXPECT_EQ(field(dataset.point_fields, "boundary_marker").values, (std::vector<double>{0, 0, 0, 0, 9}));
        EXPECT_EQ(field(dataset.cell_fields, "region").values, (std::vector<double>{-1, 2.5}));
    }
}

INSTANTIATE_TEST_SUITE_P(TetGen, TetGenSample, testing::Values(0, 1));

TEST(TetGen, Errors) {
    using enum ErrorKind;
    const fs::path nodes = write("bad.node", tetgen_nodes(1));
    expect_error(read_tetgen, write("alone.node", tetgen_nodes(1)), ErrorKind::file, "alone.ele");
    write("bad.ele", "1 4 0\n1 1 2 3 6\n");
    expect_error(read_tetgen, nodes, data, "bad.ele, line 2: expected a vertex id of one of the 5 points, found 6");
    write("bad.ele", "2 4 0\n1 1 2 3 4\n3 1 2 3 5\n");
    expect_error(read_tetgen, nodes, format, "bad.ele, line 3: expected the index 2");
    write("bad.ele", "1 5 0\n1 1 2 3 4 5\n");
    expect_error(read_tetgen, nodes, format, "4 or 10 nodes");
    write("bad.ele", "0 4 0\n");
    expect_error(read_tetgen, nodes, data, "volume cells");
}

// ---- Damage ----

// Reads the file cut at 20 places and with 200 single flipped bytes each; the file is whole again afterwards.
void expect_damage_is_survived(Reader reader, const fs::path& entry, const fs::path& damaged, const std::string& good) {
    const auto start = std::chrono::steady_clock::now();
    std::size_t errors = 0;
    const auto read_with = [&](const std::string& bytes) {
        std::ofstream(damaged, std::ios::binary) << bytes;
        try {
            reader(entry);
        } catch (const Error& error) {
            ++errors;
            EXPECT_NE(error.place().find(entry.stem().string()), std::string::npos) << error.what();
        }  // anything else ends the test
    };
    for (std::size_t i = 0; i < 20; ++i)
        read_with(good.substr(0, good.size() * i / 20));
    EXPECT_GE(errors, 15U);  // the last cuts may leave a whole mesh behind
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
        std::string bytes = good;
        bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
        read_with(bytes);
    }
    std::ofstream(damaged, std::ios::binary) << good;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Damage, Gmsh) {
    for (const int version : {2, 4}) {
        for (const bool binary : {false, true}) {
            const std::string good = gmsh_file(version, binary, 3);
            const fs::path file = write("damaged.msh", good);
            expect_damage_is_survived(read_gmsh, file, file, good);
        }
    }
}

TEST(Damage, Medit) {
    const fs::path mesh = write("damaged.mesh", medit_file()), solutions = write("damaged.sol", medit_solutions());
    expect_damage_is_survived(read_medit, mesh, mesh, medit_file());
    expect_damage_is_survived(read_medit, mesh, solutions, medit_solutions());
}

TEST(Damage, Su2) {
    const fs::path file = write("damaged.su2", su2_file());
    expect_damage_is_survived(read_su2, file, file, su2_file());
}

TEST(Damage, TetGen) {
    const fs::path nodes = write("damaged.node", tetgen_nodes(1)), cells = write("damaged.ele", tetgen_elements(1));
    expect_damage_is_survived(read_tetgen, nodes, nodes, tetgen_nodes(1));
    expect_damage_is_survived(read_tetgen, nodes, cells, tetgen_elements(1));
}

// ---- Real files ----

// Counts: SOURCES.md. Volumes: sums over the raw numbers of the files, by a script of its own; they and the boundary's
// agree up to the rounding of 1e5 float64 terms, 1e-11 at most.
class RealTextFormats : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(data)) GTEST_SKIP() << "no folder " << data;
    }
    const fs::path data = CELLPROJ_SHARED_DATA;
    static constexpr double rounding = 1e-11;
};

TEST_F(RealTextFormats, TetGen) {
    const Dataset dataset = read_tetgen(data / "tetgen" / "example.1.node");
    EXPECT_EQ(dataset.points.size(), 482U);
    EXPECT_EQ(dataset.cells.size(), 1533U);
    EXPECT_NEAR(volume(dataset), 17.9375, 17.9375 * rounding);
    EXPECT_NEAR(boundary_volume(dataset), 17.9375, 17.9375 * rounding);
    const Field& markers = field(dataset.point_fields, "boundary_marker");
    EXPECT_EQ(range(markers), std::pair(0.0, 9.0));
    EXPECT_EQ(std::count(markers.values.begin(), markers.values.end(), 0.0), 29);
    EXPECT_TRUE(dataset.cell_fields.empty());
}

TEST_F(RealTextFormats, Gmsh22Ascii) {
    const Dataset dataset = read_gmsh(data / "gmsh" / "piece.asc.v22.msh");
    EXPECT_EQ(dataset.points.size(), 3939U);
    EXPECT_EQ(dataset.cells.size(), 13179U);
    EXPECT_EQ(dataset.skipped_cells, 126U + 852U + 6908U);
    EXPECT_NEAR(volume(dataset), 0.9825503657410342, rounding);
    EXPECT_NEAR(boundary_volume(dataset), 0.9825503657410342, rounding);
    ASSERT_EQ(dataset.cell_fields.size(), 1U);  // all physical groups are 0
    EXPECT_EQ(range(field(dataset.cell_fields, "entity")), std::pair(1.0, 4.0));
}

TEST_F(RealTextFormats, Gmsh41Binary) {
    const Dataset dataset = read_gmsh(data / "gmsh" / "indheat.bin.v41.msh");
    EXPECT_EQ(dataset.points.size(), 5291U);
    EXPECT_EQ(dataset.cells.size(), 30444U);
    EXPECT_EQ(dataset.skipped_cells, 6446U);
    const double total = volume(dataset);
    EXPECT_NEAR(boundary_volume(dataset), total, total * rounding);
    EXPECT_GT(range(field(dataset.cell_fields, "physical")).first, 0.0);  // every volume is in a group
}

TEST_F(RealTextFormats, MeditWithSolutions) {
    const Dataset dataset = read_medit(data / "medit" / "torus.mesh");
    EXPECT_EQ(dataset.points.size(), 4351U);
    EXPECT_EQ(dataset.cells.size(), 20067U);
    EXPECT_EQ(dataset.skipped_cells, 2954U + 94U);
    EXPECT_NEAR(volume(dataset), 4.123025686154576, 4 * rounding);
    EXPECT_NEAR(boundary_volume(dataset), 4.123025686154576, 4 * rounding);
    ASSERT_EQ(dataset.point_fields.size(), 2U);
    ASSERT_EQ(dataset.point_fields[0].components, 6);
    ASSERT_EQ(dataset.point_fields[1].components, 3);
    EXPECT_EQ(range(dataset.point_fields[0], 0), std::pair(32.4466, 107414.0));
    EXPECT_EQ(range(dataset.point_fields[0], 5), std::pair(25.0, 25.0));
    EXPECT_EQ(range(dataset.point_fields[1], 0), std::pair(32.4466, 107414.0));
    EXPECT_EQ(range(dataset.point_fields[1], 2), std::pair(1.3, 1.3));
}

TEST_F(RealTextFormats, MeditBunny) {
    const Dataset dataset = read_medit(data / "medit" / "bunny.mesh");
    EXPECT_EQ(dataset.points.size(), 5433U);
    EXPECT_EQ(dataset.cells.size(), 34055U);
    EXPECT_EQ(dataset.skipped_cells, 6966U);
    EXPECT_NEAR(volume(dataset), 0.0012494148176858354, 1e-3 * rounding);
    EXPECT_TRUE(dataset.point_fields.empty());
}

TEST_F(RealTextFormats, Su2TetrahedraAndPyramidsFillTheBrick) {
    const Dataset dataset = read_su2(data / "brick_su2" / "mesh_brick_pyra_ffd.su2");
    EXPECT_EQ(dataset.points.size(), 14030U);
    EXPECT_EQ(kinds(dataset),
              (std::map<CellKind, std::size_t>{{CellKind::tetrahedron, 71884}, {CellKind::pyramid, 741}}));
    EXPECT_EQ(dataset.skipped_cells, 722U + 722U + 1482U + 1482U + 741U + 1482U);
    EXPECT_NEAR(volume(dataset), 2.0, 2 * rounding);  // [0, 2] × [0, 1] × [0, 1]
}

}  // namespace

}  // namespace cellproj
