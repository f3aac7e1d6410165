// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "mesh/error.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"
#include "mesh/write_vtu.hpp"
#include "progress.hpp"

namespace cellproj::cli {

namespace {

struct TetrahedralizeOptions {
    std::filesystem::path surface, output;
    MesherOptions mesher;
};

// Before the work, not after it.
void require_vtu(const std::filesystem::path& output) {
    if (output.extension() == ".vtu") return;
    throw Error({.kind = ErrorKind::option,
                 .place = "option --output",
                 .expected = "a name that ends in .vtu",
                 .found = "\"" + output.string() + "\"",
                 .advice = "meshes are written as VTK XML unstructured grids"});
}

TetMesh mesh_inside(const TetrahedralizeOptions& options) {
    const Surface surface = read_surface(options.surface);
    const Progress progress("filling " + surface.name);
    return tetrahedralize(surface, options.mesher);
}

void run(const TetrahedralizeOptions& options) {
    require_vtu(options.output);
    const TetMesh mesh = mesh_inside(options);
    write_vtu(mesh, options.output);
    double volume = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell)
        volume += signed_volume(mesh, cell);
    std::printf("%s: %zu tetrahedra, volume %.9g\n", options.output.c_str(), mesh.tets.size(), volume);
}

}  // namespace

void add_tetrahedralize_command(CLI::App& app) {
    auto options = std::make_shared<TetrahedralizeOptions>();
    MesherOptions& mesher = options->mesher;
    mesher.radius_edge_ratio = 1.414;
    CLI::App* command = app.add_subcommand("tetrahedralize", "Fill a closed surface with tetrahedra.");
    command->add_option("SURFACE", options->surface, "An STL, OFF, PLY, OBJ or VTP file")->required();
    command->add_option("-o,--output", options->output, "The mesh to write, a .vtu file")->required();
    command->add_option("--max-volume", mesher.max_volume, "Largest cell [mesh units³]; 0: no bound")
        ->capture_default_str();
    command
        ->add_option("--quality", mesher.radius_edge_ratio,
                     "Largest circumradius / shortest edge of a cell; 0: no quality refinement")
        ->capture_default_str();
    command->add_flag("--fill-holes", mesher.fill_holes, "Cap the open ends of the surface");
    command->add_option("--timeout", mesher.timeout_seconds, "Give up after so many seconds")->capture_default_str();
    command->callback([options] { run(*options); });
}

}  // namespace cellproj::cli
