// SPDX-License-Identifier: BSD-3-Clause
//
// How many things of each kind cut the rays of a scene short.
#pragma once

#include <cstddef>
#include <string>

#include "classify/method.hpp"
#include "render/body_scene.hpp"
#include "render/clip_region.hpp"
#include "render/slice_scene.hpp"

namespace cellproj {

struct RayCuts {
    std::size_t planes = 0, bodies = 0, slices = 0, caps = 0;

    bool any() const { return planes + bodies + slices + caps > 0; }
    // Whether some are seen themselves.
    bool opaque() const { return bodies + slices + caps > 0; }
};

// Null: none.
RayCuts count_cuts(const ClipRegion* clip, const BodyScene* bodies, const SliceScene* slices);

// "2 clipping planes, 1 slice"; those that are opaque alone if so asked.
std::string describe(const RayCuts& cuts, bool opaque_alone = false);

// Whether a method draws rays that are cut so: light at vertices knows no place on a ray.
bool draws(const Method& method, const RayCuts& cuts);
// Throws Error (option) if not.
void require_drawn(const Method& method, const RayCuts& cuts);

}  // namespace cellproj
