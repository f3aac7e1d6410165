// SPDX-License-Identifier: BSD-3-Clause
//
// The mesh that is rendered: tetrahedra over float64 points, with named fields on points and on cells.
//
// Conventions, valid everywhere in cellproj:
// - A cell lists its four vertices so that its signed volume det(b−a, c−a, d−a)/6 is ≥ 0 (predicates.hpp); flat cells
//   keep the order they came in.
// - Face i of a cell is the one opposite to vertex i. `face_vertices` lists its three vertices counter-clockwise as seen
//   from outside the cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace cellproj {

using VertexId = std::uint32_t;
using CellId = std::uint32_t;
inline constexpr CellId no_cell = 0xffffffffU;           // the neighbour behind a boundary face
inline constexpr std::size_t max_elements = 0xfffffffeU;  // points or cells in one mesh

// A named quantity on points or on cells: `values` is #elements by `components`, row-major.
struct Field {
    std::string name;
    int components = 1;
    std::vector<double> values;
};

struct Bounds {
    glm::dvec3 low;
    glm::dvec3 high;

    glm::dvec3 center() const { return 0.5 * low + 0.5 * high; }
    double diagonal() const;  // length of the space diagonal [mesh units]
};

struct TetMesh {
    std::vector<glm::dvec3> points;               // #P [mesh units]
    std::vector<std::array<VertexId, 4>> tets;    // #T by 4, 0-based into points
    std::vector<Field> point_fields;              // each with #P rows
    std::vector<Field> cell_fields;               // each with #T rows
};

// The local vertices of face i, counter-clockwise from outside a positively oriented cell.
inline constexpr std::array<std::array<int, 3>, 4> face_corners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

inline std::array<VertexId, 3> face_vertices(const std::array<VertexId, 4>& tet, int face) {
    const auto& f = face_corners[static_cast<std::size_t>(face)];
    return {tet[f[0]], tet[f[1]], tet[f[2]]};
}

// Box around the points; low > high when there are none.
Bounds bounds(const std::vector<glm::dvec3>& points);

// det(b−a, c−a, d−a)/6 in float64 [mesh units³]. Its sign is not decisive: use `orientation` for that.
double signed_volume(const TetMesh& mesh, CellId cell);

struct OrientationCounts {
    std::size_t flipped = 0;  // cells that were stored with negative volume
    std::size_t flat = 0;     // cells of exactly zero volume
};

// Makes every cell positively oriented (exact signs) by exchanging its last two vertices where needed.
OrientationCounts orient_cells(TetMesh& mesh);

// Throws Error (data), naming `place`, when the mesh cannot be used: no cells, more than `max_elements`, a vertex id out of
// range, a point that is not finite, or a field whose length does not fit. Cheapest checks first; the first offender is told.
void validate(const TetMesh& mesh, const std::string& place);

// neighbours[c][i]: the cell on the other side of face i of cell c, or `no_cell`. A face shared by three or more cells
// (a non-manifold mesh) pairs the first two in cell order; `overused_faces` counts the sides left over. A cell is never its
// own neighbour.
struct Adjacency {
    std::vector<std::array<CellId, 4>> neighbours;  // #T by 4
    std::size_t overused_faces = 0;
};

// Linear in the number of cells; 16 bytes per cell kept, and while building 8 more per cell and 8 per point. Runs on all cores.
Adjacency build_adjacency(const TetMesh& mesh);

struct BoundaryFace {
    CellId cell;
    int face;  // 0..3
};

// The faces without a neighbour, in cell order.
std::vector<BoundaryFace> boundary_faces(const Adjacency& adjacency);

}  // namespace cellproj
