// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of second order and Lagrange cells, cut at their nodes. VTK's own source of such meshes says where the nodes
// lie.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypeSource.h>
#include <vtkDoubleArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include "mesh/cell_faces.hpp"
#include "mesh/io/curved_cells.hpp"
#include "mesh/tetrahedralize.hpp"
#include "mesh/text_formats.hpp"
#include "mesh/io/vtk_conversion.hpp"
#include "tests/read_fixtures.hpp"

namespace cellproj {
namespace curved_cells_test {

// `grid` stays: to_dataset empties what it is given.
Dataset dataset_of(vtkUnstructuredGrid& grid, const char* place, int subdivide = 1) {
    vtkNew<vtkUnstructuredGrid> copy;
    copy->DeepCopy(&grid);
    return to_dataset(*copy, place, place, subdivide);
}

double volume_of(const TetMesh& mesh) {
    double sum = 0;
    for (CellId t = 0; t < mesh.tets.size(); ++t)
        sum += signed_volume(mesh, t);
    return sum;
}

// Nine nodes of a square can tell these apart: every quadratic term and the two of third order that the eight-node face
// has.
double f(const glm::dvec3& x) {
    return 1 + 2 * x.x - 3 * x.y + x.z + x.x * x.x + 2 * x.y * x.y - x.z * x.z + x.x * x.y - 2 * x.y * x.z + x.z * x.x;
}

void add_field(vtkUnstructuredGrid& grid) {
    vtkNew<vtkDoubleArray> values;
    values->SetName("f");
    for (vtkIdType p = 0; p < grid.GetNumberOfPoints(); ++p) {
        glm::dvec3 x;
        grid.GetPoint(p, &x.x);
        values->InsertNextValue(f(x));
    }
    grid.GetPointData()->AddArray(values);
}

// The quadratic field is met at every point that was made.
void expect_field(const Dataset& dataset) {
    for (std::size_t p = 0; p < dataset.points.size(); ++p) {
        // Coordinates up to 2, so terms up to 8; a dozen roundings of float64.
        EXPECT_NEAR(field(dataset.point_fields, "f").values[p], f(dataset.points[p]), 1e-14 * 100) << p;
    }
}

struct Source {
    int type;
    int order;
    std::size_t pieces;  // of each cell
    const char* name;
};

std::ostream& operator<<(std::ostream& stream, const Source& source) {
    return stream << source.name;
}

class CellsOfHigherOrder : public testing::TestWithParam<Source> {
protected:
    // The cube [0, 2]³, filled with cells of the type.
    vtkSmartPointer<vtkUnstructuredGrid> cube() const {
        vtkNew<vtkCellTypeSource> source;
        source->SetCellType(GetParam().type);
        source->SetCellOrder(GetParam().order);
        source->SetBlocksDimensions(2, 2, 2);
        source->SetOutputPrecision(vtkAlgorithm::DOUBLE_PRECISION);
        source->Update();
        vtkSmartPointer<vtkUnstructuredGrid> grid = source->GetOutput();
        grid->GetPointData()->Initialize();
        grid->GetCellData()->Initialize();
        return grid;
    }
};

TEST_P(CellsOfHigherOrder, ArePavedByTheirPieces) {
    const auto grid = cube();
    add_field(*grid);
    const Dataset dataset = dataset_of(*grid, "cube");
    EXPECT_EQ(dataset.cells.size(), static_cast<std::size_t>(grid->GetNumberOfCells()) * GetParam().pieces);
    EXPECT_EQ(dataset.skipped_cells, 0U);
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset, &report);
    EXPECT_EQ(report.flat, 0U);
    EXPECT_EQ(report.inverted, 0U);
    EXPECT_NEAR(volume_of(mesh), 8.0, 1e-11);  // up to 6144 roundings of a sum up to 8, 1e-15 each
    expect_field(dataset);
}

// Points inside the cube are moved, so that nearly all cells are curved. The cube stays full and no crack opens: faces
// that only one tetrahedron has lie on the cube's sides.
TEST_P(CellsOfHigherOrder, FitTheirNeighbours) {
    const auto grid = cube();
    for (vtkIdType p = 0; p < grid->GetNumberOfPoints(); ++p) {
        glm::dvec3 x;
        grid->GetPoint(p, &x.x);
        constexpr double pi = std::numbers::pi;
        const double bump = 0.05 * std::sin(pi * x.x / 2) * std::sin(pi * x.y / 2) * std::sin(pi * x.z / 2);
        grid->GetPoints()->SetPoint(p, x.x + bump * x.y, x.y - bump * x.z, x.z + bump);
    }
    TetrahedralizeReport report;
    const TetMesh mesh = tetrahedralize(dataset_of(*grid, "cube"), &report);
    EXPECT_EQ(report.inverted, 0U);
    EXPECT_NEAR(volume_of(mesh), 8.0, 1e-11);
    const Adjacency adjacency = build_adjacency(mesh);
    EXPECT_EQ(adjacency.overused_faces, 0U);
    for (CellId t = 0; t < mesh.tets.size(); ++t) {
        for (int face = 0; face < 4; ++face) {
            if (adjacency.neighbours[t][static_cast<std::size_t>(face)] != no_cell) continue;
            bool on_side = false;
            for (int axis = 0; axis < 3; ++axis) {
                for (const double side : {0.0, 2.0}) {
                    bool all = true;
                    for (int corner = 0; corner < 4; ++corner) {
                        const VertexId v = mesh.tets[t][static_cast<std::size_t>(corner)];
                        all = all && (corner == face || std::abs(mesh.points[v][axis] - side) < 1e-14);
                    }
                    on_side = on_side || all;
                }
            }
            EXPECT_TRUE(on_side) << "tetrahedron " << t << ", face " << face;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Vtk, CellsOfHigherOrder,
                         testing::Values(Source{VTK_QUADRATIC_TETRA, 2, 8, "tetra"},
                                         Source{VTK_QUADRATIC_HEXAHEDRON, 2, 8, "hexahedron"},
                                         Source{VTK_QUADRATIC_WEDGE, 2, 8, "wedge"},
                                         Source{VTK_QUADRATIC_PYRAMID, 2, 10, "pyramid"},
                                         Source{VTK_TRIQUADRATIC_PYRAMID, 2, 10, "triquadratic pyramid"},
                                         Source{VTK_LAGRANGE_TETRAHEDRON, 2, 8, "Lagrange tetra, order 2"},
                                         Source{VTK_LAGRANGE_TETRAHEDRON, 4, 64, "Lagrange tetra, order 4"},
                                         Source{VTK_LAGRANGE_HEXAHEDRON, 2, 8, "Lagrange hexahedron, order 2"},
                                         Source{VTK_LAGRANGE_HEXAHEDRON, 3, 27, "Lagrange hexahedron, order 3"},
                                         Source{VTK_LAGRANGE_WEDGE, 2, 8, "Lagrange wedge, order 2"},
                                         Source{VTK_LAGRANGE_WEDGE, 3, 27, "Lagrange wedge, order 3"}));

// ---- Single cells ----

// A cell of the type with its nodes where VTK puts them in its unit cell.
vtkSmartPointer<vtkUnstructuredGrid> unit_cell(int type) {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    std::vector<vtkIdType> ids;
    for (vtkIdType n = 0; n < cell->GetNumberOfPoints(); ++n) {
        points->InsertNextPoint(cell->GetParametricCoords() + 3 * n);
        ids.push_back(n);
    }
    grid->SetPoints(points);
    grid->InsertNextCell(type, static_cast<vtkIdType>(ids.size()), ids.data());
    return grid;
}

TEST(CurvedCells, CentresThatATypeHasAreUsed) {
    struct Type {
        int type;
        double volume;
        std::size_t pieces, new_points;
    };
    for (const Type& type :
         {Type{VTK_QUADRATIC_HEXAHEDRON, 1.0, 8, 7}, Type{VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, 1.0, 8, 3},
          Type{VTK_TRIQUADRATIC_HEXAHEDRON, 1.0, 8, 0}, Type{VTK_QUADRATIC_LINEAR_WEDGE, 0.5, 4, 0},
          Type{VTK_QUADRATIC_WEDGE, 0.5, 8, 3}, Type{VTK_BIQUADRATIC_QUADRATIC_WEDGE, 0.5, 8, 0}}) {
        SCOPED_TRACE(type.type);
        const auto grid = unit_cell(type.type);
        add_field(*grid);
        const Dataset dataset = dataset_of(*grid, "cell");
        EXPECT_EQ(dataset.cells.size(), type.pieces);
        EXPECT_EQ(dataset.points.size(), static_cast<std::size_t>(grid->GetNumberOfPoints()) + type.new_points);
        TetrahedralizeReport report;
        EXPECT_NEAR(volume_of(tetrahedralize(dataset, &report)), type.volume, 1e-15);
        EXPECT_EQ(report.flat, 0U);
        if (type.type != VTK_QUADRATIC_LINEAR_WEDGE) expect_field(dataset);
    }
}

// The top of the unit cube bent to z = 1 + 4 a x (1 - x): 1 + 2a/3 in all, a quadratic face, so the cell is exactly
// that. Corners alone give 1; two chords from the nodes give 1 + a/2: a quarter of the error is left.
TEST(CurvedCells, TwoChordsLeaveAQuarterOfTheError) {
    for (const double a : {0.25, -0.125}) {
        for (const int type :
             {VTK_QUADRATIC_HEXAHEDRON, VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, VTK_TRIQUADRATIC_HEXAHEDRON}) {
            const auto grid = unit_cell(type);
            for (vtkIdType p = 0; p < grid->GetNumberOfPoints(); ++p) {
                glm::dvec3 x;
                grid->GetPoint(p, &x.x);
                grid->GetPoints()->SetPoint(p, x.x, x.y, x.z * (1 + 4 * a * x.x * (1 - x.x)));
            }
            const double exact = 1 + 2 * a / 3;
            const double corners = volume_of(tetrahedralize(dataset_of(*grid, "cell", 0)));
            const double nodes = volume_of(tetrahedralize(dataset_of(*grid, "cell", 1)));
            EXPECT_NEAR((exact - nodes) / (exact - corners), 0.25, 1e-13) << a << " " << type;
        }
    }
}

TEST(CurvedCells, PiecesRepeatTheValueOfTheirCellAndLinearCellsStay) {
    Dataset dataset;
    dataset.points.resize(15);
    dataset.cells.kinds = {CellKind::tetrahedron, CellKind::tetrahedron, CellKind::tetrahedron};
    dataset.cells.offsets = {0, 4, 8, 12};
    dataset.cells.vertices = {0, 1, 2, 3, 1, 2, 3, 4, 1, 2, 4, 5};
    dataset.cell_fields = {{"c", 2, {1, 2, 3, 4, 5, 6}}};
    CurvedCells curved;
    const std::vector<VertexId> nodes{1, 2, 3, 4, 9, 10, 11, 12, 13, 14};
    constexpr std::array<std::int8_t, 6> places{4, 5, 6, 7, 8, 9};
    curved.add(1, nodes, places);
    subdivide_at_nodes(dataset, curved);
    ASSERT_EQ(dataset.cells.size(), 10U);
    EXPECT_EQ(dataset.cells.offsets.back(), 40U);
    EXPECT_EQ(std::vector<VertexId>(dataset.cells.vertices.begin(), dataset.cells.vertices.begin() + 8),
              (std::vector<VertexId>{0, 1, 2, 3, 1, 9, 11, 12}));
    EXPECT_EQ(std::vector<VertexId>(dataset.cells.vertices.end() - 4, dataset.cells.vertices.end()),
              (std::vector<VertexId>{1, 2, 4, 5}));
    for (std::size_t c = 0; c < 10; ++c)
        EXPECT_EQ(dataset.cell_fields[0].values[2 * c + 1], c == 0 ? 2 : c == 9 ? 6 : 4);
    EXPECT_EQ(dataset.points.size(), 15U);
}

// ---- The readers of our own ----

// Gmsh puts the nodes of edges, then of faces, in the order of their sorted corners; but for its tetrahedron.
struct GmshCell {
    int type;
    CellKind kind;
    std::vector<std::vector<int>> nodes;  // the corners whose mean each further node is
    double volume;
};

const std::vector<std::vector<int>> hex_edges{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                              {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
const std::vector<std::vector<int>> wedge_edges{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 4}, {2, 5}, {3, 4}, {3, 5}, {4, 5}};
const std::vector<std::vector<int>> pyramid_edges{{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};

std::vector<std::vector<int>> joined(std::vector<std::vector<int>> edges, const std::vector<std::vector<int>>& faces) {
    edges.insert(edges.end(), faces.begin(), faces.end());
    return edges;
}

TEST(CurvedCells, OfGmsh) {
    const std::array<GmshCell, 7> cells{
        {{11, CellKind::tetrahedron, {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}, 1.0 / 6},
         {17, CellKind::hexahedron, hex_edges, 1},
         {12, CellKind::hexahedron,
          joined(hex_edges, {{0, 1, 2, 3},
                             {0, 1, 4, 5},
                             {0, 3, 4, 7},
                             {1, 2, 5, 6},
                             {2, 3, 6, 7},
                             {4, 5, 6, 7},
                             {0, 1, 2, 3, 4, 5, 6, 7}}),
          1},
         {18, CellKind::wedge, wedge_edges, 0.5},
         {13, CellKind::wedge, joined(wedge_edges, {{0, 1, 3, 4}, {0, 2, 3, 5}, {1, 2, 4, 5}}), 0.5},
         {19, CellKind::pyramid, pyramid_edges, 1.0 / 3},
         {14, CellKind::pyramid, joined(pyramid_edges, {{0, 1, 2, 3}}), 1.0 / 3}}};
    const std::vector<glm::dvec3> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                       {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    for (const GmshCell& cell : cells) {
        SCOPED_TRACE(cell.type);
        std::vector<glm::dvec3> points = cube;
        if (cell.kind == CellKind::tetrahedron) points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        if (cell.kind == CellKind::wedge) points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
        if (cell.kind == CellKind::pyramid) points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
        for (const std::vector<int>& corners : cell.nodes) {
            glm::dvec3 mean(0.0);
            for (const int c : corners)
                mean += points[static_cast<std::size_t>(c)] / static_cast<double>(corners.size());
            points.push_back(mean);
        }
        std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(points.size()) + "\n";
        std::string ids;
        for (std::size_t p = 0; p < points.size(); ++p) {
            text += std::to_string(p + 1) + " " + std::to_string(points[p].x) + " " + std::to_string(points[p].y) +
                    " " + std::to_string(points[p].z) + "\n";
            ids += " " + std::to_string(p + 1);
        }
        text += "$EndNodes\n$Elements\n1\n1 " + std::to_string(cell.type) + " 2 5 6" + ids + "\n$EndElements\n";
        const fs::path file = write("cell.msh", text);
        const Dataset dataset = read(file);
        EXPECT_EQ(dataset.cells.size(), cell.kind == CellKind::pyramid ? 10U : 8U);
        EXPECT_EQ(field(dataset.cell_fields, "physical").values, std::vector<double>(dataset.cells.size(), 5.0));
        TetrahedralizeReport report;
        EXPECT_NEAR(volume_of(tetrahedralize(dataset, &report)), cell.volume, 1e-15);
        EXPECT_EQ(report.flat, 0U);
        const Dataset by_corners = read(file, {.subdivide = 0});
        EXPECT_EQ(by_corners.cells.kinds, std::vector<CellKind>{cell.kind});
        EXPECT_EQ(by_corners.cells.vertices.size(), vertex_count(cell.kind));
    }
}

// As TetGen 1.5.0 wrote it (tetgen -o2) for the unit tetrahedron.
TEST(CurvedCells, OfTetGen) {
    const fs::path file = write("unit.node",
                                "10 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 0.5 0 0.5\n5 0.5 0 0\n6 0 0.5 0\n"
                                "7 0 0.5 0.5\n8 0.5 0.5 0\n9 0 0 0.5\n");
    write("unit.ele", "1 10 1\n0 0 2 3 1 4 5 6 7 8 9 2.5\n");
    const Dataset dataset = read(file);
    EXPECT_EQ(dataset.cells.size(), 8U);
    EXPECT_EQ(field(dataset.cell_fields, "region").values, std::vector<double>(8, 2.5));
    TetrahedralizeReport report;
    EXPECT_NEAR(volume_of(tetrahedralize(dataset, &report)), 1.0 / 6, 1e-16);
    EXPECT_EQ(report.flat, 0U);
    EXPECT_EQ(read(file, {.subdivide = 0}).cells.size(), 1U);
}

}  // namespace
}  // namespace cellproj
