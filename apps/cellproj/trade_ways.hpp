// SPDX-License-Identifier: BSD-3-Clause
//
// What `cellproj trade` measures: the ways to one picture of a mesh, or of a regular grid.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/plan.hpp"
#include "render/trade.hpp"
#include "scene_options.hpp"

namespace cellproj::cli {

// What was asked for.
struct TradeChoices {
    std::vector<std::string> methods, targets, iso_methods, samplings;
    // What follows of --backend on this machine.
    BackendWish wish = BackendWish::automatic;
    Gpu gpu = {};

    bool is_empty() const { return methods.empty() && targets.empty() && iso_methods.empty() && samplings.empty(); }
};

// Every method in every target and with every way to isosurfaces; the usual one of what is not given. Nothing given: trade_qualities,
// surface_qualities. Throws Error (option) for what is unknown.
std::vector<Quality> choose_qualities(const SceneOptions& scene, const TradeChoices& choices);
std::vector<GridSampling> choose_samplings(const TradeChoices& choices);

// Throws Error (option) for what the backend that was asked for does not draw of meshes.
void require_all_drawn(const SceneOptions& scene, const TradeChoices& choices, std::span<const Quality> qualities);

struct TradeSubject {
    std::vector<TradeWay> ways;
    TradeJudge judge;
    std::string cells;  // in words: "1234 tetrahedra"
    std::vector<std::shared_ptr<const void>> kept = {};  // what the ways and the judge use
};

TradeSubject mesh_subject(const LoadedScene& loaded, const TradeChoices& choices, std::span<const Quality> qualities, const Camera& camera,
                          ImageSize size);
// A grid as it is by rays and by OpenGL, and, unless samplings were asked for, cut into tetrahedra. Throws Error (option) for what none of
// the backends that may be taken draws.
TradeSubject grid_subject(const SceneOptions& options, const LoadedScene& loaded, const TradeChoices& choices,
                          std::span<const Quality> qualities, const Camera& camera, ImageSize size);

// A hierarchy of grids by rays, and cut into tetrahedra.
TradeSubject hierarchy_subject(const SceneOptions& options, const LoadedScene& loaded, const TradeChoices& choices,
                               std::span<const Quality> qualities, const Camera& camera, ImageSize size);

}  // namespace cellproj::cli
