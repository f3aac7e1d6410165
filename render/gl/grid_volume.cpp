// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_volume.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <string>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/grid_surfaces.hpp"
#include "render/prepared_surfaces.hpp"

namespace cellproj::gl {

namespace {

// The length of any such gradient over the weak one (classify/lighting.hpp) has a square in float32.
constexpr float steepest = 1e15F;

template <class Body>
void for_all(std::size_t count, std::size_t grain, Body body) {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, count, grain), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

// Vertices are numbered by cells (shaders/grid_place.vert), up to 16 of them to a cell.
void require_numbers(const Grid& grid) {
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max() / 16;
    if (grid.cell_count() <= most) return;
    throw Error({ErrorKind::option, "grid", "at most " + std::to_string(most) + " cells for the OpenGL backend",
                 std::to_string(grid.cell_count()), "use the CPU backend (--backend cpu)"});
}

Texture upload(const Grid& grid, const GridUnits& units) {
    const GridDimensions n = grid.dimensions();
    std::vector<float> texels(grid.values.size());
    for_all(texels.size(), 65536, [&](std::size_t i) { texels[i] = units.kept(grid.values[i]); });
    const std::size_t less = grid.location == FieldLocation::cells ? 1 : 0;
    return Texture::volume({n.ni - less, n.nj - less, n.nk - less}, texels);
}

double find_longest_chord(const Grid& grid, double length) {
    glm::dvec3 edges(0.0);
    for (int a = 0; a < 3; ++a) {
        const GridAxis& axis = grid.axes[static_cast<std::size_t>(a)];
        for (std::size_t i = 0; i < axis.cells(); ++i) edges[a] = std::max(edges[a], axis.coordinates[i + 1] - axis.coordinates[i]);
    }
    return glm::length(edges / length);
}

}  // namespace

GridVolume::GridVolume(const GridScene& scene)
    : units_((require_numbers(*scene.grid), units_of(*scene.grid))),
      mean_chord_(cellproj::mean_chord(*scene.grid, units_)),
      longest_chord_(find_longest_chord(*scene.grid, units_.length)),
      values_(upload(*scene.grid, units_)) {}

Texture GridVolume::classified(const Grid& grid, const TransferFunction& transfer) const {
    const GridDimensions n = grid.dimensions();
    std::vector<float> texels(4 * grid.values.size());
    for_all(grid.values.size(), 4096, [&](std::size_t i) {
        const double s = std::clamp(units_.normalized(grid.values[i]), 0.0, 1.0);
        const glm::dvec3 emission = transfer.emission(s);
        for (int channel = 0; channel < 3; ++channel) texels[4 * i + static_cast<std::size_t>(channel)] = static_cast<float>(emission[channel]);
        texels[4 * i + 3] = static_cast<float>(transfer.extinction(s));
    });
    return Texture::volume({n.ni, n.nj, n.nk}, texels);
}

const Texture& GridVolume::gradients(const Grid& grid) {
    if (gradients_) return *gradients_;
    const std::vector<glm::vec3> kept = kept_gradients(grid, units_);
    std::vector<float> texels(4 * kept.size());
    for_all(kept.size(), 65536, [&](std::size_t i) {
        for (int axis = 0; axis < 3; ++axis) texels[4 * i + static_cast<std::size_t>(axis)] = std::clamp(kept[i][axis], -steepest, steepest);
    });
    const GridDimensions n = grid.dimensions();
    return gradients_.emplace(Texture::volume({n.ni, n.nj, n.nk}, texels));
}

void GridVolume::set_light(const Grid& grid, const TransferFunction& transfer, std::span<const float> thresholds) {
    drawn_.assign(grid.cell_count(), 0);
    const std::size_t nx = grid.axes[0].cells(), ny = grid.axes[1].cells();
    for_all(drawn_.size() / nx, 64, [&](std::size_t row) {
        for (std::size_t i = 0; i < nx; ++i) {
            const GridCell cell{i, row % ny, row / ny};
            if (grid.is_blanked(cell)) continue;
            const auto corners = grid.corner_values(cell);
            const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
            const bool crossed = !thresholds.empty() && level_of(thresholds, units_.kept(*low)) != level_of(thresholds, units_.kept(*high));
            drawn_[row * nx + i] = crossed || transfer.visible(*low, *high) ? 1 : 0;
        }
    });
}

}  // namespace cellproj::gl
