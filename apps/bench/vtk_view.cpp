// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/vtk_view.hpp"

#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

namespace cellproj::bench {

void draw(vtkRenderWindow& window, vtkRenderer& renderer, const Camera& camera) {
    vtkCamera* view = renderer.GetActiveCamera();
    view->SetPosition(camera.eye.x, camera.eye.y, camera.eye.z);
    view->SetFocalPoint(camera.center.x, camera.center.y, camera.center.z);
    view->SetViewUp(camera.up.x, camera.up.y, camera.up.z);
    view->SetParallelProjection(camera.projection == Camera::Projection::parallel);
    view->SetParallelScale(0.5 * camera.height);
    view->SetViewAngle(camera.fov_y_degrees);
    renderer.ResetCameraClippingRange();
    window.Render();
    window.WaitForCompletion();
}

Image picture_of(vtkRenderWindow& window, ImageSize size) {
    vtkNew<vtkUnsignedCharArray> bytes;
    window.GetPixelData(0, 0, size.width - 1, size.height - 1, 0, bytes);
    Image image(size.width, size.height);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const vtkIdType at = 3 * (static_cast<vtkIdType>(size.height - 1 - y) * size.width + x);
            for (int k = 0; k < 3; ++k) image.at(x, y)[k] = static_cast<float>(bytes->GetValue(at + k)) / 255.0F;
        }
    return image;
}

}  // namespace cellproj::bench
