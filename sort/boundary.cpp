// SPDX-License-Identifier: BSD-3-Clause
#include "sort/boundary.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <cstdint>

#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

// The sign of a cell's volume over one of its faces, or of another cell's by the vertex that is not in the face.
int side_of_face(const TetMesh& mesh, const std::array<VertexId, 3>& face, CellId cell) {
    for (const VertexId v : mesh.tets[cell]) {
        if (v == face[0] || v == face[1] || v == face[2]) continue;
        return orientation(mesh.points[face[0]], mesh.points[face[1]], mesh.points[face[2]], mesh.points[v]);
    }
    return 0;  // a vertex twice
}

}  // namespace

bool separates(const TetMesh& mesh, CellId cell, int face, CellId other) {
    const auto vertices = face_vertices(mesh.tets[cell], face);
    return side_of_face(mesh, vertices, cell) * side_of_face(mesh, vertices, other) < 0;
}

std::vector<BoundaryFace> order_boundary(const TetMesh& mesh, const Adjacency& adjacency) {
    const std::size_t cells = mesh.tets.size();
    std::vector<std::uint8_t> is_open(cells);  // a bit per face
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, cells, 4096), [&](const Range& range) {
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const auto& t = mesh.tets[c];
            is_open[c] = 0;
            if (orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) == 0) continue;
            for (int face = 0; face < 4; ++face) {
                const CellId other = adjacency.neighbours[c][static_cast<std::size_t>(face)];
                if (other == no_cell || !separates(mesh, static_cast<CellId>(c), face, other))
                    is_open[c] |= static_cast<std::uint8_t>(1U << face);
            }
        }
    });
    std::vector<BoundaryFace> faces;
    for (CellId cell = 0; cell < cells; ++cell) {
        for (int face = 0; face < 4; ++face) {
            if (is_open[cell] >> face & 1) faces.push_back({cell, face});
        }
    }
    return faces;
}

}  // namespace cellproj
