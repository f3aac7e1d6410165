// SPDX-License-Identifier: BSD-3-Clause
//
// What is drawn and from where: the options that `render` and `trade` share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cut_options.hpp"
#include "input.hpp"
#include "iso_options.hpp"
#include "project/camera.hpp"
#include "render/grid_scene.hpp"
#include "render/hierarchy_renderer.hpp"
#include "render/renderer.hpp"
#include "render/scene.hpp"
#include "surface_input.hpp"

namespace CLI {
class App;
}

namespace cellproj::cli {

struct SceneOptions {
    SceneOptions();

    InputOptions input;
    bool tetrahedralize = false;
    DrawnAs drawn_as = DrawnAs::tets;  // --as, where a command has it
    SurfaceOptions surface;
    std::filesystem::path camera, transfer;
    std::string field, opacity_field, projection = "perspective", size = "512x512", cell_values = "constant";
    std::vector<double> from{-1, -2, 1}, up{0, 0, 1};
    std::optional<double> nan;
    std::string colors, axis = "linear";
    std::vector<double> range;  // empty, or low and high
    double opacity_scale = 1;
    bool colors_chosen = false;  // by any of --colors, --range, --axis
    IsoOptions iso;
    CutOptions cuts;
    bool opacity_chosen = false;  // by --transfer, --opacity-scale or --opacity-field: the medium is asked for

    FieldsRead fields() const { return opacity_field.empty() ? FieldsRead::one : FieldsRead::two; }
};

// Into `options`, which must live as long as the command.
void add_scene_options(CLI::App& command, SceneOptions& options);

// What can be refused without reading the mesh: throws Error (option). The size of the picture.
ImageSize require_possible(const SceneOptions& options);

struct LoadedScene {
    Input input;
    Scene scene;                    // of a grid that is drawn as it is: a mesh without cells
    std::optional<GridScene> grid;  // set for such a one
    std::optional<HierarchyScene> hierarchy = {};  // set for pieces refined inside each other, likewise
};

// Reads the mesh and chooses field and transfer function; warns of values that are not finite. Throws Error.
LoadedScene load_scene(const SceneOptions& options, DrawnAs drawn_as = DrawnAs::tets);

// The cameras of --camera or of the embedded scene, or one that sees the mesh, from every side of it if it is to `turn`.
std::vector<Camera> choose_cameras(const SceneOptions& options, const Input& input, ImageSize size, bool turn);

}  // namespace cellproj::cli
