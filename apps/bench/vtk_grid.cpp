// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/vtk_grid.hpp"

#include <vtkAutoInit.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <cmath>

#include "apps/bench/vtk_view.hpp"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingVolumeOpenGL2)

namespace cellproj::bench {

struct VtkFixedPoint::Parts {
    ImageSize size;
    vtkNew<vtkImageData> image;
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
    vtkNew<vtkVolume> volume;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkRenderWindow> window;
};

VtkFixedPoint::VtkFixedPoint(const Grid& grid, const TransferFunction& transfer, ImageSize size, double step)
    : parts_(std::make_unique<Parts>()) {
    Parts& p = *parts_;
    p.size = size;
    const GridDimensions n = grid.dimensions();
    p.image->SetDimensions(static_cast<int>(n.ni), static_cast<int>(n.nj), static_cast<int>(n.nk));
    const auto& axes = grid.axes;
    p.image->SetOrigin(axes[0].coordinates[0], axes[1].coordinates[0], axes[2].coordinates[0]);
    p.image->SetSpacing(axes[0].width(0), axes[1].width(0), axes[2].width(0));
    vtkNew<vtkFloatArray> scalars;
    scalars->SetName("f");
    scalars->SetNumberOfValues(static_cast<vtkIdType>(grid.values.size()));
    for (std::size_t i = 0; i < grid.values.size(); ++i)
        scalars->SetValue(static_cast<vtkIdType>(i), static_cast<float>(grid.values[i]));
    p.image->GetPointData()->SetScalars(scalars);

    // α = 1 − exp(−τ·u) of a short u: as good as linear in τ between the nodes, and VTK's own (1 − α)^(step/u) gives back exp(−τ·step).
    double densest = 0;
    for (const ExtinctionNode& node : transfer.extinction_nodes()) densest = std::max(densest, node.extinction);
    const double unit = 0.002 / densest;
    vtkNew<vtkColorTransferFunction> color;
    vtkNew<vtkPiecewiseFunction> opacity;
    for (const double s : transfer.breakpoints()) {
        const glm::dvec3 c = transfer.color(s);
        color->AddRGBPoint(s, c.r, c.g, c.b);
        opacity->AddPoint(s, -std::expm1(-transfer.extinction(s) * unit));
    }
    p.property->SetColor(color);
    p.property->SetScalarOpacity(opacity);
    p.property->SetScalarOpacityUnitDistance(unit);
    p.property->SetInterpolationTypeToLinear();
    p.property->ShadeOff();

    p.mapper->SetInputData(p.image);
    p.mapper->SetAutoAdjustSampleDistances(false);
    p.mapper->SetLockSampleDistanceToInputSpacing(false);
    p.mapper->SetImageSampleDistance(1.0F);
    p.mapper->SetSampleDistance(static_cast<float>(step * axes[0].width(0)));
    p.mapper->SetInteractiveSampleDistance(p.mapper->GetSampleDistance());
    p.mapper->SetIntermixIntersectingGeometry(false);
    p.volume->SetMapper(p.mapper);
    p.volume->SetProperty(p.property);
    p.renderer->AddVolume(p.volume);
    p.renderer->SetBackground(0, 0, 0);
    p.window->SetOffScreenRendering(true);
    p.window->SetMultiSamples(0);
    p.window->SetSize(size.width, size.height);
    p.window->AddRenderer(p.renderer);
}

VtkFixedPoint::~VtkFixedPoint() = default;

void VtkFixedPoint::draw(const Camera& camera) { bench::draw(*parts_->window, *parts_->renderer, camera); }

Image VtkFixedPoint::picture() const { return picture_of(*parts_->window, parts_->size); }

}  // namespace cellproj::bench
