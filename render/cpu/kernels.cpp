// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/kernels.hpp"

#include "render/cpu/precise_cell.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/cpu/kernels.cpp"
#include "render/cpu/instruction_sets.hpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/cache_control.h>
#include <hwy/contrib/math/math-inl.h>

#include "render/cpu/segment_light-inl.hpp"
#include "render/cpu/table_light-inl.hpp"
#include "render/cpu/pack_lanes-inl.hpp"
#include "render/cpu/cell_planes-inl.hpp"
#include "render/cpu/window_drawing-inl.hpp"
#include "render/cpu/tile_drawing-inl.hpp"
#include "render/cpu/reflection-inl.hpp"
#include "render/cpu/surface_light-inl.hpp"
#include "render/cpu/medium_light-inl.hpp"
#include "render/cpu/surface_drawing-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The tiles that a cell's corners span. Rounding keeps order, so no pixel centre inside falls out.
class BoxFinder {
public:
    HWY_INLINE BoxFinder(const ScreenCells& cells, const Region& region)
        : cells_(cells), x0_(static_cast<float>(region.x) + 0.5F - 0.5F * static_cast<float>(cells.view.width)),
          y0_(static_cast<float>(region.y) + 0.5F - 0.5F * static_cast<float>(cells.view.height)),
          right_(static_cast<float>(region.width - 1)), bottom_(static_cast<float>(region.height - 1)),
          at_left_(region.x == 0), at_top_(region.y == 0) {}

    HWY_INLINE TileBox of(std::uint32_t item) const {
        if (item < cells_.tets.size() && !cells_.visible.empty() && !cells_.visible[item]) return {};
        const hn::CappedTag<float, 4> d;  // x, y, nearness, scalar
        const auto& corners = cells_.corners(item);
        HWY_ALIGN float low[4], high[4];
        for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
            const auto point = [&](std::size_t i) HWY_ATTR { return hn::LoadU(d, &cells_.points[corners[i]].x + k); };
            const auto a = point(0), b = point(1), c = point(2), e = point(3);
            hn::Store(hn::Min(hn::Min(a, b), hn::Min(c, e)), d, low + k);
            hn::Store(hn::Max(hn::Max(a, b), hn::Max(c, e)), d, high + k);
        }
        const float from_x = std::ceil(low[0] - x0_), from_y = std::ceil(low[1] - y0_);
        const float left = std::max(from_x, 0.0F), top = std::max(from_y, 0.0F);
        const float right = std::min(std::floor(high[0] - x0_), right_), bottom = std::min(std::floor(high[1] - y0_), bottom_);
        if (!(left <= right && top <= bottom)) return {};
        const auto tile = [](float pixel) { return static_cast<std::uint32_t>(pixel) / tile_side % region_side; };
        return {tile(left), tile(top), tile(right), tile(bottom), (from_x >= 0 || at_left_) && (from_y >= 0 || at_top_)};
    }

private:
    const ScreenCells& cells_;
    float x0_, y0_, right_, bottom_;
    bool at_left_, at_top_;
};

void FindBoxes(const ScreenCells& cells, const Region& region, std::size_t first, std::size_t end, TileBox* boxes) {
    const BoxFinder finder(cells, region);
    for (std::size_t item = first; item < end; ++item) boxes[item] = finder.of(static_cast<std::uint32_t>(item));
}

void FindBoxesOf(const ScreenCells& cells, const Region& region, const std::uint32_t* items, std::size_t count, TileBox* boxes) {
    const BoxFinder finder(cells, region);
    for (std::size_t i = 0; i < count; ++i) boxes[items[i]] = finder.of(items[i]);
}

// Where nothing of a ray is kept, its pixel is closed. False where that is so of all.
HWY_NOINLINE bool open_window(WindowTile& window, const Tile& target, TileState& tile) {
    tile.window = &window;
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width; ++x)
            if (!(window.near[tile_side * y + x] > window.far[tile_side * y + x])) {
                tile.open[y] &= ~(1U << x);
                tile.some_closed = true;
            }
    return window.nearest > window.farthest;
}

