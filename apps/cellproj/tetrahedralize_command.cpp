// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "commands.hpp"
#include "mesh/error.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"
#include "mesh/write_vtu.hpp"
#include "progress.hpp"
#include "surface_input.hpp"

namespace cellproj::cli {

namespace {

struct TetrahedralizeOptions {
    std::filesystem::path surface, output, intersections;
    SurfaceOptions filling;
};

// Before the work, not after it.
void require_suffix(const char* option, const std::filesystem::path& output, const char* suffix, const char* what) {
    if (output.extension() == suffix) return;
    throw Error({.kind = ErrorKind::option,
                 .place = std::string("option ") + option,
                 .expected = std::string("a name that ends in ") + suffix,
                 .found = "\"" + output.string() + "\"",
                 .advice = what});
}

// The offending facets alone, with the fields "facet", their number in the file, and "crossed", that of the facets they meet.
void write_intersections(const Surface& surface, const SurfaceReport& report, const std::filesystem::path& file) {
    std::map<std::uint32_t, std::set<std::uint32_t>> crossed;
    for (const auto& [a, b] : report.intersections) {
        crossed[a].insert(b);
        crossed[b].insert(a);
    }
    Surface offenders{surface.name, surface.points, {}, surface.point_fields};
    std::vector<Field> fields{{"facet", 1, {}}, {"crossed", 1, {}}};
    for (std::size_t i = 0; i < surface.polygons.size(); ++i) {
        const auto entry = crossed.find(facet_of(surface, i));
        if (entry == crossed.end()) continue;
        offenders.polygons.push_back(surface.polygons[i]);
        fields[0].values.push_back(entry->first);
        fields[1].values.push_back(static_cast<double>(entry->second.size()));
    }
    write_vtp(offenders, fields, file);
    std::printf("%s: %zu facets that cross or touch others\n", file.c_str(), offenders.polygons.size());
}

TetMesh mesh_inside(const TetrahedralizeOptions& options) {
    const Surface surface = load_surface(options.surface, options.filling);
    MesherOptions mesher = options.filling.mesher;
    mesher.max_volume = options.filling.max_volume.value_or(0.0);
    SurfaceReport report;
    try {
        const Progress progress("filling " + surface.name);
        return tetrahedralize(surface, mesher, &report);
    } catch (const Error&) {
        if (!options.intersections.empty() && !report.intersections.empty())
            write_intersections(surface, report, options.intersections);
        throw;
    }
}

struct Part {
    std::size_t tets = 0;
    double volume = 0.0;
};

void print_parts(const TetMesh& mesh, const std::filesystem::path& file) {
    Part whole;
    std::map<double, Part> regions;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        const double volume = signed_volume(mesh, cell);
        whole.volume += volume;
        if (mesh.cell_fields.empty()) continue;
        Part& region = regions[mesh.cell_fields.front().values[cell]];
        ++region.tets;
        region.volume += volume;
    }
    std::printf("%s: %zu tetrahedra, volume %.9g\n", file.c_str(), mesh.tets.size(), whole.volume);
    for (const auto& [attribute, region] : regions)
        std::printf("  region %g: %zu tetrahedra, volume %.9g\n", attribute, region.tets, region.volume);
}

void run(const TetrahedralizeOptions& options) {
    require_suffix("--output", options.output, ".vtu", "meshes are written as VTK XML unstructured grids");
    if (!options.intersections.empty())
        require_suffix("--intersections", options.intersections, ".vtp", "facets are written as VTK XML polygonal data");
    const TetMesh mesh = mesh_inside(options);
    write_vtu(mesh, options.output);
    print_parts(mesh, options.output);
    if (!options.intersections.empty())
        std::printf("no facets cross or touch: %s is not written\n", options.intersections.c_str());
}

}  // namespace

void add_tetrahedralize_command(CLI::App& app) {
    auto options = std::make_shared<TetrahedralizeOptions>();
    CLI::App* command = app.add_subcommand("tetrahedralize", "Fill a closed surface with tetrahedra.");
    command->add_option("SURFACE", options->surface, "An STL, OFF, PLY, OBJ, VTP, .poly or .smesh file")->required();
    command->add_option("-o,--output", options->output, "The mesh to write, a .vtu file")->required();
    command->add_option("--intersections", options->intersections,
                        "Where facets cross or touch each other: write them to this .vtp file");
    add_surface_options(*command, options->filling, "no bound");
    command->callback([options] { run(*options); });
}

}  // namespace cellproj::cli
