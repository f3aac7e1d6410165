// SPDX-License-Identifier: BSD-3-Clause
#include "input.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/grid_pieces.hpp"
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

std::vector<double> counted(std::size_t n) {
    std::vector<double> numbers(n);
    std::iota(numbers.begin(), numbers.end(), 0.0);
    return numbers;
}

const std::map<std::string, NumberType> types_by_name = [] {
    std::map<std::string, NumberType> types;
    for (const NamedNumberType& named : number_types) types.emplace(named.name, named.type);
    return types;
}();

void add_raw_options(CLI::App& command, InputOptions& options) {
    auto* dims = command.add_option("--dims", options.raw_dimensions, "FILE is bare voxels, NX NY NZ of them, x fastest")
                     ->expected(3)->type_name("NX NY NZ");
    auto* type = command.add_option("--type", options.raw_type, "Their type")
                     ->check(CLI::IsMember(types_by_name))->type_name("TYPE");
    dims->needs(type);
    type->needs(dims);
    command.add_flag("--big-endian", options.raw.big_endian, "Their bytes have the highest first")->needs(dims);
    command.add_option("--spacing", options.raw_spacing, "Their distances [mesh units]")->needs(dims)->expected(3)
        ->type_name("DX DY DZ")->check(finite_number())->capture_default_str();
    command.add_option("--origin", options.raw_origin, "Where the first one lies [mesh units]")->needs(dims)->expected(3)
        ->type_name("X Y Z")->check(finite_number())->capture_default_str();
    command.add_option("--header", options.raw.header_bytes, "Bytes in front of them")->needs(dims)->capture_default_str();
}

ReadOptions read_options(const InputOptions& options) {
    ReadOptions result;
    result.solution = options.solution;
    result.blocks = options.blocks;
    result.time = options.time;
    result.subdivide = options.subdivide;
    if (options.raw_dimensions.empty()) return result;
    result.raw = options.raw;
    const auto vector3 = [](const std::vector<double>& v) { return glm::dvec3(v[0], v[1], v[2]); };
    result.raw->spacing = vector3(options.raw_spacing);
    result.raw->origin = vector3(options.raw_origin);
    result.raw->type = types_by_name.at(options.raw_type);
    result.raw->dimensions = {options.raw_dimensions[0], options.raw_dimensions[1], options.raw_dimensions[2]};
    return result;
}

std::vector<InputLevel> levels_of(const Dataset& dataset) {
    std::vector<std::array<GridAxis, 3>> axes;
    std::vector<std::string> names;
    for (const PieceRows& piece : dataset.pieces) {
        axes.push_back(piece.boxes.axes);
        names.push_back(piece.name);
    }
    if (axes.empty()) return {};
    const Lattice lattice = place_pieces(axes, names, dataset.source);
    std::vector<InputLevel> levels(static_cast<std::size_t>(lattice.levels));
    for (std::size_t p = 0; p < axes.size(); ++p) {
        InputLevel& level = levels[static_cast<std::size_t>(lattice.pieces[p].level)];
        level.spacing = {*axes[p][0].spacing, *axes[p][1].spacing, *axes[p][2].spacing};
        ++level.pieces;
        level.cells += axes[p][0].cells() * axes[p][1].cells() * axes[p][2].cells();
        level.visible += dataset.pieces[p].cells;
    }
    return levels;
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
    command.add_option("--subdivide", options.subdivide,
                       "Cells of second order and Lagrange cells: 1 cuts them at their nodes, 0 takes their corners only")
        ->check(CLI::Range(0, 1))->capture_default_str();
    add_raw_options(command, options);
}

std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
        return std::isalnum(c) || c >= 0x80 || std::string_view("_-./:,=+@%").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (plain) return word;
    std::string result = "'";
    for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

CLI::Validator finite_number() {
    return {[](std::string& text) -> std::string {
                double value = 0;
                return CLI::detail::lexical_cast(text, value) && std::isfinite(value) ? "" : text + " is no finite number";
            },
            "FINITE"};
}

Input load(const InputOptions& options, DrawnAs drawn_as) {
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
    Dataset dataset = [&] {
        Progress progress("reading " + input.name);
        ReadOptions how = read_options(options);
        how.progress = [&](double fraction) { progress.set(fraction); };
        return read(options.file, how);
    }();
    input.read_ms = reading.ms();

    input.cells = cells_in_words(dataset);
    input.levels = levels_of(dataset);
    if (drawn_as == DrawnAs::grid || (drawn_as == DrawnAs::automatic && (dataset.boxes || !dataset.pieces.empty()))) {
        auto mesh = std::make_shared<TetMesh>();
        mesh->points = std::move(dataset.points);
        mesh->point_fields = std::move(dataset.point_fields);
        mesh->cell_fields = std::move(dataset.cell_fields);
        input.mesh = std::move(mesh);
        input.regular.emplace();
        input.regular->source = dataset.source;
        input.regular->format = dataset.format;
        input.regular->grid = dataset.grid;
        input.regular->boxes = std::move(dataset.boxes);
        input.regular->pieces = std::move(dataset.pieces);
    } else {
        const Stopwatch splitting;
        const Progress progress("splitting cells");
        if (options.number_cells) dataset.cell_fields.push_back({"", 1, counted(dataset.cell_count())});
        auto mesh = std::make_shared<TetMesh>(tetrahedralize(dataset, &input.report));
        if (options.number_cells) {
            input.file_cells = std::move(mesh->cell_fields.back().values);
            mesh->cell_fields.pop_back();
        }
        input.mesh = std::move(mesh);
        input.tetrahedralize_ms = splitting.ms();
    }
    input.format = dataset.format;
    input.grid = dataset.grid;
    input.skipped_cells = dataset.skipped_cells;
    input.ghost_cells = dataset.ghost_cells;
    input.skipped_blocks = dataset.skipped_blocks;
    input.blocks = dataset.blocks;
    input.times = dataset.times;
    input.time = dataset.time;
    return input;
}

}  // namespace cellproj::cli
