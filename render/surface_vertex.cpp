// SPDX-License-Identifier: BSD-3-Clause
#include "render/surface_vertex.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// Slopes in cells thinner than a millionth of the mesh are noise in float32.
constexpr double steepest_slope = 1e6;

// Sums of a few such terms stay finite: infinity less infinity is not a number.
float held(double x) { return static_cast<float>(std::clamp(x, -1e30, 1e30)); }

double largest_part(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
double largest_part(double x) { return std::abs(x); }

// Values of about 1.
template <class Value>
AffineMap<Value> make_map(const std::array<glm::dvec3, 4>& places, const std::array<Value, 4>& values) {
    const glm::dvec3 a = places[1] - places[0], b = places[2] - places[0], c = places[3] - places[0];
    const glm::dvec3 bc = glm::cross(b, c);
    const double volume = glm::dot(a, bc);
    const std::array weights{bc / volume, glm::cross(c, a) / volume, glm::cross(a, b) / volume};  // ∇ of the barycentric ones
    AffineMap<Value> map;
    double steepest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        auto& slope = map.slopes[static_cast<std::size_t>(axis)];
        for (std::size_t i = 0; i < 3; ++i) slope += (values[i + 1] - values[0]) * weights[i][axis];
        const double part = largest_part(slope);
        steepest = std::isfinite(part) ? std::max(steepest, part) : 2.0 * steepest_slope;
    }
    if (!(steepest <= steepest_slope)) return {0.25 * (values[0] + values[1] + values[2] + values[3]), {}};
    map.value = values[0] - (places[0].x * map.slopes[0] + places[0].y * map.slopes[1] + places[0].z * map.slopes[2]);
    return map;
}

}  // namespace

glm::dvec2 nearest_pixel(const glm::dvec2& place, ImageSize size) {
    return glm::clamp(glm::floor(place), glm::dvec2(0.0), glm::dvec2(size.width, size.height) - 1.0) + 0.5;
}

SurfaceFace make_surface_face(std::array<FaceCorner, 3> corners, ImageSize size) {
    std::sort(corners.begin(), corners.end(), [](const FaceCorner& a, const FaceCorner& b) {
        return std::tuple(a.position.x, a.position.y, a.nearness, a.scalar_term) <
               std::tuple(b.position.x, b.position.y, b.nearness, b.scalar_term);
    });
    const auto& [a, b, c] = corners;
    const glm::dvec2 low = glm::min(a.position, glm::min(b.position, c.position));
    const glm::dvec2 high = glm::max(a.position, glm::max(b.position, c.position));
    const glm::dvec2 origin = nearest_pixel(0.5 * (low + high), size);
    const glm::dvec2 ab = b.position - a.position, ac = c.position - a.position, there = origin - a.position;
    const double area = ab.x * ac.y - ab.y * ac.x, share = area != 0.0 ? 1.0 / area : 0.0;
    const auto set = [&](float* plane, double at_a, double at_b, double at_c) {
        const double rise_b = at_b - at_a, rise_c = at_c - at_a;
        const glm::dvec2 slope{(rise_b * ac.y - rise_c * ab.y) * share, (rise_c * ab.x - rise_b * ac.x) * share};
        plane[0] = held(at_a + glm::dot(slope, there));
        plane[1] = held(slope.x);
        plane[2] = held(slope.y);
    };
    SurfaceFace face{};
    set(face.nearness, a.nearness, b.nearness, c.nearness);
    set(face.scalar, a.scalar_term, b.scalar_term, c.scalar_term);
    face.origin_x = static_cast<float>(origin.x);
    face.origin_y = static_cast<float>(origin.y);
    return face;
}

AffineMap<glm::dvec3> make_gradient_map(const std::array<glm::dvec3, 4>& places, const std::array<glm::dvec3, 4>& gradients) {
    double largest = 0.0;
    for (const glm::dvec3& g : gradients) largest = std::max(largest, largest_part(g));
    if (!(largest > 0.0)) return {};
    std::array<glm::dvec3, 4> scaled;
    for (std::size_t i = 0; i < 4; ++i) scaled[i] = gradients[i] / largest;
    return make_map(places, scaled);
}

AffineMap<double> make_scalar_map(const std::array<glm::dvec3, 4>& places, const std::array<double, 4>& scalars) {
    return make_map(places, scalars);
}

}  // namespace cellproj
