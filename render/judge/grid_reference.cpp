// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/grid_reference.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>

#include "mesh/grid_gradient.hpp"

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

// On the planes that a crossing was made of, exactly 0 or 1: what lies across such a face then has no share.
glm::dvec3 place_in_cell(const Bounds& box, const ScreenTransform::Ray& ray, double t) {
    const glm::dvec3 place = (ray.origin + t * ray.direction - box.low) / (box.high - box.low);
    glm::dvec3 u = glm::clamp(place, 0.0, 1.0);
    for (int axis = 0; axis < 3; ++axis) {
        const double o = ray.origin[axis], d = ray.direction[axis];
        if (d == 0) continue;
        if ((box.low[axis] - o) / d == t) u[axis] = 0.0;
        if ((box.high[axis] - o) / d == t) u[axis] = 1.0;
    }
    return u;
}

// Between the values of the corners that have a share: where these are equal, or nearly, rounding must not make another
// value of them.
double scalar_at(const std::array<double, 8>& corners, const glm::dvec3& u) {
    const std::array<double, 8> weights = corner_weights(u);
    double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t c = 0; c < 8; ++c) {
        if (weights[c] == 0) continue;
        sum += weights[c] * corners[c];
        low = std::min(low, corners[c]);
        high = std::max(high, corners[c]);
    }
    return std::clamp(sum, low, high);
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
    const glm::dvec3 a = place_in_cell(box, ray, crossing.enter), b = place_in_cell(box, ray, crossing.leave);
    const auto value = [&](double x, double y, double z) { return scalar_at(corners, {x, y, z}); };
    const auto bounded = [&](double s) { return std::clamp(s, least, most); };
    return {{value(a.x, a.y, a.z), bounded((value(b.x, a.y, a.z) + value(a.x, b.y, a.z) + value(a.x, a.y, b.z)) / 3),
             bounded((value(a.x, b.y, b.z) + value(b.x, a.y, b.z) + value(b.x, b.y, a.z)) / 3), value(b.x, b.y, b.z)}};
}

// What a ray crosses in one cell.
struct GridReference::Piece {
    GridCrossing crossing;
    Cubic scalar;
    std::vector<IsoCrossing> surfaces;  // along it

    double at(double t) const { return (1 - t) * crossing.enter + t * crossing.leave; }
};

std::vector<GridReference::Piece> GridReference::pieces_along(const ScreenTransform::Ray& ray, bool from_origin) const {
    std::vector<Piece> pieces;
    for (const GridCrossing& crossing : cells_along(*scene_.grid, ray, from_origin)) {
        Piece piece{crossing, scalar_along(*scene_.grid, crossing, ray), {}};
        // One number, also where the faces of the grid lie too close for float64.
        if (!pieces.empty() && pieces.back().crossing.leave == crossing.enter && scene_.grid->location == FieldLocation::points)
            piece.scalar.control[0] = pieces.back().scalar.control[3];
        if (scene_.surfaces) piece.surfaces = crossings(scene_.surfaces->isosurfaces, piece.scalar);
        pieces.push_back(std::move(piece));
    }
    return pieces;
}

GridReference::GridReference(std::shared_ptr<const Grid> grid, std::shared_ptr<const TransferFunction> transfer,
                             std::shared_ptr<const SurfaceScene> surfaces)
    : scene_{std::move(grid), std::move(transfer), std::move(surfaces)} {
    validate(scene_);
    if (!has_lit_medium(scene_)) return;
    const GridUnits units = units_of(*scene_.grid);
    weak_ = weak_gradient * (units.scalar_high - units.scalar_low) / units.length;
}

std::vector<GridSurfaceHit> GridReference::surfaces_along(const ScreenTransform::Ray& ray, bool from_origin) const {
    std::vector<GridSurfaceHit> hits;
    for (const Piece& piece : pieces_along(ray, from_origin)) {
        for (const IsoCrossing& c : piece.surfaces) {
            const double t = piece.at(c.t);
            hits.push_back({c.surface, t, c.rising, piece.crossing.cell, place_in_cell(scene_.grid->cell_bounds(piece.crossing.cell), ray, t)});
        }
    }
    return hits;
}

