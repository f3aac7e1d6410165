// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_scene.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "mesh/error.hpp"

namespace cellproj {

bool has_surfaces(const GridScene& scene) { return scene.surfaces && !scene.surfaces->isosurfaces.surfaces().empty(); }

void validate(const GridScene& scene) {
    assert(scene.grid && scene.transfer);
    const Grid& grid = *scene.grid;
    validate(grid, "grid");
    if (!grid.blanked.empty() && std::find(grid.blanked.begin(), grid.blanked.end(), 0) == grid.blanked.end())
        throw Error({ErrorKind::data, "grid", "a cell that is not blanked", "none", "leave cells to draw"});
    if (!has_surfaces(scene)) return;
    if (grid.location == FieldLocation::cells) {
        throw Error({ErrorKind::option, "isosurfaces", "a field on points", "one on cells, constant in each",
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

}  // namespace cellproj
