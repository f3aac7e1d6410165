// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: one cell to tetrahedra, so that its neighbours' splits fit.
//
// The surface comes first, triangles that both cells of a face agree on (face_triangles.hpp). Then the triangles are
// joined to one point that is the cell's own affair: its lowest vertex (the pulling split of Dompierre et al.) or a new
// point.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/dataset.hpp"
#include "mesh/face_triangles.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// A new point: the weighted mean of a cell's vertices. The weights sum to 1; any may be negative where parts of a cell
// are.
struct CellCentre {
    glm::dvec3 position;
    std::vector<VertexId> vertices;  // each once
    std::vector<double> weights;
};

// Keeps its working memory from cell to cell.
class CellSplitter {
public:
    // `points` must outlive the splitter; every vertex id of the cells must be one of theirs.
    explicit CellSplitter(std::span<const glm::dvec3> points) : points_(points) {}

    // Appends the tetrahedra of a cell (vertices or face stream, as in CellList) to `tets`. Returns its centre when it
    // got one, which the tetrahedra call `centre_id` (above all ids of points); valid until the next call. Polyhedra
    // always get a centre, other kinds where the pulling split has flat tetrahedra or both signs and a centre does
    // better. Tetrahedra with a repeated vertex, as in collapsed cells, are not made. All tetrahedra of a cell have one
    // sign (or 0) unless no point in the cell sees all of its faces from inside.
    const CellCentre* split(CellKind kind, std::span<const VertexId> cell, VertexId centre_id,
                            std::vector<std::array<VertexId, 4>>& tets);

private:
    // Of the tetrahedra between an apex and the surface; contradictions weigh more. Flat ones fill nothing, and their
    // faces can meet those of flat ones in other cells along a common edge.
    struct Flaws {
        std::size_t contradictions = 0;  // have the rarer one of the two signs
        std::size_t flat = 0;

        auto operator<=>(const Flaws&) const = default;
    };

    void triangulate_surface(CellKind kind, std::span<const VertexId> cell);
    void cancel_coincident_triangles();
    void turn_alike();
    Flaws flaws(const glm::dvec3& apex, VertexId apex_id) const;
    void join(VertexId apex_id, std::vector<std::array<VertexId, 4>>& tets) const;
    Flaws place_centre(CellKind kind, VertexId centre_id);
    void collect_vertices();
    glm::dvec3 mean_of_vertices() const;
    glm::dvec3 centroid(const glm::dvec3& start) const;
    glm::dvec3 relaxed(const glm::dvec3& start) const;
    void weigh_vertices(const glm::dvec3& mean);
    glm::dvec3 normal_of(const Triangle& t) const;
    double volume_below(const Triangle& t, const glm::dvec3& apex) const;

    std::span<const glm::dvec3> points_;
    std::vector<Triangle> surface_;
    CellCentre centre_;
};

}  // namespace cellproj
