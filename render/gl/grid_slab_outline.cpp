// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_slab_outline.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace cellproj::gl {

std::vector<glm::dvec3> slab_corners(const Bounds& box, const glm::dvec3& normal, double low, double high) {
    const auto corner = [&](unsigned c) {
        return glm::dvec3((c & 1U) != 0 ? box.high.x : box.low.x, (c & 2U) != 0 ? box.high.y : box.low.y,
                          (c & 4U) != 0 ? box.high.z : box.low.z);
    };
    std::vector<glm::dvec3> corners;
    for (unsigned c = 0; c < 8; ++c) {
        const glm::dvec3 p = corner(c);
        const double at = glm::dot(normal, p);
        if (low <= at && at <= high) corners.push_back(p);
        for (const unsigned along : {1U, 2U, 4U}) {
            if ((c & along) != 0) continue;
            const glm::dvec3 q = corner(c | along);
            const double until = glm::dot(normal, q);
            for (const double plane : {low, high}) {
                if ((at < plane) != (until < plane)) corners.push_back(p + (plane - at) / (until - at) * (q - p));
            }
        }
    }
    return corners;
}

// Andrew's monotone chain.
std::vector<glm::dvec2> convex_hull(std::vector<glm::dvec2> points) {
    std::sort(points.begin(), points.end(), [](const glm::dvec2& a, const glm::dvec2& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    std::vector<glm::dvec2> hull;
    const auto add = [&](const glm::dvec2& p, std::size_t least) {
        const auto turns = [&] {
            const glm::dvec2 a = hull[hull.size() - 1] - hull[hull.size() - 2], b = p - hull.back();
            return a.x * b.y - a.y * b.x > 0;
        };
        while (hull.size() > least && !turns()) hull.pop_back();
        hull.push_back(p);
    };
    for (const glm::dvec2& p : points) add(p, 1);
    const std::size_t upper = hull.size();
    for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], upper);
    hull.pop_back();  // the first point again
    return hull;
}

std::vector<glm::dvec2> outline_on_screen(const GridView& view, std::span<const glm::dvec3> corners) {
    const ScreenTransform& transform = view.transform();
    std::vector<glm::dvec2> places;
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 p = view.to_eye(corner);
        if (view.perspective() && p.z < near_depth) {
            const double width = transform.size().width, height = transform.size().height;
            return {{0, 0}, {width, 0}, {width, height}, {0, height}};
        }
        const glm::dvec2 place = transform.to_screen(p);
        for (const double x : {-outline_margin, outline_margin}) {
            for (const double y : {-outline_margin, outline_margin}) places.push_back(place + glm::dvec2(x, y));
        }
    }
    return convex_hull(std::move(places));
}

glm::vec2 clip_space(const GridView& view, const glm::dvec2& pixel) {
    const ImageSize size = view.transform().size();
    return 2.0 * pixel / glm::dvec2(size.width, size.height) - 1.0;
}

}  // namespace cellproj::gl
