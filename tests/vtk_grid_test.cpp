// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataSetAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <numeric>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/tetrahedralize.hpp"
#include "mesh/io/vtk_conversion.hpp"

namespace cellproj {
namespace vtk_grid_test {

// The points (x, y, z) of a grid of 2 by 2 by `layers`, x fastest, then y: a voxel counts them 0, 1, 2, …
vtkNew<vtkUnstructuredGrid> grid_with_points(int layers) {
    vtkNew<vtkPoints> points;
    for (int z = 0; z < layers; ++z) {
        for (int p = 0; p < 4; ++p)
            points->InsertNextPoint(p % 2, p / 2, z);
    }
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(points);
    return grid;
}

void add_cell(vtkUnstructuredGrid& grid, int type, const std::vector<vtkIdType>& ids) {
    grid.InsertNextCell(type, static_cast<vtkIdType>(ids.size()), ids.data());
}

void add_marks(vtkDataSetAttributes& attributes, const std::vector<unsigned char>& marks) {
    vtkNew<vtkUnsignedCharArray> array;
    array->SetName(vtkDataSetAttributes::GhostArrayName());
    for (const unsigned char mark : marks)
        array->InsertNextValue(mark);
    attributes.AddArray(array);
}

Dataset dataset_of(vtkUnstructuredGrid& grid) {
    return to_dataset(grid, "grid.vtu", "a grid");
}

double volume_of(const Dataset& dataset) {
    const TetMesh mesh = tetrahedralize(dataset);
    double sum = 0.0;
    for (CellId t = 0; t < mesh.tets.size(); ++t)
        sum += signed_volume(mesh, t);
    return sum;
}

TEST(VtkGrid, VoxelsBecomeHexahedra) {
    const auto grid = grid_with_points(2);
    add_cell(*grid, VTK_VOXEL, {0, 1, 2, 3, 4, 5, 6, 7});
    const Dataset dataset = dataset_of(*grid);
    EXPECT_EQ(dataset.format, "a grid");
    EXPECT_EQ(dataset.cells.kinds, std::vector<CellKind>{CellKind::hexahedron});
    EXPECT_EQ(dataset.cells.vertices, (std::vector<VertexId>{0, 1, 3, 2, 4, 5, 7, 6}));
    EXPECT_DOUBLE_EQ(volume_of(dataset), 1.0);
}

TEST(VtkGrid, TakesTheCornersOfCellsOfHigherOrderOnDemand) {
    const auto grid = grid_with_points(5);
    // Twenty vertices; the corners are those of the cube, the others would be elsewhere.
    std::vector<vtkIdType> ids{0, 1, 3, 2, 4, 5, 7, 6};
    for (vtkIdType id = 8; id < 20; ++id)
        ids.push_back(id);
    add_cell(*grid, VTK_QUADRATIC_HEXAHEDRON, ids);
    const std::vector<vtkIdType> wedge{0, 1, 2, 4, 5, 6, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    add_cell(*grid, VTK_QUADRATIC_WEDGE, wedge);
    add_cell(*grid, VTK_LAGRANGE_TETRAHEDRON, {0, 1, 2, 4, 8, 9, 10, 11, 12, 13});
    const Dataset dataset = to_dataset(*grid, "grid.vtu", "a grid", 0);
    EXPECT_EQ(dataset.cells.kinds,
              (std::vector<CellKind>{CellKind::hexahedron, CellKind::wedge, CellKind::tetrahedron}));
    EXPECT_EQ(dataset.cells.offsets, (std::vector<std::uint64_t>{0, 8, 14, 18}));
    EXPECT_NEAR(volume_of(dataset), 1.0 + 1.0 / 2.0 + 1.0 / 6.0, 1e-12);
}

// The faces of the cube of the first eight points.
const std::vector<vtkIdType> cube_stream{4, 0, 2, 3, 1, 4, 4, 5, 7, 6, 4, 0, 1, 5, 4,
                                         4, 1, 3, 7, 5, 4, 3, 2, 6, 7, 4, 2, 0, 4, 6};

TEST(VtkGrid, KeepsTheFacesOfPolyhedra) {
    const auto grid = grid_with_points(3);
    add_cell(*grid, VTK_VOXEL, {4, 5, 6, 7, 8, 9, 10, 11});
    grid->InsertNextCell(VTK_POLYHEDRON, 6, cube_stream.data());
    add_cell(*grid, VTK_LINE, {0, 1});
    const Dataset dataset = dataset_of(*grid);
    EXPECT_EQ(dataset.cells.kinds, (std::vector<CellKind>{CellKind::hexahedron, CellKind::polyhedron}));
    EXPECT_EQ(dataset.cells.offsets, (std::vector<std::uint64_t>{0, 8, 39}));
    EXPECT_EQ(dataset.cells.vertices[8], 6U);
    EXPECT_TRUE(std::equal(cube_stream.begin(), cube_stream.end(), dataset.cells.vertices.begin() + 9));
    EXPECT_EQ(dataset.skipped_cells, 1U);
    EXPECT_NEAR(volume_of(dataset), 2.0, 1e-12);
}

TEST(VtkGrid, LeavesGhostsOutAndCountsThem) {
    const auto grid = grid_with_points(6);
    for (vtkIdType layer = 0; layer < 5; ++layer) {
        std::vector<vtkIdType> ids(8);
        std::iota(ids.begin(), ids.end(), 4 * layer);
        add_cell(*grid, VTK_VOXEL, ids);
    }
    add_cell(*grid, VTK_VERTEX, {0});
    add_marks(*grid->GetCellData(), {vtkDataSetAttributes::DUPLICATECELL, 0, vtkDataSetAttributes::HIDDENCELL,
                                     vtkDataSetAttributes::HIGHCONNECTIVITYCELL, 0, 0});
    std::vector<unsigned char> point_marks(24, 0);
    point_marks[0] = vtkDataSetAttributes::DUPLICATEPOINT;  // of no meaning for drawing
    point_marks[23] = vtkDataSetAttributes::HIDDENPOINT;    // in the last cell
    add_marks(*grid->GetPointData(), point_marks);
    vtkNew<vtkDoubleArray> field;
    field->SetName("c");
    for (int c = 0; c < 6; ++c)
        field->InsertNextValue(c);
    grid->GetCellData()->AddArray(field);

    const Dataset dataset = dataset_of(*grid);
    EXPECT_EQ(dataset.ghost_cells, 3U);
    EXPECT_EQ(dataset.skipped_cells, 1U);
    ASSERT_EQ(dataset.cell_fields.size(), 1U);  // the marks are no field
    EXPECT_TRUE(dataset.point_fields.empty());
    EXPECT_EQ(dataset.cell_fields[0].values, (std::vector<double>{1, 3}));
    EXPECT_NEAR(volume_of(dataset), 2.0, 1e-12);
}

ErrorKind kind_of_error(vtkUnstructuredGrid& grid) {
    try {
        dataset_of(grid);
    } catch (const Error& error) {
        EXPECT_NE(error.place().find("grid.vtu"), std::string::npos);
        return error.kind();
    }
    throw std::logic_error("no error was thrown");
}

TEST(VtkGrid, ChecksBeforeItFollows) {
    const auto short_wedge = grid_with_points(2);
    add_cell(*short_wedge, VTK_WEDGE, {0, 1, 2, 4, 5});
    EXPECT_EQ(kind_of_error(*short_wedge), ErrorKind::format);
    const auto bad_id = grid_with_points(2);
    add_cell(*bad_id, VTK_PYRAMID, {0, 1, 3, 2, 8});
    EXPECT_EQ(kind_of_error(*bad_id), ErrorKind::data);
    const auto unsupported = grid_with_points(2);
    add_cell(*unsupported, VTK_CONVEX_POINT_SET, {0, 1, 3, 2, 7});
    EXPECT_EQ(kind_of_error(*unsupported), ErrorKind::data);
    const auto surface = grid_with_points(2);
    add_cell(*surface, VTK_TRIANGLE, {0, 1, 2});
    EXPECT_EQ(kind_of_error(*surface), ErrorKind::data);
    const auto marks = grid_with_points(2);
    add_cell(*marks, VTK_VOXEL, {0, 1, 2, 3, 4, 5, 6, 7});
    add_marks(*marks->GetCellData(), {0, 0});
    EXPECT_EQ(kind_of_error(*marks), ErrorKind::format);
}

TEST(VtkGrid, ChecksFaceStreams) {
    struct Damage {
        vtkIdType at, value;
        ErrorKind kind;
    };
    // 0: number of faces; 1: vertices of the first face; 2: a vertex.
    for (const Damage& damage :
         {Damage{0, 7, ErrorKind::format}, Damage{0, 3, ErrorKind::format}, Damage{0, -1, ErrorKind::format},
          Damage{1, 2, ErrorKind::format}, Damage{1, 1000, ErrorKind::format}, Damage{2, 8, ErrorKind::data},
          Damage{2, -1, ErrorKind::data}}) {
        const auto grid = grid_with_points(2);
        grid->InsertNextCell(VTK_POLYHEDRON, 6, cube_stream.data());
        grid->GetFaces()->SetValue(damage.at, damage.value);
        EXPECT_EQ(kind_of_error(*grid), damage.kind) << damage.at << " " << damage.value;
    }
    const auto lost = grid_with_points(2);
    lost->InsertNextCell(VTK_POLYHEDRON, 6, cube_stream.data());
    lost->GetFaceLocations()->SetValue(0, 1000);
    EXPECT_EQ(kind_of_error(*lost), ErrorKind::format);
}

}  // namespace
}  // namespace cellproj
