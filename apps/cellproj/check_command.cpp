// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/check.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

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

// A finding, and what to print of it: its name in JSON (in text with spaces), what its ids count, what it means.
struct Entry {
    std::string key;
    const Finding& finding;
    bool cells;  // ids of tetrahedra; else of points
    const char* meaning;
};

std::vector<Entry> entries(const MeshCheck& c) {
    return {{"flat_cells", c.flat_cells, true, "they hold no light; harmless"},
            {"repeated_vertices", c.repeated_vertices, true, "collapsed cells; harmless"},
            {"overlapping_cells", c.overlapping_cells, true, "space is drawn twice there: repair the mesh"},
            {"overused_faces", c.overused_faces, true,
             "three or more cells at a face; the order may be wrong there: repair the mesh"},
            {"hanging_points", c.hanging_points, false,
             "inside a face of a cell that does not know them; the field may jump there, and the order of cells goes by depth: "
             "join the grids point by point"},
            {"crossing_faces", c.crossing_faces, true,
             "cut along another diagonal than on the other side; the field may jump there, with gaps or overlaps where the "
             "face is not planar, and the order of cells goes by depth: merge the coincident points"},
            {"seam_faces", c.seam_faces, true,
             "pairs of faces at one place that share no points: blocks not joined, or a wall without thickness; drawn as they "
             "are, the order of cells across them goes by depth"},
            {"isolated_points", c.isolated_points, false, "in no cell; harmless"},
            {"coincident_points", c.coincident_points, false, "at the place of another point; cells may not be joined there"}};
}

glm::dvec3 place(const TetMesh& mesh, const Entry& entry, std::size_t id) {
    if (!entry.cells) return mesh.points[id];
    glm::dvec3 centroid(0);
    for (const VertexId v : mesh.tets[id]) centroid += 0.25 * mesh.points[v];
    return centroid;
}

// The cell of the file that holds a tetrahedron; points keep their ids.
std::size_t file_id(const Input& input, const Entry& entry, std::size_t id) {
    return entry.cells && !input.file_cells.empty() ? static_cast<std::size_t>(input.file_cells[id]) : id;
}

std::string with_spaces(std::string key) {
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
}

void print(const Input& input, const Entry& entry) {
    if (entry.finding.count == 0) return;
    std::printf("%-22s %zu: %s\n", with_spaces(entry.key).c_str(), entry.finding.count, entry.meaning);
    for (const std::size_t id : entry.finding.first) {
        const glm::dvec3 at = place(*input.mesh, entry, id);
        std::printf("%-22s   %s %zu at (%.9g, %.9g, %.9g)\n", "", entry.cells ? "cell" : "point", file_id(input, entry, id), at.x,
                    at.y, at.z);
    }
    if (entry.finding.count > entry.finding.first.size()) std::printf("%-22s   …\n", "");
}

const char* order_in_words(const MeshCheck& c) {
    if (c.convex && c.delaunay) return "exact from every view";
    if (c.convex) return "exact unless cells hide each other in a cycle";
    return "exact inside a component unless cells hide each other in a cycle; by depth, not proven, across gaps, holes and seams";
}

void print_text(const Input& input, const MeshCheck& c) {
    std::printf("%s: %zu tetrahedra, %zu points\n", input.name.c_str(), input.mesh->tets.size(), input.mesh->points.size());
    if (!input.file_cells.empty()) std::printf("cells are told by their number among the volume cells of the file, from 0\n");
    if (input.report.flipped > 0) {
        std::printf("%-22s %zu: turned; harmless\n", "stored inside out", input.report.flipped);
    }
    if (input.report.inverted > 0) {
        std::printf("%-22s %zu: parts of crushed cells that no split could keep upright; they overlap their neighbours\n",
                    "inverted tetrahedra", input.report.inverted);
    }
    for (const Entry& entry : entries(c)) print(input, entry);
    if (!c.coincident_field.empty()) {
        std::printf("%-22s up to %.6g between the values of \"%s\" at one place\n", "", c.coincident_difference,
                    c.coincident_field.c_str());
    }
    for (const auto& [name, values] : c.not_finite) {
        std::printf("%-22s %zu in field \"%s\": the cells that touch them are left out\n", "values not finite", values, name.c_str());
    }
    std::printf("%-22s %zu, with %zu closed boundary surfaces, of which %zu are cavities\n", "components", c.components,
                c.boundary_components, c.cavities);
    std::printf("%-22s %.6g to %.6g, median %.6g\n", "volumes of tetrahedra", c.volumes[0], c.volumes[2], c.volumes[1]);
    std::printf("%-22s %.6g to %.6g\n", "edges", c.edges[0], c.edges[1]);
    std::printf("%-22s %s, %s\n", "shape", c.convex ? "convex" : "not convex", c.delaunay ? "Delaunay" : "not Delaunay");
    std::printf("%-22s %s\n", "order of cells", order_in_words(c));
    std::printf("%s\n", c.faithful() ? "can be rendered faithfully" : "cannot be rendered faithfully, see above");
}

nlohmann::ordered_json to_json(const Input& input, const Entry& entry) {
    nlohmann::ordered_json first = nlohmann::ordered_json::array(), at = first;
    for (const std::size_t id : entry.finding.first) {
        const glm::dvec3 p = place(*input.mesh, entry, id);
        first.push_back(file_id(input, entry, id));
        at.push_back({p.x, p.y, p.z});
    }
    return {{"count", entry.finding.count}, {"of", entry.cells ? "cells" : "points"}, {"first", first}, {"at", at}};
}

void print_json(const Input& input, const MeshCheck& c) {
    nlohmann::ordered_json json{{"file", input.name},
                                {"tetrahedra", input.mesh->tets.size()},
                                {"points", input.mesh->points.size()},
                                {"stored_inside_out", input.report.flipped},
                                {"inverted", input.report.inverted}};
    for (const Entry& entry : entries(c)) json[entry.key] = to_json(input, entry);
    json["coincident_difference"] = c.coincident_difference;
    json["coincident_field"] = c.coincident_field;
    json["not_finite"] = nlohmann::ordered_json::object();
    for (const auto& [name, values] : c.not_finite) json["not_finite"][name] = values;
    json["components"] = c.components;
    json["boundary_surfaces"] = c.boundary_components;
    json["cavities"] = c.cavities;
    json["volumes"] = {{"smallest", c.volumes[0]}, {"median", c.volumes[1]}, {"largest", c.volumes[2]}};
    json["edges"] = {{"shortest", c.edges[0]}, {"longest", c.edges[1]}};
    json["convex"] = c.convex;
    json["delaunay"] = c.delaunay;
    json["order"] = order_in_words(c);
    json["faithful"] = c.faithful();
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
    options->input.number_cells = true;
    CLI::App* command =
        app.add_subcommand("check", "Say what is wrong with a mesh; exit code 0 when it can be rendered faithfully.");
    add_input_options(*command, options->input);
    command->add_flag("--json", options->json, "As JSON on standard output");
    command->callback([options] { check_file(*options); });
}

}  // namespace cellproj::cli
