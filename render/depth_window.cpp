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

using Range = oneapi::tbb::blocked_range<int>;
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
        : transform_(relative_transform(camera, size, unit)), eye_(camera.eye), unit_(unit) {}

    bool perspective() const { return transform_.perspective(); }
    glm::dvec3 place(const glm::dvec3& point) const { return transform_.to_eye((point - eye_) / unit_); }
    glm::dvec3 direction(const glm::dvec3& v) const { return transform_.to_eye(v); }
    glm::dvec2 screen(const glm::dvec3& place) const { return transform_.to_screen(place); }
    glm::dvec2 slope(int x, int y) const {
        return (glm::dvec2(x + 0.5, y + 0.5) - transform_.principal_point()) / transform_.pixels_per_unit();
    }
    glm::dvec3 to_eye(int x, int y) const { return -transform_.ray({x + 0.5, y + 0.5}).direction; }  // in the axes of the mesh

private:
    ScreenTransform transform_;
    glm::dvec3 eye_;
    double unit_;
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

struct EyeTriangle {
    std::array<glm::dvec3, 3> corners;
    std::array<glm::dvec3, 3> edges;  // perspective: of the edge opposite to each corner, the cross product of its ends
    PixelBox box;
    std::uint32_t body, number;
};

PixelBox box_of(const EyeTriangle& triangle, const EyeRays& rays, ImageSize size) {
    const PixelBox whole{0, 0, size.width - 1, size.height - 1};
    if (rays.perspective()) {
        const auto [nearest, farthest] = std::minmax({triangle.corners[0].z, triangle.corners[1].z, triangle.corners[2].z});
        if (farthest <= 0) return {};
        if (nearest <= 1e-9 * farthest) return whole;  // it passes the eye, or is infinitely large on the screen
    }
    glm::dvec2 low(infinity), high(-infinity);
    for (const glm::dvec3& corner : triangle.corners) {
        const glm::dvec2 p = rays.screen(corner);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    // Rounding of a place on the screen, generously: what covers is decided pixel by pixel.
    const double margin = 1e-3;
    const auto first = [&](double v) { return static_cast<int>(std::clamp(std::ceil(v - 0.5 - margin), 0.0, 16384.0)); };
    const auto last = [&](double v, int side) { return static_cast<int>(std::clamp(std::floor(v - 0.5 + margin), -1.0, side - 1.0)); };
    return {first(low.x), first(low.y), last(high.x, size.width), last(high.y, size.height)};
}

std::vector<EyeTriangle> triangles_of(const BodyScene& scene, const EyeRays& rays, ImageSize size) {
    std::vector<EyeTriangle> triangles;
    for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) {
        const Body& body = scene.bodies[b];
        std::vector<glm::dvec3> places(body.points.size());
        for (std::size_t i = 0; i < places.size(); ++i) places[i] = rays.place(body.points[i]);
        for (std::uint32_t number = 0; number < body.triangles.size(); ++number) {
            const auto& ids = body.triangles[number];
            EyeTriangle t{{places[ids[0]], places[ids[1]], places[ids[2]]}, {}, {}, b, number};
            t.box = box_of(t, rays, size);
            if (t.box.left > t.box.right || t.box.top > t.box.bottom) continue;
            for (std::size_t i = 0; i < 3; ++i) t.edges[i] = glm::cross(t.corners[(i + 1) % 3], t.corners[(i + 2) % 3]);
            triangles.push_back(t);
        }
    }
    return triangles;
}

// The depth at which the ray meets it; infinite where it does not, or only edge-on.
double depth_on(const EyeTriangle& t, const glm::dvec2& uv, bool perspective) {
    std::array<double, 3> w;
    for (std::size_t i = 0; i < 3; ++i) {
        if (perspective) {
            w[i] = glm::dot(glm::dvec3(uv, 1.0), t.edges[i]);
        } else {
            const glm::dvec2 a = glm::dvec2(t.corners[(i + 1) % 3]) - uv, b = glm::dvec2(t.corners[(i + 2) % 3]) - uv;
            w[i] = a.x * b.y - a.y * b.x;
        }
    }
    const auto [low, high] = std::minmax({w[0], w[1], w[2]});
    const double sum = w[0] + w[1] + w[2];
    if ((low < 0 && high > 0) || sum == 0) return infinity;
    const double z = (w[0] * t.corners[0].z + w[1] * t.corners[1].z + w[2] * t.corners[2].z) / sum;
    return perspective && z < 0 ? infinity : z;
}

}  // namespace

