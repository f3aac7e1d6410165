// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkAutoInit.h>
#include <vtkContourFilter.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include "apps/bench/iso_contender.hpp"
#include "apps/bench/vtk_mesh.hpp"
#include "apps/bench/vtk_view.hpp"

VTK_MODULE_INIT(vtkRenderingOpenGL2)

namespace cellproj::bench {

namespace {

class VtkContours final : public IsoContender {
public:
    explicit VtkContours(ImageSize size) {
        renderer_->SetBackground(0, 0, 0);
        renderer_->SetUseDepthPeeling(true);  // counts for translucent polygons only
        renderer_->SetMaximumNumberOfPeels(0);
        renderer_->SetOcclusionRatio(0);
        actor_->SetMapper(mapper_);
        mapper_->ScalarVisibilityOff();
        renderer_->AddActor(actor_);
        window_->SetOffScreenRendering(true);
        window_->SetMultiSamples(0);
        window_->SetAlphaBitPlanes(true);
        window_->SetSize(size.width, size.height);
        window_->AddRenderer(renderer_);
    }

    void set(const Scene& scene) override {
        if (mesh_ != scene.mesh || field_ != scene.field) {
            mesh_ = scene.mesh;
            field_ = scene.field;
            filter_->SetInputData(make_vtk_grid(scene));
        }
        const auto& surfaces = scene.surfaces->isosurfaces.surfaces();
        filter_->SetNumberOfContours(static_cast<int>(surfaces.size()));
        for (std::size_t i = 0; i < surfaces.size(); ++i) filter_->SetValue(static_cast<int>(i), surfaces[i].value);
        const bool smooth = scene.surfaces->shading == Shading::smooth;
        filter_->SetComputeNormals(smooth);
        filter_->SetComputeScalars(false);
        filter_->Update();
        mapper_->SetInputData(filter_->GetOutput());
        vtkProperty* property = actor_->GetProperty();
        const IsoSurface& first = surfaces.front();
        property->SetColor(first.color.x, first.color.y, first.color.z);
        property->SetOpacity(first.opacity);
        smooth ? property->SetInterpolationToPhong() : property->SetInterpolationToFlat();
    }

    void draw(const Camera& camera) override { bench::draw(*window_, *renderer_, camera); }

    std::size_t triangles() const override { return static_cast<std::size_t>(mapper_->GetInput()->GetNumberOfPolys()); }

private:
    std::shared_ptr<const TetMesh> mesh_;
    std::shared_ptr<const ScalarField> field_;
    vtkNew<vtkContourFilter> filter_;
    vtkNew<vtkPolyDataMapper> mapper_;
    vtkNew<vtkActor> actor_;
    vtkNew<vtkRenderer> renderer_;
    vtkNew<vtkRenderWindow> window_;
};

}  // namespace

std::unique_ptr<IsoContender> make_vtk_contours(ImageSize size) { return std::make_unique<VtkContours>(size); }

}  // namespace cellproj::bench
