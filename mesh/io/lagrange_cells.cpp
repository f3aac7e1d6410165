// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/lagrange_cells.hpp"

#include <vtkHigherOrderHexahedron.h>
#include <vtkHigherOrderTetra.h>
#include <vtkHigherOrderWedge.h>

#include <array>
#include <cassert>

#include "mesh/io/text_cells.hpp"

namespace cellproj {

namespace {

using Lattice = std::array<int, 3>;

std::size_t node_count(CellKind kind, std::size_t order) {
    const std::size_t n = order + 1;
    switch (kind) {
        case CellKind::tetrahedron:
            return n * (n + 1) * (n + 2) / 6;
        case CellKind::hexahedron:
            return n * n * n;
        case CellKind::wedge:
            return n * n * (n + 1) / 2;
        default:
            return 0;
    }
}

class Pieces {
public:
    Pieces(CellKind kind, int order, std::span<const VertexId> nodes, CellList& cells)
        : kind_(kind), order_(order), nodes_(nodes), cells_(cells) {}

    void append() {
        for (int k = 0; k < order_; ++k) {
            for (int j = 0; j < order_; ++j) {
                for (int i = 0; i < order_; ++i) {
                    if (kind_ == CellKind::hexahedron) append_hexahedron(i, j, k);
                    if (kind_ == CellKind::wedge && i + j < order_) append_wedges(i, j, k);
                    if (kind_ == CellKind::tetrahedron && i + j + k < order_) append_tets(i, j, k);
                }
            }
        }
    }

private:
    VertexId node(const Lattice& at) const {
        const auto [i, j, k] = at;
        const std::array<int, 4> order{order_, order_, order_, static_cast<int>(nodes_.size())};
        vtkIdType index = 0;
        if (kind_ == CellKind::hexahedron) {
            index = vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order.data());
        } else if (kind_ == CellKind::wedge) {
            index = vtkHigherOrderWedge::PointIndexFromIJK(i, j, k, order.data());
        } else {
            const std::array<vtkIdType, 4> barycentric{i, j, k, order_ - i - j - k};
            index = vtkHigherOrderTetra::Index(barycentric.data(), order_);
        }
        return nodes_[static_cast<std::size_t>(index)];
    }

    template <std::size_t Count>
    void piece(const std::array<Lattice, Count>& corners) {
        std::array<VertexId, Count> ids{};
        for (std::size_t n = 0; n < Count; ++n)
            ids[n] = node(corners[n]);
        append_cell(cells_, kind_, ids);
    }

    void append_hexahedron(int i, int j, int k) {
        piece<8>({{{i, j, k},
                   {i + 1, j, k},
                   {i + 1, j + 1, k},
                   {i, j + 1, k},
                   {i, j, k + 1},
                   {i + 1, j, k + 1},
                   {i + 1, j + 1, k + 1},
                   {i, j + 1, k + 1}}});
    }

    // The triangle from (i, j) on, and the one that points the other way.
    void append_wedges(int i, int j, int k) {
        piece<6>({{{i, j, k}, {i + 1, j, k}, {i, j + 1, k}, {i, j, k + 1}, {i + 1, j, k + 1}, {i, j + 1, k + 1}}});
        if (i + j + 1 >= order_) return;
        piece<6>({{{i + 1, j, k},
                   {i + 1, j + 1, k},
                   {i, j + 1, k},
                   {i + 1, j, k + 1},
                   {i + 1, j + 1, k + 1},
                   {i, j + 1, k + 1}}});
    }

    // The tetrahedron from (i, j, k) on; the octahedron beside it, cut along one diagonal into four; and the
    // tetrahedron that is left of the lattice's box, which points the other way.
    void append_tets(int i, int j, int k) {
        piece<4>({{{i, j, k}, {i + 1, j, k}, {i, j + 1, k}, {i, j, k + 1}}});
        const int room = order_ - i - j - k;
        if (room >= 2) {
            const Lattice low{i + 1, j, k}, high{i, j + 1, k + 1};
            const std::array<Lattice, 4> around{{{i, j + 1, k}, {i, j, k + 1}, {i + 1, j, k + 1}, {i + 1, j + 1, k}}};
            for (std::size_t n = 0; n < 4; ++n)
                piece<4>({{low, high, around[n], around[(n + 1) % 4]}});
        }
        if (room >= 3) piece<4>({{{i + 1, j + 1, k}, {i, j + 1, k + 1}, {i + 1, j, k + 1}, {i + 1, j + 1, k + 1}}});
    }

    CellKind kind_;
    int order_;
    std::span<const VertexId> nodes_;
    CellList& cells_;
};

}  // namespace

int order_of_lagrange_cell(CellKind kind, std::size_t nodes) {
    for (std::size_t order = 1; node_count(kind, order) > 0 && node_count(kind, order) <= nodes; ++order) {
        if (node_count(kind, order) == nodes) return static_cast<int>(order);
    }
    return 1;
}

void append_lagrange_pieces(CellKind kind, int order, std::span<const VertexId> nodes, CellList& cells) {
    assert(node_count(kind, static_cast<std::size_t>(order)) == nodes.size());
    Pieces(kind, order, nodes, cells).append();
}

}  // namespace cellproj
