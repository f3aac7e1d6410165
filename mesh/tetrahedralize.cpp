// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tetrahedralize.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

#include "mesh/cell_faces.hpp"
#include "mesh/cell_split.hpp"
#include "mesh/error.hpp"
#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

using Tet = std::array<VertexId, 4>;

void require_addressable(std::size_t count, const char* what, const std::string& place) {
    if (count <= max_elements) return;
    throw Error({.kind = ErrorKind::data,
                 .place = place,
                 .expected = "at most " + std::to_string(max_elements) + " " + what + " (ids have 32 bits)",
                 .found = std::to_string(count),
                 .advice = "cut the data into parts"});
}

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

// ---- Cells of unstructured grids ----

std::span<const VertexId> list_of(const CellList& cells, std::size_t cell) {
    return std::span(cells.vertices).subspan(cells.offsets[cell], cells.offsets[cell + 1] - cells.offsets[cell]);
}

[[noreturn]] void throw_bad_cell(const Dataset& dataset, std::size_t cell, std::string expected, std::string found) {
    throw Error({.kind = ErrorKind::data,
                 .place = dataset.source + ", cell " + std::to_string(cell),
                 .expected = std::move(expected),
                 .found = std::move(found),
                 .advice = "the data are damaged: write them again"});
}

// Whether a face stream ends where its counts say.
bool is_face_stream(std::span<const VertexId> stream) {
    if (stream.empty()) return false;
    std::size_t faces = 0;
    std::size_t at = 1;
    for (; at < stream.size() && stream[at] < stream.size() - at; at += 1 + stream[at])
        ++faces;
    return at == stream.size() && faces == stream[0];
}

// Throws Error (data) for a cell whose list does not fit its kind or that has a vertex that is none of the points or is
// not finite: the split follows them all.
void require_sound_cells(const Dataset& dataset) {
    const CellList& cells = dataset.cells;
    const auto is_sound = [&](VertexId v) {
        if (v >= dataset.points.size()) return false;
        const glm::dvec3& p = dataset.points[v];
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    const auto require_sound = [&](std::size_t c, std::span<const VertexId> vertices) {
        const auto bad = std::find_if_not(vertices.begin(), vertices.end(), is_sound);
        if (bad == vertices.end()) return;
        throw_bad_cell(dataset, c, "vertices among the " + std::to_string(dataset.points.size()) + " finite points",
                       "the vertex " + std::to_string(*bad));
    };
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const std::span<const VertexId> cell = list_of(cells, c);
        const bool fits =
            cells.kinds[c] == CellKind::polyhedron ? is_face_stream(cell) : cell.size() == vertex_count(cells.kinds[c]);
        if (!fits) throw_bad_cell(dataset, c, "a list that fits its kind", std::to_string(cell.size()) + " entries");
        if (cells.kinds[c] == CellKind::polyhedron) {
            for_each_face(cells.kinds[c], cell, [&](std::span<const VertexId> face) { require_sound(c, face); });
        } else {
            require_sound(c, cell);
        }
    }
}

// Appends to the point fields of `mesh` their weighted means over the centre's vertices.
void add_point(const CellCentre& centre, TetMesh& mesh) {
    mesh.points.push_back(centre.position);
    for (Field& field : mesh.point_fields) {
        const auto components = static_cast<std::size_t>(field.components);
        for (std::size_t k = 0; k < components; ++k) {
            double mean = 0.0;
            for (std::size_t n = 0; n < centre.vertices.size(); ++n)
                mean += centre.weights[n] * field.values[centre.vertices[n] * components + k];
            field.values.push_back(mean);
        }
    }
}

// Returns, per cell, the index of its first tetrahedron, and one more entry for the end.
std::vector<CellId> split_cells(const Dataset& dataset, TetMesh& mesh, TetrahedralizeReport& report) {
    const CellList& cells = dataset.cells;
    CellSplitter splitter(dataset.points);
    std::vector<CellId> first_tets;
    first_tets.reserve(cells.size() + 1);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        first_tets.push_back(static_cast<CellId>(mesh.tets.size()));
        const auto next_point = static_cast<VertexId>(mesh.points.size());
        if (const CellCentre* centre = splitter.split(cells.kinds[c], list_of(cells, c), next_point, mesh.tets)) {
            add_point(*centre, mesh);
            ++report.added_points;
            if (cells.kinds[c] != CellKind::polyhedron) ++report.centred_cells;
        }
        require_addressable(mesh.tets.size(), "tetrahedra", dataset.source);
        require_addressable(mesh.points.size(), "points, the centres of cells included,", dataset.source);
    }
    first_tets.push_back(static_cast<CellId>(mesh.tets.size()));
    return first_tets;
}

