// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/hierarchy_boxes.hpp"

#include <algorithm>
#include <numeric>

namespace cellproj {

namespace {

double volume(const LatticeBox& box) {
    double product = 1;
    for (std::size_t a = 0; a < 3; ++a) product *= static_cast<double>(box.high[a] - box.low[a]);
    return product;
}

bool same(const LatticeBox& a, const LatticeBox& b) { return a.low == b.low && a.high == b.high; }

LatticeBox below(LatticeBox box, std::size_t axis, std::int64_t plane) {
    box.high[axis] = plane;
    return box;
}

LatticeBox above(LatticeBox box, std::size_t axis, std::int64_t plane) {
    box.low[axis] = plane;
    return box;
}

struct Split {
    std::size_t axis = 0;
    std::int64_t plane = 0;
    double cut_off = 0;  // what lies on the other side of it than the piece
};

// The face of a piece inside the box, beyond which most of the box lies: what is left shrinks fast to the piece. There is one, as the
// piece does not fill the box.
Split best_split(const LatticeBox& box, const LatticeBox& piece) {
    Split best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (piece.low[axis] > box.low[axis]) {
            const double cut = volume(below(box, axis, piece.low[axis]));
            if (cut > best.cut_off) best = {axis, piece.low[axis], cut};
        }
        if (piece.high[axis] < box.high[axis]) {
            const double cut = volume(above(box, axis, piece.high[axis]));
            if (cut > best.cut_off) best = {axis, piece.high[axis], cut};
        }
    }
    return best;
}

}  // namespace

HierarchyTree::HierarchyTree(const Lattice& lattice) {
    LatticeBox all = lattice.pieces.front().box;
    for (const PiecePlace& piece : lattice.pieces)
        for (std::size_t a = 0; a < 3; ++a) {
            all.low[a] = std::min(all.low[a], piece.box.low[a]);
            all.high[a] = std::max(all.high[a], piece.box.high[a]);
        }
    std::vector<std::size_t> pieces(lattice.pieces.size());
    std::iota(pieces.begin(), pieces.end(), std::size_t{0});
    build(lattice, all, pieces);
}

std::size_t HierarchyTree::build(const Lattice& lattice, const LatticeBox& box, const std::vector<std::size_t>& pieces) {
    const std::size_t own = nodes_.size();
    nodes_.emplace_back();
    std::vector<std::size_t> inside;
    std::optional<std::size_t> shown;  // of the finest level here, the piece with the largest part
    double largest = 0;
    for (const std::size_t p : pieces) {
        const PiecePlace& piece = lattice.pieces[p];
        const LatticeBox part = intersection(piece.box, box);
        if (part.is_empty()) continue;
        inside.push_back(p);
        const int level = shown ? lattice.pieces[*shown].level : -1;
        if (piece.level < level || (piece.level == level && volume(part) <= largest)) continue;
        shown = p;
        largest = volume(part);
    }
    if (!shown) return own;
    const LatticeBox part = intersection(lattice.pieces[*shown].box, box);
    if (same(part, box)) {
        nodes_[own].box = boxes_.size();
        boxes_.push_back({*shown, box});
        return own;
    }
    const Split split = best_split(box, part);
    const std::size_t low = build(lattice, below(box, split.axis, split.plane), inside);
    const std::size_t high = build(lattice, above(box, split.axis, split.plane), inside);
    nodes_[own] = {static_cast<int>(split.axis), split.plane, lattice.plane(split.axis, split.plane), low, high, {}};
    return own;
}

std::optional<std::size_t> HierarchyTree::box_at(const LatticeIndex& cell) const {
    std::size_t n = 0;
    while (nodes_[n].axis >= 0) n = cell[static_cast<std::size_t>(nodes_[n].axis)] < nodes_[n].split ? nodes_[n].below : nodes_[n].above;
    const std::optional<std::size_t> box = nodes_[n].box;
    if (!box) return box;
    for (std::size_t a = 0; a < 3; ++a) {  // the outermost half spaces are open
        if (cell[a] < boxes_[*box].box.low[a] || cell[a] >= boxes_[*box].box.high[a]) return std::nullopt;
    }
    return box;
}

std::vector<std::size_t> HierarchyTree::front_to_back(const Eye& eye) const {
    std::vector<std::size_t> order, open{0};
    while (!open.empty()) {
        const Node& node = nodes_[open.back()];
        open.pop_back();
        if (node.box) order.push_back(*node.box);
        if (node.axis < 0) continue;
        // On the plane itself no ray crosses it.
        const bool eye_below = eye.xyz[node.axis] < (eye.at_infinity ? 0.0 : node.plane);
        open.push_back(eye_below ? node.above : node.below);
        open.push_back(eye_below ? node.below : node.above);
    }
    return order;
}

}  // namespace cellproj