bool DepthWindow::is_needed(const Scene& scene) {
    return (scene.clip && !scene.clip->half_spaces.empty()) || (scene.bodies && !scene.bodies->bodies.empty());
}

DepthWindow::DepthWindow(const Scene& scene, const Camera& camera, ImageSize size, double unit) {
    const EyeRays rays(camera, size, unit);
    const bool perspective = rays.perspective();
    const auto width = static_cast<std::size_t>(size.width);
    std::vector<EyePlane> planes;
    if (scene.clip) {
        validate(*scene.clip, "clip region");
        for (const HalfSpace& half_space : scene.clip->half_spaces) {
            const glm::dvec3 n = rays.direction(unit_normal(half_space));
            planes.push_back({n, -glm::dot(n, rays.place(half_space.point))});
        }
    }
    std::vector<EyeTriangle> triangles;
    if (scene.bodies) {
        validate(*scene.bodies);
        triangles = triangles_of(*scene.bodies, rays, size);
        bodies_.resize(width * static_cast<std::size_t>(size.height));
        covered_.resize(bodies_.size());
    }
    pixels_.assign(width * static_cast<std::size_t>(size.height), {perspective ? 0.0 : -infinity, infinity});

    const int bands = (size.height + band_rows - 1) / band_rows;
    oneapi::tbb::parallel_for(Range(0, bands, 1), [&](const Range& range) {
        const int top = range.begin() * band_rows, bottom = std::min(range.end() * band_rows, size.height) - 1;
        const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x); };
        for (int y = top; y <= bottom && !planes.empty(); ++y)
            for (int x = 0; x < size.width; ++x)
                for (const EyePlane& plane : planes) plane.cut(pixels_[at(x, y)], rays.slope(x, y), perspective);
        if (triangles.empty()) return;
        const std::size_t first = at(0, top);
        std::vector<double> depth(at(0, bottom + 1) - first, infinity);
        std::vector<const EyeTriangle*> nearest(depth.size(), nullptr);
        for (const EyeTriangle& t : triangles)
            for (int y = std::max(top, t.box.top); y <= std::min(bottom, t.box.bottom); ++y)
                for (int x = t.box.left; x <= t.box.right; ++x) {
                    const double z = depth_on(t, rays.slope(x, y), perspective);
                    const std::size_t i = at(x, y) - first;
                    if (!(z < depth[i])) continue;
                    depth[i] = z;
                    nearest[i] = &t;
                }
        for (int y = top; y <= bottom; ++y)
            for (int x = 0; x < size.width; ++x) {
                const EyeTriangle* t = nearest[at(x, y) - first];
                if (!t) continue;
                DepthInterval& interval = pixels_[at(x, y)];
                interval.far = std::min(interval.far, depth[at(x, y) - first]);
                const Body& body = scene.bodies->bodies[t->body];
                const auto& ids = body.triangles[t->number];
                const glm::dvec3& a = body.points[ids[0]];
                const glm::dvec3 normal = glm::cross(body.points[ids[1]] - a, body.points[ids[2]] - a);
                bodies_[at(x, y)] = shade(scene.bodies->lighting, body.color, normal, rays.to_eye(x, y));
                covered_[at(x, y)] = 1;
            }
    });
}

void DepthWindow::add_bodies(Image& image) const {
    assert(image.pixels.size() == pixels_.size());
    for (std::size_t i = 0; i < covered_.size(); ++i)
        if (covered_[i]) image.pixels[i] += (1.0F - image.pixels[i].a) * glm::vec4(bodies_[i], 1.0F);
}

}  // namespace cellproj
