// SPDX-License-Identifier: BSD-3-Clause
#include "sort/boundary.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "mesh/predicates.hpp"

namespace cellproj {

std::vector<BoundaryFace> order_boundary(const TetMesh& mesh, const Adjacency& adjacency) {
    const std::size_t cells = mesh.tets.size();
    std::vector<std::uint8_t> is_flat(cells);
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, cells, 4096), [&](const Range& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const auto& t = mesh.tets[c];
            is_flat[c] = orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) == 0;
        }
    });
    std::vector<BoundaryFace> faces;
    for (CellId cell = 0; cell < cells; ++cell) {
        if (is_flat[cell]) continue;
        for (int face = 0; face < 4; ++face) {
            const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
            if (other == no_cell || is_flat[other]) faces.push_back({cell, face});
        }
    }
    return faces;
}

}  // namespace cellproj
