// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes to files that other programs read.
#pragma once

#include <filesystem>
#include <vector>

#include "mesh/surface.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Writes a VTK XML unstructured grid: float64, zlib, appended raw. Under a temporary name in the same folder first,
// renamed when it is whole: `file` is never half written. Throws Error (file) when that cannot be done, Error
// (environment) where cellproj was built without VTK.
void write_vtu(const TetMesh& mesh, const std::filesystem::path& file);

// The same for the polygons of a surface, with its point fields and with fields of one row per polygon: VTK XML polygonal
// data.
void write_vtp(const Surface& surface, const std::vector<Field>& polygon_fields, const std::filesystem::path& file);

}  // namespace cellproj
