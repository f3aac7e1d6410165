// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tet_mesh.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

// One side of a face: its vertices but the smallest (the list it stands in says that one), ascending, and whose it is.
struct FaceSide {
    VertexId middle, largest;
    CellId cell;
    std::uint8_t face;

    bool same_face(const FaceSide& other) const { return middle == other.middle && largest == other.largest; }
    bool operator<(const FaceSide& other) const {
        return std::tie(middle, largest, cell, face) < std::tie(other.middle, other.largest, other.cell, other.face);
    }
};

std::array<VertexId, 3> sorted_face(const std::array<VertexId, 4>& tet, int face) {
    auto v = face_vertices(tet, face);
    if (v[0] > v[1]) std::swap(v[0], v[1]);
    if (v[1] > v[2]) std::swap(v[1], v[2]);
    if (v[0] > v[1]) std::swap(v[0], v[1]);
    return v;
}

// The vertices that are the smallest of some face of a cell: the smallest, and the second one, which is that of the face opposite to it.
std::pair<VertexId, VertexId> two_smallest(const std::array<VertexId, 4>& tet) {
    const auto [a, b] = std::minmax(tet[0], tet[1]);
    const auto [c, d] = std::minmax(tet[2], tet[3]);
    return {std::min(a, c), std::min(std::max(a, c), std::min(b, d))};
}

// The cells that have a face whose smallest vertex is this one, ascending, for each vertex (a counting sort). Their faces are found when
// they are paired: listed all at once they would take eight times as much.
struct CellBuckets {
    std::vector<std::size_t> begin;  // #P + 1
    std::vector<CellId> cells;       // up to 2·#T
};

CellBuckets bucket_cells(const TetMesh& mesh) {
    CellBuckets buckets;
    buckets.begin.assign(mesh.points.size() + 2, 0);
    for (const auto& tet : mesh.tets) {
        const auto [first, second] = two_smallest(tet);
        ++buckets.begin[first + 2];
        if (second != first) ++buckets.begin[second + 2];
    }
    for (std::size_t v = 2; v < buckets.begin.size(); ++v) buckets.begin[v] += buckets.begin[v - 1];
    buckets.cells.resize(buckets.begin.back());
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        const auto [first, second] = two_smallest(mesh.tets[cell]);
        buckets.cells[buckets.begin[first + 1]++] = cell;
        if (second != first) buckets.cells[buckets.begin[second + 1]++] = cell;
    }
    buckets.begin.pop_back();
    return buckets;
}

// The sides of all faces of these cells whose smallest vertex is v.
void find_sides(const TetMesh& mesh, std::span<const CellId> cells, VertexId v, std::vector<FaceSide>& sides) {
    sides.clear();
    for (const CellId cell : cells) {
        for (int face = 0; face < 4; ++face) {
            const auto vertices = sorted_face(mesh.tets[cell], face);
            if (vertices[0] == v) sides.push_back({vertices[1], vertices[2], cell, static_cast<std::uint8_t>(face)});
        }
    }
}

// Pairs the sides of each face, of those with one smallest vertex; returns how many sides were left over on faces with more than two.
std::size_t pair_sides(std::vector<FaceSide>& sides, std::vector<std::array<CellId, 4>>& neighbours) {
    std::sort(sides.begin(), sides.end());
    std::size_t left_over = 0;
    for (auto run = sides.begin(); run != sides.end();) {
        const auto run_end = std::find_if_not(run, sides.end(), [&](const FaceSide& side) { return side.same_face(*run); });
        const auto other = std::find_if(run, run_end, [&](const FaceSide& side) { return side.cell != run->cell; });
        if (other != run_end) {
            neighbours[run->cell][run->face] = other->cell;
            neighbours[other->cell][other->face] = run->cell;
        }
        left_over += static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, run_end - run - 2));
        run = run_end;
    }
    return left_over;
}

[[noreturn]] void fail(const std::string& place, std::string expected, std::string found, std::string advice) {
    throw Error({.kind = ErrorKind::data,
                 .place = place,
                 .expected = std::move(expected),
                 .found = std::move(found),
                 .advice = std::move(advice)});
}

