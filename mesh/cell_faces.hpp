// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: the faces of every kind of cell.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh/dataset.hpp"

namespace cellproj {

// Vertices of a cell; 0 for polyhedra, which may have any number.
constexpr std::size_t vertex_count(CellKind kind) {
    switch (kind) {
        case CellKind::tetrahedron:
            return 4;
        case CellKind::pyramid:
            return 5;
        case CellKind::wedge:
            return 6;
        case CellKind::hexahedron:
            return 8;
        case CellKind::pentagonal_prism:
            return 10;
        case CellKind::hexagonal_prism:
            return 12;
        case CellKind::polyhedron:
            break;
    }
    return 0;
}

struct CellFace {
    std::size_t size;
    std::array<std::uint8_t, 6> corners;
};

namespace face_tables {

inline constexpr std::array<CellFace, 4> tetrahedron{{{3, {1, 2, 3}}, {3, {0, 3, 2}}, {3, {0, 1, 3}}, {3, {0, 2, 1}}}};
inline constexpr std::array<CellFace, 5> pyramid{
    {{4, {0, 3, 2, 1}}, {3, {0, 1, 4}}, {3, {1, 2, 4}}, {3, {2, 3, 4}}, {3, {3, 0, 4}}}};
inline constexpr std::array<CellFace, 5> wedge{
    {{3, {0, 2, 1}}, {3, {3, 4, 5}}, {4, {0, 1, 4, 3}}, {4, {1, 2, 5, 4}}, {4, {2, 0, 3, 5}}}};
inline constexpr std::array<CellFace, 6> hexahedron{
    {{4, {0, 3, 2, 1}}, {4, {4, 5, 6, 7}}, {4, {0, 1, 5, 4}}, {4, {1, 2, 6, 5}}, {4, {2, 3, 7, 6}}, {4, {3, 0, 4, 7}}}};
inline constexpr std::array<CellFace, 7> pentagonal_prism{{{5, {0, 4, 3, 2, 1}},
                                                           {5, {5, 6, 7, 8, 9}},
                                                           {4, {0, 1, 6, 5}},
                                                           {4, {1, 2, 7, 6}},
                                                           {4, {2, 3, 8, 7}},
                                                           {4, {3, 4, 9, 8}},
                                                           {4, {4, 0, 5, 9}}}};
inline constexpr std::array<CellFace, 8> hexagonal_prism{{{6, {0, 5, 4, 3, 2, 1}},
                                                          {6, {6, 7, 8, 9, 10, 11}},
                                                          {4, {0, 1, 7, 6}},
                                                          {4, {1, 2, 8, 7}},
                                                          {4, {2, 3, 9, 8}},
                                                          {4, {3, 4, 10, 9}},
                                                          {4, {4, 5, 11, 10}},
                                                          {4, {5, 0, 6, 11}}}};

}  // namespace face_tables

// All faces of a kind turn the same way: counter-clockwise from outside, or all clockwise where a cell is stored inside
// out. None for polyhedra, whose faces stand in their stream.
constexpr std::span<const CellFace> faces_of(CellKind kind) {
    switch (kind) {
        case CellKind::tetrahedron:
            return face_tables::tetrahedron;
        case CellKind::pyramid:
            return face_tables::pyramid;
        case CellKind::wedge:
            return face_tables::wedge;
        case CellKind::hexahedron:
            return face_tables::hexahedron;
        case CellKind::pentagonal_prism:
            return face_tables::pentagonal_prism;
        case CellKind::hexagonal_prism:
            return face_tables::hexagonal_prism;
        case CellKind::polyhedron:
            break;
    }
    return {};
}

// Calls visit(std::span<const VertexId>) for each face of a cell, given by its vertices or its face stream, which must
// be sound. The span lives as long as the call.
template <class Visit>
void for_each_face(CellKind kind, std::span<const VertexId> cell, Visit visit) {
    if (kind == CellKind::polyhedron) {
        for (std::size_t at = 1; at < cell.size(); at += 1 + cell[at]) {
            assert(cell[at] <= cell.size() - at - 1);
            visit(cell.subspan(at + 1, cell[at]));
        }
        return;
    }
    assert(cell.size() == vertex_count(kind));
    std::array<VertexId, 6> vertices{};
    for (const CellFace& face : faces_of(kind)) {
        for (std::size_t n = 0; n < face.size; ++n)
            vertices[n] = cell[face.corners[n]];
        visit(std::span<const VertexId>(vertices).first(face.size));
    }
}

}  // namespace cellproj
