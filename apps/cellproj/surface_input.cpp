// SPDX-License-Identifier: BSD-3-Clause
#include "surface_input.hpp"

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>

#include "mesh/error.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/io/surface_format.hpp"
#include "option_text.hpp"
#include "progress.hpp"
#include "render/statistics.hpp"

namespace cellproj::cli {

namespace {

[[noreturn]] void refuse(const char* option, const std::string& expected, const std::string& found) {
    throw Error({.kind = ErrorKind::option,
                 .place = std::string("option ") + option,
                 .expected = expected,
                 .found = "\"" + found + "\"",
                 .advice = "numbers have a point, not a comma, before their decimals"});
}

glm::dvec3 parse_hole(const std::string& text) {
    if (const auto point = to_point(text)) return *point;
    refuse("--hole", "a point X,Y,Z", text);
}

// Without an attribute, regions count from 1.
Region parse_region(const std::string& text, std::size_t number) {
    const auto parts = split(text, ':');
    const auto point = to_point(parts[0]);
    const auto attribute = parts.size() > 1 ? to_number(parts[1]) : static_cast<double>(number);
    const auto volume = parts.size() > 2 ? to_number(parts[2]) : 0.0;
    if (parts.size() > 3 || !point || !attribute || !volume || *volume < 0.0)
        refuse("--region", "X,Y,Z, X,Y,Z:ATTRIBUTE or X,Y,Z:ATTRIBUTE:MAXVOLUME", text);
    return {*point, *attribute, *volume};
}

// The volume of a regular tetrahedron with edges of 1/40 of the diagonal: a few times 1e5 cells in a compact body, for
// which filling and drawing take a few seconds.
double picture_volume(const Surface& surface) {
    const double edge = bounds(surface.points).diagonal() / 40.0;
    return edge * edge * edge / (6.0 * std::sqrt(2.0));
}

std::string next_commands(const std::filesystem::path& file) {
    const std::string name = quoted(file.string());
    return "cellproj render " + name + " --tetrahedralize -o picture.png, or cellproj tetrahedralize " + name + " -o " +
           quoted(file.stem().string() + ".vtu");
}

}  // namespace

std::vector<CLI::Option*> add_surface_options(CLI::App& command, SurfaceOptions& options,
                                              const std::string& default_volume) {
    MesherOptions& mesher = options.mesher;
    return {command.add_option("--max-volume", options.max_volume,
                               "Surfaces: largest cell [mesh units³], 0: no bound; default: " + default_volume),
            command
                .add_option("--quality", mesher.radius_edge_ratio,
                            "Surfaces: largest circumradius / shortest edge of a cell; 0: no quality refinement")
                ->capture_default_str(),
            command.add_flag("--fill-holes", mesher.fill_holes, "Surfaces: cap the open ends"),
            command.add_option("--wrap", mesher.wrap,
                               "Surfaces: fill a closed wrap around it instead, for hopeless ones; the radius of the ball "
                               "that rolls over it, as a part of its box's diagonal (such as 0.05); the wrap lies 1/30 of "
                               "that radius outside"),
            command
                .add_option("--hole", options.holes,
                            "Surfaces: X,Y,Z is in a void to be left empty (again for more); inner walls are allowed then")
                ->allow_extra_args(false),
            command
                .add_option("--region", options.regions,
                            "Surfaces: X,Y,Z[:ATTRIBUTE[:MAXVOLUME]] is in a part between walls (again for more), which gets "
                            "its attribute in the cell field \"region\" (default: 1, 2, …) and a bound of its own")
                ->allow_extra_args(false),
            command.add_option("--timeout", mesher.timeout_seconds, "Surfaces: give up filling after so many seconds")
                ->capture_default_str()};
}

Surface load_surface(const std::filesystem::path& file, const SurfaceOptions& options) {
    std::vector<glm::dvec3> holes;
    std::vector<Region> regions;
    for (const std::string& text : options.holes)
        holes.push_back(parse_hole(text));
    for (const std::string& text : options.regions)
        regions.push_back(parse_region(text, regions.size() + 1));
    Surface surface = read_surface(file);
    if (!holes.empty() || !regions.empty()) surface.inside = Inside::enclosed;
    surface.holes.insert(surface.holes.end(), holes.begin(), holes.end());
    surface.regions.insert(surface.regions.end(), regions.begin(), regions.end());
    return surface;
}

Input load_filled(const std::filesystem::path& file, const SurfaceOptions& options) {
    Input input;
    input.name = file.string();
    const Stopwatch reading;
    const Surface surface = load_surface(file, options);
    input.read_ms = reading.ms();

    const Progress progress("filling " + input.name);
    const Stopwatch filling;
    MesherOptions mesher = options.mesher;
    mesher.max_volume = options.max_volume.value_or(picture_volume(surface));
    auto mesh = std::make_shared<TetMesh>(tetrahedralize(surface, mesher));
    input.tetrahedralize_ms = filling.ms();
    input.report.tets = mesh->tets.size();
    input.cells = std::to_string(mesh->tets.size()) + " tetrahedra";
    input.format = "a surface, filled with tetrahedra";
    input.mesh = std::move(mesh);
    return input;
}

void print_surface(const std::filesystem::path& file) {
    const Surface surface = read_surface(file);
    const std::string name = surface.name;
    const auto format = detect_surface_format(file);
    std::printf("%s: a surface, %s\npoints      %zu as stored\nfacets      %zu\n", name.c_str(),
                format ? cellproj::name(*format) : "", surface.points.size(),
                facet_of(surface, surface.polygons.size() - 1) + std::size_t{1});
    if (!surface.holes.empty()) std::printf("holes       %zu\n", surface.holes.size());
    if (!surface.regions.empty()) std::printf("regions     %zu\n", surface.regions.size());
    const Bounds box = bounds(surface.points);
    std::printf("bounds      x %.6g .. %.6g, y %.6g .. %.6g, z %.6g .. %.6g\n", box.low.x, box.high.x, box.low.y,
                box.high.y, box.low.z, box.high.z);
    std::printf("fields%s\n", surface.point_fields.empty() ? "      none (the inside gets \"distance\", that to the surface)" : "");
    for (const Field& field : surface.point_fields) {
        const ScalarRange values = range(as_scalar(field, FieldLocation::points).values);
        std::printf("  %-24s on points, %.6g .. %.6g\n", field.name.c_str(), values.low, values.high);
    }
    std::printf("\nA surface has no cells to render yet. To fill it:\n  cellproj render %s --tetrahedralize -o picture.png\n"
                "  cellproj tetrahedralize %s -o %s\n",
                quoted(name).c_str(), quoted(name).c_str(), quoted(file.stem().string() + ".vtu").c_str());
}

void require_no_surface(const std::filesystem::path& file) {
    const auto format = detect_surface_format(file);
    if (!format) return;
    throw Error({.kind = ErrorKind::data,
                 .place = file.string(),
                 .expected = "a mesh of volume cells",
                 .found = std::string("a surface (") + name(*format) + ")",
                 .advice = "fill it: " + next_commands(file)});
}

}  // namespace cellproj::cli
