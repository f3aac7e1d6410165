// SPDX-License-Identifier: BSD-3-Clause
//
// Whether a file's regular grid is drawn as it is or as tetrahedra.
#pragma once

#include <string>

#include "render/grid_renderer.hpp"
#include "render/plan.hpp"
#include "render/renderer.hpp"
#include "scene_options.hpp"

namespace CLI {
class App;
}

namespace cellproj::cli {

// --as, into `options`, which must live as long as the command.
void add_grid_options(CLI::App& command, SceneOptions& options);

// What a picture asks of a renderer besides the scene.
struct PictureWishes {
    Backend backend;  // of a grid
    Quality quality;
    GridSampling sampling;  // of a grid
    bool measured_method;  // --max-error
    bool named_order;      // --order, but for auto
};

// The backend of grids: rays on the CPU, unless OpenGL was asked for, or slabs, which it alone draws.
ChosenBackend choose_grid_backend(BackendWish wish, const GridSampling& sampling, const Gpu& gpu);

// --as auto becomes tets where grids do not know something that was asked for. Throws Error (option) where --as grid was, or slabs were,
// which tetrahedra do not know.
DrawnAs choose_drawn_as(const SceneOptions& options, const PictureWishes& wishes);

// Throws Error (option) for what is not drawn of hierarchies of grids as they are.
void require_hierarchy_drawn(const SceneOptions& options, Backend backend, const GridQuality& quality);

}  // namespace cellproj::cli
