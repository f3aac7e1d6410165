// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/grid_kernels.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cpu/grid_kernels.cpp"
#include "render/cpu/instruction_sets.hpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "render/cpu/segment_light-inl.hpp"
#include "render/cpu/table_light-inl.hpp"
#include "render/cpu/pack_lanes-inl.hpp"
#include "render/cpu/grid_segments-inl.hpp"
#include "render/cpu/grid_light-inl.hpp"
#include "render/cpu/lane_pairs-inl.hpp"
#include "render/cpu/grid_walk-inl.hpp"
#include "render/cpu/reflection-inl.hpp"
#include "render/cpu/grid_medium_light-inl.hpp"
#include "render/cpu/grid_surfaces-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

std::size_t DrawGridTile(const GridCells& grid, const GridSurfaces* surfaces, const GridRays& rays, const Shading& shading, float bend, const Tile& tile) {
    const bool uniform = !grid.axes[0].planes;
    if (surfaces)
        return uniform ? draw_grid_surfaces<true>(grid, *surfaces, rays, shading, bend, tile)
                       : draw_grid_surfaces<false>(grid, *surfaces, rays, shading, bend, tile);
    return uniform ? draw_grid<true>(grid, rays, shading, bend, tile) : draw_grid<false>(grid, rays, shading, bend, tile);
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace cellproj::cpu {

HWY_EXPORT(DrawGridTile);

std::size_t draw_grid_tile(const GridCells& grid, const GridSurfaces* surfaces, const GridRays& rays, const Shading& shading, float bend,
                           const Tile& tile) {
    assert(tile.width <= tile_side && tile.height <= tile_side);
    assert(!surfaces || !grid.constant);
    return HWY_DYNAMIC_DISPATCH(DrawGridTile)(grid, surfaces, rays, shading, bend, tile);
}

}  // namespace cellproj::cpu

#endif
