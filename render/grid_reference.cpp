// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_reference.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>

namespace cellproj {

namespace {

// The part of a ray inside the whole grid; empty where enter ≥ leave.
struct Span {
    double enter, leave;
};

Span clip_to_grid(const Grid& grid, const ScreenTransform::Ray& ray, bool from_origin) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Span span{from_origin ? 0.0 : -infinity, infinity};
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<double>& planes = grid.axes[static_cast<std::size_t>(axis)].coordinates;
        const double o = ray.origin[axis], d = ray.direction[axis];
        if (d == 0) {
            if (o < planes.front() || o >= planes.back()) return {0, 0};
            continue;
        }
        const double a = (planes.front() - o) / d, b = (planes.back() - o) / d;
        span.enter = std::max(span.enter, std::min(a, b));
        span.leave = std::min(span.leave, std::max(a, b));
    }
    return span;
}

// Where the ray crosses planes of the grid, ends included, ascending. A sorted list instead of 3D-DDA's running sums:
// it cannot drift.
std::vector<double> plane_crossings(const Grid& grid, const ScreenTransform::Ray& ray, const Span& span) {
    std::vector<double> crossings{span.enter, span.leave};
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0) continue;
        for (const double plane : grid.axes[static_cast<std::size_t>(axis)].coordinates) {
            const double t = (plane - ray.origin[axis]) / ray.direction[axis];
            if (t > span.enter && t < span.leave) crossings.push_back(t);
        }
    }
    std::sort(crossings.begin(), crossings.end());
    return crossings;
}

GridCell cell_at(const Grid& grid, const glm::dvec3& point) {
    GridCell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::vector<double>& planes = grid.axes[axis].coordinates;
        const auto above = std::upper_bound(planes.begin() + 1, planes.end() - 1, point[static_cast<int>(axis)]);
        cell[axis] = static_cast<std::size_t>(above - planes.begin()) - 1;
    }
    return cell;
}

}  // namespace

std::vector<GridCrossing> cells_along(const Grid& grid, const ScreenTransform::Ray& ray, bool from_origin) {
    std::vector<GridCrossing> cells;
    const Span span = clip_to_grid(grid, ray, from_origin);
    if (!(span.enter < span.leave)) return cells;
    const std::vector<double> crossings = plane_crossings(grid, ray, span);
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        const double enter = crossings[i], leave = crossings[i + 1];
        if (enter == leave) continue;
        const GridCell cell = cell_at(grid, ray.origin + (0.5 * enter + 0.5 * leave) * ray.direction);
        if (!grid.is_blanked(cell)) cells.push_back({cell, enter, leave});
    }
    return cells;
}

// The control points of a trilinear function along a line are its values at points whose coordinates are those of the
// one or the other end, averaged over the axes that take the second end's: means of the corners' values, so that
// nothing cancels.
Cubic scalar_along(const Grid& grid, const GridCrossing& crossing, const ScreenTransform::Ray& ray) {
    const std::array<double, 8> corners = grid.corner_values(crossing.cell);
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    const double least = *low, most = *high;
    const Bounds box = grid.cell_bounds(crossing.cell);
    const auto inside = [&](double t) {
        return glm::clamp((ray.origin + t * ray.direction - box.low) / (box.high - box.low), 0.0, 1.0);
    };
    const glm::dvec3 a = inside(crossing.enter), b = inside(crossing.leave);
    // Where all corners are equal, or nearly, rounding must not make another value of them.
    const auto value = [&](double x, double y, double z) { return interpolate(corners, {x, y, z}); };
    const auto bounded = [&](double s) { return std::clamp(s, least, most); };
    return {{bounded(value(a.x, a.y, a.z)),
             bounded((value(b.x, a.y, a.z) + value(a.x, b.y, a.z) + value(a.x, a.y, b.z)) / 3),
             bounded((value(a.x, b.y, b.z) + value(b.x, a.y, b.z) + value(b.x, b.y, a.z)) / 3),
             bounded(value(b.x, b.y, b.z))}};
}

GridReference::GridReference(std::shared_ptr<const Grid> grid, std::shared_ptr<const TransferFunction> transfer)
    : grid_(std::move(grid)), transfer_(std::move(transfer)) {
    assert(grid_ && transfer_);
    validate(*grid_, "grid");
}

Light GridReference::light(const ScreenTransform::Ray& ray, bool from_origin) const {
    CubicLight light(*transfer_);
    for (const GridCrossing& crossing : cells_along(*grid_, ray, from_origin)) {
        if (light.opaque()) break;
        light.add(scalar_along(*grid_, crossing, ray), crossing.leave - crossing.enter);
    }
    return light.light();
}

std::vector<PixelTruth> GridReference::pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels,
                                              double slack) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return truths_of(pixels, size, slack,
                     [&](const glm::dvec2& place) { return light(transform.ray(place), transform.perspective()); });
}

std::vector<PixelId> GridReference::sample(const Camera& camera, ImageSize size, std::size_t count,
                                           std::uint64_t seed) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return sample_pixels(size, count, seed, [&](const glm::dvec2& place) {
        return !cells_along(*grid_, transform.ray(place), transform.perspective()).empty();
    });
}

}  // namespace cellproj
