// SPDX-License-Identifier: BSD-3-Clause
//
// What a view does not change of a grid in OpenGL: its scalars as a texture, and which cells can be seen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "render/gl/textures.hpp"
#include "render/grid_scene.hpp"

namespace cellproj::gl {

class GridVolume {
public:
    // Of a sound scene. Throws Error (option) where the driver takes no grid that large.
    explicit GridVolume(const GridScene& scene);

    const GridUnits& units() const { return units_; }
    // Since set_light. Per cell: 0 for those that add nothing to any picture, blanked or without emission and extinction over their scalars.
    const std::vector<std::uint8_t>& drawn() const { return drawn_; }
    const Texture& values() const { return values_; }
    double mean_chord() const { return mean_chord_; }
    // No segment in a cell is longer [GridUnits::length].
    double longest_chord() const { return longest_chord_; }

    // Emission and extinction at the points, for slabs that interpolate them; of a function in scene units.
    Texture classified(const Grid& grid, const TransferFunction& transfer) const;

    // The gradients at the points (render/grid_surfaces.hpp), made when they are first asked for.
    const Texture& gradients(const Grid& grid);

    // Of the same grid: finds the cells that can be seen, by a function or as an isosurface crosses them (its threshold, ascending).
    void set_light(const Grid& grid, const TransferFunction& transfer, std::span<const float> thresholds);

private:
    GridUnits units_;
    double mean_chord_, longest_chord_;
    Texture values_;
    std::optional<Texture> gradients_;
    std::vector<std::uint8_t> drawn_;
};

}  // namespace cellproj::gl
