// SPDX-License-Identifier: BSD-3-Clause
//
// Files to datasets. All formats are read through VTK's readers; built without VTK, `read` throws Error (environment).
#pragma once

#include <filesystem>

#include "mesh/dataset.hpp"

namespace cellproj {

struct ReadOptions {
    std::filesystem::path solution;  // PLOT3D: the solution (Q) file that belongs to the grid; empty: none
};

// Reads VTK XML unstructured (.vtu) and legacy VTK (.vtk, unstructured) files with tetrahedra and hexahedra, and
// single-block PLOT3D grids with, if `solution` is given, the fields Density, Momentum, StagnationEnergy, Pressure, Mach
// and VelocityMagnitude. The format is told by content first and by the file's suffix second. Cells that are no volumes
// are skipped and counted. VTK's own messages are caught, not printed; reads in several threads wait for each other.
// Throws Error:
// - file: missing, a folder, unreadable;
// - format: not recognised, truncated, malformed, another VTK dataset type;
// - data: no volume cells, cells of an unsupported kind, points that are not finite, vertex ids out of range, a PLOT3D
//   grid of several blocks or with blanked points, a solution of another size;
// - option: a solution given for a file that is no PLOT3D grid.
Dataset read(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace cellproj
