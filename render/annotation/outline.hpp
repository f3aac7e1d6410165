// SPDX-License-Identifier: BSD-3-Clause
//
// The edges of a box around the volume, split into those before it and those behind it.
//
// Rule: an edge lies before the volume when the eye sees one of its two faces, strictly, from outside; else behind it. For a convex box this is
// exact without depth: a ray through a point of a face that is seen enters the box there, so nothing inside comes before it; a ray
// through an edge of two faces that are not seen leaves the box there, so all that it meets inside comes before the edge. From
// inside no face is seen: all edges are behind.
#pragma once

#include <vector>

#include "mesh/tet_mesh.hpp"
#include "project/camera.hpp"
#include "render/annotation/canvas.hpp"

namespace cellproj {

struct BoxOutline {
    std::vector<Segment> before, behind;  // on the screen [pixels]: parts of the 12 edges beyond the near plane (scene_view.hpp)
};

BoxOutline outline_of(const Bounds& box, const Camera& camera, ImageSize size);

}  // namespace cellproj
