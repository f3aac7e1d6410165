// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells for an eye: one sorter per mesh, one call per view. sort/README.md says what each method is worth.
//
// Contract. Every visible cell comes once, farthest first. The report tells the method that was used and
// whether the order is proven for this mesh and eye:
// - mpvo (Williams, "Visibility Ordering Meshed Polyhedra", ACM TOG 11(2), 1992, the sorter behind RKE00 §2): of two cells with a common
//   face, the one on the eye's side is in front; any topological order of these relations is an order; cells in cycles are cut. Proven for
//   meshes that fill a convex body. In others, cells that see each other across the outside have no relation: the farthest centroid
//   of those that are free comes first, which is right almost everywhere.
// - centroid: by the distance of centroids, never proven.
// - bsp, sxmpvo: mpvo with the relations across the outside, for all rays or those of `pixels`; cells in cycles are cut. Proven for any mesh
//   whose cells do not overlap (sort/exact_orders.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// Keeps what does not depend on the eye. The mesh must outlive the sorter and stay unchanged. Time: linear. Same order on every machine
// and for any number of threads; one call at a time.
class VisibilitySorter {
public:
    explicit VisibilitySorter(const TetMesh& mesh) : VisibilitySorter(mesh, build_adjacency(mesh)) {}
    VisibilitySorter(const TetMesh& mesh, const Adjacency& adjacency);
    ~VisibilitySorter();
    VisibilitySorter(VisibilitySorter&&) noexcept;
    VisibilitySorter& operator=(VisibilitySorter&&) noexcept;

    // Cells from back to front. The spans stay valid until the next call or the end of the sorter. `method`: nothing for one that
    // is exact for this mesh. `pixels`: what sxmpvo needs; without it is bsp. `visible` (#T or empty): cells with 0 are left out.
    ViewOrder order(const Eye& eye, OrderReport* report = nullptr, std::optional<OrderMethod> method = {},
                    const PixelGrid* pixels = nullptr, std::span<const std::uint8_t> visible = {});

    // Whether the cells fill a convex body (sort/mesh_facts.hpp).
    bool convex() const;

    // How many pairs of face neighbours stand the wrong way round, by exact signs. Pairs with a cell that is split or left out do not
    // count.
    std::size_t count_violations(const ViewOrder& order, const Eye& eye) const;

private:
    struct State;  // sort/visibility_sorter.cpp: no user needs to know the layout
    std::unique_ptr<State> state_;
};

// One order of all cells for one eye, as wholes: a cell that had to be split comes where its farthest piece would, and is counted as
// unordered.
std::vector<CellId> order_cells(const TetMesh& mesh, const Eye& eye, OrderReport* report = nullptr);

}  // namespace cellproj
