// SPDX-License-Identifier: BSD-3-Clause
//
// The inner loop of the CPU renderer of regular grids, compiled once for each instruction set (kernels.hpp): rays walk
// from cell to cell (3D-DDA; Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987),
// as many at once as a vector has lanes, and take one segment per cell from the scalars where they enter and leave.
//
// Places are in axis units: along each axis from 0 at its first plane to its number of cells at its last one, which
// makes plane i of a uniform axis i. Lengths are in scene units (GridUnits).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

#include "render/cpu/kernels.hpp"

namespace cellproj::cpu {

inline constexpr int brick_levels = 3;  // bricks of 4, 16 and 64 cells along each axis

// A grid as rays read it: plain arrays that somebody else keeps (GridVolume).
struct GridCells {
    struct Axis {
        std::int32_t cells = 0;
        std::int32_t value_stride = 0;        // from a cell's value to that of the next one along the axis
        std::int32_t turned_stride = 0;       // likewise in the turned copy of the values
        std::int32_t cell_stride = 0;         // likewise of `present`
        std::int32_t brick_stride = 0;        // likewise of `empty`
        const float* planes = nullptr;        // #cells + 1, axis units; null in all axes when all are uniform
        const float* per_width = nullptr;     // #cells, 1/(distance of a cell's planes)
    };
    std::array<Axis, 3> axes;
    const float* values = nullptr;          // 0..1, one per point or per cell
    std::int32_t turned = 0;                // of values per point: where in `values` they stand once more, neighbours along y side by side
    bool constant = false;                  // per cell
    const float* present = nullptr;         // per cell: 1, or 0 where it is blanked; null when none is
    // Per brick of the first level: 0, or the number of the highest level whose brick around it shows nothing at all.
    const std::int32_t* empty = nullptr;    // null when every brick shows something
};

// The isosurfaces in a grid, and the light on them and the medium, as rays read them (render/grid_surfaces.hpp).
struct GridSurfaces {
    std::int32_t count = 0;
    const float* values = nullptr;       // #count, ascending
    std::vector<float> materials;        // #count by 8: front colour, opacity; back colour, opacity
    SurfaceShading shading = SurfaceShading::unlit;
    SurfaceLighting lighting;
    const float* gradients = nullptr;    // #points by 3; null for those of the trilinear scalar
    std::array<float, 3> per_length{};   // axis units in a length of 1
    const std::int32_t* crossed = nullptr;  // per brick of the first level: 1 where some surface crosses it
    bool medium = true;                  // whether there is light between them
    bool lit_medium = false;             // which is lit
};

// The rays of a tile's pixels, row by row.
struct GridRays {
    static constexpr int count = tile_side * tile_side;
    alignas(64) std::array<std::array<float, count>, 3> origin;     // where they enter the grid [axis units]
    alignas(64) std::array<std::array<float, count>, 3> direction;  // change of that place per length
    alignas(64) std::array<float, count> length;                    // inside the grid; 0: the ray misses it
    bool cut = false;  // some lengths end inside of it
};

// Composites the grid along a tile's rays. Returns the number of segments.
// `surfaces`: null without any and where nothing is lit; not of a grid that is constant per cell. `bend`: how far a cell's scalar may stay away from straight lines between the places where it is looked at; infinite:
// one line from face to face.
std::size_t draw_grid_tile(const GridCells& grid, const GridSurfaces* surfaces, const GridRays& rays, const Shading& shading, float bend,
                           const Tile& tile);

}  // namespace cellproj::cpu
