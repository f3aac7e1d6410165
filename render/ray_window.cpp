// SPDX-License-Identifier: BSD-3-Clause
#include "render/ray_window.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <glm/geometric.hpp>

#include "render/ray_frame.hpp"

namespace cellproj {

namespace {

// Where the ray meets a triangle; nothing where it does not, or only edge-on.
std::optional<double> meet(const std::array<FramePoint, 3>& p) {
    std::array<double, 3> w;  // of the corner opposite to each edge
    for (std::size_t i = 0; i < 3; ++i) w[i] = cross_product(p[(i + 1) % 3], p[(i + 2) % 3]);
    const auto [low, high] = std::minmax({w[0], w[1], w[2]});
    if ((low < 0 && high > 0) || (low == 0 && high == 0)) return std::nullopt;
    return (w[0] * p[0].t + w[1] * p[1].t + w[2] * p[2].t) / (w[0] + w[1] + w[2]);
}

}  // namespace

RayWindow ray_window(const Scene& scene, const glm::dvec3& middle, const ViewRay& ray) {
    RayWindow window{ray.start, std::numeric_limits<double>::infinity(), std::nullopt};
    const auto nothing = [&] {
        window.begin = std::numeric_limits<double>::infinity();
        window.end = -window.begin;
    };
    for (const HalfSpace& half_space : scene.clip ? scene.clip->half_spaces : std::vector<HalfSpace>{}) {
        const glm::dvec3 n = unit_normal(half_space);
        const double ahead = glm::dot(n, ray.origin - (half_space.point - middle)), speed = glm::dot(n, ray.direction);
        if (speed > 0) window.begin = std::max(window.begin, -ahead / speed);
        if (speed < 0) window.end = std::min(window.end, -ahead / speed);
        if (speed == 0 && ahead < 0) nothing();
    }
    if (!scene.bodies) return window;
    const RayFrame frame(ray);
    std::vector<FramePoint> places;
    for (const Body& body : scene.bodies->bodies) {
        places.clear();
        for (const glm::dvec3& point : body.points) places.push_back(frame.see(point - middle));
        for (const auto& triangle : body.triangles) {
            const auto t = meet({places[triangle[0]], places[triangle[1]], places[triangle[2]]});
            if (!t || !(*t >= ray.start) || (window.body && !(*t < window.body->t))) continue;
            const glm::dvec3& a = body.points[triangle[0]];
            window.body = {*t, &body, glm::cross(body.points[triangle[1]] - a, body.points[triangle[2]] - a)};
        }
    }
    return window;
}

}  // namespace cellproj
