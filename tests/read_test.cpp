// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/read.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

#include <gtest/gtest.h>

#include <vtkLogger.h>
#include <vtkOutputWindow.h>

#include "mesh/error.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/read_fixtures.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace read_test {

// ---- Small unstructured files as text ----

struct GridText {
    std::string points = "0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  0.5 0.5 2";
    std::size_t point_count = 9;
    std::vector<std::vector<int>> cells{{0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2}, {4, 5, 7, 8}, {3}};
    std::vector<int> types{12, 5, 10, 1};  // hexahedron, triangle, tetrahedron, vertex
    std::string vtu_fields =
        "<PointData><DataArray type=\"Float32\" Name=\"s\" format=\"ascii\">0 1 2 3 4 5 6 7 8.5</DataArray></PointData>"
        "<CellData><DataArray type=\"Int32\" Name=\"id\" format=\"ascii\">10 11 12 13</DataArray>"
        "<DataArray type=\"Float64\" Name=\"v\" NumberOfComponents=\"2\" format=\"ascii\">0 1 2 3 4 5 6 7</DataArray>"
        "</CellData>";
    std::string vtk_fields =
        "CELL_DATA 4\nSCALARS id int 1\nLOOKUP_TABLE default\n10 11 12 13\n"
        "FIELD more 1\nv 2 4 double\n0 1 2 3 4 5 6 7\n"
        "POINT_DATA 9\nSCALARS s float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8.5\nSCALARS second float 1\n"
        "LOOKUP_TABLE default\n9 8 7 6 5 4 3 2 1\n";
};

std::string vtu_piece(const GridText& grid) {
    std::ostringstream connectivity, offsets, types;
    std::size_t end = 0;
    for (const auto& cell : grid.cells) {
        for (const int id : cell)
            connectivity << id << ' ';
        offsets << (end += cell.size()) << ' ';
    }
    for (const int type : grid.types)
        types << type << ' ';
    std::ostringstream text;
    text << "<Piece NumberOfPoints=\"" << grid.point_count << "\" NumberOfCells=\"" << grid.cells.size() << "\">"
         << grid.vtu_fields << "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
         << grid.points
         << "</DataArray></Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">"
         << connectivity.str() << "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">"
         << offsets.str() << "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" << types.str()
         << "</DataArray></Cells></Piece>\n";
    return text.str();
}

std::string vtu_around(const std::string& pieces, const std::string& type = "UnstructuredGrid") {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"1.0\" byte_order=\"LittleEndian\">\n<" +
           type + ">\n" + pieces + "</" + type + ">\n</VTKFile>\n";
}

std::string vtu(const GridText& grid) {
    return vtu_around(vtu_piece(grid));
}

std::string vtk(const GridText& grid) {
    std::ostringstream text, types;
    std::size_t size = 0;
    for (const auto& cell : grid.cells)
        size += 1 + cell.size();
    text << "# vtk DataFile Version 3.0\nCELLS 1 2\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << grid.point_count
         << " double\n"
         << grid.points << "\nCELLS " << grid.cells.size() << ' ' << size << '\n';
    for (const auto& cell : grid.cells) {
        text << cell.size();
        for (const int id : cell)
            text << ' ' << id;
        text << '\n';
    }
    text << "CELL_TYPES " << grid.types.size() << '\n';
    for (const int type : grid.types)
        text << type << '\n';
    return text.str() + grid.vtk_fields;
}

