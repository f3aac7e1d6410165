// SPDX-License-Identifier: BSD-3-Clause
#include "grid_options.hpp"

#include <CLI/CLI.hpp>

#include <map>

#include "mesh/error.hpp"

namespace cellproj::cli {

namespace {

const std::map<std::string, DrawnAs> ways{{"auto", DrawnAs::automatic}, {"grid", DrawnAs::grid}, {"tets", DrawnAs::tets}};

// Throws Error (option).
void require_grid_options(const SceneOptions& options, const PictureWishes& wishes) {
    const auto refuse = [](const char* option, const char* expected, const char* found) {
        throw Error({ErrorKind::option, option, expected, found, "leave it out, or draw the grid as tetrahedra (--as tets)"});
    };
    if (options.tetrahedralize) refuse("--tetrahedralize", "a file that holds a regular grid", "a surface");
    if (!options.opacity_field.empty()) refuse("--opacity-field", "colour and opacity from one field for a regular grid", "another field");
    if (options.cell_values == "averaged") refuse("--cell-values", "constant for a regular grid", "averaged");
    if (options.iso.any() && wishes.quality.surfaces.kind != SurfaceMethodKind::exact)
        refuse("--iso-method", "exact for isosurfaces of a regular grid", "a table");
    if (wishes.named_order) refuse("--order", "auto for a regular grid, whose cells need no sorting", "another order");
    if (wishes.quality.check_rays > 0) refuse("--verify-order", "a mesh, whose cells are sorted", "a regular grid");
    // The judge of grids knows neither clip regions nor bodies and slices.
    if (wishes.measured_method && !text_of(options.cuts).empty()) refuse("--max-error", "--method for a regular grid that is cut, such as exact:1e-3", "--max-error");
    const GridQuality quality{wishes.quality.method, wishes.quality.target, wishes.sampling};
    require_grid_drawn(wishes.backend, quality, {options.iso.any(), options.iso.shade_volume});
    require_grid_cut(quality, planned_cuts(options.cuts));
}

}  // namespace

void add_grid_options(CLI::App& command, SceneOptions& options) {
    options.drawn_as = DrawnAs::automatic;
    command.add_option_function<std::string>("--as", [&options](const std::string& name) { options.drawn_as = ways.at(name); },
                       "How a regular grid (image, rectilinear grid, bare voxels) is drawn: grid (as it is, the scalar trilinear in its boxes), tets "
                       "(cut into tetrahedra), or auto: grid, and tets for what only they know")
        ->check(CLI::IsMember(ways))->default_str("auto");
}

ChosenBackend choose_grid_backend(BackendWish wish, const GridSampling& sampling, const Gpu& gpu) {
    const bool slabs = sampling.cut != GridSampling::Cut::cells;
    const auto chosen = [](Backend backend, const char* why) { return ChosenBackend{backend, {"backend", to_string(backend), why}}; };
    if (wish == BackendWish::cpu) return chosen(Backend::cpu, "asked for");
    if (wish == BackendWish::automatic && !slabs)
        return chosen(Backend::cpu, "the cells of a regular grid need no projection: rays walk from one to the next");
    if (wish == BackendWish::automatic) return chosen(wished_backend(BackendWish::gl, {}, FieldsRead::one, gpu), "it draws slabs");
    return chosen(wished_backend(wish, {}, FieldsRead::one, gpu), "OpenGL was asked for");
}

DrawnAs choose_drawn_as(const SceneOptions& options, const PictureWishes& wishes) {
    const bool slabs = wishes.sampling.cut != GridSampling::Cut::cells;
    if (slabs && options.drawn_as == DrawnAs::tets)
        throw Error({ErrorKind::option, "--sampling", "cells for tetrahedra", to_string(wishes.sampling), "leave it out, or --as tets"});
    if (options.drawn_as == DrawnAs::tets) return DrawnAs::tets;
    try {
        require_grid_options(options, wishes);
    } catch (const Error&) {
        if (slabs || options.drawn_as == DrawnAs::grid) throw;
        return DrawnAs::tets;
    }
    return slabs ? DrawnAs::grid : options.drawn_as;
}

void require_hierarchy_drawn(const SceneOptions& options, Backend backend, const GridQuality& quality) {
    const auto refuse = [](const char* option, const char* expected, const std::string& found) {
        throw Error({ErrorKind::option, option, expected, found, "leave it out, or draw the hierarchy as tetrahedra (--as tets)"});
    };
    if (quality.sampling.cut != GridSampling::Cut::cells) refuse("--sampling", "cells for a hierarchy of grids", to_string(quality.sampling));
    if (backend != Backend::cpu) refuse("--backend", "cpu for a hierarchy of grids", to_string(backend));
    if (options.iso.any()) refuse("--iso", "no isosurfaces for a hierarchy of grids", "some");
    if (options.iso.shade_volume) refuse("--shade-volume", "the volume of a hierarchy of grids as it is, not lit", "--shade-volume");
    if (const std::string cuts = text_of(options.cuts); !cuts.empty()) refuse(cuts.c_str(), "no clipping planes, slices and bodies for a hierarchy of grids", "some");
    require_grid_drawn(backend, quality, {});
}

}  // namespace cellproj::cli
