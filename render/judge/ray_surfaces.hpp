// SPDX-License-Identifier: BSD-3-Clause
//
// The judge's view of one ray: its segments cell by cell, and the isosurfaces that it meets on them.
//
// A surface is met where the ray changes sides (classify/isosurface.hpp). The scalar on a face is one number for both its cells,
// so that it is met once there. Where the scalar jumps from a segment to the one that follows it at the same place (a cell lies
// between that the ray crosses with no length, or a hanging point), the surfaces between both values lie in that place: an
// isosurface has no holes but those of the mesh.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "classify/isosurface.hpp"
#include "render/judge/ray_index.hpp"
#include "render/judge/ray_light.hpp"
#include "render/scene.hpp"

namespace cellproj {

// A part of the ray inside one cell, with its scalars.
struct RaySegment {
    CellId cell;
    double enter, leave;                       // t on the ray [mesh units]
    ScalarEnds scalars;                        // finite
    std::array<double, 4> at_enter, at_leave;  // weights of the cell's points
    ScalarEnds opacity;                        // finite, of the opacity field; 0 without one

    double share(double t) const;       // of the way from enter to leave, 0..1
    double at(double t) const;          // the scalar
    double opacity_at(double t) const;  // that of the opacity field
};

// By ascending `enter`. Cells that touch a scalar of either field which is not finite are left out.
std::vector<RaySegment> ray_segments(const Scene& scene, const std::vector<Crossing>& crossings);

// A place where a ray meets an isosurface.
struct SurfaceHit {
    std::size_t surface;            // index into the scene's isosurfaces, by ascending value
    double t;                       // on the ray [mesh units]
    bool rising;                    // the front side is seen
    CellId cell;                    // where the scalar jumps, the one in front
    std::array<double, 4> weights;  // of the cell's points there
};

// How far two t of one place may lie apart, for a mesh of that extent: 4e-15 of it (ray_index.hpp: a few units of 1e-16).
inline double rounding_along_ray(double extent) { return 4e-15 * extent; }

// By ascending t; at one place in the order in which the ray passes them. Segments not longer than `rounding` ≥ 0 [mesh units]
// count as crossed with no length: which end comes first is chance there, and the jump over them tells the same. Where
// cells overlap, each has its own surfaces, and jumps are not looked for.
std::vector<SurfaceHit> surface_hits(const IsoSurfaces& surfaces, std::span<const RaySegment> segments, double rounding);

}  // namespace cellproj
