// SPDX-License-Identifier: BSD-3-Clause
//
// What clip regions, opaque bodies and slices leave of each pixel's ray: one interval of depths. A renderer cuts its segments there; bodies
// and slices themselves, which end what a ray sees, go behind its picture. How rays meet planes and triangles: eye_rays.hpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "project/camera.hpp"
#include "render/grid_scene.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"

namespace cellproj {

// Along the viewing axis from the eye [SceneUnits::length]: from 0 on in perspective, from −infinity in parallel views.
struct DepthInterval {
    double near, far;

    bool empty() const { return !(near < far); }
};

class DepthWindow {
public:
    // Of a scene whose rays are cut (ray_cuts). `unit`: SceneUnits::length, GridUnits::length. Parallel over rows, the same for any number of
    // threads. O(#pixels · (#planes + #slices of a grid) + #triangles · rows of tiles + pixels that triangles cover). Throws Error as
    // `validate` of regions, bodies and slices.
    DepthWindow(const Scene& scene, const Camera& camera, ImageSize size, double unit);
    DepthWindow(const GridScene& scene, const Camera& camera, ImageSize size, double unit);

    std::span<const DepthInterval> pixels() const { return pixels_; }  // row by row

    // Composites bodies and slices behind what the picture holds.
    void add_opaque(Image& image) const;

private:
    struct Cuts;
    DepthWindow(const Cuts& cuts, const Camera& camera, ImageSize size, double unit);

    std::vector<DepthInterval> pixels_;
    std::vector<glm::vec3> colors_;     // of bodies, lit, and slices; row by row, or none
    std::vector<std::uint8_t> covered_; // where there is one
};

}  // namespace cellproj
