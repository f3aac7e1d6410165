// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/ray_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "render/judge/ray_frame.hpp"

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

// The side of a plane along a ray: ahead + speed·t ≥ 0 is kept.
struct PlaneOnRay {
    double ahead, speed;

    PlaneOnRay(const HalfSpace& half_space, const glm::dvec3& middle, const ViewRay& ray) {
        const glm::dvec3 n = unit_normal(half_space);
        ahead = glm::dot(n, ray.origin - (half_space.point - middle));
        speed = glm::dot(n, ray.direction);
    }
    double root() const { return -ahead / speed; }
};

// Whether the plane of a slice cuts a cell, or only touches it.
enum class Met { not_at_all, touched, cut };

Met meet(const Slice& slice, const TetMesh& mesh, CellId cell) {
    const glm::dvec3 normal = unit_normal(slice.plane);
    bool above = false, below = false, on = false;
    for (const VertexId v : mesh.tets[cell]) {
        const double distance = distance_to_plane(mesh.points[v], slice.plane.point, normal);
        above = above || distance > 0;
        below = below || distance < 0;
        on = on || distance == 0;
    }
    if (above && (below || on)) return Met::cut;
    return on && !slice.cap ? Met::touched : Met::not_at_all;
}

}  // namespace

std::optional<SliceHit> slice_hit(const Scene& scene, const glm::dvec3& middle, const ViewRay& ray, const RayWindow& window,
                                  std::span<const RaySegment> along, double rounding) {
    std::optional<SliceHit> nearest;
    if (!scene.slices) return nearest;
    for (const Slice& slice : scene.slices->slices) {
        const auto place = place_on_plane(slice.plane, middle, ray, window);
        if (!place || (nearest && !(*place < nearest->t))) continue;
        const double t = *place;
        const RaySegment* best = nullptr;
        Met how = Met::not_at_all;
        for (const RaySegment& segment : along) {
            if (segment.enter - rounding > t || segment.leave + rounding < t) continue;
            const Met met = meet(slice, *scene.mesh, segment.cell);
            if (met <= how) continue;
            how = met;
            best = &segment;
        }
        if (!best) continue;
        const double scalar = best->at(std::clamp(t, best->enter, best->leave));
        if (SliceColors(*scene.slices->colors).at(scalar)) nearest = {t, scalar};
    }
    return nearest;
}

std::optional<double> place_on_plane(const HalfSpace& plane, const glm::dvec3& middle, const ViewRay& ray, const RayWindow& window) {
    const double t = PlaneOnRay(plane, middle, ray).root();
    if (!std::isfinite(t) || !(t > ray.start) || !(t >= window.begin && t <= window.end)) return std::nullopt;
    return t;
}

FieldEnd field_end(const BodyScene* bodies, const SliceScene* slices, const ViewRay& ray, const RayWindow& window, const std::optional<SliceHit>& slice) {
    const std::optional<BodyHit>& body = window.body;
    if (slice && !(body && body->t <= slice->t)) return {slice->t, layer(*SliceColors(*slices->colors).at(slice->scalar), 1.0)};
    if (!body) return {window.end, std::nullopt};
    return {std::min(body->t, window.end), layer(shade(bodies->lighting, body->body->color, body->normal, -ray.direction), 1.0)};
}

RayWindow ray_window(const ClipRegion* clip, const BodyScene* bodies, const glm::dvec3& middle, const ViewRay& ray) {
    RayWindow window{ray.start, std::numeric_limits<double>::infinity(), std::nullopt};
    const auto nothing = [&] {
        window.begin = std::numeric_limits<double>::infinity();
        window.end = -window.begin;
    };
    for (const HalfSpace& half_space : clip ? std::span(clip->half_spaces) : std::span<const HalfSpace>()) {
        const PlaneOnRay plane(half_space, middle, ray);
        if (plane.speed > 0) window.begin = std::max(window.begin, plane.root());
        if (plane.speed < 0) window.end = std::min(window.end, plane.root());
        if (plane.speed == 0 && plane.ahead < 0) nothing();
    }
    if (!bodies) return window;
    const RayFrame frame(ray);
    std::vector<FramePoint> places;
    for (const Body& body : bodies->bodies) {
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
