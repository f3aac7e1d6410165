// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/plane_cut.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace cellproj {

namespace {

constexpr std::size_t cells_per_task = 16384;

using Distances = std::vector<double>;

Distances distances_of(const std::vector<glm::dvec3>& points, const glm::dvec3& point, const glm::dvec3& unit_normal) {
    Distances distances(points.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, points.size(), 65536), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) distances[i] = distance_to_plane(points[i], point, unit_normal);
    });
    return distances;
}

bool finite_at(const TetMesh& mesh, const ScalarField& field, CellId cell) {
    return std::isfinite(field.at(mesh, cell, 0)) && std::isfinite(field.at(mesh, cell, 1)) && std::isfinite(field.at(mesh, cell, 2)) &&
           std::isfinite(field.at(mesh, cell, 3));
}

// A face in the plane, and the cell on one side of it.
struct PlaneFace {
    std::array<VertexId, 3> vertices;  // ascending
    CellId cell;
};

class Cutter {
public:
    Cutter(const TetMesh& mesh, const ScalarField& field, const Distances& distances) : mesh_(mesh), field_(field), distances_(distances) {}

    // The corners above the plane, as bits.
    unsigned above(CellId cell) const {
        unsigned bits = 0;
        for (unsigned corner = 0; corner < 4; ++corner)
            if (distances_[mesh_.tets[cell][corner]] > 0) bits |= 1U << corner;
        return bits;
    }

    void cut(CellId cell, std::vector<CutTriangle>& triangles) const {
        std::array<int, 4> up{}, down{};
        std::size_t ups = 0, downs = 0;
        const unsigned bits = above(cell);
        for (int corner = 0; corner < 4; ++corner) (bits >> corner & 1U ? up[ups++] : down[downs++]) = corner;
        if (ups == 0 || downs == 0) return;
        if (ups == 2) {
            const Corner a = on_edge(cell, up[0], down[0]), b = on_edge(cell, up[0], down[1]), c = on_edge(cell, up[1], down[1]), d = on_edge(cell, up[1], down[0]);
            triangles.push_back(triangle(a, b, c));
            triangles.push_back(triangle(a, c, d));
            return;
        }
        const auto& [apex, base] = ups == 1 ? std::pair(up[0], down) : std::pair(down[0], up);
        triangles.push_back(triangle(on_edge(cell, apex, base[0]), on_edge(cell, apex, base[1]), on_edge(cell, apex, base[2])));
    }

    // The faces of the cell that lie in the plane.
    void add_plane_faces(CellId cell, std::vector<PlaneFace>& faces) const {
        for (int face = 0; face < 4; ++face) {
            auto v = face_vertices(mesh_.tets[cell], face);
            if (!std::ranges::all_of(v, [&](VertexId id) { return distances_[id] == 0; })) continue;
            std::ranges::sort(v);
            faces.push_back({v, cell});
        }
    }

    CutTriangle triangle_of(const PlaneFace& face) const {
        CutTriangle result;
        for (std::size_t i = 0; i < 3; ++i) {
            result.corners[i] = mesh_.points[face.vertices[i]];
            result.scalars[i] = field_.values[field_.location == FieldLocation::points ? face.vertices[i] : face.cell];
        }
        return result;
    }

private:
    struct Corner {
        glm::dvec3 place;
        double scalar;
    };

    static CutTriangle triangle(const Corner& a, const Corner& b, const Corner& c) {
        return {{a.place, b.place, c.place}, {a.scalar, b.scalar, c.scalar}};
    }

    // Where the plane meets the edge between two corners, one above it and one not.
    Corner on_edge(CellId cell, int one, int other) const {
        const auto& tet = mesh_.tets[cell];
        if (tet[static_cast<std::size_t>(other)] < tet[static_cast<std::size_t>(one)]) std::swap(one, other);
        const VertexId a = tet[static_cast<std::size_t>(one)], b = tet[static_cast<std::size_t>(other)];
        const double share = distances_[a] / (distances_[a] - distances_[b]);
        // Both ends exactly, and no value beyond theirs.
        const auto between = [&](double from, double to) {
            return std::clamp(share == 1 ? to : (1 - share) * from + share * to, std::min(from, to), std::max(from, to));
        };
        Corner corner{{}, between(field_.at(mesh_, cell, one), field_.at(mesh_, cell, other))};
        for (int axis = 0; axis < 3; ++axis) corner.place[axis] = between(mesh_.points[a][axis], mesh_.points[b][axis]);
        return corner;
    }

    const TetMesh& mesh_;
    const ScalarField& field_;
    const Distances& distances_;
};

// What one task finds.
struct Part {
    std::vector<CutTriangle> triangles;
    std::vector<PlaneFace> above, below;  // faces in the plane of cells on either side
};

// Of the faces of cells below, one for each place where no cell is above.
std::vector<PlaneFace> lone_faces(const std::vector<Part>& parts) {
    const auto order = [](const PlaneFace& a, const PlaneFace& b) { return a.vertices < b.vertices; };
    std::vector<PlaneFace> above, below;
    for (const Part& part : parts) {
        above.insert(above.end(), part.above.begin(), part.above.end());
        below.insert(below.end(), part.below.begin(), part.below.end());
    }
    std::ranges::stable_sort(above, order);
    std::ranges::stable_sort(below, order);
    const auto same = [](const PlaneFace& a, const PlaneFace& b) { return a.vertices == b.vertices; };
    below.erase(std::unique(below.begin(), below.end(), same), below.end());
    std::erase_if(below, [&](const PlaneFace& face) { return std::ranges::binary_search(above, face, order); });
    return below;
}

}  // namespace

double distance_to_plane(const glm::dvec3& p, const glm::dvec3& point, const glm::dvec3& unit_normal) {
    const double distance = glm::dot(unit_normal, p - point);
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * glm::dot(glm::abs(unit_normal), glm::abs(p) + glm::abs(point));
    return std::abs(distance) <= rounding && std::isfinite(rounding) ? 0.0 : distance;
}

std::vector<CutTriangle> cut_by_plane(const TetMesh& mesh, const ScalarField& field, const ScalarField* other, const glm::dvec3& point,
                                      const glm::dvec3& unit_normal, PlaneCutSides sides) {
    const Distances distances = distances_of(mesh.points, point, unit_normal);
    const Cutter cutter(mesh, field, distances);
    std::vector<Part> parts((mesh.tets.size() + cells_per_task - 1) / cells_per_task);
    oneapi::tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t number) {
        Part& part = parts[number];
        const std::size_t end = std::min(mesh.tets.size(), (number + 1) * cells_per_task);
        for (std::size_t i = number * cells_per_task; i < end; ++i) {
            const auto cell = static_cast<CellId>(i);
            const auto drawn = [&] { return finite_at(mesh, field, cell) && (!other || finite_at(mesh, *other, cell)); };
            const unsigned above = cutter.above(cell);
            if (above == 15U || (above == 0 && sides == PlaneCutSides::above) || !drawn()) continue;
            if (above != 0) cutter.cut(cell, part.triangles);
            if (sides == PlaneCutSides::both) cutter.add_plane_faces(cell, above != 0 ? part.above : part.below);
        }
    });
    std::vector<CutTriangle> triangles;
    for (const Part& part : parts) triangles.insert(triangles.end(), part.triangles.begin(), part.triangles.end());
    if (sides == PlaneCutSides::both)
        for (const PlaneFace& face : lone_faces(parts)) triangles.push_back(cutter.triangle_of(face));
    return triangles;
}

}  // namespace cellproj
