// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/check.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "input.hpp"
#include "mesh/error.hpp"

namespace cellproj::cli {

namespace {

struct CheckOptions {
    InputOptions input;
    bool json = false;
};

void print(const char* what, const Finding& finding, const char* kind, const char* meaning) {
    if (finding.count == 0) return;
    std::printf("%-22s %zu (%s", what, finding.count, kind);
    for (const std::size_t id : finding.first) std::printf(" %zu", id);
    std::printf("%s): %s\n", finding.count > finding.first.size() ? " …" : "", meaning);
}

void print_text(const Input& input, const MeshCheck& c) {
    std::printf("%s: %zu tetrahedra, %zu points\n", input.name.c_str(), input.mesh->tets.size(), input.mesh->points.size());
    if (input.report.flipped > 0) {
        std::printf("%-22s %zu: turned; harmless\n", "stored inside out", input.report.flipped);
    }
    if (input.report.inverted > 0) {
        std::printf("%-22s %zu: parts of crushed cells that no split could keep upright\n", "inverted tetrahedra", input.report.inverted);
    }
    print("flat cells", c.flat_cells, "cells", "they hold no light; harmless");
    print("repeated vertices", c.repeated_vertices, "cells", "collapsed cells; harmless");
    print("overlapping cells", c.overlapping_cells, "cells", "space is drawn twice there: repair the mesh");
    if (c.overused_faces > 0) {
        std::printf("%-22s %zu: three or more cells at a face; the order may be wrong there: repair the mesh\n",
                    "overused faces", c.overused_faces);
    }
    print("isolated points", c.isolated_points, "points", "in no cell; harmless");
    print("coincident points", c.coincident_points, "points", "cells may not be joined there");
    if (c.coincident_points.count > 0) {
        std::printf("%-22s up to %.6g between the values at one place\n", "", c.coincident_difference);
    }
    for (const auto& [name, values] : c.not_finite) {
        std::printf("%-22s %zu in field \"%s\": the cells that touch them are left out\n", "values not finite", values, name.c_str());
    }
    std::printf("%-22s %zu, %zu closed boundary surfaces\n", "components", c.components, c.boundary_components);
    std::printf("%-22s %.6g, %.6g, %.6g\n", "cell volumes", c.volumes[0], c.volumes[1], c.volumes[2]);
    std::printf("%-22s %s, %s: the order of cells is %s\n", "shape", c.convex ? "convex" : "not convex",
                c.delaunay ? "Delaunay" : "not Delaunay",
                c.convex ? (c.delaunay ? "exact" : "exact unless cells hide each other in a cycle")
                         : "not proven across the outside");
    std::printf("%s\n", c.faithful() ? "can be rendered faithfully" : "cannot be rendered faithfully, see above");
}

nlohmann::ordered_json to_json(const Finding& finding) { return {{"count", finding.count}, {"first", finding.first}}; }

void print_json(const Input& input, const MeshCheck& c) {
    nlohmann::ordered_json not_finite = nlohmann::ordered_json::object();
    for (const auto& [name, values] : c.not_finite) not_finite[name] = values;
    const nlohmann::ordered_json json{{"file", input.name},
                                      {"tetrahedra", input.mesh->tets.size()},
                                      {"points", input.mesh->points.size()},
                                      {"stored_inside_out", input.report.flipped},
                                      {"inverted", input.report.inverted},
                                      {"flat_cells", to_json(c.flat_cells)},
                                      {"repeated_vertices", to_json(c.repeated_vertices)},
                                      {"overlapping_cells", to_json(c.overlapping_cells)},
                                      {"overused_faces", c.overused_faces},
                                      {"isolated_points", to_json(c.isolated_points)},
                                      {"coincident_points", to_json(c.coincident_points)},
                                      {"coincident_difference", c.coincident_difference},
                                      {"not_finite", not_finite},
                                      {"components", c.components},
                                      {"boundary_surfaces", c.boundary_components},
                                      {"cell_volumes", c.volumes},
                                      {"convex", c.convex},
                                      {"delaunay", c.delaunay},
                                      {"faithful", c.faithful()}};
    std::printf("%s\n", json.dump(2).c_str());
}

void check_file(const CheckOptions& options) {
    const Input input = load(options.input);
    const MeshCheck result = check(*input.mesh, build_adjacency(*input.mesh));
    (options.json ? print_json : print_text)(input, result);
    if (!result.faithful()) throw CLI::RuntimeError(1);
}

}  // namespace

void add_check_command(CLI::App& app) {
    auto options = std::make_shared<CheckOptions>();
    CLI::App* command =
        app.add_subcommand("check", "Say what is wrong with a mesh; exit code 0 when it can be rendered faithfully.");
    add_input_options(*command, options->input);
    command->add_flag("--json", options->json, "As JSON on standard output");
    command->callback([options] { check_file(*options); });
}

}  // namespace cellproj::cli
