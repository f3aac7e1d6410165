// SPDX-License-Identifier: BSD-3-Clause
#include "render/depth_window.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "render/scene_view.hpp"

namespace cellproj {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Rows that one task draws: enough that each triangle is looked at a few times only.
constexpr int band_rows = 32;

// The side of a plane along a ray: offset + slope·z ≥ 0 is kept.
void cut(DepthInterval& interval, double offset, double slope) {
    if (slope > 0) interval.near = std::max(interval.near, -offset / slope);
    if (slope < 0) interval.far = std::min(interval.far, -offset / slope);
    if (slope == 0 && offset < 0) interval = {infinity, -infinity};
}

// Cameras in eye space and scene units, and the rays of their pixels.
class EyeRays {
public:
    EyeRays(const Camera& camera, ImageSize size, double unit)
        : transform_(relative_transform(camera, size, unit)), eye_(camera.eye), unit_(unit), units_per_pixel_(1.0 / transform_.pixels_per_unit()) {}

    bool perspective() const { return transform_.perspective(); }
    glm::dvec3 place(const glm::dvec3& point) const { return transform_.to_eye((point - eye_) / unit_); }
    glm::dvec3 direction(const glm::dvec3& v) const { return transform_.to_eye(v); }
    glm::dvec2 screen(const glm::dvec3& place) const { return transform_.to_screen(place); }
    glm::dvec2 slope(int x, int y) const {
        return (glm::dvec2(x + 0.5, y + 0.5) - transform_.principal_point()) * units_per_pixel_;
    }
    glm::dvec3 to_eye(int x, int y) const { return -transform_.ray({x + 0.5, y + 0.5}).direction; }  // in the axes of the mesh

private:
    ScreenTransform transform_;
    glm::dvec3 eye_;
    double unit_, units_per_pixel_;
};

// A half space in eye space: its side at z·(u, v, 1), or at (u, v, z), is offset + slope·z.
struct EyePlane {
    glm::dvec3 normal;
    double offset;

    void cut(DepthInterval& interval, const glm::dvec2& uv, bool perspective) const {
        const double across = normal.x * uv.x + normal.y * uv.y;
        if (perspective) {
            cellproj::cut(interval, offset, across + normal.z);
        } else {
            cellproj::cut(interval, offset + across, normal.z);
        }
    }
};

// Pixels whose centres a triangle may cover.
struct PixelBox {
    int left = 0, top = 0, right = -1, bottom = -1;
};

// A triangle of a body and the pixels whose centres it may cover.
struct SeenTriangle {
    PixelBox box;
    std::uint32_t body, number;
};

using EyeCorners = std::array<glm::dvec3, 3>;

EyeCorners corners_of(const Body& body, std::size_t number, const EyeRays& rays) {
    const auto& ids = body.triangles[number];
    return {rays.place(body.points[ids[0]]), rays.place(body.points[ids[1]]), rays.place(body.points[ids[2]])};
}

PixelBox box_of(const EyeCorners& corners, const EyeRays& rays, ImageSize size) {
    const PixelBox whole{0, 0, size.width - 1, size.height - 1};
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

// Those of all bodies, one after the other; what no pixel can see has an empty box.
std::vector<SeenTriangle> triangles_of(const BodyScene& scene, const EyeRays& rays, ImageSize size) {
    std::vector<SeenTriangle> triangles;
    for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) {
        const Body& body = scene.bodies[b];
        const std::size_t first = triangles.size();
        triangles.resize(first + body.triangles.size());
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, body.triangles.size(), 1024), [&](const auto& range) {
            for (std::size_t number = range.begin(); number != range.end(); ++number)
                triangles[first + number] = {box_of(corners_of(body, number, rays), rays, size), b, static_cast<std::uint32_t>(number)};
        });
    }
    return triangles;
}

using Band = std::vector<const SeenTriangle*>;

// The triangles that may cover pixels of each band, in their order.
std::vector<Band> by_bands(const std::vector<SeenTriangle>& triangles, int bands) {
    std::vector<Band> result(static_cast<std::size_t>(bands));
    for (const SeenTriangle& t : triangles) {
        if (t.box.left > t.box.right || t.box.top > t.box.bottom) continue;
        for (int band = t.box.top / band_rows; band <= t.box.bottom / band_rows; ++band) result[static_cast<std::size_t>(band)].push_back(&t);
    }
    return result;
}

// A triangle as rays meet it.
class TriangleDepth {
public:
    TriangleDepth(const EyeCorners& corners, bool perspective) : corners_(corners), perspective_(perspective) {
        for (std::size_t i = 0; i < 3; ++i) edges_[i] = glm::cross(corners[(i + 1) % 3], corners[(i + 2) % 3]);
    }

    // The depth at which the ray meets it; infinite where it does not, or only edge-on.
    double at(const glm::dvec2& uv) const {
        std::array<double, 3> w;
        for (std::size_t i = 0; i < 3; ++i) w[i] = perspective_ ? glm::dot(glm::dvec3(uv, 1.0), edges_[i]) : area(i, uv);
        const auto [low, high] = std::minmax({w[0], w[1], w[2]});
        const double sum = w[0] + w[1] + w[2];
        if ((low < 0 && high > 0) || sum == 0) return infinity;
        const double z = (w[0] * corners_[0].z + w[1] * corners_[1].z + w[2] * corners_[2].z) / sum;
        return perspective_ && z < 0 ? infinity : z;
    }

private:
    // Twice that of the ray and the edge opposite to a corner, on the screen.
    double area(std::size_t corner, const glm::dvec2& uv) const {
        const glm::dvec2 a = glm::dvec2(corners_[(corner + 1) % 3]) - uv, b = glm::dvec2(corners_[(corner + 2) % 3]) - uv;
        return a.x * b.y - a.y * b.x;
    }