void expect_mixed_grid(const Dataset& dataset) {
    ASSERT_EQ(dataset.points.size(), 9U);
    EXPECT_EQ(dataset.points[8], glm::dvec3(0.5, 0.5, 2));
    EXPECT_FALSE(dataset.grid);
    EXPECT_EQ(dataset.cells.kinds, (std::vector<CellKind>{CellKind::hexahedron, CellKind::tetrahedron}));
    EXPECT_EQ(dataset.cells.offsets, (std::vector<std::uint64_t>{0, 8, 12}));
    EXPECT_EQ(dataset.cells.vertices, (std::vector<VertexId>{0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 7, 8}));
    EXPECT_EQ(dataset.skipped_cells, 2U);
    ASSERT_GE(dataset.point_fields.size(), 1U);
    EXPECT_EQ(dataset.point_fields[0].name, "s");
    EXPECT_EQ(dataset.point_fields[0].values, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8.5}));
    ASSERT_EQ(dataset.cell_fields.size(), 2U);
    EXPECT_EQ(dataset.cell_fields[0].name, "id");
    EXPECT_EQ(dataset.cell_fields[0].values, (std::vector<double>{10, 12}));  // the rows of skipped cells are dropped
    EXPECT_EQ(dataset.cell_fields[1].components, 2);
    EXPECT_EQ(dataset.cell_fields[1].values, (std::vector<double>{0, 1, 4, 5}));
}

TEST(ReadVtu, ReadsVolumeCellsAndFields) {
    const fs::path file = write("mixed.vtu", vtu({}));
    const Dataset dataset = read(file);
    EXPECT_EQ(dataset.source, file.string());
    EXPECT_EQ(dataset.format, "VTK XML unstructured grid");
    expect_mixed_grid(dataset);
}

TEST(ReadVtu, JoinsPieces) {
    const Dataset dataset = read(write("pieces.vtu", vtu_around(vtu_piece({}) + vtu_piece({}))));
    EXPECT_EQ(dataset.points.size(), 18U);
    EXPECT_EQ(dataset.cells.size(), 4U);
    EXPECT_EQ(dataset.skipped_cells, 4U);
    EXPECT_EQ(dataset.cells.vertices[12], 9U);
    EXPECT_EQ(dataset.cell_fields[0].values, (std::vector<double>{10, 12, 10, 12}));
}

TEST(ReadLegacy, ReadsVolumeCellsAndAllArrays) {
    const Dataset dataset = read(write("mixed.vtk", vtk({})));
    EXPECT_EQ(dataset.format, "VTK legacy unstructured grid");
    expect_mixed_grid(dataset);
    ASSERT_EQ(dataset.point_fields.size(), 2U);
    EXPECT_EQ(dataset.point_fields[1].name, "second");
}

TEST(Read, TellsTheFormatByContentBeforeTheSuffix) {
    EXPECT_EQ(read(write("legacy.vtu", vtk({}))).format, "VTK legacy unstructured grid");
    EXPECT_EQ(read(write("xml.bin", vtu({}))).format, "VTK XML unstructured grid");
}

// ---- What cannot be read ----

TEST(ReadErrors, FilesThatAreNone) {
    expect_error(scratch_folder() / "missing.vtu", ErrorKind::file, "No such file");
    expect_error(scratch_folder(), ErrorKind::file, "a folder");
    expect_error(write("empty.vtu", ""), ErrorKind::format, "0 bytes");
    expect_error("/dev/null", ErrorKind::file, "no regular file");
}

TEST(ReadErrors, FilesOfNoKnownFormat) {
    expect_error(write("notes.txt", "Dear diary\x01,"), ErrorKind::format, "starts with \"Dear diary.,\"");
    expect_error(write("page.xml", "<?xml version=\"1.0\"?><html/>"), ErrorKind::format, "<VTKFile");
}

TEST(ReadErrors, OtherVtkDatasetsAreNamed) {
    expect_error(write("surface.vtp", vtu_around("", "PolyData")), ErrorKind::format, "the type PolyData");
    expect_error(write("grid.vtk", "# vtk DataFile Version 3.0\nDATASET of mine\nASCII\nDATASET POLYDATA\n"),
                 ErrorKind::format, "the type POLYDATA");
    expect_error(write("none.vtk", "# vtk DataFile Version 3.0\ntitle\nASCII\n"), ErrorKind::format, "no dataset type");
    expect_error(write("none.vtu", "<VTKFile version=\"1.0\"></VTKFile>"), ErrorKind::format, "no dataset type");
}

