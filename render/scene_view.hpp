// SPDX-License-Identifier: BSD-3-Clause
//
// A camera as the backends use it: about its own eye, in the units of the scene.
#pragma once

#include "project/camera.hpp"

namespace cellproj {

// The camera with lengths in units of `length` [mesh units], relative to its eye: large coordinates cancel in float64, once.
ScreenTransform relative_transform(const Camera& camera, ImageSize size, double length);

// Depth of the near plane in perspective, in units of `length`: a thousandth of the distance to what the camera looks at, or of `length`
// where that is nearer.
double near_plane_depth(const Camera& camera, double length);

}  // namespace cellproj