// Loads a tile's pixels, draws, and stores them.
template <class Draw>
HWY_INLINE std::size_t on_tile(const ScreenCells& cells, const Shading& shading, const Tile& target, const Draw& draw_as) {
    TileState tile;  // aligned for the longest vectors
    const View& view = cells.view;
    tile.x = static_cast<float>(target.x) + 0.5F - 0.5F * static_cast<float>(view.width);
    tile.y = static_cast<float>(target.y) + 0.5F - 0.5F * static_cast<float>(view.height);
    const auto row_bytes = static_cast<std::size_t>(target.width) * sizeof(glm::vec4);
    for (int y = 0; y < target.height; ++y) {
        std::memcpy(tile.rgba[tile_side * y], target.pixels + static_cast<std::size_t>(y) * target.stride, row_bytes);
        tile.open[y] = target.width == 32 ? ~0U : (1U << target.width) - 1U;
    }
    std::optional<WindowTile> window;
    if (target.windows) window.emplace(view, target.windows, target.stride, target.width, target.height);
    const std::size_t fragments = !window || open_window(*window, target, tile) ? draw_as(tile) : 0;
    if (target.full && !close_pixels(tile, shading.opaque, target.width, target.height)) *target.full = 1;
    for (int y = 0; y < target.height; ++y)
        std::memcpy(target.pixels + static_cast<std::size_t>(y) * target.stride, tile.rgba[tile_side * y], row_bytes);
    return fragments;
}

// The same with the pixels' trails.
template <class Draw>
HWY_NOINLINE std::size_t on_tile_with_surfaces(const ScreenCells& cells, const Shading& shading, const Tile& target, const Draw& draw_as) {
    SurfaceTile surfaces;
    const auto row_bytes = static_cast<std::size_t>(target.width) * sizeof(PixelTrail);
    const auto row = [&](int y) HWY_ATTR { return target.trails + static_cast<std::size_t>(y) * target.stride; };
    for (int y = 0; y < target.height; ++y) std::memcpy(&surfaces.trails[tile_side * y], row(y), row_bytes);
    const std::size_t fragments = on_tile(cells, shading, target, [&](TileState& tile) HWY_ATTR {
        tile.surfaces = &surfaces;
        return draw_as(tile);
    });
    for (int y = 0; y < target.height; ++y) std::memcpy(row(y), &surfaces.trails[tile_side * y], row_bytes);
    return fragments;
}

std::size_t DrawTile(const ScreenCells& cells, const Shading& shading, const Tile& target, std::span<const std::uint32_t> items) {
    const bool perspective = cells.view.perspective, constant = !cells.cell_scalars.empty();
    if (cells.surfaces)
        return on_tile_with_surfaces(cells, shading, target, [&](TileState& tile) HWY_ATTR {
            return perspective ? draw<true, false, true>(cells, shading, target, items, tile)
                               : draw<false, false, true>(cells, shading, target, items, tile);
        });
    return on_tile(cells, shading, target, [&](TileState& tile) HWY_ATTR {
        if (perspective)
            return constant ? draw<true, true, false>(cells, shading, target, items, tile)
                            : draw<true, false, false>(cells, shading, target, items, tile);
        return constant ? draw<false, true, false>(cells, shading, target, items, tile)
                        : draw<false, false, false>(cells, shading, target, items, tile);
    });
}

std::size_t DrawTileByPixels(const ScreenCells& cells, const Shading& shading, const Tile& target, std::span<const std::uint32_t> items,
                             PendingFragments& pending) {
    const bool perspective = cells.view.perspective, constant = !cells.cell_scalars.empty();
    if (cells.surfaces)
        return on_tile_with_surfaces(cells, shading, target, [&](TileState& tile) HWY_ATTR {
            return perspective ? draw_by_pixels<true, false, true>(cells, shading, target, items, tile, pending)
                               : draw_by_pixels<false, false, true>(cells, shading, target, items, tile, pending);
        });
    return on_tile(cells, shading, target, [&](TileState& tile) HWY_ATTR {
        if (perspective)
            return constant ? draw_by_pixels<true, true, false>(cells, shading, target, items, tile, pending)
                            : draw_by_pixels<true, false, false>(cells, shading, target, items, tile, pending);
        return constant ? draw_by_pixels<false, true, false>(cells, shading, target, items, tile, pending)
                        : draw_by_pixels<false, false, false>(cells, shading, target, items, tile, pending);
    });
}

std::size_t DrawNearestSurfaces(const ScreenCells& cells, const Tile& target, std::span<const std::uint32_t> items) {
    return on_tile_with_surfaces(cells, {}, target, [&](TileState& tile) HWY_ATTR {
        return cells.view.perspective ? draw_nearest<true>(cells, target, items, tile) : draw_nearest<false>(cells, target, items, tile);
    });
}