// What the split needs, to reserve it: exact without collapsed cells and centres in cells that are no polyhedra.
std::size_t expected_tets(const CellList& cells) {
    std::size_t tets = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const std::span<const VertexId> cell = list_of(cells, c);
        switch (cells.kinds[c]) {
            case CellKind::tetrahedron:
                tets += 1;
                break;
            case CellKind::pyramid:
                tets += 2;
                break;
            case CellKind::polyhedron:  // a count and, on each face, two vertices more than triangles
                tets += std::max(cell.size() - 1, 3 * std::size_t{cell[0]}) - 3 * std::size_t{cell[0]};
                break;
            default:
                tets += 3 * (cell.size() / 2 - 2);  // prisms
        }
    }
    return tets;
}

// ---- Around the splits ----

void require_rows(const Field& field, std::size_t rows, const char* what, const std::string& place) {
    const std::size_t values = rows * static_cast<std::size_t>(std::max(field.components, 0));
    if (field.components >= 1 && field.values.size() == values) return;
    throw Error({.kind = ErrorKind::data,
                 .place = place + ", field \"" + field.name + "\"",
                 .expected = std::to_string(values) + " values (" + std::to_string(rows) + " " + what + " by " +
                             std::to_string(field.components) + " components)",
                 .found = std::to_string(field.values.size()),
                 .advice = "give every element one row"});
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

// Makes the tetrahedra of one cell, [begin, end), positive, and counts those that had to be turned and those that
// contradict the cell's volume. Flat ones turn with their cell, so that the faces between the cell's tetrahedra stay
// between them.
void orient_cell(TetMesh& mesh, std::size_t begin, std::size_t end, TetrahedralizeReport& report) {
    double volume = 0.0;
    for (std::size_t i = begin; i < end; ++i)
        volume += signed_volume(mesh, static_cast<CellId>(i));
    const int cell_sign = volume < 0.0 ? -1 : 1;
    for (std::size_t i = begin; i < end; ++i) {
        Tet& t = mesh.tets[i];
        const int sign = orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]);
        if (sign == 0) ++report.flat;
        if (sign < 0) ++report.flipped;
        if (sign == -cell_sign) ++report.inverted;
        if (sign < 0 || (sign == 0 && cell_sign < 0)) std::swap(t[2], t[3]);
    }
}

}  // namespace

TetMesh tetrahedralize(const Dataset& dataset, TetrahedralizeReport* report) {
    assert(!dataset.grid || dataset.points.size() == dataset.grid->ni * dataset.grid->nj * dataset.grid->nk);
    assert(dataset.grid || dataset.cells.offsets.size() == dataset.cells.size() + 1);
    require_sound_cells(dataset);
    const std::size_t cells = dataset.cell_count();
    const std::size_t tets = dataset.grid ? tets_per_grid_cell * cells : expected_tets(dataset.cells);
    require_addressable(dataset.points.size(), "points", dataset.source);
    require_addressable(tets, "tetrahedra", dataset.source);
    for (const Field& field : dataset.point_fields)
        require_rows(field, dataset.points.size(), "points", dataset.source);
    for (const Field& field : dataset.cell_fields)
        require_rows(field, cells, "cells", dataset.source);

    TetMesh mesh{dataset.points, {}, dataset.point_fields, {}};
    mesh.tets.reserve(tets);
    TetrahedralizeReport counts;
    std::vector<CellId> first_tets;
    if (dataset.grid) {
        split_grid(*dataset.grid, mesh.tets);
    } else {
        first_tets = split_cells(dataset, mesh, counts);
    }
    const auto first_tet = [&](std::size_t c) -> std::size_t {
        return dataset.grid ? tets_per_grid_cell * c : first_tets[c];
    };
    for (const Field& field : dataset.cell_fields) {
        mesh.cell_fields.push_back(repeat_rows(field, cells, mesh.tets.size(),
                                               [&](std::size_t c) { return first_tet(c + 1) - first_tet(c); }));
    }

    validate(mesh, dataset.source);  // all points finite, before the signs are asked for
    for (std::size_t c = 0; c < cells; ++c)
        orient_cell(mesh, first_tet(c), first_tet(c + 1), counts);
    counts.tets = mesh.tets.size();
    if (report) *report = counts;
    return mesh;
}

}  // namespace cellproj
