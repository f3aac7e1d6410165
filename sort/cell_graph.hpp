// SPDX-License-Identifier: BSD-3-Clause
//
// The cells of a mesh and who is beside whom, laid out for sorting: cells that are close in space are close in memory, and points are
// float32. From it come the relations of one view: which of two face neighbours hides the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// Cells have *places*, 0 .. #T−1: the caller's order where that is coherent, Morton order where it is not. Place #T is nobody's.
// The mesh must outlive the graph and stay unchanged. Memory: 17 bytes per cell and 16 per point that is used; 20 more per cell in Morton
// order, 16 more where points stand in no order.
class CellGraph {
public:
    // The adjacency must be of this mesh.
    CellGraph(const TetMesh& mesh, const Adjacency& adjacency);

    // What one view makes of the cell at a place: bit i is set when the neighbour across face i hides the cell; times 16, how many
    // neighbours it hides.
    using Relations = std::uint8_t;
    static constexpr Relations one_hidden = 0x10, in_front = 0x0f;

    // The relations of all places, exact: they are those of the float64 mesh and eye. `relations` has #T + 1 elements; the last one
    // is set to 0. Runs on all cores.
    void find_relations(const Eye& eye, std::span<Relations> relations) const;
    // Those of some places, on this core, and for each how far the eye, as `scaled` gives it, may move in any direction before one of
    // them can change: ≥ 0, never too much. Both results are as long as `places`.
    void find_relations(const Eye& eye, std::span<const CellId> places, std::span<Relations> relations, std::span<float> reach) const;

    const TetMesh& mesh() const { return mesh_; }
    std::size_t size() const { return neighbours_.size(); }
    CellId nobody() const { return static_cast<CellId>(size()); }
    CellId cell(CellId place) const { return keeps_order_ ? place : cells_[place]; }  // as the caller numbers it
    const std::vector<CellId>& cells() const { return cells_; }          // by place; empty where the order is kept
    bool keeps_order() const { return keeps_order_; }                    // of the caller: places are his numbers
    const std::array<CellId, 4>& neighbours(CellId place) const { return neighbours_[place]; }  // places; nobody() where there is none
    const std::vector<std::array<CellId, 4>>& neighbours() const { return neighbours_; }
    bool on_boundary(CellId place) const { return (faces_[place] >> 4) != 0x0f; }
    // Faces whose two cells lie on the same side: the mesh overlaps itself there, and they tell no order.
    std::size_t folded_faces() const { return folded_faces_; }
    std::size_t flat_cells() const { return flat_.size(); }
    bool is_flat(CellId place) const;  // without volume

    // An eye, or the direction to it, in the graph's own coordinates, in which points lie within ±1. A direction's largest coordinate is 1.
    glm::dvec3 scaled(const Eye& eye) const;
    // The centroids of the cells at first, first + 1, … in these coordinates; the last component is 0.
    void find_centroids(CellId first, std::span<glm::vec4> centroids) const;

    // Relations and centroids are found from points in float32. Without them the graph takes 16 bytes per point less, and as many per
    // cell where corners are not the mesh's own. Nothing that needs them may be asked for in between.
    void release_points();
    void find_points();

    // Where the eye lies with respect to face i: +1 on the neighbour's side, −1 on the cell's, 0 in its plane. Exact.
    int beyond(const Eye& eye, CellId place, int face) const;

private:
    struct View;

    void number_cells(const Adjacency& adjacency);
    // #T by 4, into points_.
    const std::array<std::uint32_t, 4>* corners() const { return own_corners_.empty() ? mesh_.tets.data() : own_corners_.data(); }
    void find_sides();
    Relations relations_at(const View& view, std::size_t place, unsigned positive, unsigned negative) const;
    View view_from(const Eye& eye) const;
    template <class PlaceOf, class Take>
    void relate(const View& view, std::size_t count, PlaceOf place_of, Take take) const;

    const TetMesh& mesh_;
    glm::dvec3 center_{0.0};
    double scale_ = 1.0;  // a power of two; points are (p − center)·scale, within ±1
    bool keeps_order_ = false;
    std::vector<CellId> cells_;                      // #T: the cell at a place; empty where the order is kept
    std::vector<std::array<CellId, 4>> neighbours_;  // #T by 4: places
    std::vector<std::array<std::uint32_t, 4>> own_corners_;  // #T by 4, into points_; empty where they are those of the mesh
    std::vector<glm::vec4> points_;                  // xyz: float32; the mesh's, or those that are used, by first use
    // #T: bits 0–3: the cell lies on the outer side of its face i (it is inverted, or flat and its neighbour says so); bits 4–7: there
    // is a neighbour.
    std::vector<std::uint8_t> faces_;
    std::size_t folded_faces_ = 0;
    std::vector<CellId> flat_;  // places, ascending
};

}  // namespace cellproj
