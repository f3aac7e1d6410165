// SPDX-License-Identifier: BSD-3-Clause
#include "render/ray_cuts.hpp"

#include <algorithm>

#include "mesh/error.hpp"

namespace cellproj {

RayCuts count_cuts(const ClipRegion* clip, const BodyScene* bodies, const SliceScene* slices) {
    RayCuts cuts;
    if (clip) cuts.planes = clip->half_spaces.size();
    if (bodies) cuts.bodies = bodies->bodies.size();
    if (!slices) return cuts;
    cuts.caps = static_cast<std::size_t>(std::ranges::count_if(slices->slices, &Slice::cap));
    cuts.slices = slices->slices.size() - cuts.caps;
    return cuts;
}

std::string describe(const RayCuts& cuts, bool opaque_alone) {
    std::string text;
    const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
        if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + (count == 1 ? one : many);
    };
    if (!opaque_alone) add(cuts.planes, "clipping plane", "clipping planes");
    add(cuts.bodies, "body", "bodies");
    add(cuts.slices, "slice", "slices");
    add(cuts.caps, "cap", "caps");
    return text;
}

bool draws(const Method& method, const RayCuts& cuts) { return !cuts.any() || !light_at_vertices(method); }

void require_drawn(const Method& method, const RayCuts& cuts) {
    if (draws(method, cuts)) return;
    throw Error({ErrorKind::option, "--method", "one of light per pixel for a scene with " + describe(cuts), to_string(method),
                 "use integral, exact or a table"});
}

}  // namespace cellproj
