// SPDX-License-Identifier: BSD-3-Clause
#include "render/ray_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// a·d − b·c, of which the sign is right (Kahan).
double difference_of_products(double a, double d, double b, double c) {
    const double product = b * c;
    return std::fma(a, d, -product) + std::fma(-b, c, product);
}

// Points in the frame of the ray: x and y across it, z along it from its origin.
struct RayFrame {
    glm::dvec3 across, up, along, origin;

    RayFrame(const ViewRay& ray, const glm::dvec3& middle) : along(ray.direction), origin(ray.origin), middle_(middle) {
        const glm::dvec3 size = glm::abs(along);
        const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0) : size.y <= size.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
        across = glm::normalize(glm::cross(along, axis));
        up = glm::cross(along, across);
    }
    glm::dvec3 operator()(const glm::dvec3& point) const {
        const glm::dvec3 p = (point - middle_) - origin;
        return {glm::dot(p, across), glm::dot(p, up), glm::dot(p, along)};
    }

private:
    glm::dvec3 middle_;
};

// Where the ray, the z-axis, meets a triangle; nothing where it does not, or only edge-on.
std::optional<double> meet(const std::array<glm::dvec3, 3>& p) {
    std::array<double, 3> w;  // of the corner opposite to each edge
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &a = p[(i + 1) % 3], &b = p[(i + 2) % 3];
        w[i] = difference_of_products(a.x, b.y, a.y, b.x);
    }
    const auto [low, high] = std::minmax({w[0], w[1], w[2]});
    if ((low < 0 && high > 0) || (low == 0 && high == 0)) return std::nullopt;
    return (w[0] * p[0].z + w[1] * p[1].z + w[2] * p[2].z) / (w[0] + w[1] + w[2]);
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
    const RayFrame frame(ray, middle);
    std::vector<glm::dvec3> places;
    for (const Body& body : scene.bodies->bodies) {
        places.clear();
        for (const glm::dvec3& point : body.points) places.push_back(frame(point));
        for (const auto& triangle : body.triangles) {
            const auto t = meet({places[triangle[0]], places[triangle[1]], places[triangle[2]]});
            if (!t || *t < ray.start || (window.body && *t >= window.body->t)) continue;
            const glm::dvec3& a = body.points[triangle[0]];
            window.body = {*t, &body, glm::cross(body.points[triangle[1]] - a, body.points[triangle[2]] - a)};
        }
    }
    return window;
}

}  // namespace cellproj
