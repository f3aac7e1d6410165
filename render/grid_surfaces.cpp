// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_surfaces.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "mesh/grid_gradient.hpp"

namespace cellproj {

std::vector<float> kept_isovalues(const IsoSurfaces& surfaces, const GridUnits& units) {
    std::vector<float> values;
    for (const IsoSurface& surface : surfaces.surfaces()) {
        const double v = surface.value;
        values.push_back(v <= units.scalar_low ? -1.0F : v > units.scalar_high ? 2.0F : static_cast<float>(units.normalized(v)));
    }
    return values;
}

std::vector<glm::vec3> kept_gradients(const Grid& grid, const GridUnits& units) {
    const GridDimensions n = grid.dimensions();
    std::vector<glm::vec3> gradients(n.ni * n.nj * n.nk, glm::vec3(0));
    const double range = units.scalar_high - units.scalar_low;
    if (!(range > 0)) return gradients;
    const auto kept = [&](double slope) {
        const double share = slope / range * units.length;
        return std::isfinite(share) ? static_cast<float>(std::clamp(share, -1e18, 1e18)) : 0.0F;  // squares stay in float32
    };
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, n.nj * n.nk, 16), [&](const Range& rows) {
        for (std::size_t row = rows.begin(); row != rows.end(); ++row)
            for (std::size_t i = 0; i < n.ni; ++i) {
                const glm::dvec3 g = point_gradient(grid, {i, row % n.nj, row / n.nj});
                gradients[row * n.ni + i] = {kept(g.x), kept(g.y), kept(g.z)};
            }
    });
    return gradients;
}

}  // namespace cellproj
