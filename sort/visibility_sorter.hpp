// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells for an eye, by MPVO: meshed polyhedra visibility ordering (Williams, "Visibility Ordering Meshed
// Polyhedra", ACM TOG 11(2), 1992), the sorter behind RKE00 §2. Two cells that share a face cannot both hide each other: the
// one on the eye's side of the face is in front. These relations form a graph; any topological order of it is an order.
//
// Contract. The order lists every cell once, farthest first. Among the cells that are free to come next, the one with the
// farthest centroid is taken. What that is worth:
// - convex, acyclic mesh: every relation between face neighbours is respected, and the picture is exact;
// - non-convex mesh (holes, concave boundary, several pieces): the relations are respected, too, but cells that see each
//   other across the outside have none; between them the farthest-first rule is right almost everywhere, not proven;
// - visibility cycles: when no cell is free, the farthest of those left is taken all the same and counted in
//   `OrderReport::unordered`. 0 means that all relations hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"
#include "sort/depth_queue.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// Keeps what does not depend on the eye: the adjacency. The mesh must outlive the sorter and stay unchanged.
// Memory: 28 bytes per cell. Time: linear (a bucket queue of 65,536 depths). Same order on every machine and for any
// number of threads.
class VisibilitySorter {
public:
    explicit VisibilitySorter(const TetMesh& mesh) : VisibilitySorter(mesh, build_adjacency(mesh)) {}
    VisibilitySorter(const TetMesh& mesh, Adjacency adjacency);

    // Cells from back to front. The spans stay valid until the next call or the end of the sorter. `method`: nothing for one that
    // is exact for this mesh. `pixels`: what sxmpvo needs. `visible` (#T or empty): cells with 0 are not drawn; they may be left out.
    ViewOrder order(const Eye& eye, OrderReport* report = nullptr, std::optional<OrderMethod> method = {},
                    const PixelGrid* pixels = nullptr, std::span<const std::uint8_t> visible = {});

    const Adjacency& adjacency() const { return adjacency_; }

private:
    void find_relations(const Eye& eye);
    void release(CellId cell);
    void drain();

    const TetMesh& mesh_;
    Adjacency adjacency_;
    std::vector<std::uint8_t> in_front_;  // #T: bit i is set when the neighbour across face i hides the cell
    std::vector<std::uint8_t> behind_;    // #T: neighbours that the cell hides and that are not yet in the order
    std::vector<std::uint16_t> depth_;    // #T: bucket of the centroid's distance, larger is farther
    DepthQueue free_;                     // cells whose hidden neighbours are all in the order
    std::vector<CellId> order_;
};

// One order for one eye.
std::vector<CellId> order_cells(const TetMesh& mesh, const Eye& eye, OrderReport* report = nullptr);

// How many pairs of face neighbours stand the wrong way round, by exact signs. Pairs with a cell that is split or left out do not
// count.
std::size_t count_order_violations(const TetMesh& mesh, const Adjacency& adjacency, const ViewOrder& order, const Eye& eye);

}  // namespace cellproj
