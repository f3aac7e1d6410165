// SPDX-License-Identifier: BSD-3-Clause
//
// The formats that `read` gives to VTK's readers, beyond unstructured VTK files (read_test.cpp) and PLOT3D: small files
// written here, whole and cut off; real ones in read_cases_test.cpp.
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkDataSetWriter.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataSetWriter.h>
#include <vtkXMLMultiBlockDataWriter.h>

#include "mesh/io/merge_blocks.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace read_formats_test {

// ---- Small datasets, written by VTK ----

constexpr std::array<int, 3> dims{3, 4, 2};
constexpr std::size_t point_count = 24;
constexpr std::size_t cell_count = 6;

glm::dvec3 position(int i, int j, int k) {
    return {1.0 + 0.5 * i, 2.0 + j, -1.0 + 2.0 * k};
}

// The point field "x + 10 y" and the cell field "number".
void add_fields(vtkDataSet& data) {
    vtkNew<vtkDoubleArray> values, numbers;
    values->SetName("x + 10 y");
    numbers->SetName("number");
    for (vtkIdType p = 0; p < data.GetNumberOfPoints(); ++p) {
        values->InsertNextValue(data.GetPoint(p)[0] + 10 * data.GetPoint(p)[1]);
    }
    for (vtkIdType c = 0; c < data.GetNumberOfCells(); ++c)
        numbers->InsertNextValue(static_cast<double>(c));
    data.GetPointData()->AddArray(values);
    data.GetCellData()->AddArray(numbers);
}

vtkNew<vtkImageData> image(std::array<int, 3> n = dims) {
    vtkNew<vtkImageData> grid;
    grid->SetDimensions(n.data());
    grid->SetOrigin(1, 2, -1);
    grid->SetSpacing(0.5, 1, 2);
    add_fields(*grid);
    return grid;
}

vtkNew<vtkRectilinearGrid> rectilinear() {
    vtkNew<vtkRectilinearGrid> grid;
    grid->SetDimensions(dims.data());
    std::array<vtkNew<vtkDoubleArray>, 3> axes;
    for (int d = 0; d < 3; ++d) {
        const auto axis = static_cast<std::size_t>(d);
        for (int n = 0; n < dims[axis]; ++n)
            axes[axis]->InsertNextValue(position(n, n, n)[d]);
    }
    grid->SetXCoordinates(axes[0]);
    grid->SetYCoordinates(axes[1]);
    grid->SetZCoordinates(axes[2]);
    add_fields(*grid);
    return grid;
}

vtkNew<vtkStructuredGrid> curvilinear() {
    vtkNew<vtkStructuredGrid> grid;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (int k = 0; k < dims[2]; ++k) {
        for (int j = 0; j < dims[1]; ++j) {
            for (int i = 0; i < dims[0]; ++i) {
                const glm::dvec3 p = position(i, j, k);
                points->InsertNextPoint(p.x, p.y, p.z);
            }
        }
    }
    grid->SetDimensions(dims.data());
    grid->SetPoints(points);
    add_fields(*grid);
    return grid;
}

