// SPDX-License-Identifier: BSD-3-Clause
//
// The isosurfaces of a scene and how they are lit.
#pragma once

#include "classify/isosurface.hpp"
#include "classify/lighting.hpp"

namespace cellproj {

// Where a surface's normal comes from (mesh/gradient.hpp).
enum class Shading {
    flat,    // the gradient of the cell: as planar as the surface is inside each cell (RKE00 §7)
    smooth,  // the gradients of the cell's points, linear in between (RKE00 §8, EKE01 §5.3)
    unlit    // the material's colour, without light
};

struct SurfaceScene {
    IsoSurfaces isosurfaces{{}};
    Shading shading = Shading::smooth;
    Lighting lighting = {};  // its directions in the axes of the mesh
};

}  // namespace cellproj
