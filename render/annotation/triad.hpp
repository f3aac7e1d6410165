// SPDX-License-Identifier: BSD-3-Clause
//
// The axes of the mesh as a small cross of arrows, seen in parallel along the viewing direction: what the middle of the picture shows of
// them, also in perspective.
#pragma once

#include <array>

#include "project/camera.hpp"
#include "render/annotation/style.hpp"

namespace cellproj {

// x, y and z of unit length in the camera's frame: right, down, away from the eye.
std::array<glm::dvec3, 3> axes_seen(const Camera& camera);

// Side of the square that a triad takes [pixels].
int triad_size(const AnnotationStyle& style);

// Into `box`, of that size. Axes are drawn from the one that points away most to the one that comes nearest.
void draw_triad(Image& image, const Camera& camera, const PixelBox& box, const Font& font, const AnnotationStyle& style);

}  // namespace cellproj