vtkNew<vtkUnstructuredGrid> tetrahedron(double at) {
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    for (const auto& p : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
        points->InsertNextPoint(at + p.x, p.y, p.z);
    const std::array<vtkIdType, 4> ids{0, 1, 2, 3};
    grid->SetPoints(points);
    grid->InsertNextCell(VTK_TETRA, 4, ids.data());
    return grid;
}

fs::path write_xml(const std::string& name, vtkDataSet& data) {
    const fs::path file = scratch_folder() / name;
    vtkNew<vtkXMLDataSetWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(&data);
    writer->Write();
    return file;
}

fs::path write_legacy(const std::string& name, vtkDataSet& data, bool binary) {
    const fs::path file = scratch_folder() / name;
    vtkNew<vtkDataSetWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(&data);
    writer->SetFileType(binary ? VTK_BINARY : VTK_ASCII);
    writer->Write();
    return file;
}

// Blocks "grid" (structured, 6 cells), "parts/tet" (one tetrahedron) and "wall" (a triangle).
fs::path write_blocks(const std::string& name) {
    vtkNew<vtkMultiBlockDataSet> blocks, parts;
    vtkNew<vtkPolyData> wall;
    vtkNew<vtkPoints> points;
    for (int p = 0; p < 3; ++p)
        points->InsertNextPoint(p, p * p, 0);
    const std::array<vtkIdType, 3> ids{0, 1, 2};
    wall->SetPoints(points);
    wall->Allocate();
    wall->InsertNextCell(VTK_TRIANGLE, 3, ids.data());
    parts->SetBlock(0, tetrahedron(7).Get());
    parts->GetMetaData(0U)->Set(vtkCompositeDataSet::NAME(), "tet");
    blocks->SetBlock(0, curvilinear().Get());
    blocks->SetBlock(1, parts);
    blocks->SetBlock(2, wall);
    unsigned int block = 0;
    for (const char* label : {"grid", "parts", "wall"}) {
        blocks->GetMetaData(block++)->Set(vtkCompositeDataSet::NAME(), label);
    }
    const fs::path file = scratch_folder() / name;
    vtkNew<vtkXMLMultiBlockDataWriter> writer;
    writer->SetFileName(file.c_str());
    writer->SetInputData(blocks);
    writer->Write();
    return file;
}

void expect_small_grid(const Dataset& dataset) {
    ASSERT_TRUE(dataset.grid);
    EXPECT_EQ(dataset.grid->ni, 3U);
    EXPECT_EQ(dataset.grid->nj, 4U);
    EXPECT_EQ(dataset.grid->nk, 2U);
    ASSERT_EQ(dataset.points.size(), point_count);
    const std::vector<double>& values = field(dataset.point_fields, "x + 10 y").values;
    ASSERT_EQ(values.size(), point_count);
    std::size_t p = 0;
    for (int k = 0; k < dims[2]; ++k) {
        for (int j = 0; j < dims[1]; ++j) {
            for (int i = 0; i < dims[0]; ++i, ++p) {
                EXPECT_EQ(dataset.points[p], position(i, j, k));  // halves: exact in text and in float32
                EXPECT_EQ(values[p], position(i, j, k).x + 10 * position(i, j, k).y);
            }
        }
    }
    EXPECT_EQ(field(dataset.cell_fields, "number").values, (std::vector<double>{0, 1, 2, 3, 4, 5}));
}

TEST(ReadStructured, XmlAndLegacyGiveTheSameGrid) {
    const auto structured = curvilinear();
    const auto axes = rectilinear();
    const auto voxels = image();
    const std::map<std::string, vtkDataSet*> grids{
        {"s.vts", structured.Get()}, {"r.vtr", axes.Get()}, {"i.vti", voxels.Get()}};
    for (const auto& [name, grid] : grids) {
        SCOPED_TRACE(name);
        expect_small_grid(read(write_xml(name, *grid)));
        expect_small_grid(read(write_legacy(name + ".binary.vtk", *grid, true)));
        expect_small_grid(read(write_legacy(name + ".ascii.vtk", *grid, false)));
    }
    EXPECT_EQ(read(write_xml("s.vts", *structured)).format, "VTK XML structured grid");
    EXPECT_EQ(read(write_legacy("i.vtk", *voxels, true)).format, "VTK legacy image");
}

TEST(ReadStructured, ContentDecidesBeforeSuffix) {
    expect_small_grid(read(write_xml("image.cgns", *image())));
}

TEST(ReadStructured, RefusesGridsWithoutVolume) {
    expect_error(write_xml("flat.vti", *image({3, 4, 1})), ErrorKind::data, "3 x 4 x 1 points");
    expect_error(write_legacy("line.vtk", *image({1, 4, 1}), false), ErrorKind::data, "2 points in each direction");
}

TEST(ReadStructured, LeavesBlankedCellsOut) {
    const auto grid = curvilinear();
    grid->BlankCell(1);
    grid->BlankPoint(23);  // a corner, of cell 5 only
    const Dataset dataset = read(write_xml("blanked.vts", *grid));
    EXPECT_FALSE(dataset.grid);
    EXPECT_EQ(dataset.cells.size(), 4U);
    EXPECT_EQ(dataset.ghost_cells, 2U);
    EXPECT_EQ(dataset.points.size(), point_count - 4);  // without those that cells 1 and 5 alone had
    EXPECT_EQ(field(dataset.point_fields, "x + 10 y").values.size(), point_count - 4);
    EXPECT_EQ(field(dataset.cell_fields, "number").values, (std::vector<double>{0, 2, 3, 4}));
}

TEST(ReadImages, MetaImageAndNrrd) {
    std::string voxels;
    for (int v = 0; v < 40; ++v)
        voxels += static_cast<char>(v);
    const std::string mha =
        "ObjectType = Image\nNDims = 3\nDimSize = 10 2 2\nElementSpacing = 0.5 1 2\nOffset = 1 2 -1\n"
        "ElementType = MET_UCHAR\nElementByteOrderMSB = False\nElementDataFile = LOCAL\n";
    const std::string nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 2 2\nspacings: 0.5 1 2\nencoding: raw\n\n";
    for (const fs::path& file : {write("voxels.mha", mha + voxels), write("voxels.nrrd", nrrd + voxels)}) {
        SCOPED_TRACE(file);
        const Dataset dataset = read(file);
        ASSERT_TRUE(dataset.grid);
        EXPECT_EQ(dataset.grid->cells(), 9U);
        ASSERT_EQ(dataset.points.size(), 40U);
        ASSERT_EQ(dataset.point_fields.size(), 1U);
        for (std::size_t v = 0; v < 40; ++v)
            EXPECT_EQ(dataset.point_fields[0].values[v], static_cast<double>(v));
        EXPECT_EQ(dataset.points[39] - dataset.points[0], glm::dvec3(4.5, 1, 2));
    }
}

// ---- Blocks ----

TEST(ReadBlocks, JoinsVolumesAndSkipsTheRest) {
    const Dataset dataset = read(write_blocks("blocks.vtm"));
    EXPECT_EQ(dataset.blocks, (std::vector<std::string>{"grid", "parts/tet"}));
    EXPECT_EQ(dataset.skipped_blocks, 1U);
    EXPECT_EQ(dataset.skipped_cells, 1U);
    EXPECT_FALSE(dataset.grid);
    ASSERT_EQ(dataset.points.size(), point_count + 4);
    ASSERT_EQ(dataset.cells.size(), cell_count + 1);
    EXPECT_EQ(std::vector<VertexId>(dataset.cells.vertices.begin(), dataset.cells.vertices.begin() + 8),
              (std::vector<VertexId>{0, 1, 4, 3, 12, 13, 16, 15}));
    EXPECT_EQ(std::vector<VertexId>(dataset.cells.vertices.end() - 4, dataset.cells.vertices.end()),
              (std::vector<VertexId>{24, 25, 26, 27}));
    EXPECT_EQ(dataset.cells.offsets.back(), dataset.cells.vertices.size());
    const std::vector<double>& values = field(dataset.point_fields, "x + 10 y").values;  // the tetrahedron has none
    ASSERT_EQ(values.size(), point_count + 4);
    EXPECT_FALSE(std::isnan(values[point_count - 1]));
    EXPECT_TRUE(std::isnan(values[point_count]));
    EXPECT_EQ(field(dataset.cell_fields, "number").values.size(), cell_count + 1);
}

TEST(ReadBlocks, ChoosesByName) {
    const fs::path file = write_blocks("blocks.vtm");
    expect_small_grid(read(file, {.blocks = {"grid"}}));
    for (const char* name : {"parts/tet", "parts", "tet"}) {
        EXPECT_EQ(read(file, {.blocks = {name}}).cells.size(), 1U) << name;
    }
    EXPECT_EQ(read(file, {.blocks = {"tet", "grid"}}).cell_count(), cell_count + 1);
    expect_error(file, ErrorKind::option, "\"grid\", \"parts/tet\"", {.blocks = {"wal"}});
    expect_error(write_xml("one.vts", *curvilinear()), ErrorKind::option, "without block names", {.blocks = {"grid"}});
}

TEST(ReadBlocks, MovesTheIdsOfPolyhedraButNotTheirCounts) {
    Dataset block;
    block.points.resize(4);
    block.cells.kinds = {CellKind::polyhedron};
    block.cells.vertices = {4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 2, 3};
    block.cells.offsets = {0, 17};
    const Dataset both = merge_blocks({block, block}, "polyhedra");
    ASSERT_EQ(both.cells.offsets, (std::vector<std::uint64_t>{0, 17, 34}));
    EXPECT_EQ(std::vector<VertexId>(both.cells.vertices.begin() + 17, both.cells.vertices.end()),
              (std::vector<VertexId>{4, 3, 4, 5, 6, 3, 4, 5, 7, 3, 5, 6, 7, 3, 4, 6, 7}));
}

TEST(ReadBlocks, Partitioned) {
    write_xml("a.vtu", *tetrahedron(0));
    write_xml("b.vtu", *tetrahedron(1));
    const std::string head =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\">\n<PUnstructuredGrid "
        "GhostLevel=\"0\">\n"
        "<PPoints><PDataArray type=\"Float32\" NumberOfComponents=\"3\"/></PPoints>\n";
    const std::string tail = "</PUnstructuredGrid>\n</VTKFile>\n";
    const Dataset whole =
        read(write("whole.pvtu", head + "<Piece Source=\"a.vtu\"/><Piece Source=\"b.vtu\"/>\n" + tail));
    EXPECT_EQ(whole.points.size(), 8U);
    EXPECT_EQ(whole.cells.vertices, (std::vector<VertexId>{0, 1, 2, 3, 4, 5, 6, 7}));
    expect_error(write("lost.pvtu", head + "<Piece Source=\"a.vtu\"/><Piece Source=\"c.vtu\"/>\n" + tail),
                 ErrorKind::format, "");
}

// Two pieces of a grid of 5 by 4 by 2 points that share the plane i = 2; `piece` says what a piece file holds.
TEST(ReadBlocks, PartitionedGrids) {
    struct Kind {
        const char* suffix;
        const char* type;
        const char* head;   // attributes of the whole
        const char* parts;  // what the whole says of its arrays
    };
    const std::array<Kind, 3> kinds{
        {{"vts", "StructuredGrid", "", "<PPoints><PDataArray type=\"Float64\" NumberOfComponents=\"3\"/></PPoints>"},
         {"vtr", "RectilinearGrid", "",
          "<PCoordinates><PDataArray type=\"Float64\"/><PDataArray type=\"Float64\"/><PDataArray "
          "type=\"Float64\"/></PCoordinates>"},
         {"vti", "ImageData", " Origin=\"1 2 -1\" Spacing=\"0.5 1 2\"", ""}}};
    for (const Kind& kind : kinds) {
        SCOPED_TRACE(kind.suffix);
        for (const int part : {0, 1}) {
            std::array<int, 6> extent{2 * part, 2 * part + 2, 0, 3, 0, 1};
            const std::string name = std::string(part == 0 ? "a." : "b.") + kind.suffix;
            if (kind.suffix == std::string("vts")) {
                const auto grid = curvilinear();
                grid->SetExtent(extent.data());
                for (vtkIdType p = 0; part == 1 && p < grid->GetNumberOfPoints(); ++p) {
                    glm::dvec3 x;
                    grid->GetPoint(p, &x.x);
                    grid->GetPoints()->SetPoint(p, x.x + 1, x.y, x.z);
                }
                write_xml(name, *grid);
            } else if (kind.suffix == std::string("vtr")) {
                const auto grid = rectilinear();
                grid->SetExtent(extent.data());
                for (vtkIdType i = 0; part == 1 && i < 3; ++i)
                    grid->GetXCoordinates()->SetComponent(i, 0, grid->GetXCoordinates()->GetComponent(i, 0) + 1);
                write_xml(name, *grid);
            } else {
                const auto grid = image();
                grid->SetExtent(extent.data());
                write_xml(name, *grid);
            }
        }
        const std::string type = std::string("P") + kind.type;
        const std::string text =
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"0.1\">\n<" + type +
            " WholeExtent=\"0 4 0 3 0 1\" GhostLevel=\"0\"" + kind.head +
            ">\n<PPointData><PDataArray type=\"Float64\" Name=\"x + 10 y\"/></PPointData>\n<PCellData><PDataArray "
            "type=\"Float64\" Name=\"number\"/></PCellData>\n" +
            kind.parts + "<Piece Extent=\"0 2 0 3 0 1\" Source=\"a." + kind.suffix +
            "\"/><Piece Extent=\"2 4 0 3 0 1\" Source=\"b." + kind.suffix + "\"/>\n</" + type + ">\n</VTKFile>\n";
        const Dataset dataset = read(write(std::string("whole.p") + kind.suffix, text));
        ASSERT_TRUE(dataset.grid);
        EXPECT_EQ(dataset.grid->ni, 5U);
        EXPECT_EQ(dataset.grid->cells(), 12U);
        ASSERT_EQ(dataset.points.size(), 40U);
        EXPECT_EQ(dataset.points[4], position(4, 0, 0));
        EXPECT_EQ(dataset.points[39], position(4, 3, 1));
        const std::vector<double>& numbers = field(dataset.cell_fields, "number").values;
        EXPECT_EQ(std::vector<double>(numbers.begin(), numbers.begin() + 4), (std::vector<double>{0, 1, 0, 1}));
        EXPECT_EQ(field(dataset.point_fields, "x + 10 y").values.size(), 40U);
    }
}

// ---- Fluent ----

// A case of a cube and a pyramid on top, as Fluent writes it: nodes, cells by type and faces between two cells, ids
// from 1, in hexadecimal.
std::string fluent_case() {
    return "(0 \"cube and pyramid\")\n(2 3)\n(10 (0 1 9 0 3))\n(10 (1 1 9 1 3)(\n"
           "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n0.5 0.5 2\n))\n"
           "(12 (0 1 2 0))\n(12 (2 1 2 1 0)(\n4 5\n))\n(13 (0 1 a 0))\n(13 (3 1 1 2 0)(\n4 5 6 7 8 1 2\n))\n"
           "(13 (4 2 a 3 0)(\n4 1 4 3 2 1 0\n4 1 2 6 5 1 0\n4 2 3 7 6 1 0\n4 3 4 8 7 1 0\n4 4 1 5 8 1 0\n"
           "3 5 6 9 2 0\n3 6 7 9 2 0\n3 7 8 9 2 0\n3 8 5 9 2 0\n))\n"
           "(45 (2 fluid air)())\n(45 (3 interior inside)())\n(45 (4 wall skin)())\n";
}

TEST(ReadFluent, IsToldFromGmshByItsContent) {
    for (const char* name : {"mesh.msh", "mesh.cas"}) {
        const Dataset dataset = read(write(name, fluent_case()));
        EXPECT_EQ(dataset.format, "Fluent");
        EXPECT_EQ(dataset.points.size(), 9U);
        EXPECT_EQ(dataset.cells.kinds, (std::vector<CellKind>{CellKind::hexahedron, CellKind::pyramid}));
        const TetMesh mesh = tetrahedralize(dataset);
        double volume = 0;
        for (CellId t = 0; t < mesh.tets.size(); ++t)
            volume += signed_volume(mesh, t);
        EXPECT_DOUBLE_EQ(volume, 1.0 + 1.0 / 3.0);
    }
}

TEST(ReadFluent, TakesTheValuesBesideIt) {
    const fs::path file = write("flow.cas", fluent_case());
    // Subsection 1 is the pressure: zone 2, one component, cells 1 to 2.
    write("flow.dat", "(0 \"values\")\n(300 (1 2 1 0 0 1 2)(\n3.5\n-1.25\n))\n");
    const Dataset dataset = read(file);
    ASSERT_EQ(dataset.cell_fields.size(), 1U);
    EXPECT_EQ(dataset.cell_fields[0].name, "PRESSURE");
    EXPECT_EQ(dataset.cell_fields[0].values, (std::vector<double>{3.5, -1.25}));
}

TEST(ReadFluent, PolyhedraWithoutTheirFacesAreRefused) {
    std::string text = fluent_case();
    text.replace(text.find("\n4 5\n))\n(13"), 5, "\n7 7\n");
    expect_error(write("poly.cas", text), ErrorKind::data, "convex point set");
}

// ---- Time ----

TEST(ReadTime, ACollectionGivesTheLastOrTheNearestStep) {
    for (int t = 0; t < 3; ++t)
        write_xml("t" + std::to_string(t) + ".vtu", *tetrahedron(t));
    const fs::path file = write("series.pvd",
                                "<VTKFile type=\"Collection\" version=\"0.1\"><Collection>\n"
                                "<DataSet timestep=\"0\" part=\"0\" file=\"t0.vtu\"/>\n"
                                "<DataSet timestep=\"0.5\" part=\"0\" file=\"t1.vtu\"/>\n"
                                "<DataSet timestep=\"2\" part=\"0\" file=\"t2.vtu\"/>\n</Collection></VTKFile>\n");
    const std::map<double, double> nearest{{-1, 0}, {0.2, 0}, {0.3, 0.5}, {1.2, 0.5}, {1.3, 2}, {9, 2}};
    for (const auto& [wanted, step] : nearest)
        EXPECT_EQ(read(file, {.time = wanted}).time, step);
    const Dataset last = read(file);
    EXPECT_EQ(last.time, 2.0);
    EXPECT_EQ(last.times, (std::vector<double>{0, 0.5, 2}));
    EXPECT_EQ(last.points[0].x, 2);
    expect_error(scratch_folder() / "t0.vtu", ErrorKind::option, "time steps", {.time = 1});
}

TEST(ReadTime, TheNamedPartsOfACollectionAreBlocks) {
    write_xml("a.vtu", *tetrahedron(0));
    write_xml("b.vts", *curvilinear());
    const fs::path file =
        write("parts.pvd",
              "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"1\" name=\"a\" file=\"a.vtu\"/>"
              "<DataSet timestep=\"1\" name=\"b\" file=\"b.vts\"/></Collection></VTKFile>");
    EXPECT_EQ(read(file).blocks, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(read(file).cell_count(), cell_count + 1);
    expect_small_grid(read(file, {.blocks = {"b"}}));
}

// ---- Damage ----

TEST(ReadDamaged, SmallFiles) {
    const auto structured = curvilinear();
    const auto axes = rectilinear();
    const auto voxels = image();
    for (const fs::path& file :
         {write_xml("s.vts", *structured), write_xml("r.vtr", *axes), write_xml("i.vti", *voxels),
          write_blocks("b.vtm"), write_legacy("s.vtk", *structured, true), write_legacy("r.vtk", *axes, false),
          write_legacy("i.vtk", *voxels, true)}) {
        expect_cuts_told(file, file);
    }
}

TEST(ReadDamaged, AnOpenFoamFileOutsideItsCase) {
    const fs::path file = write("alone.foam", "");
    expect_error(file, ErrorKind::file, "system/controlDict");
    expect_error(scratch_folder(), ErrorKind::file, "a folder");
}

}  // namespace
}  // namespace cellproj
