// SPDX-License-Identifier: BSD-3-Clause
//
// Our cameras and pictures as VTK has them.
#pragma once

#include "project/camera.hpp"
#include "render/image.hpp"

class vtkRenderWindow;
class vtkRenderer;

namespace cellproj::bench {

// A whole frame from this camera, all of it when this returns.
void draw(vtkRenderWindow& window, vtkRenderer& renderer, const Camera& camera);

// The last one: 8 bits, opacity unknown (0).
Image picture_of(vtkRenderWindow& window, ImageSize size);

}  // namespace cellproj::bench
