// SPDX-License-Identifier: BSD-3-Clause
//
// The judge's view of clip regions, bodies and slices: what they leave of one ray. Every plane and every triangle is asked, each by itself.
//
// Triangles are decided as the cells of ray_index.hpp are: vertices are seen in the frame of the ray, and the sign of a difference of two
// products is exact (Kahan). A ray through an edge meets the triangles on both sides of it, so that a closed surface has no holes; of
// what is met at one place the first triangle counts.
#pragma once

#include <optional>
#include <span>

#include <glm/vec3.hpp>

#include "classify/segment_integral.hpp"
#include "render/judge/ray_index.hpp"
#include "render/judge/ray_surfaces.hpp"
#include "render/scene.hpp"

namespace cellproj {

// Where a ray meets a body first.
struct BodyHit {
    double t;                // on the ray [mesh units]
    const Body* body;
    glm::dvec3 normal;       // of the triangle, of any length; along its corners' turn
};

// Where a ray meets the plane of a slice, and the scalar there.
struct SliceHit {
    double t;  // on the ray [mesh units]
    double scalar;
};

struct RayWindow {
    double begin, end;            // of what the clip region keeps [t]; begin > end: nothing
    std::optional<BodyHit> body;  // from the ray's start on, clipped or not
};

// `middle`: what the ray is relative to (RayIndex::middle; 0 where it is not). Null: none. O(#planes + #triangles).
RayWindow ray_window(const ClipRegion* clip, const BodyScene* bodies, const glm::dvec3& middle, const ViewRay& ray);

// Where the ray meets a plane in the window, behind its start; nothing for a ray along it.
std::optional<double> place_on_plane(const HalfSpace& plane, const glm::dvec3& middle, const ViewRay& ray, const RayWindow& window);

// The nearest slice that the ray meets in the window: not by the triangles that renderers draw (SliceScene::cuts), but by the cells along the
// ray, of which that one counts which the plane cuts (mesh/plane_cut.hpp). `rounding`: of places along the ray [mesh units].
std::optional<SliceHit> slice_hit(const Scene& scene, const glm::dvec3& middle, const ViewRay& ray, const RayWindow& window,
                                  std::span<const RaySegment> along, double rounding);

// Where the field ends that the ray sees from the window's begin on, and the light of the body or the slice that hides the rest. Where both are at
// one place, the body is seen.
struct FieldEnd {
    double t;
    std::optional<Light> light;
};
FieldEnd field_end(const BodyScene* bodies, const SliceScene* slices, const ViewRay& ray, const RayWindow& window, const std::optional<SliceHit>& slice);

}  // namespace cellproj
