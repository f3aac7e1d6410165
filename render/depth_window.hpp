// SPDX-License-Identifier: BSD-3-Clause
//
// What clip regions and opaque bodies leave of each pixel's ray: one interval of depths. A renderer cuts its segments there; the bodies
// themselves, which end what a ray sees, go behind its picture.
//
// In eye space a ray is z·(u, v, 1) in perspective and (u, v, z) in parallel views, and the side of a plane is affine in z along it: its
// root cuts the interval, exactly but for rounding, for planes at any place, through the eye or along the ray too. A ray meets a triangle
// abc where its volumes with the three edges have one sign, d·(a×b), d·(b×c), d·(c×a) (in parallel views areas on the screen): no division,
// no clipping at the eye, and bit for bit one number, but for its sign, for both triangles of an edge, so that closed bodies have no
// holes. These are the weights of the corners, with which depths are mixed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "project/camera.hpp"
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
    // The scene is clipped or has bodies.
    static bool is_needed(const Scene& scene);

    // Of a scene that needs it. `unit`: SceneUnits::length. Parallel over rows, the same for any number of threads. O(#pixels · #planes +
    // #triangles · rows of tiles + pixels that triangles cover). Throws Error as `validate` of regions and bodies.
    DepthWindow(const Scene& scene, const Camera& camera, ImageSize size, double unit);

    std::span<const DepthInterval> pixels() const { return pixels_; }  // row by row

    // Composites the bodies behind what the picture holds.
    void add_bodies(Image& image) const;

private:
    std::vector<DepthInterval> pixels_;
    std::vector<glm::vec3> bodies_;     // colours, lit; row by row, or none
    std::vector<std::uint8_t> covered_; // where there is one
};

}  // namespace cellproj
