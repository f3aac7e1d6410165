// SPDX-License-Identifier: BSD-3-Clause
//
// What is drawn of a regular grid, as scene.hpp of a mesh: shared, immutable parts, so that a renderer can recognise
// what it has prepared already.
#pragma once

#include <memory>

#include "classify/transfer_function.hpp"
#include "mesh/grid.hpp"
#include "render/ray_cuts.hpp"
#include "render/surface_scene.hpp"

namespace cellproj {

// Neither of the first two may be null. Do not change them while a renderer may use them.
struct GridScene {
    std::shared_ptr<const Grid> grid;
    std::shared_ptr<const TransferFunction> transfer;
    // Null: none, and nothing is lit. They lie in the medium of `transfer`. Flat shading takes the gradient of the trilinear scalar, inside the
    // cell at hand, smooth that of the points, trilinear in between (mesh/grid_gradient.hpp). A lit medium takes it where a ray enters
    // a cell, or begins in it (camera inside, clipping), and where it leaves or ends.
    std::shared_ptr<const SurfaceScene> surfaces = nullptr;
    std::shared_ptr<const ClipRegion> clip = nullptr;     // as of a mesh (scene.hpp)
    std::shared_ptr<const BodyScene> bodies = nullptr;
    std::shared_ptr<const SliceScene> slices = nullptr;   // without cuts
};

bool has_surfaces(const GridScene& scene);
bool has_lit_medium(const GridScene& scene);
RayCuts ray_cuts(const GridScene& scene);

// What of `GridScene::surfaces` not every way of drawing grids knows.
struct GridShading {
    bool isosurfaces = false, lit_medium = false;
};
inline GridShading grid_shading(const GridScene& scene) { return {has_surfaces(scene), has_lit_medium(scene)}; }

// Throws Error (data) when the grid is not sound (mesh/grid.hpp) or all its cells are blanked, Error (option) for
// isosurfaces of a field on cells, which has none, or a medium lit by its gradient, for lights out of range and for clip
// regions, bodies and slices as their own `validate`.
void validate(const GridScene& scene);

// What a renderer counts in, so that float32 serves grids and fields of any scale: as SceneUnits of a mesh
// (prepared_scene.hpp).
struct GridUnits {
    double length;       // half the diagonal of the grid's box [mesh units], > 0
    double scalar_low;   // smallest value of the cells that are not blanked
    double scalar_high;  // largest one

    // 0 at scalar_low, 1 at scalar_high; 0 for a constant field. Values that only blanked cells have may lie outside.
    double normalized(double s) const {
        return scalar_high > scalar_low ? (s - scalar_low) / (scalar_high - scalar_low) : 0.0;
    }
    // The same as renderers keep it, 0..1; values that only blanked cells have may be anything.
    float kept(double s) const;
};

// Of a sound grid. O(cells).
GridUnits units_of(const Grid& grid);

// Mean length of a segment over all cells and directions, 4·volume / surface by Cauchy's formula [GridUnits::length], > 0.
double mean_chord(const Grid& grid, const GridUnits& units);

}  // namespace cellproj
