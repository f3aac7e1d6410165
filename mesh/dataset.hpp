// SPDX-License-Identifier: BSD-3-Clause
//
// What a file says, before it is cut into tetrahedra: cells of any kind over float64 points, and fields.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/grid_axis.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Volume cells, vertices in VTK's order (a wedge or prism: one end, then the other in the same order; which way round is
// never trusted). Voxels are stored as hexahedra; cells of higher order are cut at their nodes or stored by their corners
// (ReadOptions::subdivide). A polyhedron stores a face stream instead of vertices: the number of faces, then for each face the
// number of its vertices and their ids in cyclic order.
enum class CellKind : std::uint8_t {
    tetrahedron,
    hexahedron,
    wedge,
    pyramid,
    pentagonal_prism,
    hexagonal_prism,
    polyhedron
};

// #C cells of mixed kind: the vertices (or the face stream) of cell c are vertices[offsets[c] .. offsets[c+1]).
struct CellList {
    std::vector<CellKind> kinds;          // #C
    std::vector<std::uint64_t> offsets;   // #C + 1, first 0
    std::vector<VertexId> vertices;       // 0-based into Dataset::points

    std::size_t size() const { return kinds.size(); }
};

// A curvilinear grid: point (i, j, k) is points[i + ni·(j + nj·k)]; every cell is a hexahedron; no CellList is kept.
struct GridDimensions {
    std::size_t ni = 0, nj = 0, nk = 0;   // points per direction, each ≥ 2

    std::size_t cells() const { return (ni - 1) * (nj - 1) * (nk - 1); }
};

// What is regular in a file of boxes along x, y and z: an image, a rectilinear grid, voxels. As the file has it, so axes may
// descend or be no axes at all; mesh/grid.hpp makes a sound grid of it.
struct BoxGrid {
    std::array<GridAxis, 3> axes;
    std::vector<std::uint8_t> blanked;  // 1 for a cell of the file that is left out, i fastest; empty when none is
};

// One piece of a hierarchy of grids (grid_pieces.hpp): its boxes, of which those under finer pieces are blanked, and how many of the
// dataset's points and cells are its own.
struct PieceRows {
    std::string name;  // for messages: its file, or its place in the file
    BoxGrid boxes;
    std::size_t points = 0, cells = 0;
};

struct Dataset {
    std::string source;                        // the file, for messages
    std::string format;                        // in words: "VTK XML unstructured grid"
    std::vector<glm::dvec3> points;            // #P [mesh units]
    std::optional<GridDimensions> grid;        // set for a curvilinear grid; then `cells` is empty
    CellList cells;                            // set otherwise
    std::optional<BoxGrid> boxes;              // set when the cells are those of one grid along x, y and z
    std::vector<PieceRows> pieces;             // of a hierarchy of grids, one behind the other; `cells` has what is visible of them
    std::vector<Field> point_fields;           // each with #P rows
    std::vector<Field> cell_fields;            // each with one row per cell
    std::size_t skipped_cells = 0;             // cells that are no volumes: points, lines, surfaces
    std::size_t ghost_cells = 0;               // volume cells left out: hidden, or copies of another part's cells

    // Files of several blocks or time steps; empty for the others.
    std::vector<std::string> blocks;           // names of all volume blocks of the file, read or not
    std::size_t skipped_blocks = 0;            // blocks without volume cells
    std::vector<double> times;                 // of all time steps, ascending
    std::optional<double> time;                // the one that was read

    std::size_t cell_count() const { return grid ? grid->cells() : cells.size(); }
};

}  // namespace cellproj
