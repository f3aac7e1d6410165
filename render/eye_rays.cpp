// SPDX-License-Identifier: BSD-3-Clause
#include "render/eye_rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "render/scene_view.hpp"

namespace cellproj {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

EyeRays::EyeRays(const Camera& camera, ImageSize size, double unit)
    : transform_(relative_transform(camera, size, unit)), eye_(camera.eye), unit_(unit), units_per_pixel_(1.0 / transform_.pixels_per_unit()) {
    // The rows of a rotation are the axes of the eye.
    const glm::dvec3 x = direction({1, 0, 0}), y = direction({0, 1, 0}), z = direction({0, 0, 1});
    right_ = {x.x, y.x, z.x};
    down_ = {x.y, y.y, z.y};
    forward_ = {x.z, y.z, z.z};
}

glm::dvec3 EyeRays::point(const glm::dvec2& slope, double z) const {
    const double reach = perspective() ? z : 1.0;
    return eye_ + unit_ * (reach * slope.x * right_ + reach * slope.y * down_ + z * forward_);
}

EyePlane::EyePlane(const HalfSpace& half_space, const EyeRays& rays)
    : normal_(rays.direction(unit_normal(half_space))), offset_(-glm::dot(normal_, rays.place(half_space.point))), perspective_(rays.perspective()) {}

PixelCover cover_of(const EyeCorners& corners, const EyeRays& rays) {
    const ImageSize size = rays.size();
    const PixelCover whole{0, 0, size.width - 1, size.height - 1};
    if (rays.perspective()) {
        const auto [nearest, farthest] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
        if (farthest <= 0) return {};
        if (nearest <= 1e-9 * farthest) return whole;  // it passes the eye, or is infinitely large on the screen
    }
    glm::dvec2 low(infinity), high(-infinity);
    for (const glm::dvec3& corner : corners) {
        const glm::dvec2 p = rays.screen(corner);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (!std::isfinite(low.x + low.y + high.x + high.y)) return whole;  // beyond float64
    // Rounding of a place on the screen, generously: what covers is decided pixel by pixel.
    const double margin = 1e-3;
    const auto first = [&](double v) { return static_cast<int>(std::clamp(std::ceil(v - 0.5 - margin), 0.0, 16384.0)); };
    const auto last = [&](double v, int side) { return static_cast<int>(std::clamp(std::floor(v - 0.5 + margin), -1.0, side - 1.0)); };
    return {first(low.x), first(low.y), last(high.x, size.width), last(high.y, size.height)};
}

std::vector<std::vector<std::size_t>> by_bands(const std::vector<PixelCover>& covers, int height) {
    std::vector<std::vector<std::size_t>> bands(static_cast<std::size_t>(band_count(height)));
    for (std::size_t i = 0; i < covers.size(); ++i) {
        if (covers[i].empty()) continue;
        for (int band = covers[i].top / band_rows; band <= covers[i].bottom / band_rows; ++band) bands[static_cast<std::size_t>(band)].push_back(i);
    }
    return bands;
}

TriangleOnRays::TriangleOnRays(const EyeCorners& corners, bool perspective) : corners_(corners), perspective_(perspective) {
    for (std::size_t i = 0; i < 3; ++i) edges_[i] = glm::cross(corners[(i + 1) % 3], corners[(i + 2) % 3]);
}

std::optional<std::array<double, 3>> TriangleOnRays::shares(const glm::dvec2& uv) const {
    std::array<double, 3> w;
    for (std::size_t i = 0; i < 3; ++i) w[i] = perspective_ ? glm::dot(glm::dvec3(uv, 1.0), edges_[i]) : area(i, uv);
    const auto [low, high] = std::minmax({w[0], w[1], w[2]});
    const double sum = w[0] + w[1] + w[2];
    if ((low < 0 && high > 0) || sum == 0) return std::nullopt;
    for (double& share : w) share /= sum;
    return w;
}

double TriangleOnRays::depth(const glm::dvec2& uv) const {
    const auto w = shares(uv);
    if (!w) return infinity;
    const double z = (*w)[0] * corners_[0].z + (*w)[1] * corners_[1].z + (*w)[2] * corners_[2].z;
    return perspective_ && z < 0 ? infinity : z;
}

double TriangleOnRays::area(std::size_t corner, const glm::dvec2& uv) const {
    const glm::dvec2 a = glm::dvec2(corners_[(corner + 1) % 3]) - uv, b = glm::dvec2(corners_[(corner + 2) % 3]) - uv;
    return a.x * b.y - a.y * b.x;
}

}  // namespace cellproj
