// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tetrahedralize.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

using Tet = std::array<VertexId, 4>;

// ---- Curvilinear grids: the alternating split ----

// A hexahedron's corners in VTK's order are (000, 100, 110, 010, 001, 101, 111, 011) as ijk. A cell whose i + j + k is
// even is cut along the face diagonals between 1, 3, 4 and 6, an odd one along those between 0, 2, 5 and 7; stepping
// over a face maps one set of diagonals onto the other. (The other way round would be as good for most grids; this way,
// none of the tetrahedra of NASA's combustor is inverted.) First the inner tetrahedron, then the four cut-off corners.
constexpr std::array<std::array<std::array<int, 4>, 5>, 2> alternating_split{{
    {{{1, 3, 4, 6}, {0, 1, 3, 4}, {2, 3, 1, 6}, {5, 4, 6, 1}, {7, 6, 4, 3}}},
    {{{0, 2, 7, 5}, {1, 2, 0, 5}, {3, 0, 2, 7}, {4, 7, 5, 0}, {6, 5, 7, 2}}},
}};
constexpr std::size_t tets_per_grid_cell = alternating_split[0].size();

void split_grid(const GridDimensions& grid, std::vector<Tet>& tets) {
    const auto id = [&](std::size_t i, std::size_t j, std::size_t k) {
        return static_cast<VertexId>(i + grid.ni * (j + grid.nj * k));
    };
    for (std::size_t k = 0; k + 1 < grid.nk; ++k) {
        for (std::size_t j = 0; j + 1 < grid.nj; ++j) {
            for (std::size_t i = 0; i + 1 < grid.ni; ++i) {
                const std::array<VertexId, 8> cell{
                    id(i, j, k),     id(i + 1, j, k),     id(i + 1, j + 1, k),     id(i, j + 1, k),
                    id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)};
                for (const auto& t : alternating_split[(i + j + k) % 2]) {
                    tets.push_back({cell[t[0]], cell[t[1]], cell[t[2]], cell[t[3]]});
                }
            }
        }
    }
}

// ---- Cells of unstructured grids: the pulling split ----

// The corners of a face, counter-clockwise as seen from outside the cell.
struct CellFace {
    std::size_t size;
    std::array<std::size_t, 4> corners;
};

constexpr std::array<CellFace, 6> hexahedron_faces{
    {{4, {0, 3, 2, 1}}, {4, {4, 5, 6, 7}}, {4, {0, 1, 5, 4}}, {4, {1, 2, 6, 5}}, {4, {2, 3, 7, 6}}, {4, {3, 0, 4, 7}}}};

bool has_repeated_vertex(const Tet& t) {
    return t[0] == t[1] || t[0] == t[2] || t[0] == t[3] || t[1] == t[2] || t[1] == t[3] || t[2] == t[3];
}

// Joins the lowest vertex of the cell with the triangles of the faces that do not touch it, each face a fan around its
// own lowest vertex. Where a cell lists a vertex twice, faces have collapsed; the tetrahedra that would repeat it are
// not made.
void pull(std::span<const VertexId> cell, std::span<const CellFace> faces, std::vector<Tet>& tets) {
    const VertexId apex = *std::min_element(cell.begin(), cell.end());
    for (const CellFace& face : faces) {
        const auto vertex = [&](std::size_t n) { return cell[face.corners[n % face.size]]; };
        std::size_t lowest = 0;
        bool touches_apex = false;
        for (std::size_t n = 0; n < face.size; ++n) {
            touches_apex = touches_apex || vertex(n) == apex;
            if (vertex(n) < vertex(lowest)) lowest = n;
        }
        if (touches_apex) continue;
        for (std::size_t n = 1; n + 1 < face.size; ++n) {
            const Tet tet{apex, vertex(lowest), vertex(lowest + n), vertex(lowest + n + 1)};
            if (!has_repeated_vertex(tet)) tets.push_back(tet);
        }
    }
}

void split_cell(CellKind kind, std::span<const VertexId> cell, std::vector<Tet>& tets) {
    switch (kind) {
        case CellKind::tetrahedron:
            assert(cell.size() == 4);
            tets.push_back({cell[0], cell[1], cell[2], cell[3]});
            break;
        case CellKind::hexahedron:
            assert(cell.size() == 8);
            pull(cell, hexahedron_faces, tets);
            break;
    }
}

