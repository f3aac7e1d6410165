// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/io/surface_format.hpp"
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
        if (values.low == values.high) std::printf(", constant");
        if (values.not_finite > 0) std::printf(", %zu not finite", values.not_finite);
        std::printf("\n");
    }
}

void print_points(const Input& input) {
    const TetMesh& mesh = *input.mesh;
    std::vector<bool> used(mesh.points.size(), false);
    for (const auto& tet : mesh.tets) {
        for (const VertexId v : tet) used[v] = true;
    }
    std::printf("points      %zu", mesh.points.size() - input.report.added_points);
    if (input.grid) std::printf(" (%zux%zux%zu)", input.grid->ni, input.grid->nj, input.grid->nk);
    const auto unused = std::count(used.begin(), used.end(), false);
    if (unused > 0) std::printf(" (%td of them in no volume cell)", unused);
    std::printf("\n");
}

void print_tetrahedra(const Input& input) {
    const TetrahedralizeReport& report = input.report;
    std::printf("tetrahedra  %zu (%zu of zero volume, %zu turned to positive volume", report.tets, report.flat, report.flipped);
    if (report.inverted > 0) std::printf(", %zu of crushed cells, see cellproj check", report.inverted);
    if (report.added_points > 0) std::printf(", %zu points added inside cells", report.added_points);
    std::printf(")\n");
}

void print_blocks(const Input& input) {
    if (input.blocks.empty()) return;
    std::printf("blocks      %zu of volumes", input.blocks.size());
    if (input.skipped_blocks > 0) std::printf(" (%zu more hold none and are skipped)", input.skipped_blocks);
    std::printf("; --block NAME chooses\n");
    for (const std::string& name : input.blocks) std::printf("  %s\n", name.c_str());
}

void print_levels(const Input& input) {
    if (input.levels.empty()) return;
    std::size_t pieces = 0;
    for (const InputLevel& level : input.levels) pieces += level.pieces;
    std::printf("hierarchy   %zu levels, %zu pieces\n", input.levels.size(), pieces);
    for (std::size_t l = 0; l < input.levels.size(); ++l) {
        const InputLevel& level = input.levels[l];
        std::printf("  level %-3zu spacing %gx%gx%g, %zu pieces, %zu of %zu cells visible\n", l, level.spacing.x, level.spacing.y, level.spacing.z, level.pieces,
                    level.visible, level.cells);
    }
}

void print_times(const Input& input) {
    if (!input.time) return;
    if (input.times.size() == 1) {
        std::printf("time        %.6g, the only step\n", *input.time);
        return;
    }
    std::printf("time        %.6g (of %zu steps, %.6g .. %.6g; --time T chooses)\n", *input.time, input.times.size(),
                input.times.front(), input.times.back());
}

void print_size(const TetMesh& mesh) {
    const Bounds box = bounds(mesh.points);
    for (int axis = 0; axis < 3; ++axis) {
        std::printf("%s%c %.6g .. %.6g%s", axis == 0 ? "bounds      " : ", ", "xyz"[axis], box.low[axis], box.high[axis],
                    axis == 2 ? "\n" : "");
    }
    double volume = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) volume += signed_volume(mesh, cell);
    std::printf("volume      %.6g\n", volume);
}

std::string number(double x) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
    return {text.data(), end};
}

// The options without which the file is not read like this, each with a blank before it.
std::string how_it_was_read(const InputOptions& options) {
    std::ostringstream text;
    if (!options.solution.empty()) text << " --q " << quoted(options.solution.string());
    for (const std::string& block : options.blocks) text << " --block " << quoted(block);
    if (options.time) text << " --time " << number(*options.time);
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

void print_first_picture(const Input& input, const InputOptions& options) {
    const std::optional<std::string> field = field_to_look_at(*input.mesh, input.report.added_points);
    const bool needs_solution = !field && options.solution.empty() && input.format.starts_with("PLOT3D");
    if (needs_solution) {
        std::printf("\nA PLOT3D grid has its values in a solution file, give it by --q FILE\n");
    } else if (!field) {
        std::printf("\nNo field of this file varies over the mesh\n");
    }
    std::printf("\n%s:\n  cellproj render %s%s -o picture.png --field %s\n", field ? "A first picture" : "A picture of a coordinate",
                quoted(input.name).c_str(), how_it_was_read(options).c_str(), quoted(field.value_or("Points:z")).c_str());
}

void print_info(const InputOptions& options) {
    if (detect_surface_format(options.file)) return print_surface(options.file);
    const Input input = load(options);
    const TetMesh& mesh = *input.mesh;
    std::printf("%s: %s\n", input.name.c_str(), input.format.c_str());
    print_points(input);
    std::printf("cells       %s", input.cells.c_str());
    if (input.skipped_cells > 0) std::printf(" (%zu more are no volumes and are skipped)", input.skipped_cells);
    if (input.ghost_cells > 0) std::printf(" (%zu more are %s and left out)", input.ghost_cells,
                                          input.levels.empty() ? "hidden, blanked or copies" : "under finer ones, hidden or blanked");
    std::printf("\n");
    print_tetrahedra(input);
    print_levels(input);
    print_blocks(input);
    print_times(input);
    print_size(mesh);
    const auto is_vector = [](const Field& field) { return field.components > 1; };
    const bool vectors = std::any_of(mesh.point_fields.begin(), mesh.point_fields.end(), is_vector) ||
                         std::any_of(mesh.cell_fields.begin(), mesh.cell_fields.end(), is_vector);
    std::printf("fields%s\n", mesh.point_fields.empty() && mesh.cell_fields.empty() ? "      none"
                              : vectors ? "      (a component of NAME: --field NAME:x, NAME:y, NAME:z or NAME:0 and so on)"
                                        : "");
    print_fields(mesh, FieldLocation::points);
    print_fields(mesh, FieldLocation::cells);
    print_first_picture(input, options);
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InputOptions>();
    CLI::App* command = app.add_subcommand("info", "Say what is in a file: cells, fields with ranges, bounds.");
    add_input_options(*command, *options);
    command->callback([options] { print_info(*options); });
}

}  // namespace cellproj::cli
