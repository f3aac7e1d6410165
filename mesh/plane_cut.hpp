// SPDX-License-Identifier: BSD-3-Clause
//
// The field of a mesh on a plane: triangles with the scalars of their corners. A field on points is linear in a cell, so linear on each
// triangle; one on cells is constant on it.
//
// A cell is cut where some of its points lie strictly above the plane (on the side that its normal points to) and others do not: a face in the
// plane belongs to the cell above it, so that every point of the plane is covered once, whatever the plane goes through. The side of a point
// is decided once, and the point on an edge found from its ends in the order of their numbers: neighbouring triangles have the same bits at
// their common corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct CutTriangle {
    std::array<glm::dvec3, 3> corners;  // [mesh units]
    std::array<double, 3> scalars;      // finite, one for each corner
};

// Which faces that lie in the plane are seen when no cell is above them: none, or those of the cells below.
enum class PlaneCutSides { above, both };

// The signed distance of a point from the plane through `point` with the unit normal, 0 where it is within the rounding of all numbers that it
// is made of: planes that are meant to pass through points of a mesh do so.
double distance_to_plane(const glm::dvec3& p, const glm::dvec3& point, const glm::dvec3& unit_normal);

// In the order of the cells; with `both`, faces of cells below come behind. Cells that touch a value of the field, or of `other` (null: none),
// that is not finite are left out. A plane beside the mesh: nothing. O(#P + #T), parallel, the same for any number of threads.
std::vector<CutTriangle> cut_by_plane(const TetMesh& mesh, const ScalarField& field, const ScalarField* other, const glm::dvec3& point,
                                      const glm::dvec3& unit_normal, PlaneCutSides sides);

}  // namespace cellproj
