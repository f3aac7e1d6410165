// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: boundary faces that lie on boundary faces of other cells, so that the space behind them is filled
// although no cell shares their vertices.
//
// Faces whose corners stand at the very same places are told by comparing coordinates. Everything else is a question of
// closeness, not of sign, as planes that meet on paper miss each other by rounding in a file. Two faces lie on each other
// when their overlap is no farther from either than the smaller `contact_tolerance` of the two, is wider than that, and
// both cells rise higher than that from it.
#pragma once

#include <span>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct FaceContacts {
    std::vector<CellId> seams;      // pairs of faces alike, cells on both sides: the lower cell of each
    std::vector<CellId> doubled;    // faces on faces whose cells lie on the same side and overlap: the lower cell
    std::vector<VertexId> hanging;  // points inside a face or an edge of a face that lies on one of theirs
    std::vector<CellId> crossing;   // the cell of each face that faces with the same corners cut differently
};                                  // each ascending

// The rounding that the largest coordinate carries [mesh units]: float32's half unit when all coordinates are float32 values,
// as most files have them, else float64's.
double coordinate_rounding(std::span<const glm::dvec3> points);

// How far apart faces with the longest edge `edge` may be and still lie on each other: a millionth of it and four roundings
// of the coordinates (two planes, each off by up to two at corners as far out as the face is long), at most a hundredth.
double contact_tolerance(double edge, double rounding);

// `faces`: the boundary faces of `mesh`. places: #P, the lowest id of the points at the place of each point. Quadrangles
// that are not planar and cut along different diagonals are found while the diagonals pass within a quarter of their length.
// Faces smaller than 1e-70 or larger than 1e70 are passed over. O(n log n) in the number of faces, on all cores.
FaceContacts find_face_contacts(const TetMesh& mesh, std::span<const BoundaryFace> faces, std::span<const VertexId> places);

}  // namespace cellproj
