// SPDX-License-Identifier: BSD-3-Clause
#include "sort/boundary.hpp"

#include <algorithm>
#include <tuple>

namespace cellproj {

std::vector<BoundaryFace> order_boundary(const CellGraph& graph) {
    const bool some_are_flat = graph.flat_cells() > 0;
    const auto is_flat = [&](CellId place) { return some_are_flat && graph.is_flat(place); };
    std::vector<BoundaryFace> faces;
    for (CellId place = 0; place < graph.size(); ++place) {
        if (!some_are_flat && !graph.on_boundary(place)) continue;
        if (is_flat(place)) continue;
        for (int face = 0; face < 4; ++face) {
            const CellId other = graph.neighbours(place)[static_cast<std::size_t>(face)];
            if (other == graph.nobody() || is_flat(other)) faces.push_back({graph.cell(place), face});
        }
    }
    std::sort(faces.begin(), faces.end(),
              [](const BoundaryFace& a, const BoundaryFace& b) { return std::tie(a.cell, a.face) < std::tie(b.cell, b.face); });
    return faces;
}

}  // namespace cellproj