glm::dvec3 GridReference::gradient_at(const GridSurfaceHit& hit) const {
    return has_surfaces(scene_) ? gradient(hit.cell, hit.u) : glm::dvec3(0);
}

// At a place in a cell.
glm::dvec3 GridReference::gradient(const GridCell& cell, const glm::dvec3& u) const {
    if (scene_.surfaces->shading == Shading::unlit) return glm::dvec3(0);
    const Grid& grid = *scene_.grid;
    if (scene_.surfaces->shading == Shading::flat) return trilinear_gradient(grid.corner_values(cell), u, grid.cell_edges(cell));
    const std::array<double, 8> weights = corner_weights(u);
    glm::dvec3 sum(0);
    for (std::size_t c = 0; c < 8; ++c)
        if (weights[c] > 0) sum += weights[c] * point_gradient(grid, {cell[0] + (c & 1U), cell[1] + (c >> 1U & 1U), cell[2] + (c >> 2U)});
    return sum;
}

// What the medium of a cell sends to the eye where the ray enters and leaves it.
ShareEnds GridReference::shares(const GridCrossing& crossing, const ScreenTransform::Ray& ray) const {
    const Bounds box = scene_.grid->cell_bounds(crossing.cell);
    const auto share = [&](double t) {
        const glm::dvec3 over_weak = weak_ > 0 ? gradient(crossing.cell, place_in_cell(box, ray, t)) / weak_ : glm::dvec3(0);
        return lit_share(scene_.surfaces->lighting, over_weak, -ray.direction);
    };
    return {share(crossing.enter), share(crossing.leave)};
}

// The surface as a layer of the light that it sends back along the ray.
Light GridReference::reflected(const GridSurfaceHit& hit, const glm::dvec3& direction) const {
    const SurfaceScene& surfaces = *scene_.surfaces;
    const IsoSurface& surface = surfaces.isosurfaces.surfaces()[hit.surface];
    const glm::dvec3& color = seen_color(surface, hit.rising);
    if (surfaces.shading == Shading::unlit) return layer(color, surface.opacity);
    // The front side is that of the lower scalars.
    return layer(shade(surfaces.lighting, color, -gradient_at(hit), -direction), surface.opacity);
}

Light GridReference::light(const ScreenTransform::Ray& ray, bool from_origin) const {
    CubicLight light(*scene_.transfer);
    const bool lit = has_lit_medium(scene_);
    for (const Piece& piece : pieces_along(ray, from_origin)) {
        if (light.opaque()) break;
        const double length = piece.crossing.leave - piece.crossing.enter;
        const ShareEnds ends = lit ? shares(piece.crossing, ray) : whole_share;
        double begin = 0.0;
        for (const IsoCrossing& c : piece.surfaces) {
            light.add(piece.scalar.part(begin, c.t), (c.t - begin) * length, ends.part(begin, c.t));
            const double t = piece.at(c.t);
            light.add(reflected({c.surface, t, c.rising, piece.crossing.cell, place_in_cell(scene_.grid->cell_bounds(piece.crossing.cell), ray, t)},
                                ray.direction));
            begin = c.t;
        }
        light.add(begin > 0 ? piece.scalar.part(begin, 1.0) : piece.scalar, (1 - begin) * length, ends.part(begin, 1.0));
    }
    return light.light();
}

std::vector<PixelTruth> GridReference::pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels, double slack) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return truths_of(pixels, size, slack, [&](const glm::dvec2& place) { return light(transform.ray(place), transform.perspective()); });
}

std::vector<PixelId> GridReference::sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return sample_pixels(size, count, seed, [&](const glm::dvec2& place) {
        return !cells_along(*scene_.grid, transform.ray(place), transform.perspective()).empty();
    });
}

}  // namespace cellproj
