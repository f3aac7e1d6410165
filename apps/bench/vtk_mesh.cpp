// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/vtk_mesh.hpp"

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

namespace cellproj::bench {

vtkSmartPointer<vtkUnstructuredGrid> make_vtk_grid(const Scene& scene) {
    const TetMesh& mesh = *scene.mesh;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.points.size()));
    vtkNew<vtkFloatArray> scalars;
    scalars->SetName("f");
    scalars->SetNumberOfValues(static_cast<vtkIdType>(mesh.points.size()));
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const auto id = static_cast<vtkIdType>(v);
        points->SetPoint(id, mesh.points[v].x, mesh.points[v].y, mesh.points[v].z);
        scalars->SetValue(id, static_cast<float>(scene.field->values[v]));
    }
    vtkNew<vtkIdTypeArray> corners;
    corners->SetNumberOfValues(static_cast<vtkIdType>(4 * mesh.tets.size()));
    vtkIdType next = 0;
    for (const auto& tet : mesh.tets)
        for (const VertexId v : tet) corners->SetValue(next++, v);
    vtkNew<vtkCellArray> cells;
    cells->SetData(4, corners);
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(points);
    grid->SetCells(VTK_TETRA, cells);
    grid->GetPointData()->SetScalars(scalars);
    return grid;
}

}  // namespace cellproj::bench