// `first_tets` gets, per cell, the index of its first tetrahedron, and one more entry for the end.
void split_cells(const CellList& cells, std::vector<Tet>& tets, std::vector<CellId>& first_tets) {
    assert(cells.offsets.size() == cells.size() + 1);
    const std::span<const VertexId> vertices(cells.vertices);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        first_tets.push_back(static_cast<CellId>(tets.size()));
        split_cell(cells.kinds[c], vertices.subspan(cells.offsets[c], cells.offsets[c + 1] - cells.offsets[c]), tets);
    }
    first_tets.push_back(static_cast<CellId>(tets.size()));
}

// ---- Around the splits ----

// Exact for cells without repeated vertices, an upper bound otherwise.
std::size_t tet_count(const Dataset& dataset) {
    if (dataset.grid) return tets_per_grid_cell * dataset.grid->cells();
    const auto& kinds = dataset.cells.kinds;
    const auto hexahedra = static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), CellKind::hexahedron));
    return kinds.size() + 5 * hexahedra;
}

void require_addressable(std::size_t count, const char* what, const std::string& place) {
    if (count <= max_elements) return;
    throw Error({.kind = ErrorKind::data,
                 .place = place,
                 .expected = "at most " + std::to_string(max_elements) + " " + what + " (ids have 32 bits)",
                 .found = std::to_string(count),
                 .advice = "cut the data into parts"});
}

void require_rows(const Field& field, std::size_t rows, const std::string& place) {
    const std::size_t values = rows * static_cast<std::size_t>(field.components);
    if (field.components >= 1 && field.values.size() == values) return;
    throw Error({.kind = ErrorKind::data,
                 .place = place + ", cell field \"" + field.name + "\"",
                 .expected = std::to_string(values) + " values (" + std::to_string(rows) + " cells by " +
                             std::to_string(field.components) + " components)",
                 .found = std::to_string(field.values.size()),
                 .advice = "give every cell one row"});
}

// The rows of a field on cells, repeated on each cell's tetrahedra, `tets` in all. `tets_of(c)`: how many cell c has.
template <class TetsOf>
Field repeat_rows(const Field& field, std::size_t cells, std::size_t tets, TetsOf tets_of) {
    Field result{field.name, field.components, {}};
    const auto components = static_cast<std::size_t>(field.components);
    result.values.reserve(tets * components);
    for (std::size_t c = 0; c < cells; ++c) {
        const auto row = field.values.begin() + static_cast<std::ptrdiff_t>(c * components);
        for (std::size_t n = 0; n < tets_of(c); ++n) {
            result.values.insert(result.values.end(), row, row + field.components);
        }
    }
    return result;
}

}  // namespace

TetMesh tetrahedralize(const Dataset& dataset, TetrahedralizeReport* report) {
    assert(!dataset.grid || dataset.points.size() == dataset.grid->ni * dataset.grid->nj * dataset.grid->nk);
    const std::size_t cells = dataset.cell_count();
    const std::size_t tets = tet_count(dataset);
    require_addressable(dataset.points.size(), "points", dataset.source);
    require_addressable(tets, "tetrahedra", dataset.source);
    for (const Field& field : dataset.cell_fields)
        require_rows(field, cells, dataset.source);

    TetMesh mesh{dataset.points, {}, dataset.point_fields, {}};
    mesh.tets.reserve(tets);
    std::vector<CellId> first_tets;
    if (dataset.grid) {
        split_grid(*dataset.grid, mesh.tets);
    } else {
        first_tets.reserve(cells + 1);
        split_cells(dataset.cells, mesh.tets, first_tets);
    }
    const auto tets_of = [&](std::size_t c) -> std::size_t {
        return dataset.grid ? tets_per_grid_cell : first_tets[c + 1] - first_tets[c];
    };
    for (const Field& field : dataset.cell_fields) {
        mesh.cell_fields.push_back(repeat_rows(field, cells, mesh.tets.size(), tets_of));
    }

    validate(mesh, dataset.source);  // ids in range, before orient_cells follows them
    const OrientationCounts counts = orient_cells(mesh);
    if (report) *report = {mesh.tets.size(), counts.flipped, counts.flat};
    return mesh;
}

}  // namespace cellproj
