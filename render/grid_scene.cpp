// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "mesh/error.hpp"

namespace cellproj {

bool has_surfaces(const GridScene& scene) { return scene.surfaces && !scene.surfaces->isosurfaces.surfaces().empty(); }

bool has_lit_medium(const GridScene& scene) {
    return scene.surfaces && scene.surfaces->lit_medium && scene.surfaces->shading != Shading::unlit;
}

RayCuts ray_cuts(const GridScene& scene) { return count_cuts(scene.clip.get(), scene.bodies.get(), scene.slices.get()); }

void validate(const GridScene& scene) {
    assert(scene.grid && scene.transfer);
    const Grid& grid = *scene.grid;
    validate(grid, "grid");
    if (!grid.blanked.empty() && std::find(grid.blanked.begin(), grid.blanked.end(), 0) == grid.blanked.end())
        throw Error({ErrorKind::data, "grid", "a cell that is not blanked", "none", "leave cells to draw"});
    if (scene.clip) validate(*scene.clip, "clip region");
    if (scene.bodies) validate(*scene.bodies);
    if (scene.slices) validate(*scene.slices);
    if (!has_surfaces(scene) && !has_lit_medium(scene)) return;
    if (grid.location == FieldLocation::cells) {
        throw Error({ErrorKind::option, has_surfaces(scene) ? "isosurfaces" : "light by the gradient", "a field on points", "one on cells, constant in each",
                     "draw it as tetrahedra and carry it to the points first (--as tets --cell-values averaged)"});
    }
    validate(scene.surfaces->lighting, "lights");
}

GridUnits units_of(const Grid& grid) {
    GridUnits units{0.5 * grid.bounds().diagonal(), std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
    const auto include = [&](double s) {
        units.scalar_low = std::min(units.scalar_low, s);
        units.scalar_high = std::max(units.scalar_high, s);
    };
    if (grid.blanked.empty()) {  // then every value belongs to a cell
        std::for_each(grid.values.begin(), grid.values.end(), include);
        return units;
    }
    const GridDimensions n = grid.dimensions();
    for (std::size_t k = 0; k + 1 < n.nk; ++k)
        for (std::size_t j = 0; j + 1 < n.nj; ++j)
            for (std::size_t i = 0; i + 1 < n.ni; ++i) {
                if (grid.is_blanked({i, j, k})) continue;
                for (const double s : grid.corner_values({i, j, k})) include(s);
            }
    return units;
}

float GridUnits::kept(double s) const {
    const double share = normalized(s);
    return std::isfinite(share) ? static_cast<float>(std::clamp(share, 0.0, 1.0)) : 0.0F;
}

// Edges add up along the axes by themselves: all cells together have the volume of the box, and faces across each axis.
double mean_chord(const Grid& grid, const GridUnits& units) {
    const glm::dvec3 edges = (grid.bounds().high - grid.bounds().low) / units.length;
    double inverse = 0.0;
    for (int a = 0; a < 3; ++a)
        inverse += static_cast<double>(grid.axes[static_cast<std::size_t>(a)].cells()) / edges[a];
    return 2.0 / inverse;  // volume xyz, surface 2·(n_x·yz + n_y·xz + n_z·xy)
}

}  // namespace cellproj
