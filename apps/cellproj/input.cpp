// SPDX-License-Identifier: BSD-3-Clause
#include "input.hpp"

#include <map>

#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "progress.hpp"
#include "render/statistics.hpp"

namespace cellproj::cli {

namespace {

std::string cells_in_words(const Dataset& dataset) {
    if (dataset.grid) return std::to_string(dataset.grid->cells()) + " hexahedra";
    std::map<CellKind, std::size_t> counts;
    for (const CellKind kind : dataset.cells.kinds) ++counts[kind];
    std::string text;
    for (const auto& [kind, count] : counts) {
        const char* plural = kind == CellKind::tetrahedron ? " tetrahedra" : " hexahedra";
        text += (text.empty() ? "" : ", ") + std::to_string(count) + plural;
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

Input load(const InputOptions& options) {
    const std::string demo = "demo:";
    if (options.file == "demo:sphere") return load_sphere_flow();
    if (options.file.starts_with(demo)) {
        throw Error({ErrorKind::option, "input", "demo:sphere, the only embedded scene", options.file,
                     "or give a file"});
    }
    Input input;
    input.name = options.file;
    const Stopwatch reading;
    const Dataset dataset = [&] {
        const Progress progress("reading " + input.name);
        return read(options.file, {.solution = options.solution});
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
    return input;
}

}  // namespace cellproj::cli