TEST(ReadErrors, ATruncatedVtuWhereverItIsCut) {
    const std::string whole = vtu({});
    for (std::size_t size = 1; size + 1 < whole.size(); size += 5) {  // the last byte is an empty line's
        SCOPED_TRACE("cut at " + std::to_string(size));
        EXPECT_EQ(error_of(write("cut.vtu", whole.substr(0, size))).kind(), ErrorKind::format);
    }
}

TEST(ReadErrors, ATruncatedLegacyFileUpToItsFields) {
    // Every section behind CELL_TYPES may be missing altogether, so a cut between arrays is no error.
    const std::string whole = vtk({});
    const std::size_t fields = whole.find("CELL_DATA");
    for (std::size_t size = 1; size + 2 < fields; size += 3) {
        SCOPED_TRACE("cut at " + std::to_string(size));
        error_of(write("cut.vtk", whole.substr(0, size)));
    }
    expect_error(write("cut.vtk", whole.substr(0, whole.find("8.5"))), ErrorKind::format, "ascii data");
}

TEST(ReadErrors, MalformedXml) {
    std::string text = vtu({});
    text.replace(text.find("</Points>"), 9, "</Pionts>");
    expect_error(write("bad.vtu", text), ErrorKind::format, "mismatched tag");
}

TEST(ReadErrors, NoVolumeCells) {
    GridText grid;
    grid.cells = {{0, 1, 2}, {0, 2, 3}, {0, 1, 5, 4}};
    grid.types = {5, 5, 9};
    grid.vtu_fields = grid.vtk_fields = "";
    for (const fs::path& file : {write("flat.vtu", vtu(grid)), write("flat.vtk", vtk(grid))}) {
        expect_error(file, ErrorKind::data, "2 of kind \"triangle\", 1 of kind \"quad\"");
    }
    grid.cells.clear();
    grid.types.clear();
    expect_error(write("none.vtu", vtu(grid)), ErrorKind::data, "no cells");
}

TEST(ReadErrors, VertexIdsOutsideThePoints) {
    for (const int id : {9, -1, 2000000000}) {
        GridText grid;
        grid.cells[2][3] = id;
        for (const fs::path& file : {write("ids.vtu", vtu(grid)), write("ids.vtk", vtk(grid))}) {
            expect_error(file, ErrorKind::data, "the id " + std::to_string(id));
            EXPECT_NE(error_of(file).place().find("cell 2"), std::string::npos);
        }
    }
}

TEST(ReadErrors, CellsWithTheWrongNumberOfVertices) {
    GridText grid;
    grid.cells[2] = {4, 5, 7};
    for (const fs::path& file : {write("short.vtu", vtu(grid)), write("short.vtk", vtk(grid))}) {
        expect_error(file, ErrorKind::format, "expected 4 vertices");
    }
    // Counts that overrun the list crash VTK 9.1's legacy reader.
    std::string text = vtk({});
    text.replace(text.find("\n4 4 5 7 8"), 3, "\n99 ");
    expect_error(write("overrun.vtk", text), ErrorKind::format, "the block CELLS");
}

TEST(ReadErrors, OffsetsThatLeaveTheList) {
    std::string text = vtu({});
    text.replace(text.find("8 11 15 16"), 10, "8 -3 99 16");
    EXPECT_EQ(error_of(write("offsets.vtu", text)).kind(), ErrorKind::format);
}

