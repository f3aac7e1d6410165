// SPDX-License-Identifier: BSD-3-Clause
//
// What the user names on the command line: a file, or an embedded scene.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "classify/transfer_function.hpp"
#include "mesh/dataset.hpp"
#include "mesh/tet_mesh.hpp"
#include "mesh/tetrahedralize.hpp"
#include "project/camera.hpp"

namespace cellproj::cli {

struct InputOptions {
    std::string file;                // a path, or "demo:sphere"
    std::filesystem::path solution;  // PLOT3D: --q
};

struct Input {
    std::string name;                       // for messages
    std::shared_ptr<const TetMesh> mesh;
    TetrahedralizeReport report;
    std::string cells;                      // in words: "37479 hexahedra"
    std::string format;                     // in words
    std::optional<GridDimensions> grid;
    std::size_t skipped_cells = 0;
    double read_ms = 0, tetrahedralize_ms = 0;
    // What an embedded scene brings with it.
    std::optional<Camera> camera;
    std::shared_ptr<const TransferFunction> transfer;
};

// Throws Error as `read`, `tetrahedralize` and the mesher do.
Input load(const InputOptions& options);

}  // namespace cellproj::cli