    EyeCorners corners_;
    std::array<glm::dvec3, 3> edges_;  // of the edge opposite to each corner, the cross product of its ends
    bool perspective_;
};

struct Rows {
    int top, bottom;  // the last one included
};

// The nearest triangle of each pixel of the rows; of those at one depth, the first.
struct NearestTriangles {
    std::vector<double> depth;
    std::vector<const SeenTriangle*> triangle;  // null: none
};

NearestTriangles nearest_of(const Band& band, const BodyScene& scene, const EyeRays& rays, Rows rows, int width) {
    const auto count = static_cast<std::size_t>(rows.bottom - rows.top + 1) * static_cast<std::size_t>(width);
    NearestTriangles nearest{std::vector<double>(count, infinity), std::vector<const SeenTriangle*>(count, nullptr)};
    for (const SeenTriangle* t : band) {
        const TriangleDepth triangle(corners_of(scene.bodies[t->body], t->number, rays), rays.perspective());
        for (int y = std::max(rows.top, t->box.top); y <= std::min(rows.bottom, t->box.bottom); ++y)
            for (int x = t->box.left; x <= t->box.right; ++x) {
                const double z = triangle.at(rays.slope(x, y));
                const std::size_t i = static_cast<std::size_t>(y - rows.top) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                if (!(z < nearest.depth[i])) continue;
                nearest.depth[i] = z;
                nearest.triangle[i] = t;
            }
    }
    return nearest;
}

glm::dvec3 lit(const SeenTriangle& t, const BodyScene& scene, const glm::dvec3& to_eye) {
    const Body& body = scene.bodies[t.body];
    const auto& ids = body.triangles[t.number];
    const glm::dvec3& a = body.points[ids[0]];
    return shade(scene.lighting, body.color, glm::cross(body.points[ids[1]] - a, body.points[ids[2]] - a), to_eye);
}

std::vector<EyePlane> planes_of(const ClipRegion& region, const EyeRays& rays) {
    std::vector<EyePlane> planes;
    for (const HalfSpace& half_space : region.half_spaces) {
        const glm::dvec3 n = rays.direction(unit_normal(half_space));
        planes.push_back({n, -glm::dot(n, rays.place(half_space.point))});
    }
    return planes;
}

}  // namespace

bool DepthWindow::is_needed(const Scene& scene) {
    return (scene.clip && !scene.clip->half_spaces.empty()) || (scene.bodies && !scene.bodies->bodies.empty());
}

DepthWindow::DepthWindow(const Scene& scene, const Camera& camera, ImageSize size, double unit) {
    const EyeRays rays(camera, size, unit);
    const std::size_t count = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    pixels_.assign(count, {rays.perspective() ? 0.0 : -infinity, infinity});
    if (scene.clip) validate(*scene.clip, "clip region");
    const std::vector<EyePlane> planes = scene.clip ? planes_of(*scene.clip, rays) : std::vector<EyePlane>{};
    std::vector<SeenTriangle> triangles;
    if (scene.bodies) {
        validate(*scene.bodies);
        triangles = triangles_of(*scene.bodies, rays, size);
        bodies_.resize(count);
        covered_.resize(count);
    }

    const int bands = (size.height + band_rows - 1) / band_rows;
    const std::vector<Band> of_band = by_bands(triangles, bands);
    oneapi::tbb::parallel_for(0, bands, [&](int index) {
        const Rows rows{index * band_rows, std::min((index + 1) * band_rows, size.height) - 1};
        const std::size_t first = static_cast<std::size_t>(rows.top) * static_cast<std::size_t>(size.width);
        const Band& band = of_band[static_cast<std::size_t>(index)];
        NearestTriangles nearest;
        if (!band.empty()) nearest = nearest_of(band, *scene.bodies, rays, rows, size.width);
        std::size_t i = 0;
        for (int y = rows.top; y <= rows.bottom; ++y)
            for (int x = 0; x < size.width; ++x, ++i) {
                DepthInterval& pixel = pixels_[first + i];
                for (const EyePlane& plane : planes) plane.cut(pixel, rays.slope(x, y), rays.perspective());
                if (band.empty() || !nearest.triangle[i]) continue;
                pixel.far = std::min(pixel.far, nearest.depth[i]);
                bodies_[first + i] = lit(*nearest.triangle[i], *scene.bodies, rays.to_eye(x, y));
                covered_[first + i] = 1;
            }
    });
}

void DepthWindow::add_bodies(Image& image) const {
    assert(image.pixels.size() == pixels_.size());
    for (std::size_t i = 0; i < covered_.size(); ++i)
        if (covered_[i]) image.pixels[i] += (1.0F - image.pixels[i].a) * glm::vec4(bodies_[i], 1.0F);
}

}  // namespace cellproj
