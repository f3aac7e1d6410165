// SPDX-License-Identifier: BSD-3-Clause
//
// What is wrong with a mesh, and what that means for its picture. Signs are exact (predicates.hpp); nothing is repaired.
#pragma once

#include <array>
#include <cstddef>
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
};

struct NotFiniteField {
    std::string name;
    std::size_t values;
};

struct MeshCheck {
    Finding flat_cells;           // exactly zero volume
    Finding repeated_vertices;    // cells that name a vertex twice
    Finding overlapping_cells;    // both cells of a face lie on the same side of it; the lower id is told
    Finding isolated_points;      // in no cell
    Finding coincident_points;    // at the place of a point with a lower id
    double coincident_difference = 0.0;  // largest difference between values of one point field at coincident points
    std::size_t overused_faces = 0;      // sides beyond two at one face
    std::vector<NotFiniteField> not_finite;

    std::size_t components = 0;          // pieces of cells joined by faces
    std::size_t boundary_components = 0; // closed surfaces: each component has one, each cavity one more
    std::array<double, 3> volumes{};     // smallest, median, largest volume of a cell [mesh units³]
    bool convex = false;                 // one component, and every edge of its boundary is convex or flat
    bool delaunay = false;               // no vertex of a neighbour strictly inside the circumsphere of a cell

    // Whether the picture shows what the mesh says: no overlaps, no faces of three cells, every value finite.
    bool faithful() const;
};

// Linear but for sorting points by position. The mesh must be valid (`validate`) and oriented (`orient_cells`).
MeshCheck check(const TetMesh& mesh, const Adjacency& adjacency);

}  // namespace cellproj
