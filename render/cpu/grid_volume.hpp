// SPDX-License-Identifier: BSD-3-Clause
//
// A grid as the CPU renderer keeps it: float32 values in scene units, and a pyramid of the least and largest scalar in
// bricks of cells, from which it follows for each transfer function what rays may leap over.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"
#include "project/camera.hpp"
#include "render/cpu/grid_kernels.hpp"
#include "render/depth_window.hpp"
#include "render/grid_scene.hpp"

namespace cellproj::cpu {

class GridVolume {
public:
    // Throws Error (data) for more values than 32 bits count.
    explicit GridVolume(const Grid& grid) : GridVolume(grid, units_of(grid)) {}
    // The same in the units of what the grid is a part of.
    GridVolume(const Grid& grid, const GridUnits& units);

    const GridUnits& units() const { return units_; }
    double mean_chord() const { return mean_chord_; }

    // `transfer` in scene units, and isovalues as kept_isovalues has them: finds the bricks in which nothing can be seen, and those that
    // surfaces cross.
    void set_light(const TransferFunction& transfer, std::vector<float> isovalues);
    // Since set_light; materials, lights and gradients are not known here. No isovalues: a count of 0.
    GridSurfaces surfaces() const;
    std::size_t empty_cells() const { return empty_cells_; }  // in them, or blanked

    GridCells cells() const;
    // The part of the pixels' rays inside the grid. Pixel (x, y) is the tile's first one. `window`: what of the picture's rays is kept, row
    // by row [GridUnits::length]; none: all.
    void find_rays(const ScreenTransform& transform, int x, int y, int width, int height, std::span<const DepthInterval> window, GridRays& rays) const;

private:
    struct Range {
        float low = 1, high = 0;  // low > high: no cell that is not blanked
    };
    struct Level {
        std::array<std::size_t, 3> bricks;
        std::vector<Range> ranges;
    };
    // Of a ray, of any length.
    struct Direction {
        Direction(const glm::dvec3& d, double unit) : along(d), inverse(1.0 / d), speed(glm::length(d) / unit), per_speed(1.0 / speed) {}

        glm::dvec3 along, inverse;
        double speed, per_speed;  // lengths [GridUnits] per length of it
    };
    struct Axis {
        double low, high, per_unit;  // ends [mesh units]; axis units per mesh unit
        std::vector<float> planes, per_width;  // none when all axes are uniform
    };

    void add_turned_values(const GridDimensions& n);
    void find_ranges(const Grid& grid);
    void find_ray(const glm::dvec3& origin, const Direction& direction, const DepthInterval& kept, std::size_t pixel, GridRays& rays) const;

    GridUnits units_;
    double mean_chord_;
    bool constant_;
    std::array<Axis, 3> axes_;
    std::array<std::int32_t, 3> cell_counts_, value_strides_;
    std::vector<float> values_, present_;
    std::int32_t turned_ = 0;  // where in values_ they stand once more, turned; 0 for values of cells
    std::array<Level, brick_levels> levels_;
    std::vector<float> isovalues_;
    std::vector<std::int32_t> empty_, crossed_;  // per brick of the first level
    std::size_t empty_cells_ = 0;
    bool leaps_ = false;
};

}  // namespace cellproj::cpu
