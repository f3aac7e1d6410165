// SPDX-License-Identifier: BSD-3-Clause
//
// Private to mesh/: which of many boxes touch a given one. A tree of boxes, halved at the median of the longest side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

class BoxTree {
public:
    // O(n log n). Boxes keep their numbers, 0 .. n−1.
    explicit BoxTree(std::vector<Bounds> boxes) : boxes_(std::move(boxes)), items_(boxes_.size()) {
        std::iota(items_.begin(), items_.end(), std::size_t{0});
        if (!items_.empty()) build(0, items_.size());
    }

    // Calls visit(i) for every box i that shares a point with `box`, in the tree's order. May run in several threads.
    template <class Visit>
    void visit_touching(const Bounds& box, Visit visit) const {
        for (std::size_t n = 0; n < nodes_.size();) {
            const Node& node = nodes_[n];
            const bool touched = touch(node.box, box);
            for (std::size_t i = node.first; touched && node.leaf() && i < node.last; ++i) {
                if (touch(boxes_[items_[i]], box)) visit(items_[i]);
            }
            n = touched ? n + 1 : node.next;
        }
    }

private:
    static constexpr std::size_t leaf_size = 4;

    // Depth first: the children follow their node, `next` comes after the last of them.
    struct Node {
        Bounds box;
        std::size_t first, last, next;

        bool leaf() const { return last - first <= leaf_size; }
    };

    static bool touch(const Bounds& a, const Bounds& b) {
        return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
               a.low.z <= b.high.z && b.low.z <= a.high.z;
    }

    Bounds around(std::size_t first, std::size_t last) const {
        Bounds all = boxes_[items_[first]];
        for (std::size_t i = first + 1; i < last; ++i) {
            for (int k = 0; k < 3; ++k) {
                all.low[k] = std::min(all.low[k], boxes_[items_[i]].low[k]);
                all.high[k] = std::max(all.high[k], boxes_[items_[i]].high[k]);
            }
        }
        return all;
    }

    void build(std::size_t first, std::size_t last) {
        const std::size_t node = nodes_.size();
        const Bounds box = around(first, last);
        nodes_.push_back({box, first, last, 0});
        if (!nodes_[node].leaf()) {
            const glm::dvec3 size = box.high - box.low;
            const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
            const std::size_t middle = first + (last - first) / 2;
            const auto at = [&](std::size_t i) { return items_.begin() + static_cast<std::ptrdiff_t>(i); };
            std::nth_element(at(first), at(middle), at(last), [&](std::size_t a, std::size_t b) {
                return boxes_[a].low[axis] + boxes_[a].high[axis] < boxes_[b].low[axis] + boxes_[b].high[axis];
            });
            build(first, middle);
            build(middle, last);
        }
        nodes_[node].next = nodes_.size();
    }

    std::vector<Bounds> boxes_;
    std::vector<std::size_t> items_;
    std::vector<Node> nodes_;
};

}  // namespace cellproj
