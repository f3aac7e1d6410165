// SPDX-License-Identifier: BSD-3-Clause
//
// What is wrong with a mesh, and what that means for its picture. Signs are exact (predicates.hpp); nothing is repaired.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// How often something was found, and the first places (at most 5): cell or point ids.
struct Finding {
    std::size_t count = 0;
    std::vector<std::size_t> first;

    void add(std::size_t where) {
        if (count++ < 5) first.push_back(where);
    }
    void add_all(const std::vector<std::uint32_t>& places) {
        for (const std::uint32_t where : places) add(where);
    }
};

struct NotFiniteField {
    std::string name;
    std::size_t values;
};

struct MeshCheck {
    Finding flat_cells;           // exactly zero volume
    Finding repeated_vertices;    // cells that name a vertex twice
    Finding overlapping_cells;    // lie on the same side of a face, or of faces that lie on each other, as another cell
    Finding overused_faces;       // sides beyond two at one face; their cells
    Finding isolated_points;      // in no cell
    Finding coincident_points;    // at the place of a point with a lower id
    double coincident_difference = 0.0;  // largest difference between values of one point field at coincident points
    std::string coincident_field;        // the field that has it; empty: no difference
    std::vector<NotFiniteField> not_finite;

    // Boundary faces that lie on faces of other cells, see face_contacts.hpp for what "on" means.
    Finding seam_faces;      // the same corners, but points of their own: pairs, told by the lower cell
    Finding hanging_points;  // inside such a face or its edge, where the other side has no point
    Finding crossing_faces;  // the same corners as the faces on the other side, cut along another diagonal; their cells

    std::size_t components = 0;          // pieces of cells joined by faces
    std::size_t boundary_components = 0; // closed surfaces: the outside of each component, its cavities
    std::size_t cavities = 0;            // closed surfaces that look inwards
    std::array<double, 3> volumes{};     // smallest, median, largest volume of a cell [mesh units³]
    std::array<double, 2> edges{};       // shortest, longest edge of a cell [mesh units]
    bool convex = false;                 // one component, and no edge of its boundary is dented by more than rounding
    bool delaunay = false;               // no vertex of a neighbour strictly inside the circumsphere of a cell

    bool conforming() const { return hanging_points.count == 0 && crossing_faces.count == 0; }

    // Whether the picture shows what the mesh says: space is filled once, values are finite and continuous where cells meet.
    // Seams are no obstacle: both sides are drawn as they are.
    bool faithful() const;
};

// O(n log n), as points and boundary faces are sorted. The mesh must be valid (`validate`) and oriented (`orient_cells`).
MeshCheck check(const TetMesh& mesh, const Adjacency& adjacency);

}  // namespace cellproj
