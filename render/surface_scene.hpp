// SPDX-License-Identifier: BSD-3-Clause
//
// The isosurfaces of a scene, and how they and the medium are lit.
#pragma once

#include "classify/isosurface.hpp"
#include "classify/lighting.hpp"

namespace cellproj {

// Where a surface's normal comes from (mesh/gradient.hpp).
enum class Shading {
    flat,    // the gradient of the cell: as planar as the surface is inside each cell (RKE00 §7); of a grid that of the trilinear scalar
    smooth,  // the gradients of the cell's points, linear in between (RKE00 §8, EKE01 §5.3)
    unlit    // the material's colour, without light
};

struct SurfaceScene {
    IsoSurfaces isosurfaces{{}};
    Shading shading = Shading::smooth;
    Lighting lighting = {};  // its directions in the axes of the mesh
    // The medium is lit as isosurfaces through all of its places would be (EKE01 §5.4, RS00 §8): of the light that its colour gives, it
    // sends `lit_share` to the eye. Along a ray the share is linear in each cell, between what it is where the ray enters and leaves (of a grid:
    // where it begins and ends in the cell, if it is cut there). Extinction stays as it is. Of unlit shading nothing is lit.
    bool lit_medium = false;
};

}  // namespace cellproj
