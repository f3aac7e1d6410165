// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>
#include <sstream>
#include <string>

#include "commands.hpp"
#include "input.hpp"
#include "mesh/scalar_field.hpp"

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

// The options without which the file is not read like this, each with a blank before it.
std::string how_it_was_read(const InputOptions& options) {
    std::ostringstream text;
    if (!options.solution.empty()) text << " --q " << options.solution.string();
    for (const std::string& block : options.blocks) text << " --block \"" << block << '"';
    if (options.time) text << " --time " << *options.time;
    if (options.raw_dimensions.empty()) return text.str();
    const auto add = [&](const char* name, const auto& values) {
        text << " --" << name;
        for (const auto& value : values) text << ' ' << value;
    };
    add("dims", options.raw_dimensions);
    text << " --type " << options.raw_type << (options.raw.big_endian ? " --big-endian" : "");
    add("spacing", options.raw_spacing);
    add("origin", options.raw_origin);
    if (options.raw.header_bytes > 0) text << " --header " << options.raw.header_bytes;
    return text.str();
}

void print_info(const InputOptions& options) {
    const Input input = load(options);
    const TetMesh& mesh = *input.mesh;
    const Bounds box = bounds(mesh.points);
    std::printf("%s: %s\n", input.name.c_str(), input.format.c_str());
    std::printf("points      %zu", mesh.points.size());
    if (input.grid) std::printf(" (%zux%zux%zu)", input.grid->ni, input.grid->nj, input.grid->nk);
    std::printf("\ncells       %s", input.cells.c_str());
    if (input.skipped_cells > 0) std::printf(" (%zu more are no volumes and are skipped)", input.skipped_cells);
    if (input.ghost_cells > 0) std::printf(" (%zu more are hidden, blanked or copies and left out)", input.ghost_cells);
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
                how_it_was_read(options).c_str(), select_scalar(mesh, "", input.name).name.c_str());
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InputOptions>();
    CLI::App* command = app.add_subcommand("info", "Say what is in a file: cells, fields with ranges, bounds.");
    add_input_options(*command, *options);
    command->callback([options] { print_info(*options); });
}

}  // namespace cellproj::cli
