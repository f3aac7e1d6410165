// SPDX-License-Identifier: BSD-3-Clause
//
// Points as a ray sees them, across it and along it: what the judges of cells (ray_index) and of bodies (ray_window) measure in.
#pragma once

#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "render/judge/ray_index.hpp"

namespace cellproj {

struct FramePoint {
    double u, v, t;  // across the ray, and along it from its origin [mesh units]
};

// a.u·b.v − a.v·b.u within 1.5 ulp, so with the right sign (Kahan; ray_index.hpp).
inline double cross_product(const FramePoint& a, const FramePoint& b) {
    const double product = a.v * b.u;
    return std::fma(a.u, b.v, -product) + std::fma(-a.v, b.u, product);
}

// The ray's axis and two unit vectors across it.
struct RayFrame {
    glm::dvec3 origin, x, y, z;

    explicit RayFrame(const ViewRay& ray) : origin(ray.origin), z(ray.direction) {
        const glm::dvec3 a = glm::abs(z);
        const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                                 : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                          : glm::dvec3(0, 0, 1);
        x = glm::normalize(glm::cross(z, least));
        y = glm::cross(z, x);
    }

    // A point relative to RayIndex::middle().
    FramePoint see(const glm::dvec3& point) const {
        const glm::dvec3 p = point - origin;
        return {glm::dot(p, x), glm::dot(p, y), glm::dot(p, z)};
    }
};

}  // namespace cellproj
