// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_plan.hpp"

#include <algorithm>
#include <string>

namespace cellproj {

namespace {

using Cut = GridSampling::Cut;

Decision decide_cells(const GridScene& scene, const GridQuality& quality, Backend backend, std::size_t culled) {
    const std::size_t all = scene.grid->cell_count();
    if (quality.sampling.cut != Cut::cells) return {"cells", "all " + std::to_string(all), "slices show the whole grid"};
    const bool rays = backend == Backend::cpu;
    if (culled == 0) {
        return {"cells", "all " + std::to_string(all),
                rays ? "every brick of 4x4x4 cells can be seen: rays have nothing to leap over" : "every cell can be seen"};
    }
    return {"cells", std::to_string(all - culled) + " of " + std::to_string(all),
            rays ? "rays leap over bricks of 4, 16 and 64 cells along each axis in which the transfer function shows nothing"
                 : "the others are blanked, or the transfer function shows nothing of them"};
}

Decision decide_sampling(const GridQuality& quality, Backend backend) {
    const std::string chosen = to_string(quality.sampling);
    switch (quality.sampling.cut) {
        case Cut::object: return {"sampling", chosen, "slices across the axis of the grid that is closest to the view"};
        case Cut::view: return {"sampling", chosen, "slices across the viewing direction"};
        case Cut::cells: break;
    }
    if (backend == Backend::cpu) return {"sampling", chosen, "rays walk from cell to cell (3D-DDA): one segment from face to face"};
    if (light_at_vertices(quality.method)) return {"sampling", chosen, "one template of polygons serves all cells of a shape (WVG91)"};
    return {"sampling", chosen, "every cell's faces bound the segments of the pixels behind them"};
}

Decision decide_field(const Grid& grid) {
    if (grid.location == FieldLocation::cells) return {"field", "one value for a cell", "it is given on cells: none is interpolated"};
    return {"field", "trilinear in a cell", "it is given on points"};
}

Decision decide_axes(const Grid& grid) {
    const bool uniform =
        std::all_of(grid.axes.begin(), grid.axes.end(), [](const GridAxis& axis) { return axis.spacing.has_value(); });
    if (uniform) return {"axes", "uniform", "all cells have one shape: where planes lie follows from their numbers"};
    return {"axes", "rectilinear", "cells differ: where planes lie is looked up"};
}

Decision decide_order(const GridQuality& quality, Backend backend) {
    if (backend == Backend::cpu) return {"order", "none", "a ray meets its cells one after the other"};
    if (quality.sampling.cut != Cut::cells) return {"order", "none", "slabs lie one behind the other"};
    return {"order", "slices", "row by row towards the eye: exact for any eye, without sorting"};
}

Decision decide_method(const GridScene& scene, const GridQuality& quality, Backend backend) {
    const std::string name = to_string(quality.method);
    if (quality.sampling.light == GridSampling::Light::pre) return {"method", "pre-shaded", "points are classified, and their light is interpolated"};
    if (quality.sampling.light == GridSampling::Light::post) return {"method", "post-shaded", "a slab has the light of the scalar in its middle"};
    if (quality.sampling.cut != Cut::cells) return {"method", name, "the scalar is taken as linear from slice to slice"};
    if (scene.grid->location == FieldLocation::cells) return {"method", name, "a segment has one scalar"};
    if (backend == Backend::cpu && quality.method.kind == MethodKind::exact)
        return {"method", name, "the cubic of each segment is cut into as many lines as the tolerance asks for"};
    if (light_at_vertices(quality.method)) return {"method", name, "light at the vertices of polygons is interpolated over the screen"};
    return {"method", name, "the scalar is taken as linear from face to face"};
}

}  // namespace

std::vector<Decision> grid_decisions(const GridScene& scene, const GridQuality& quality, Backend backend, std::size_t culled) {
    return {decide_cells(scene, quality, backend, culled), decide_sampling(quality, backend), decide_field(*scene.grid),
            decide_axes(*scene.grid),                      decide_order(quality, backend),    decide_method(scene, quality, backend)};
}

}  // namespace cellproj
