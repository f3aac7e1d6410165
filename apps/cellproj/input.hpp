// SPDX-License-Identifier: BSD-3-Clause
//
// What the user names on the command line: a file, or an embedded scene.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "classify/transfer_function.hpp"
#include "mesh/dataset.hpp"
#include "mesh/raw_volume.hpp"
#include "mesh/tet_mesh.hpp"
#include "mesh/tetrahedralize.hpp"
#include "project/camera.hpp"

namespace CLI {
class App;
class Validator;
}

namespace cellproj::cli {

struct InputOptions {
    std::string file;                // a path, or "demo:sphere"
    std::filesystem::path solution;  // PLOT3D: --q
    std::vector<std::string> blocks; // --block, empty: all
    std::optional<double> time;      // --time, none: the last
    bool number_cells = false;       // fill Input::file_cells
    int subdivide = 1;               // --subdivide
    // Bare voxels: --dims (none: the file is no such one), --type, --big-endian, --spacing, --origin, --header.
    std::vector<std::size_t> raw_dimensions;
    std::vector<double> raw_spacing{1, 1, 1}, raw_origin{0, 0, 0};
    std::string raw_type;
    RawVolume raw;  // byte order and header
};

// FILE and how to read it (--q, --block, --time, --subdivide; --dims and what belongs to it), into `options`, which must live as long as the command.
void add_input_options(CLI::App& command, InputOptions& options);

// A word as the shell takes it: in single quotes where it must be.
std::string quoted(const std::string& word);

// Refuses NaN and infinity, which CLI11 takes for numbers.
CLI::Validator finite_number();

// How a regular grid is drawn.
enum class DrawnAs {
    automatic,  // as it is, where a file holds one
    grid,       // as it is; other files are refused
    tets        // cut into tetrahedra
};

// One level of a hierarchy of grids, the coarsest first.
struct InputLevel {
    glm::dvec3 spacing{0};  // mesh units
    std::size_t pieces = 0, cells = 0, visible = 0;  // cells that no finer piece covers
};

struct Input {
    std::string name;                       // for messages
    std::shared_ptr<const TetMesh> mesh;
    std::optional<Dataset> regular;         // of a grid, or a hierarchy of them, that is not cut: its axes; the mesh then has its points and fields, no cells
    TetrahedralizeReport report;
    std::string cells;                      // in words: "37479 hexahedra"
    std::string format;                     // in words
    std::optional<GridDimensions> grid;
    std::vector<InputLevel> levels;         // of a hierarchy of grids; empty: none
    std::size_t skipped_cells = 0, ghost_cells = 0, skipped_blocks = 0;
    std::vector<std::string> blocks;        // names of the volume blocks; empty: one dataset
    std::vector<double> times;              // of the file's time steps; empty: none
    std::optional<double> time;             // the one that was read
    std::vector<double> file_cells;         // #T, the volume cell of the file that each tetrahedron is part of; where asked for
    double read_ms = 0, tetrahedralize_ms = 0;
    // What an embedded scene brings with it.
    std::optional<Camera> camera;
    std::shared_ptr<const TransferFunction> transfer;
};

// Throws Error as `read`, `tetrahedralize` and the mesher do.
Input load(const InputOptions& options, DrawnAs drawn_as = DrawnAs::tets);

}  // namespace cellproj::cli