void LightOfSegments(const Shading& shading, bool constant, const float* s_f, const float* s_b, const float* length, std::size_t count,
                     glm::vec4* light) {
    const hn::CappedTag<float, CellPlanes::columns> d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t begin = 0; begin < count; begin += lanes) {
        const std::size_t some = HWY_MIN(lanes, count - begin);
        HWY_ALIGN float in[3][CellPlanes::columns] = {}, out[4 * CellPlanes::columns];
        std::memcpy(in[0], s_f + begin, some * sizeof(float));
        std::memcpy(in[1], s_b + begin, some * sizeof(float));
        std::memcpy(in[2], length + begin, some * sizeof(float));
        const auto l = shade(d, shading, constant, hn::Load(d, in[0]), hn::Load(d, in[1]), hn::Load(d, in[2]));
        hn::StoreInterleaved4(l.r, l.g, l.b, l.opacity, d, out);
        for (std::size_t i = 0; i < some; ++i) light[begin + i] = {out[4 * i], out[4 * i + 1], out[4 * i + 2], out[4 * i + 3]};
    }
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace cellproj::cpu {

HWY_EXPORT(FindBoxes);
HWY_EXPORT(FindBoxesOf);
HWY_EXPORT(DrawTile);
HWY_EXPORT(DrawTileByPixels);
HWY_EXPORT(DrawNearestSurfaces);
HWY_EXPORT(LightOfSegments);

void find_boxes(const ScreenCells& cells, const Region& region, std::size_t first, std::size_t end, std::span<TileBox> boxes) {
    assert(end <= boxes.size());
    HWY_DYNAMIC_DISPATCH(FindBoxes)(cells, region, first, end, boxes.data());
}

void find_boxes(const ScreenCells& cells, const Region& region, std::span<const std::uint32_t> items, std::span<TileBox> boxes) {
    HWY_DYNAMIC_DISPATCH(FindBoxesOf)(cells, region, items.data(), items.size(), boxes.data());
}

std::size_t draw_tile(const ScreenCells& cells, const Shading& shading, const Tile& tile, std::span<const std::uint32_t> items) {
    assert(tile.width <= tile_side && tile.height <= tile_side);
    return HWY_DYNAMIC_DISPATCH(DrawTile)(cells, shading, tile, items);
}

std::size_t draw_tile_by_pixels(const ScreenCells& cells, const Shading& shading, const Tile& tile,
                                std::span<const std::uint32_t> items, PendingFragments& pending) {
    assert(tile.width <= tile_side && tile.height <= tile_side);
    return HWY_DYNAMIC_DISPATCH(DrawTileByPixels)(cells, shading, tile, items, pending);
}

std::size_t draw_nearest_surfaces(const ScreenCells& cells, const Tile& tile, std::span<const std::uint32_t> items) {
    assert(tile.width <= tile_side && tile.height <= tile_side && cells.surfaces && tile.trails && !tile.full);
    return HWY_DYNAMIC_DISPATCH(DrawNearestSurfaces)(cells, tile, items);
}

void light_of_segments(const Shading& shading, bool constant, std::span<const float> s_f, std::span<const float> s_b,
                       std::span<const float> length, std::span<glm::vec4> light) {
    assert(s_f.size() == light.size() && s_b.size() == light.size() && length.size() == light.size());
    HWY_DYNAMIC_DISPATCH(LightOfSegments)(shading, constant, s_f.data(), s_b.data(), length.data(), light.size(), light.data());
}

namespace {

// This build's targets that the machine has, lowest bit, which is the best, first.
std::vector<std::int64_t> targets() {
    std::vector<std::int64_t> result;
    const std::int64_t available = hwy::SupportedTargets() & HWY_TARGETS;
    for (int bit = 0; bit < 63; ++bit)
        if (available & (std::int64_t{1} << bit)) result.push_back(std::int64_t{1} << bit);
    if (result.empty()) result.push_back(HWY_STATIC_TARGET);
    return result;
}

std::int64_t chosen_target = 0;  // 0: the best

}  // namespace

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    hwy::SetSupportedTargetsForTest(0);  // as the machine is
    for (const std::int64_t target : targets()) names.emplace_back(hwy::TargetName(target));
    if (chosen_target) hwy::SetSupportedTargetsForTest(chosen_target);
    return names;
}

std::string instruction_set() { return hwy::TargetName(targets().front()); }

void use_instruction_set(const std::string& name) {
    hwy::SetSupportedTargetsForTest(0);
    for (const std::int64_t target : targets()) {
        if (name != hwy::TargetName(target)) continue;
        chosen_target = target;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        return;
    }
    assert(false && "no such instruction set");
}

}  // namespace cellproj::cpu

#endif
