// SPDX-License-Identifier: BSD-3-Clause
//
// Files to datasets without VTK: the formats of TetGen, Gmsh, Medit and SU2, PLOT3D and bare voxels, by small readers
// of our own.
//
// All of them: points float64, as many and in the order as in the file; volume cells by kind, those of higher order by
// their corners, but Gmsh's and TetGen's of second order cut at their nodes, if `subdivide` is 1 (of Medit's, no
// document fixes the order of the nodes); points, lines and surfaces among the elements are skipped and counted. Ids
// become 0-based. A count announced in the file is compared with the size of the file before memory is taken for it.
// Sizes: #P points, #C volume cells. Throw Error, naming file and line (or byte):
// - file: missing, a folder, unreadable;
// - format: truncated, malformed, an unknown version, element type or keyword where one is needed;
// - data: no points, no volume cells, a two-dimensional mesh, points that are not finite, ids out of range or missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"
#include "mesh/raw_volume.hpp"
#include "mesh/read.hpp"

namespace cellproj {

// Gmsh MSH 2 and 4.1, ascii and binary (of the byte order of this machine). Node tags may have gaps. Cell fields:
// "entity", the tag of the model entity of a cell, and "physical", the first physical group of that entity (0 for none;
// left out when no cell has one, and for the entities of partitioned 4.1 files). Views ($NodeData, $ElementData) become
// fields of 1, 3 or 9 components under their own names, with " step N" behind the name for every time step but number
// 0, and NaN where a view has no value. $ElementNodeData is skipped.
Dataset read_gmsh(const std::filesystem::path& file, int subdivide);
inline Dataset read_gmsh(const std::filesystem::path& file) {
    return read_gmsh(file, 1);
}

// Medit .mesh, ascii, dimension 3. Cell field "region" from the references of the cells. When a file of the same stem
// with the suffix .sol lies beside it, its solutions at vertices become the point fields "solution" or, if there are
// several, "solution_1", "solution_2", …, with 1 (scalar), 3 (vector), 6
// (symmetric tensor) or 9 (tensor) components. The file must end with the keyword End.
Dataset read_medit(const std::filesystem::path& file);

// SU2 native meshes, NDIME= 3. They have neither fields nor regions, nor has the result.
Dataset read_su2(const std::filesystem::path& file);

// TetGen, given the .node or the .ele file; the other one of the same stem must lie beside it. Tetrahedra with 4 or 10
// nodes; ids start at 0 or 1, as in the first line of the .node file. Point fields "attribute_1", … and, if marked,
// "boundary_marker"; cell field "region" from one attribute of the cells, "region_1", … from several.
Dataset read_tetgen(const std::filesystem::path& file, int subdivide);
inline Dataset read_tetgen(const std::filesystem::path& file) {
    return read_tetgen(file, 1);
}

// PLOT3D grids of one or several blocks, with or without IBLANK, binary (4- or 8-byte reals, either byte order, as C or
// Fortran writes them) or text: the layout that explains the file's size exactly. Cells that touch a point of IBLANK 0
// are left out and counted. Of several blocks, "block 1", "block 2", …, those in `wanted` are read (none: all); blocks
// of one point in a direction are skipped and counted. From a `solution` (Q) file (empty: none) of the same layout: the
// point fields Density, Momentum, StagnationEnergy, and Pressure, Mach and VelocityMagnitude of an ideal gas of gamma
// 1.4, without units as the file's are; NaN where a value does not exist. Throws Error (option) for a block that does
// not exist, Error (data) for a solution of another size.
Dataset read_plot3d(const std::filesystem::path& file, const std::filesystem::path& solution,
                    const std::vector<std::string>& wanted);

// Bare voxels: one point each, their numbers as the point field "value". Throws Error (format) when the file's size is
// not exactly that of the header and the numbers (the message says which volumes would fit), Error (option) for
// dimensions below 2, more points than ids, or a spacing of 0.
Dataset read_raw(const std::filesystem::path& file, const RawVolume& raw);

// A hierarchy of grids from the JSON that names its pieces (README.md), each read as its own format, with VTK's help where that needs it.
// Throws Error besides as `read` and `assemble_pieces` do.
Dataset read_hierarchy(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace cellproj
