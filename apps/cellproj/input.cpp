// SPDX-License-Identifier: BSD-3-Clause
#include "input.hpp"

#include <CLI/CLI.hpp>

#include <map>

#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "progress.hpp"
#include "render/statistics.hpp"
#include "surface_input.hpp"

namespace cellproj::cli {

namespace {

const char* plural(CellKind kind) {
    switch (kind) {
        case CellKind::tetrahedron: return "tetrahedra";
        case CellKind::hexahedron: return "hexahedra";
        case CellKind::wedge: return "wedges";
        case CellKind::pyramid: return "pyramids";
        case CellKind::pentagonal_prism: return "pentagonal prisms";
        case CellKind::hexagonal_prism: return "hexagonal prisms";
        case CellKind::polyhedron: return "polyhedra";
    }
    return "cells";
}

std::string cells_in_words(const Dataset& dataset) {
    if (dataset.grid) return std::to_string(dataset.grid->cells()) + " hexahedra";
    std::map<CellKind, std::size_t> counts;
    for (const CellKind kind : dataset.cells.kinds) ++counts[kind];
    std::string text;
    for (const auto& [kind, count] : counts) {
        text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + plural(kind);
    }
    return text;
}

Input load_sphere_flow() {
    Input input;
    input.name = "demo:sphere";
    const Progress progress("tetrahedralizing the sphere scene");
    const Stopwatch watch;
    auto mesh = std::make_shared<TetMesh>(make_sphere_flow_mesh({}));
    input.tetrahedralize_ms = watch.ms();
    input.report.tets = mesh->tets.size();
    input.cells = std::to_string(mesh->tets.size()) + " tetrahedra";
    input.format = "embedded scene: potential flow around a sphere";
    input.mesh = std::move(mesh);
    input.camera = sphere_flow_camera();
    input.transfer = std::make_shared<TransferFunction>(sphere_flow_transfer_function());
    return input;
}

}  // namespace

void add_input_options(CLI::App& command, InputOptions& options) {
    command.add_option("FILE", options.file, "A mesh with fields in any format of the README, a case's folder, or demo:sphere")
        ->required();
    command.add_option("--q", options.solution, "PLOT3D: the solution file that belongs to the grid");
    command.add_option("--block", options.blocks, "Read this block only (again for more); default: all volume blocks")
        ->allow_extra_args(false);
    command.add_option("--time", options.time, "Read the time step nearest to this time; default: the last");
}

Input load(const InputOptions& options) {
    const std::string demo = "demo:";
    if (options.file == "demo:sphere") return load_sphere_flow();
    if (options.file.starts_with(demo)) {
        throw Error({ErrorKind::option, "input", "demo:sphere, the only embedded scene", options.file,
                     "or give a file"});
    }
    require_no_surface(options.file);
    Input input;
    input.name = options.file;
    const Stopwatch reading;
    const Dataset dataset = [&] {
        const Progress progress("reading " + input.name);
        return read(options.file, {.solution = options.solution, .blocks = options.blocks, .time = options.time});
    }();
    input.read_ms = reading.ms();

    const Stopwatch splitting;
    const Progress progress("splitting cells");
    input.mesh = std::make_shared<TetMesh>(tetrahedralize(dataset, &input.report));
    input.tetrahedralize_ms = splitting.ms();
    input.cells = cells_in_words(dataset);
    input.format = dataset.format;
    input.grid = dataset.grid;
    input.skipped_cells = dataset.skipped_cells;
    input.skipped_blocks = dataset.skipped_blocks;
    input.blocks = dataset.blocks;
    input.times = dataset.times;
    input.time = dataset.time;
    return input;
}

}  // namespace cellproj::cli
