// SPDX-License-Identifier: BSD-3-Clause
#include "render/depth_window.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "render/eye_rays.hpp"
#include "render/slice_view.hpp"

namespace cellproj {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The side of a plane along a ray: offset + slope·z ≥ 0 is kept.
void cut(DepthInterval& interval, const EyePlane::Side& side) {
    if (side.slope > 0) interval.near = std::max(interval.near, side.root());
    if (side.slope < 0) interval.far = std::min(interval.far, side.root());
    if (side.slope == 0 && side.offset < 0) interval = {infinity, -infinity};
}

// A triangle of a body.
struct BodyTriangle {
    std::uint32_t body, number;
};

EyeCorners corners_of(const Body& body, std::size_t number, const EyeRays& rays) {
    const auto& ids = body.triangles[number];
    return {rays.place(body.points[ids[0]]), rays.place(body.points[ids[1]]), rays.place(body.points[ids[2]])};
}

// Those of all bodies, one after the other, and where pixels may see them.
struct SeenTriangles {
    std::vector<BodyTriangle> triangles;
    std::vector<PixelCover> covers;
};

SeenTriangles triangles_of(const BodyScene& scene, const EyeRays& rays) {
    SeenTriangles seen;
    for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) {
        const Body& body = scene.bodies[b];
        const std::size_t first = seen.triangles.size();
        seen.triangles.resize(first + body.triangles.size());
        seen.covers.resize(first + body.triangles.size());
        oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, body.triangles.size(), 1024), [&](const auto& range) {
            for (std::size_t number = range.begin(); number != range.end(); ++number) {
                seen.triangles[first + number] = {b, static_cast<std::uint32_t>(number)};
                seen.covers[first + number] = cover_of(corners_of(body, number, rays), rays);
            }
        });
    }
    return seen;
}

// The nearest triangle of each pixel of the rows; of those at one depth, the first.
struct NearestTriangles {
    std::vector<double> depth;
    std::vector<const BodyTriangle*> triangle;  // null: none
};

NearestTriangles nearest_of(const std::vector<std::size_t>& band, const SeenTriangles& seen, const BodyScene& scene, const EyeRays& rays, Rows rows) {
    const int width = rays.size().width;
    const auto count = static_cast<std::size_t>(rows.bottom - rows.top + 1) * static_cast<std::size_t>(width);
    NearestTriangles nearest{std::vector<double>(count, infinity), std::vector<const BodyTriangle*>(count, nullptr)};
    for (const std::size_t t : band) {
        const TriangleOnRays triangle(corners_of(scene.bodies[seen.triangles[t].body], seen.triangles[t].number, rays), rays.perspective());
        const PixelCover& cover = seen.covers[t];
        for (int y = std::max(rows.top, cover.top); y <= std::min(rows.bottom, cover.bottom); ++y)
            for (int x = cover.left; x <= cover.right; ++x) {
                const double z = triangle.depth(rays.slope(x, y));
                const std::size_t i = static_cast<std::size_t>(y - rows.top) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
                if (!(z < nearest.depth[i])) continue;
                nearest.depth[i] = z;
                nearest.triangle[i] = &seen.triangles[t];
            }
    }
    return nearest;
}

glm::dvec3 lit(const BodyTriangle& t, const BodyScene& scene, const glm::dvec3& to_eye) {
    const Body& body = scene.bodies[t.body];
    const auto& ids = body.triangles[t.number];
    const glm::dvec3& a = body.points[ids[0]];
    return shade(scene.lighting, body.color, glm::cross(body.points[ids[1]] - a, body.points[ids[2]] - a), to_eye);
}

std::vector<EyePlane> planes_of(const ClipRegion& region, const EyeRays& rays) {
    std::vector<EyePlane> planes;
    for (const HalfSpace& half_space : region.half_spaces) planes.emplace_back(half_space, rays);
    return planes;
}

}  // namespace

// What cuts rays, of a mesh or a grid; null: none.
struct DepthWindow::Cuts {
    const ClipRegion* clip;
    const BodyScene* bodies;
    const SliceScene* slices;
    const Grid* grid;  // null: a mesh
};

DepthWindow::DepthWindow(const Scene& scene, const Camera& camera, ImageSize size, double unit)
    : DepthWindow(Cuts{scene.clip.get(), scene.bodies.get(), scene.slices.get(), nullptr}, camera, size, unit) {}

DepthWindow::DepthWindow(const GridScene& scene, const Camera& camera, ImageSize size, double unit)
    : DepthWindow(Cuts{scene.clip.get(), scene.bodies.get(), scene.slices.get(), scene.grid.get()}, camera, size, unit) {}

DepthWindow::DepthWindow(const Cuts& cuts, const Camera& camera, ImageSize size, double unit) {
    const EyeRays rays(camera, size, unit);
    const auto width = static_cast<std::size_t>(size.width);
    const std::size_t count = width * static_cast<std::size_t>(size.height);
    pixels_.assign(count, {rays.perspective() ? 0.0 : -infinity, infinity});
    if (cuts.clip) validate(*cuts.clip, "clip region");
    if (cuts.bodies) validate(*cuts.bodies);
    if (cuts.slices) validate(*cuts.slices);
    const std::vector<EyePlane> planes = cuts.clip ? planes_of(*cuts.clip, rays) : std::vector<EyePlane>{};
    const SeenTriangles triangles = cuts.bodies ? triangles_of(*cuts.bodies, rays) : SeenTriangles{};
    const auto bands = by_bands(triangles.covers, size.height);
    std::optional<const SliceView> slices;
    if (cuts.slices) slices.emplace(*cuts.slices, cuts.grid, rays);
    if (cuts.bodies || cuts.slices) {
        colors_.resize(count);
        covered_.resize(count);
    }

    oneapi::tbb::parallel_for(0, band_count(size.height), [&](int index) {
        const Rows rows = rows_of_band(index, size.height);
        const std::size_t first = static_cast<std::size_t>(rows.top) * width;
        const std::span<DepthInterval> pixels(&pixels_[first], static_cast<std::size_t>(rows.bottom - rows.top + 1) * width);
        std::size_t i = 0;
        for (int y = rows.top; y <= rows.bottom; ++y)
            for (int x = 0; x < size.width; ++x, ++i)
                for (const EyePlane& plane : planes) cut(pixels[i], plane.along(rays.slope(x, y)));

        const std::vector<std::size_t>& band = bands[static_cast<std::size_t>(index)];
        NearestTriangles bodies;
        if (!band.empty()) bodies = nearest_of(band, triangles, *cuts.bodies, rays, rows);
        SliceView::Hits sliced;
        if (slices) sliced = slices->nearest(index, pixels);
        i = 0;
        for (int y = rows.top; y <= rows.bottom; ++y)
            for (int x = 0; x < size.width; ++x, ++i) {
                const double body = band.empty() ? infinity : bodies.depth[i], slice = slices ? sliced.depth[i] : infinity;
                const double nearer = std::min(body, slice);
                if (nearer == infinity) continue;
                pixels[i].far = std::min(pixels[i].far, nearer);
                colors_[first + i] = slice < body ? sliced.color[i] : glm::vec3(lit(*bodies.triangle[i], *cuts.bodies, rays.to_eye(x, y)));
                covered_[first + i] = 1;
            }
    });
}

void DepthWindow::add_opaque(Image& image) const {
    assert(image.pixels.size() == pixels_.size());
    for (std::size_t i = 0; i < covered_.size(); ++i)
        if (covered_[i]) image.pixels[i] += (1.0F - image.pixels[i].a) * glm::vec4(colors_[i], 1.0F);
}

}  // namespace cellproj
