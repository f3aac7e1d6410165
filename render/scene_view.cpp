// SPDX-License-Identifier: BSD-3-Clause
#include "render/scene_view.hpp"

#include <algorithm>

#include <glm/geometric.hpp>

namespace cellproj {

ScreenTransform relative_transform(const Camera& camera, ImageSize size, double length) {
    Camera relative = camera;
    relative.center = (camera.center - camera.eye) / length;
    relative.eye = glm::dvec3(0.0);
    relative.height = camera.height / length;
    return {relative, size};
}

double near_plane_depth(const Camera& camera, double length) {
    return 1e-3 * std::min(glm::distance(camera.eye, camera.center) / length, 1.0);
}

}  // namespace cellproj