TEST(ReadErrors, PointsThatAreNotFinite) {
    for (const std::string coordinate : {"nan", "inf", "-inf"}) {
        GridText grid;
        grid.points.replace(grid.points.find("0.5 0.5 2"), 3, coordinate);
        // VTK reads text through streams, which know no NaN: whichever part refuses, the file is refused.
        const Error error = error_of(write("nan.vtu", vtu(grid)));
        EXPECT_TRUE(error.kind() == ErrorKind::format || error.kind() == ErrorKind::data);
    }
    // A legacy binary file can say NaN: big-endian, point 8's x.
    GridText grid;
    std::string text = vtk(grid);
    text.replace(text.find("ASCII"), 5, "BINARY");
    const auto big_endian = [](auto value) {
        std::string bytes(sizeof value, '\0');
        std::memcpy(bytes.data(), &value, sizeof value);
        if constexpr (std::endian::native == std::endian::little) std::reverse(bytes.begin(), bytes.end());
        return bytes;
    };
    std::string points, cells, types;
    std::istringstream stream(grid.points);
    for (double x = 0; stream >> x;)
        points += big_endian(x);
    points.replace(8 * 3 * sizeof(double), sizeof(double), big_endian(std::nan("")));
    for (const auto& cell : grid.cells) {
        cells += big_endian(static_cast<std::int32_t>(cell.size()));
        for (const int id : cell)
            cells += big_endian(id);
    }
    for (const int type : grid.types)
        types += big_endian(type);
    const std::string binary =
        text.substr(0, text.find(grid.points)) + points + "\nCELLS 4 20\n" + cells + "\nCELL_TYPES 4\n" + types + "\n";
    expect_error(write("nan.vtk", binary), ErrorKind::data, "point 8: expected finite coordinates, found (nan");
}

TEST(ReadErrors, ASolutionIsForPlot3dOnly) {
    EXPECT_EQ(error_of(write("a.vtu", vtu({})), {write("a.q", "anything")}).kind(), ErrorKind::option);
}

TEST(Read, LeavesVtksMessagesAsTheyWere) {
    const vtkOutputWindow* const window = vtkOutputWindow::GetInstance();
    const auto verbosity = vtkLogger::GetCurrentVerbosityCutoff();
    const std::string first = error_of(write("bad.vtu", vtu({}).replace(60, 1, "<"))).what();
    EXPECT_EQ(error_of(scratch_folder() / "bad.vtu").what(), first);  // no message is lost the second time
    read(write("good.vtu", vtu({})));
    EXPECT_EQ(vtkOutputWindow::GetInstance(), window);
    EXPECT_EQ(vtkLogger::GetCurrentVerbosityCutoff(), verbosity);
}

// ---- Files that others wrote ----

TEST_F(ReadSharedData, InlineAndCompressedAppendedVtuAgree) {
    const Dataset inlined = read(data / "aneurysm_tets_openfoam/aneurysm_tets_internal.vtu");
    const Dataset appended = read(data / "aneurysm_tets_openfoam/aneurysm_tets_lz4_appended_raw.vtu");
    EXPECT_EQ(inlined.cells.size(), 101354U);
    EXPECT_EQ(inlined.points, appended.points);
    EXPECT_EQ(inlined.cells.vertices, appended.cells.vertices);
    ASSERT_EQ(appended.cell_fields.size(), 2U);
    EXPECT_EQ(inlined.cell_fields[0].values, appended.cell_fields[0].values);
}

TEST_F(ReadSharedData, ATruncatedAppendedVtu) {
    const std::string whole = testing_support::bytes_of(data / "can_hex/can.vtu");
    ASSERT_EQ(read(data / "can_hex/can.vtu").cells.size(), 4800U);
    for (const double share : {0.001, 0.01, 0.3, 0.9, 0.99999}) {
        const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
        expect_error(write("cut.vtu", whole.substr(0, size)), ErrorKind::format, "cut.vtu");
    }
}

TEST_F(ReadSharedData, EveryKindOfCell) {
    const Dataset dataset = read(data / "classic_small/uGridEx.vtk");
    EXPECT_EQ(dataset.cells.size(), 4U);
    EXPECT_EQ(dataset.skipped_cells, 8U);
    EXPECT_EQ(tetrahedralize(dataset).tets.size(), 14U);  // two hexahedra, two tetrahedra
}

TEST_F(ReadSharedData, FilesStoredInsideOut) {
    TetrahedralizeReport fire;
    tetrahedralize(read(data / "fire_hex/fire_ug.vtu"), &fire);
    EXPECT_EQ(fire.tets, 62772U);
    EXPECT_EQ(fire.flipped, 62772U);
    TetrahedralizeReport small;
    tetrahedralize(read(data / "classic_small/tetraMesh.vtk"), &small);
    EXPECT_EQ(small.tets, 160U);
    EXPECT_EQ(small.flipped, 80U);
}

}  // namespace
}  // namespace cellproj
