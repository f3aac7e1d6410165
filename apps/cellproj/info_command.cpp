// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

#include "commands.hpp"
#include "input.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/surface_format.hpp"
#include "surface_input.hpp"

namespace cellproj::cli {

namespace {

void print_fields(const TetMesh& mesh, FieldLocation location) {
    const bool points = location == FieldLocation::points;
    for (const Field& field : points ? mesh.point_fields : mesh.cell_fields) {
        const ScalarField scalar = as_scalar(field, location);
        const ScalarRange values = range(scalar.values);
        std::printf("  %-24s on %s, %s%.6g .. %.6g", field.name.c_str(), points ? "points" : "cells",
                    field.components == 1 ? "" : (std::to_string(field.components) + " components, magnitude ").c_str(),
                    values.low, values.high);
        if (values.not_finite > 0) std::printf(", %zu not finite", values.not_finite);
        std::printf("\n");
    }
}

void print_blocks(const Input& input) {
    if (input.blocks.empty()) return;
    std::printf("blocks      %zu of volumes", input.blocks.size());
    if (input.skipped_blocks > 0) std::printf(" (%zu more hold none and are skipped)", input.skipped_blocks);
    std::printf("\n");
    for (const std::string& name : input.blocks) std::printf("  %s\n", name.c_str());
}

void print_times(const Input& input) {
    if (!input.time) return;
    std::printf("time        %.6g (of %zu steps, %.6g .. %.6g)\n", *input.time, input.times.size(), input.times.front(),
                input.times.back());
}

void print_info(const InputOptions& options) {
    if (detect_surface_format(options.file)) return print_surface(options.file);
    const Input input = load(options);
    const TetMesh& mesh = *input.mesh;
    const Bounds box = bounds(mesh.points);
    std::printf("%s: %s\n", input.name.c_str(), input.format.c_str());
    std::printf("points      %zu", mesh.points.size());
    if (input.grid) std::printf(" (%zux%zux%zu)", input.grid->ni, input.grid->nj, input.grid->nk);
    std::printf("\ncells       %s", input.cells.c_str());
    if (input.skipped_cells > 0) std::printf(" (%zu more are no volumes and are skipped)", input.skipped_cells);
    std::printf("\ntetrahedra  %zu (%zu of zero volume, %zu turned to positive volume)\n", input.report.tets,
                input.report.flat, input.report.flipped);
    print_blocks(input);
    print_times(input);
    for (int axis = 0; axis < 3; ++axis) {
        std::printf("%s%c %.6g .. %.6g%s", axis == 0 ? "bounds      " : ", ", "xyz"[axis], box.low[axis], box.high[axis],
                    axis == 2 ? "\n" : "");
    }
    std::printf("fields%s\n", mesh.point_fields.empty() && mesh.cell_fields.empty() ? "      none" : "");
    print_fields(mesh, FieldLocation::points);
    print_fields(mesh, FieldLocation::cells);
    if (mesh.point_fields.empty() && mesh.cell_fields.empty()) return;
    std::printf("\nA first picture:\n  cellproj render %s%s -o picture.png --field %s\n", input.name.c_str(),
                options.solution.empty() ? "" : (" --q " + options.solution.string()).c_str(),
                select_scalar(mesh, "", input.name).name.c_str());
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InputOptions>();
    CLI::App* command = app.add_subcommand("info", "Say what is in a file: cells, fields with ranges, bounds.");
    add_input_options(*command, *options);
    command->callback([options] { print_info(*options); });
}

}  // namespace cellproj::cli
