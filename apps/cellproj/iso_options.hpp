// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces on the command line: which, in which colours, and how they and the volume are lit.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "classify/transfer_function.hpp"
#include "mesh/scalar_field.hpp"
#include "render/surface_scene.hpp"

namespace CLI {
class App;
}

namespace cellproj::cli {

struct IsoOptions {
    std::vector<std::string> surfaces;  // --iso, each VALUE[,VALUE…][:COLOR[:OPACITY]]
    std::string shading = "smooth";
    std::vector<std::string> lights;  // each X,Y,Z towards it, or "eye", and [:COLOR]; none: a headlight; of bodies as well
    bool volume = false;              // the medium around them, and around slices, is drawn, too
    bool shade_volume = false;        // and lit
    bool shading_chosen = false;      // by --shading

    bool any() const { return !surfaces.empty(); }
    bool any_shaded() const { return any() || shade_volume; }
};

// The words of `--iso-method`.
extern const char* const iso_method_help;

// Into `options`, which must live as long as the command.
void add_iso_options(CLI::App& command, IsoOptions& options);

// A usage error (CLI::ValidationError) for --volume without isosurfaces or slices in it.
void require_something_in_volume(const IsoOptions& options, bool slices);

// Isosurfaces, and whether the volume is lit. Surfaces without a colour of their own take that of `colors` at their value. Throws Error (option) that names the option and
// what was found.
SurfaceScene parse_surfaces(const IsoOptions& options, const TransferFunction& colors);

// --light, or a headlight. Throws Error (option) for what is no light, and for a direction without length.
Lighting parse_lighting(const IsoOptions& options);

// Throws CLI::ParseError for --shading without anything to be shaded or with nothing to shade it by, Error (option) for --light without anything
// to be lit; `bodies`: whether there are some.
void require_shaded(const IsoOptions& options, bool bodies);

// Tells of isovalues that the field does not reach.
void warn_of_missing(const IsoSurfaces& surfaces, const ScalarField& field);

}  // namespace cellproj::cli
