// SPDX-License-Identifier: BSD-3-Clause
//
// Files to datasets. TetGen, Gmsh, Medit, SU2, PLOT3D and raw files are read by readers of our own, all others through
// VTK's readers; built without VTK, `read` throws Error (environment) for these.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/raw_volume.hpp"

namespace cellproj {

struct ReadOptions {
    std::filesystem::path solution = {};  // PLOT3D: the solution (Q) file that belongs to the grid; empty: none
    std::vector<std::string> blocks =
        {};                           // the blocks to read, by name or by the first or last parts of it; empty: all
    std::optional<double> time = {};  // the nearest time step is read; none: the last
    // Told how much VTK's reader has read, 0 to 1, while `read` is under way, on its thread; it may start again with each
    // part of a file. Not for the formats that need no VTK.
    std::function<void(double fraction)> progress = {};
    // Cells of second order and Lagrange cells: 1 cuts them at their nodes, so that all values are used and curved
    // edges bend there; 0 takes their corners only. Bézier cells, Lagrange pyramids, Medit's and Gmsh's orders 3 and 4
    // always count by their corners. One level is what the nodes say: more would cost 8 times the cells for what lies
    // between them.
    int subdivide = 1;
    std::optional<RawVolume> raw = {};  // the file is bare voxels of this layout, whatever its name
};

// Reads
// - VTK XML: unstructured, structured, rectilinear and image grids (.vtu .vts .vtr .vti), partitioned (.pvtu .pvts
//   .pvtr .pvti), multi-block (.vtm) and collections, which are time series (.pvd); legacy VTK of the same four kinds
//   (.vtk);
// - hierarchies of uniform grids: VTK's AMR (.vth, .vthb), overlapping or not, and JSON files {"pieces": […]} that name
//   the files of pieces (README.md); coarse cells under finer ones are left out and count as ghost cells;
// - OpenFOAM cases, reconstructed or decomposed, given by their folder, system/controlDict or a file .foam: the
//   internal mesh of each region with its cell fields;
// - EnSight Gold (.case), Exodus II (.e .ex2 .exo; displacements are a field, not applied), CGNS (ADF and HDF5);
// - Fluent (.msh .cas, with the .dat beside it): linear cells; its polyhedra lose their faces in VTK's reader and give
//   an Error;
// - MetaImage (.mhd .mha), NRRD (.nrrd .nhdr) and SLC (.slc) volumes, one point per voxel (NRRD: at least 10 voxels
//   along the first axis; VTK takes a shorter one for components, which gives an Error);
// - PLOT3D grids with, if `solution` is given, their fields; raw volumes, if `raw` is given; TetGen, Gmsh, Medit and
//   SU2 (text_formats.hpp).
// The format is told by content first and by the file's suffix second. Structured, rectilinear and image grids become
// curvilinear ones. All volume blocks of a file become one mesh, points unmerged and with NaN where a block lacks a
// field; other blocks and other cells are skipped and counted. VTK's readers run in a child process each (a fork of
// this one), since damaged files make them crash, hang or ask for all memory: this, too, gives an Error, and VTK's
// messages are caught, not printed. isolated_read.hpp says what limits of time and memory the child has and what that
// means for a program of several threads. Throws Error:
// - environment: no child process to be had;
// - file: missing, a folder that is no case, unreadable;
// - format: not recognised, truncated, malformed, beyond the child's limits, a part of it (a piece, a file of the case)
//   missing;
// - data: no volume cells, cells of an unsupported kind, grids with one point in a direction, points that are not
//   finite, vertex ids out of range, a solution of another size;
// - option: a solution given for a file that is no PLOT3D grid, impossible dimensions of a raw volume, a block that
//   does not exist (the message lists those that do), a time or blocks chosen in a file that has none.
Dataset read(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace cellproj
