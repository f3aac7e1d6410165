// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/outline.hpp"

#include <array>
#include <optional>

#include "render/scene_view.hpp"

namespace cellproj {

namespace {

// Two points of eye space to a line of the screen, cut at the near plane; nothing when they lie before it.
std::optional<Segment> on_screen(const ScreenTransform& transform, glm::dvec3 a, glm::dvec3 b, double near) {
    if (transform.perspective()) {
        if (a.z < near && b.z < near) return std::nullopt;
        const glm::dvec3 crossing = a + (b - a) * ((near - a.z) / (b.z - a.z));  // read only where the ends lie on both sides
        if (a.z < near) a = glm::dvec3(crossing.x, crossing.y, near);
        if (b.z < near) b = glm::dvec3(crossing.x, crossing.y, near);
    }
    return Segment{transform.to_screen(a), transform.to_screen(b)};
}

}  // namespace

BoxOutline outline_of(const Bounds& box, const Camera& camera, ImageSize size) {
    // In units of the box and about the eye, as the volume is: large coordinates cancel once.
    const double length = box.diagonal() > 0 ? box.diagonal() : 1;
    const ScreenTransform transform = relative_transform(camera, size, length);
    const double near = near_plane_depth(camera, length);
    const Eye eye = camera.viewpoint();
    const std::array<glm::dvec3, 2> ends{box.low, box.high};
    // seen[axis][0]: the face at the low end of the axis. An eye at infinity is beyond any bound on the side that it lies on.
    const auto beyond = [&](int axis, double bound) { return eye.xyz[axis] - (eye.at_infinity ? 0.0 : bound); };
    std::array<std::array<bool, 2>, 3> seen{};
    for (int axis = 0; axis < 3; ++axis) {
        seen[static_cast<std::size_t>(axis)][0] = beyond(axis, box.low[axis]) < 0;
        seen[static_cast<std::size_t>(axis)][1] = beyond(axis, box.high[axis]) > 0;
    }

    BoxOutline outline;
    for (int along = 0; along < 3; ++along) {
        const int u = (along + 1) % 3, v = (along + 2) % 3;
        for (std::size_t i = 0; i < 2; ++i)
            for (std::size_t j = 0; j < 2; ++j) {
                glm::dvec3 a = box.low, b = box.high;
                a[u] = b[u] = ends[i][u];
                a[v] = b[v] = ends[j][v];
                const bool before = seen[static_cast<std::size_t>(u)][i] || seen[static_cast<std::size_t>(v)][j];
                const auto line = on_screen(transform, transform.to_eye((a - camera.eye) / length), transform.to_eye((b - camera.eye) / length), near);
                if (line) (before ? outline.before : outline.behind).push_back(*line);
            }
    }
    return outline;
}

}  // namespace cellproj
