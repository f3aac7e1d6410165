// SPDX-License-Identifier: AGPL-3.0-or-later
//
// A closed surface around whatever a file holds.
#pragma once

#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

// The alpha wrap of the polygons, as MesherOptions::wrap describes it: triangles, closed, without intersections. `alpha` is
// relative to the diagonal of the box of its facets, in (0, 1]; the offset is alpha / 30. Throws Error (data), naming the
// surface, when no facet has an area.
PiecewiseLinearComplex wrapped(const Surface& surface, double alpha);

}  // namespace cellproj
