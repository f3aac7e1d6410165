// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

// Disjoint sets with path halving.
class Sets {
public:
    explicit Sets(std::size_t elements) : parent_(elements) { std::iota(parent_.begin(), parent_.end(), 0U); }

    CellId root(CellId x) {
        while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
        return x;
    }
    void join(CellId a, CellId b) { parent_[root(a)] = root(b); }
    std::size_t count() {
        std::size_t roots = 0;
        for (CellId x = 0; x < parent_.size(); ++x) roots += root(x) == x;
        return roots;
    }

private:
    std::vector<CellId> parent_;
};

bool repeats_vertex(std::array<VertexId, 4> tet) {
    std::sort(tet.begin(), tet.end());
    return std::adjacent_find(tet.begin(), tet.end()) != tet.end();
}

const glm::dvec3& corner(const TetMesh& mesh, CellId cell, int i) {
    return mesh.points[mesh.tets[cell][static_cast<std::size_t>(i)]];
}

int face_towards(const Adjacency& adjacency, CellId cell, CellId neighbour) {
    const auto& around = adjacency.neighbours[cell];
    return static_cast<int>(std::find(around.begin(), around.end(), neighbour) - around.begin());
}

void check_cells(const TetMesh& mesh, MeshCheck& result) {
    std::vector<double> volumes(mesh.tets.size());
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        volumes[cell] = std::abs(signed_volume(mesh, cell));
        const bool flat = orientation(corner(mesh, cell, 0), corner(mesh, cell, 1), corner(mesh, cell, 2),
                                      corner(mesh, cell, 3)) == 0;
        if (flat) result.flat_cells.add(cell);
        if (repeats_vertex(mesh.tets[cell])) result.repeated_vertices.add(cell);
    }
    const auto middle = volumes.begin() + static_cast<std::ptrdiff_t>(volumes.size() / 2);
    std::nth_element(volumes.begin(), middle, volumes.end());
    result.volumes = {*std::min_element(volumes.begin(), volumes.end()), *middle,
                      *std::max_element(volumes.begin(), volumes.end())};
}

// Pairs of cells at a common face: on the same side of it, and whether the mesh is Delaunay there.
void check_faces(const TetMesh& mesh, const Adjacency& adjacency, MeshCheck& result) {
    Sets pieces(mesh.tets.size());
    result.delaunay = true;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        for (int face = 0; face < 4; ++face) {
            const CellId other = adjacency.neighbours[cell][static_cast<std::size_t>(face)];
            if (other == no_cell || other < cell) continue;
            pieces.join(cell, other);
            const auto v = face_vertices(mesh.tets[cell], face);
            const glm::dvec3& beyond = corner(mesh, other, face_towards(adjacency, other, cell));
            // A cell's own corner sees its face clockwise, −1; the neighbour's must see it the other way round.
            if (orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], beyond) < 0) {
                result.overlapping_cells.add(cell);
            }
            result.delaunay = result.delaunay && side_of_circumsphere(corner(mesh, cell, 0), corner(mesh, cell, 1),
                                                                      corner(mesh, cell, 2), corner(mesh, cell, 3), beyond) <= 0;
        }
    }
    result.components = pieces.count();
    result.overused_faces = adjacency.overused_faces;
}

// The boundary's triangles joined over their edges. An edge is convex if the far corner of one triangle is not in front of
// the other.
void check_boundary(const TetMesh& mesh, const Adjacency& adjacency, MeshCheck& result) {
    const std::vector<BoundaryFace> faces = boundary_faces(adjacency);
    using Edge = std::pair<VertexId, VertexId>;
    std::map<Edge, std::size_t> directed;  // each edge as its triangle runs along it
    const auto vertices = [&](std::size_t f) { return face_vertices(mesh.tets[faces[f].cell], faces[f].face); };
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const auto v = vertices(f);
        for (std::size_t i = 0; i < 3; ++i) directed[{v[i], v[(i + 1) % 3]}] = f;
    }
    Sets surfaces(faces.size());
    bool convex = true;
    for (const auto& [edge, f] : directed) {
        const auto other = directed.find({edge.second, edge.first});
        if (other == directed.end()) continue;
        surfaces.join(static_cast<CellId>(f), static_cast<CellId>(other->second));
        const auto v = vertices(f), w = vertices(other->second);
        const auto is_apex = [&ends = edge](VertexId x) { return x != ends.first && x != ends.second; };
        const auto apex = std::find_if(w.begin(), w.end(), is_apex);
        if (apex == w.end()) continue;
        convex = convex && orientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[*apex]) <= 0;
    }
    result.boundary_components = surfaces.count();
    result.convex = convex && result.components == 1 && result.boundary_components == 1;
}

void check_points(const TetMesh& mesh, MeshCheck& result) {
    std::vector<bool> used(mesh.points.size(), false);
    for (const auto& tet : mesh.tets) {
        for (const VertexId v : tet) used[v] = true;
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) result.isolated_points.add(v);
    }
    std::vector<VertexId> by_place(mesh.points.size());
    std::iota(by_place.begin(), by_place.end(), 0U);
    const auto key = [&](VertexId v) {
        const glm::dvec3& p = mesh.points[v];
        return std::tuple(p.x, p.y, p.z, v);
    };
    std::sort(by_place.begin(), by_place.end(), [&](VertexId a, VertexId b) { return key(a) < key(b); });
    std::vector<std::pair<VertexId, VertexId>> coincident;  // (the higher id, the lowest at its place)
    for (std::size_t i = 1, first = 0; i < by_place.size(); ++i) {
        if (mesh.points[by_place[i]] == mesh.points[by_place[first]]) coincident.emplace_back(by_place[i], by_place[first]);
        else first = i;
    }
    std::sort(coincident.begin(), coincident.end());
    for (const auto& [point, twin] : coincident) {
        result.coincident_points.add(point);
        for (const Field& field : mesh.point_fields) {
            const auto n = static_cast<std::size_t>(field.components);
            for (std::size_t k = 0; k < n; ++k) {
                const double difference = std::abs(field.values[point * n + k] - field.values[twin * n + k]);
                result.coincident_difference = std::max(result.coincident_difference, difference);
            }
        }
    }
}

void check_fields(const std::vector<Field>& fields, MeshCheck& result) {
    for (const Field& field : fields) {
        const auto bad = std::count_if(field.values.begin(), field.values.end(), [](double x) { return !std::isfinite(x); });
        if (bad > 0) result.not_finite.push_back({field.name, static_cast<std::size_t>(bad)});
    }
}

}  // namespace

bool MeshCheck::faithful() const {
    return overlapping_cells.count == 0 && overused_faces == 0 && not_finite.empty();
}

MeshCheck check(const TetMesh& mesh, const Adjacency& adjacency) {
    MeshCheck result;
    check_cells(mesh, result);
    check_faces(mesh, adjacency, result);
    check_boundary(mesh, adjacency, result);
    check_points(mesh, result);
    check_fields(mesh.point_fields, result);
    check_fields(mesh.cell_fields, result);
    return result;
}

}  // namespace cellproj
