// SPDX-License-Identifier: BSD-3-Clause
//
// The trade of speed for accuracy on regular grids (trade.hpp), judged by rays through the trilinear field (grid_reference.hpp).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/judge/grid_reference.hpp"
#include "render/grid_renderer.hpp"
#include "render/hierarchy_renderer.hpp"
#include "render/trade_choice.hpp"

namespace cellproj {

// "cells, integral", "view:64:post, integral, rgba8": what cuts rays, the method, and the format of the framebuffer unless it is the
// usual one.
std::string to_string(const GridQuality& quality);

// Whether a backend draws this grid so.
bool draws_grid(Backend backend, const GridScene& scene, const GridQuality& quality);

// The choices that `cellproj trade` compares unless told otherwise: methods on cells; by OpenGL, where the grid can be sliced, also slabs
// as thick as its cells and a quarter of it, pre-, post- and pre-integrated. Those that the backend draws.
std::vector<GridQuality> grid_trade_qualities(Backend backend, const GridScene& scene);

// The ways that these qualities are. The parts of the scene are kept, the renderer must live as long.
std::vector<TradeWay> ways_of(GridRenderer& renderer, const GridScene& scene, const Camera& camera, ImageSize size,
                              std::span<const GridQuality> qualities);

struct GridChoiceOptions {
    TargetFormat target = TargetFormat::rgba32f;
    std::optional<GridSampling> sampling = {};  // the one that was asked for; none: any
    ChoiceOptions how = {};                     // its `base` and `draws` do not count
};

// As choose_quality: its methods (choice_methods) and `exact` with the bound itself as tolerance, on cells, and by OpenGL slabs as thick as
// cells and a quarter of it. The last candidate is `exact`, which OpenGL does not draw for grids: there `integral`.
QualityChoice choose_grid_quality(GridRenderer& renderer, Backend backend, const GridScene& scene, const Camera& camera, ImageSize size,
                                  double max_error, const GridChoiceOptions& options = {});

// The same for hierarchies of grids, which the native backend alone draws.
std::vector<TradeWay> ways_of(HierarchyRenderer& renderer, const HierarchyScene& scene, const Camera& camera, ImageSize size,
                              std::span<const Method> methods);
QualityChoice choose_hierarchy_method(HierarchyRenderer& renderer, const HierarchyScene& scene, const Camera& camera, ImageSize size,
                                      double max_error, const ChoiceOptions& options = {});

}  // namespace cellproj