void validate_fields(const std::vector<Field>& fields, std::size_t rows, std::string_view what,
                     const std::string& place) {
    for (const Field& field : fields) {
        const std::size_t wanted = rows * static_cast<std::size_t>(std::max(field.components, 1));
        if (field.components >= 1 && field.values.size() == wanted) continue;
        fail(place + ", field \"" + field.name + "\"",
             std::to_string(rows) + " " + std::string(what) + " of " + std::to_string(field.components) + " components",
             std::to_string(field.values.size()) + " values", "give one row per element");
    }
}

}  // namespace

double Bounds::diagonal() const { return glm::length(high - low); }

Bounds bounds(const std::vector<glm::dvec3>& points) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Bounds box{glm::dvec3(infinity), glm::dvec3(-infinity)};
    for (const glm::dvec3& p : points) {
        for (int k = 0; k < 3; ++k) {
            box.low[k] = std::min(box.low[k], p[k]);
            box.high[k] = std::max(box.high[k], p[k]);
        }
    }
    return box;
}

double signed_volume(const TetMesh& mesh, CellId cell) {
    const auto& t = mesh.tets[cell];
    const glm::dvec3 a = mesh.points[t[0]];
    return glm::dot(glm::cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a) / 6.0;
}

OrientationCounts orient_cells(TetMesh& mesh) {
    OrientationCounts counts;
    for (auto& t : mesh.tets) {
        const int sign = orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]);
        if (sign == 0) ++counts.flat;
        if (sign >= 0) continue;
        std::swap(t[2], t[3]);
        ++counts.flipped;
    }
    return counts;
}

void validate(const TetMesh& mesh, const std::string& place) {
    if (mesh.tets.empty()) {
        fail(place, "at least one volume cell", "none", "give a volume mesh; surfaces must be tetrahedralized first");
    }
    for (const auto& [count, what] : {std::pair{mesh.points.size(), "points"}, std::pair{mesh.tets.size(), "cells"}}) {
        if (count <= max_elements) continue;
        fail(place, "at most " + std::to_string(max_elements) + " " + what, std::to_string(count),
             "split the mesh: ids have 32 bits");
    }
    for (std::size_t c = 0; c < mesh.tets.size(); ++c) {
        for (const VertexId v : mesh.tets[c]) {
            if (v < mesh.points.size()) continue;
            fail(place + ", tetrahedron " + std::to_string(c),
                 "vertex ids below the number of points, " + std::to_string(mesh.points.size()), std::to_string(v),
                 "the file is damaged or its ids are not counted from 0");
        }
    }
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const glm::dvec3& p = mesh.points[i];
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
        fail(place + ", point " + std::to_string(i), "finite coordinates",
             "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ")",
             "repair or remove the point and its cells");
    }
    validate_fields(mesh.point_fields, mesh.points.size(), "points", place);
    validate_fields(mesh.cell_fields, mesh.tets.size(), "cells", place);
}

Adjacency build_adjacency(const TetMesh& mesh) {
    Adjacency adjacency;
    adjacency.neighbours.assign(mesh.tets.size(), {no_cell, no_cell, no_cell, no_cell});
    const CellBuckets buckets = bucket_cells(mesh);
    std::atomic<std::size_t> left_over{0};
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, mesh.points.size(), 1024),
                              [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
                                  std::size_t count = 0;
                                  std::vector<FaceSide> sides;
                                  for (std::size_t v = range.begin(); v != range.end(); ++v) {
                                      const auto cells = std::span(buckets.cells).subspan(buckets.begin[v], buckets.begin[v + 1] - buckets.begin[v]);
                                      find_sides(mesh, cells, static_cast<VertexId>(v), sides);
                                      count += pair_sides(sides, adjacency.neighbours);
                                  }
                                  left_over += count;
                              });
    adjacency.overused_faces = left_over;
    return adjacency;
}

std::vector<BoundaryFace> boundary_faces(const Adjacency& adjacency) {
    std::vector<BoundaryFace> faces;
    for (CellId cell = 0; cell < adjacency.neighbours.size(); ++cell) {
        for (int face = 0; face < 4; ++face) {
            if (adjacency.neighbours[cell][static_cast<std::size_t>(face)] == no_cell) faces.push_back({cell, face});
        }
    }
    return faces;
}

}  // namespace cellproj
