// SPDX-License-Identifier: BSD-3-Clause
#include "sort/strong_components.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace cellproj {

ArcRows to_rows(std::span<const NodeArc> arcs, std::size_t nodes) {
    ArcRows rows;
    rows.starts.assign(nodes + 1, 0);
    for (const NodeArc& arc : arcs)
        ++rows.starts[arc.from + 1];
    std::partial_sum(rows.starts.begin(), rows.starts.end(), rows.starts.begin());
    rows.targets.resize(arcs.size());
    std::vector<std::uint32_t> next(rows.starts.begin(), rows.starts.end() - 1);
    for (const NodeArc& arc : arcs)
        rows.targets[next[arc.from]++] = arc.to;
    return rows;
}

Components strong_components(const ArcRows& graph) {
    constexpr auto unseen = std::numeric_limits<std::uint32_t>::max();
    constexpr auto done = unseen - 1;  // its component is complete
    const auto n = static_cast<std::uint32_t>(graph.nodes());
    std::vector<std::uint32_t> index(n, unseen), low(n), next(n);
    std::vector<std::uint32_t> path, waiting;  // the way from the root; nodes whose component is open
    std::uint32_t time = 0;
    Components found;
    found.members.reserve(n);
    found.starts.push_back(0);

    const auto enter = [&](std::uint32_t node) {
        index[node] = low[node] = time++;
        next[node] = graph.starts[node];
        path.push_back(node);
        waiting.push_back(node);
    };
    for (std::uint32_t root = 0; root < n; ++root) {
        if (index[root] == unseen) enter(root);
        while (!path.empty()) {
            const std::uint32_t node = path.back();
            if (next[node] < graph.starts[node + 1]) {
                const std::uint32_t target = graph.targets[next[node]++];
                if (index[target] == unseen) {
                    enter(target);
                } else if (index[target] != done) {
                    low[node] = std::min(low[node], index[target]);
                }
                continue;
            }
            path.pop_back();
            if (!path.empty()) low[path.back()] = std::min(low[path.back()], low[node]);
            if (low[node] != index[node]) continue;
            std::uint32_t member;
            do {
                member = waiting.back();
                waiting.pop_back();
                index[member] = done;
                found.members.push_back(member);
            } while (member != node);
            found.starts.push_back(static_cast<std::uint32_t>(found.members.size()));
        }
    }
    // Tarjan finds a component after all that it points to: turn the whole list round.
    std::reverse(found.members.begin(), found.members.end());
    std::reverse(found.starts.begin(), found.starts.end());
    for (auto& start : found.starts)
        start = n - start;
    return found;
}

}  // namespace cellproj
