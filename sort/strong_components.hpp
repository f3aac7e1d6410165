// SPDX-License-Identifier: BSD-3-Clause
//
// Strongly connected components of a directed graph (Tarjan, "Depth-First Search and Linear Graph Algorithms", SIAM J. Comput.
// 1(2), 1972), without recursion. Condensed to its components a graph has no cycles: what is left is an order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cellproj {

// Arcs in rows: those of node n go to targets[starts[n]] .. targets[starts[n + 1] − 1].
struct ArcRows {
    std::vector<std::uint32_t> starts;   // #nodes + 1
    std::vector<std::uint32_t> targets;  // #arcs

    std::size_t nodes() const { return starts.size() - 1; }
    std::span<const std::uint32_t> from(std::uint32_t node) const {
        return std::span(targets).subspan(starts[node], starts[node + 1] - starts[node]);
    }
};

struct NodeArc {
    std::uint32_t from, to;
};

// The same arcs, by source; among those of one source their order stays.
ArcRows to_rows(std::span<const NodeArc> arcs, std::size_t nodes);

// Component k: members[starts[k]] .. members[starts[k + 1] − 1]. Every arc between two components goes from the earlier to the
// later one. Linear time; the answer depends on nothing but the graph.
struct Components {
    std::vector<std::uint32_t> starts;   // #components + 1
    std::vector<std::uint32_t> members;  // #nodes

    std::size_t size() const { return starts.size() - 1; }
    std::span<const std::uint32_t> operator[](std::size_t k) const {
        return std::span(members).subspan(starts[k], starts[k + 1] - starts[k]);
    }
};
Components strong_components(const ArcRows& graph);

}  // namespace cellproj
