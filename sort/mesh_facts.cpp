// SPDX-License-Identifier: BSD-3-Clause
#include "sort/mesh_facts.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

struct BoundaryTriangle {
    std::array<VertexId, 3> vertices;  // counter-clockwise from outside
    VertexId apex;                     // the cell's fourth vertex
};

struct EdgeSide {
    VertexId low, high;
    std::uint32_t triangle;
    VertexId opposite;  // the triangle's third vertex

    bool same_edge(const EdgeSide& other) const { return low == other.low && high == other.high; }
    bool operator<(const EdgeSide& other) const {
        return low != other.low ? low < other.low : high != other.high ? high < other.high : triangle < other.triangle;
    }
};

std::vector<BoundaryTriangle> boundary_of(const CellGraph& graph) {
    std::vector<BoundaryTriangle> triangles;
    for (CellId place = 0; place < graph.size(); ++place) {
        if (!graph.on_boundary(place)) continue;
        const auto& tet = graph.mesh().tets[graph.cell(place)];
        for (int face = 0; face < 4; ++face) {
            if (graph.neighbours(place)[static_cast<std::size_t>(face)] != graph.nobody()) continue;
            triangles.push_back({face_vertices(tet, face), tet[static_cast<std::size_t>(face)]});
        }
    }
    return triangles;
}

std::vector<EdgeSide> edge_sides(const std::vector<BoundaryTriangle>& triangles) {
    std::vector<EdgeSide> sides;
    sides.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const auto& v = triangles[t].vertices;
        for (std::size_t i = 0; i < 3; ++i) {
            const VertexId a = v[i], b = v[(i + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t, v[(i + 2) % 3]});
        }
    }
    std::sort(sides.begin(), sides.end());
    return sides;
}

std::size_t count_vertices(const std::vector<BoundaryTriangle>& triangles) {
    std::vector<VertexId> vertices;
    vertices.reserve(3 * triangles.size());
    for (const auto& t : triangles) vertices.insert(vertices.end(), t.vertices.begin(), t.vertices.end());
    std::sort(vertices.begin(), vertices.end());
    return static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
}

bool connected(std::size_t triangles, const std::vector<EdgeSide>& sides) {
    std::vector<std::uint32_t> parent(triangles);
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    std::size_t pieces = triangles;
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
        const std::uint32_t a = root(sides[i].triangle), b = root(sides[i + 1].triangle);
        if (a != b) --pieces;
        parent[std::max(a, b)] = std::min(a, b);
    }
    return pieces == 1;
}

// Whether the surface turns inwards or goes straight on from one triangle across an edge to the vertex `beyond` of the next.
bool convex_across(const TetMesh& mesh, const BoundaryTriangle& triangle, const EdgeSide& side, VertexId beyond) {
    const auto& p = mesh.points;
    const auto& v = triangle.vertices;
    const int above = orientation(p[v[0]], p[v[1]], p[v[2]], p[beyond]);
    if (above != 0) return above < 0;
    // In one plane: on the other side of the edge, not folded back.
    const auto of = [&](VertexId vertex) { return orientation(p[side.low], p[side.high], p[triangle.apex], p[vertex]); };
    return of(beyond) * of(side.opposite) < 0;
}

}  // namespace

bool fills_convex_body(const CellGraph& graph) {
    if (graph.folded_faces() > 0) return false;
    const auto triangles = boundary_of(graph);
    const auto sides = edge_sides(triangles);
    for (std::size_t i = 0; i < sides.size(); i += 2) {  // every edge has two triangles
        if (i + 1 == sides.size() || !sides[i].same_edge(sides[i + 1])) return false;
        if (i + 2 < sides.size() && sides[i].same_edge(sides[i + 2])) return false;
    }
    // Euler's formula for a sphere: V − E + F = 2.
    if (count_vertices(triangles) + triangles.size() != 2 + sides.size() / 2) return false;
    if (!connected(triangles.size(), sides)) return false;
    for (std::size_t i = 0; i < sides.size(); i += 2) {
        const EdgeSide& a = sides[i];
        const EdgeSide& b = sides[i + 1];
        if (!convex_across(graph.mesh(), triangles[a.triangle], a, b.opposite)) return false;
    }
    return true;
}

bool locally_delaunay(const CellGraph& graph) {
    const TetMesh& mesh = graph.mesh();
    const auto check = [&](const Range& range, bool so_far) {
        for (std::size_t i = range.begin(); so_far && i != range.end(); ++i) {
            const auto place = static_cast<CellId>(i);
            const auto& t = mesh.tets[graph.cell(place)];
            const auto& p = mesh.points;
            if (orientation(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) <= 0) return false;
            for (std::size_t face = 0; face < 4; ++face) {
                const CellId other = graph.neighbours(place)[face];
                if (other == graph.nobody() || other < place) continue;  // one side of each face is enough: the test is symmetric
                for (const VertexId v : mesh.tets[graph.cell(other)]) {
                    if (std::find(t.begin(), t.end(), v) != t.end()) continue;
                    if (side_of_circumsphere(p[t[0]], p[t[1]], p[t[2]], p[t[3]], p[v]) > 0) return false;
                }
            }
        }
        return so_far;
    };
    return oneapi::tbb::parallel_reduce(Range(0, graph.size(), 4096), true, check, std::logical_and<>());
}

}  // namespace cellproj
