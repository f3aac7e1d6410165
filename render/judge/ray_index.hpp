// SPDX-License-Identifier: BSD-3-Clause
//
// Which cells a ray crosses, and where: a tree of boxes over the cells, each candidate tested by itself. Knows neither
// neighbours nor an order of cells, so that it can judge those who do.
//
// Each vertex is seen in the frame of the ray: u, v across it and t along it, by one formula. From there on all decisions are
// exact for these rounded positions: the sign of a difference of two products, by Kahan's method (Jeannerod, Louvet, Muller,
// *Further Analysis of Kahan's Algorithm for the Accurate Computation of 2×2 Determinants*, Math. Comp. 82, 2013), is right. A
// ray through a vertex, an edge or along a face is decided as if it were moved by (ε, ε²) in (u, v), with no ε in any result
// (Edelsbrunner and Mücke, *Simulation of Simplicity*, ACM TOG 9(1), 1990). So a ray crosses two faces of a cell or none, and
// the cells of a conformal mesh follow each other on it without gap or overlap: t on a shared face is the same number for both
// its cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"
#include "project/camera.hpp"

namespace cellproj {

// A ray in coordinates relative to RayIndex::middle(), which keeps the digits of a small mesh far from the origin.
struct ViewRay {
    glm::dvec3 origin;     // [mesh units]; best near the mesh: t is as exact as |p − origin|
    glm::dvec3 direction;  // unit length
    double start;          // the ray is origin + t·direction, t ≥ start; −infinity in parallel views
};

// The part of a ray inside one cell.
struct Crossing {
    CellId cell;
    double enter, leave;                       // t, enter < leave [mesh units]
    std::array<double, 4> at_enter, at_leave;  // weights of the cell's four vertices, 0..1, with sum 1

    double length() const { return leave - enter; }
};

// Memory: 44 to 68 bytes per cell and 24 per point, 16 more per cell while it is built. The mesh is not kept. Any number of
// threads may ask at once.
class RayIndex {
public:
    // Parallel; the same for any number of threads. Throws Error (data) for a mesh that `validate` refuses.
    explicit RayIndex(const TetMesh& mesh);

    const glm::dvec3& middle() const { return middle_; }  // of the mesh's box [mesh units]

    // The ray through a position on the screen (pixels), its origin moved along itself to where it is nearest to the middle.
    ViewRay ray(const Camera& camera, ImageSize size, const glm::dvec2& screen) const;
    // The same for a ray in mesh coordinates, from its origin on or as a whole line.
    ViewRay ray(const ScreenTransform::Ray& ray, bool from_origin) const;

    // All cells along the ray, ordered by their middles on it, then by cell. Cells that it crosses with no length (flat ones)
    // are left out; a cell that holds the start begins there. Without overlaps this is the order from front to back. Rounding
    // of the vertices in the frame and of t, about 1e-16 of the mesh's size, may make neighbours overlap by as much where
    // cells are thinner than that or the ray runs along their edges: do not judge an order by crossings as short as that.
    std::vector<Crossing> cells_along(const ViewRay& ray) const;
    // Whether there is any, at a fraction of the cost.
    bool meets(const ViewRay& ray) const;

private:
    struct Box {
        glm::dvec3 low, high;
    };
    struct Cell {
        std::array<VertexId, 4> vertices;  // as in the mesh
        CellId id;
    };
    struct Frame;

    ViewRay slide(const ScreenTransform::Ray& relative, bool from_origin) const;
    template <class Visit>
    void visit_candidates(const ViewRay& ray, Visit visit) const;
    bool cross(const Frame& frame, const Cell& cell, Crossing& crossing) const;

    // Node k (0-based) of level l holds the cells n·k/2ˡ ≤ i < n·(k+1)/2ˡ and has the box 2ˡ − 1 + k.
    std::size_t first_cell(int level, std::size_t k) const { return (cells_.size() * k) >> level; }

    glm::dvec3 middle_;
    std::vector<glm::dvec3> points_;  // relative to the middle
    std::vector<Cell> cells_;         // in the order of the leaves
    int levels_ = 0;                  // the leaves' level
    std::vector<Box> boxes_;
};

}  // namespace cellproj
