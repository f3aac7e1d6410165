// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/vtk_frames.hpp"

#include <vtkAutoInit.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkProjectedTetrahedraMapper.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridLinearRayIntegrator.h>
#include <vtkUnstructuredGridPreIntegration.h>
#include <vtkUnstructuredGridVolumeRayCastMapper.h>
#include <vtkUnstructuredGridVolumeZSweepMapper.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <stdexcept>

#include "apps/bench/vtk_view.hpp"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingVolumeOpenGL2)

namespace cellproj::bench {

namespace {

vtkSmartPointer<vtkUnstructuredGrid> make_grid(const Scene& scene) {
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

vtkSmartPointer<vtkVolumeProperty> make_property(const TransferFunction& transfer) {
    double densest = 0;
    for (const ExtinctionNode& node : transfer.extinction_nodes()) densest = std::max(densest, node.extinction);
    vtkNew<vtkColorTransferFunction> color;
    vtkNew<vtkPiecewiseFunction> opacity;
    for (const double s : transfer.breakpoints()) {
        const glm::dvec3 c = transfer.color(s);
        color->AddRGBPoint(s, c.r, c.g, c.b);
        opacity->AddPoint(s, transfer.extinction(s) / densest);
    }
    auto property = vtkSmartPointer<vtkVolumeProperty>::New();
    property->SetColor(color);
    property->SetScalarOpacity(opacity);
    property->SetScalarOpacityUnitDistance(1 / densest);
    property->SetInterpolationTypeToLinear();
    property->ShadeOff();
    return property;
}

vtkSmartPointer<vtkUnstructuredGridVolumeMapper> make_mapper(const std::string& name) {
    if (name == "vtk-projected") return vtkSmartPointer<vtkProjectedTetrahedraMapper>::New();
    if (name == "vtk-zsweep") {
        auto mapper = vtkSmartPointer<vtkUnstructuredGridVolumeZSweepMapper>::New();
        mapper->SetAutoAdjustSampleDistances(false);
        mapper->SetImageSampleDistance(1.0F);
        mapper->SetIntermixIntersectingGeometry(false);
        return mapper;
    }
    auto mapper = vtkSmartPointer<vtkUnstructuredGridVolumeRayCastMapper>::New();
    mapper->SetAutoAdjustSampleDistances(false);
    mapper->SetImageSampleDistance(1.0F);
    mapper->SetIntermixIntersectingGeometry(false);
    if (name == "vtk-linear") mapper->SetRayIntegrator(vtkNew<vtkUnstructuredGridLinearRayIntegrator>());
    else if (name == "vtk-preintegration") mapper->SetRayIntegrator(vtkNew<vtkUnstructuredGridPreIntegration>());
    else throw std::invalid_argument("VTK has no " + name);
    return mapper;
}

class VtkMapper final : public Contender {
public:
    VtkMapper(const std::string& name, const Scene& scene, ImageSize size)
        : name_(name), size_(size), grid_(make_grid(scene)), property_(make_property(*scene.transfer)) {}

    // VTK has nothing to do before the first frame but to open its window.
    void set_up() override {
        const auto mapper = make_mapper(name_);
        mapper->SetInputData(grid_);
        vtkNew<vtkVolume> volume;
        volume->SetMapper(mapper);
        volume->SetProperty(property_);
        renderer_->AddVolume(volume);
        renderer_->SetBackground(0, 0, 0);
        window_->SetOffScreenRendering(true);
        window_->SetMultiSamples(0);
        window_->SetSize(size_.width, size_.height);
        window_->AddRenderer(renderer_);
    }

    Statistics draw(const Camera& camera) override {
        bench::draw(*window_, *renderer_, camera);
        return {};
    }

    Image picture() const override { return picture_of(*window_, size_); }

    // The ray casters look through the lower left corner of a pixel, found by comparing their pictures with the reference at shifted
    // places: RMS of vtk-linear, grid:17, ramp, 256²: .0061 at the centres, .0032 at these corners, .006 and more at the others.
    glm::dvec2 ray_shift() const override {
        return name_ == "vtk-linear" || name_ == "vtk-preintegration" ? glm::dvec2(-0.5, 0.5) : glm::dvec2(0);
    }

private:
    std::string name_;
    ImageSize size_;
    vtkSmartPointer<vtkUnstructuredGrid> grid_;
    vtkSmartPointer<vtkVolumeProperty> property_;
    vtkNew<vtkRenderer> renderer_;
    mutable vtkNew<vtkRenderWindow> window_;
};

}  // namespace

std::vector<std::string> vtk_contender_names() { return {"vtk-projected", "vtk-preintegration", "vtk-linear", "vtk-zsweep"}; }

std::unique_ptr<Contender> make_vtk_contender(const std::string& name, const Scene& scene, ImageSize size) {
    return std::make_unique<VtkMapper>(name, scene, size);
}

}  // namespace cellproj::bench
