// SPDX-License-Identifier: BSD-3-Clause
//
// Surfaces that the user names on the command line, and how they are filled with cells.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "input.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"

namespace CLI {
class App;
class Option;
}

namespace cellproj::cli {

struct SurfaceOptions {
    SurfaceOptions() { mesher.radius_edge_ratio = 1.414; }

    MesherOptions mesher;
    std::optional<double> max_volume;         // --max-volume
    std::vector<std::string> holes, regions;  // "X,Y,Z", "X,Y,Z:ATTRIBUTE:MAXVOLUME"
};

// --max-volume, --quality, --fill-holes, --wrap, --hole, --region and --timeout, into `options`, which must live as long as
// the command. `default_volume` says in words what holds without --max-volume.
std::vector<CLI::Option*> add_surface_options(CLI::App& command, SurfaceOptions& options,
                                              const std::string& default_volume);

// The surface of a file, with the holes and regions of the options beside its own. Throws Error as `read_surface`, and
// (option) for a hole or region that cannot be understood.
Surface load_surface(const std::filesystem::path& file, const SurfaceOptions& options);

// The mesh inside a surface file, for a picture: without --max-volume, cells are so small that a field inside shows, about
// 1/40 of the diagonal of the surface's box along their edges.
Input load_filled(const std::filesystem::path& file, const SurfaceOptions& options);

// What `cellproj info` says about a surface, and what to type next.
void print_surface(const std::filesystem::path& file);

// Throws Error (data) when the file is a surface, saying what to type instead.
void require_no_surface(const std::filesystem::path& file);

}  // namespace cellproj::cli
