// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/face_contacts.hpp"
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

std::array<double, 2> shortest_and_longest_edge(const TetMesh& mesh) {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;  // squares
    for (const auto& tet : mesh.tets) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const glm::dvec3 edge = mesh.points[tet[i]] - mesh.points[tet[j]];
                shortest = std::min(shortest, glm::dot(edge, edge));
                longest = std::max(longest, glm::dot(edge, edge));
            }
        }
    }
    return {std::sqrt(shortest), std::sqrt(longest)};
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
    result.edges = shortest_and_longest_edge(mesh);
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
}

std::array<VertexId, 3> sorted(std::array<VertexId, 3> face) {
    std::sort(face.begin(), face.end());
    return face;
}

// Takes the sides that found no partner, because two others had paired before, out of `boundary`.
void check_overused(const TetMesh& mesh, const Adjacency& adjacency, std::vector<BoundaryFace>& boundary, MeshCheck& result) {
    if (adjacency.overused_faces == 0) return;
    std::vector<std::array<VertexId, 3>> alone;
    for (const auto& [cell, face] : boundary) alone.push_back(sorted(face_vertices(mesh.tets[cell], face)));
    std::sort(alone.begin(), alone.end());
    std::vector<std::array<VertexId, 3>> overused;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        for (int face = 0; face < 4; ++face) {
            const auto v = sorted(face_vertices(mesh.tets[cell], face));
            const bool paired = adjacency.neighbours[cell][static_cast<std::size_t>(face)] != no_cell;
            if (paired && std::binary_search(alone.begin(), alone.end(), v)) overused.push_back(v);
        }
    }
    std::sort(overused.begin(), overused.end());
    std::erase_if(boundary, [&](const BoundaryFace& f) {
        const auto v = sorted(face_vertices(mesh.tets[f.cell], f.face));
        const bool left_over = std::binary_search(overused.begin(), overused.end(), v);
        if (left_over) result.overused_faces.add(f.cell);
        return left_over;
    });
}

// An edge of a boundary triangle as the triangle runs along it.
struct BoundaryEdge {
    VertexId from, to, apex;
    CellId triangle;

    std::pair<VertexId, VertexId> undirected() const { return std::minmax(from, to); }
};

std::vector<BoundaryEdge> boundary_edges(const TetMesh& mesh, const std::vector<BoundaryFace>& faces) {
    std::vector<BoundaryEdge> edges;
    edges.reserve(3 * faces.size());
    for (CellId f = 0; f < faces.size(); ++f) {
        const auto v = face_vertices(mesh.tets[faces[f].cell], faces[f].face);
        for (std::size_t i = 0; i < 3; ++i) edges.push_back({v[i], v[(i + 1) % 3], v[(i + 2) % 3], f});
    }
    std::sort(edges.begin(), edges.end(), [](const BoundaryEdge& a, const BoundaryEdge& b) {
        return std::pair(a.undirected(), a.triangle) < std::pair(b.undirected(), b.triangle);
    });
    return edges;
}

// Whether the far corner of b's triangle rises above that of a by more than rounding (exact where it does not).
bool dented(const TetMesh& mesh, const BoundaryEdge& a, const BoundaryEdge& b, double rounding) {
    const glm::dvec3 &p = mesh.points[a.from], &q = mesh.points[a.to], &r = mesh.points[a.apex], &far = mesh.points[b.apex];
    if (orientation(p, q, r, far) <= 0) return false;
    const glm::dvec3 normal = glm::cross(q - p, r - p);
    const double edge = std::max({glm::distance(p, q), glm::distance(p, r), glm::distance(p, far)});
    return glm::dot(normal, far - p) > contact_tolerance(edge, rounding) * glm::length(normal);
}

// How many of the surfaces look inwards: what they enclose, by the divergence theorem, is negative.
std::size_t count_cavities(const TetMesh& mesh, const std::vector<BoundaryFace>& faces, Sets& surfaces) {
    const glm::dvec3 origin = bounds(mesh.points).center();
    std::vector<double> enclosed(faces.size(), 0.0);
    for (CellId f = 0; f < faces.size(); ++f) {
        const auto v = face_vertices(mesh.tets[faces[f].cell], faces[f].face);
        const glm::dvec3 a = mesh.points[v[0]] - origin, b = mesh.points[v[1]] - origin, c = mesh.points[v[2]] - origin;
        enclosed[surfaces.root(f)] += glm::dot(a, glm::cross(b, c));
    }
    return static_cast<std::size_t>(std::count_if(enclosed.begin(), enclosed.end(), [](double x) { return x < 0.0; }));
}

// The boundary's triangles joined over their edges into closed surfaces.
void check_boundary(const TetMesh& mesh, const std::vector<BoundaryFace>& faces, MeshCheck& result) {
    const std::vector<BoundaryEdge> edges = boundary_edges(mesh, faces);
    const double rounding = coordinate_rounding(mesh.points);
    Sets surfaces(faces.size());
    bool convex = true;
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
        for (end = i; end < edges.size() && edges[end].undirected() == edges[i].undirected(); ++end) {
            surfaces.join(edges[i].triangle, edges[end].triangle);
        }
        convex = convex && end == i + 2 && !dented(mesh, edges[i], edges[i + 1], rounding);
    }
    result.boundary_components = surfaces.count();
    result.cavities = count_cavities(mesh, faces, surfaces);
    result.convex = convex && result.components == 1 && result.boundary_components == 1;
}

void check_contacts(const TetMesh& mesh, const std::vector<BoundaryFace>& boundary, const std::vector<VertexId>& places,
                    MeshCheck& result) {
    const FaceContacts contacts = find_face_contacts(mesh, boundary, places);
    result.overlapping_cells.add_all(contacts.doubled);
    result.seam_faces.add_all(contacts.seams);
    result.hanging_points.add_all(contacts.hanging);
    result.crossing_faces.add_all(contacts.crossing);
}

// The lowest id of the points at the place of each point.
std::vector<VertexId> find_places(const std::vector<glm::dvec3>& points) {
    std::vector<VertexId> by_place(points.size());
    std::iota(by_place.begin(), by_place.end(), 0U);
    const auto key = [&](VertexId v) { return std::tuple(points[v].x, points[v].y, points[v].z, v); };
    std::sort(by_place.begin(), by_place.end(), [&](VertexId a, VertexId b) { return key(a) < key(b); });
    std::vector<VertexId> places(points.size());
    for (std::size_t i = 0, first = 0; i < by_place.size(); ++i) {
        if (points[by_place[i]] != points[by_place[first]]) first = i;
        places[by_place[i]] = by_place[first];
    }
    return places;
}

void check_points(const TetMesh& mesh, const std::vector<VertexId>& places, MeshCheck& result) {
    std::vector<bool> used(mesh.points.size(), false);
    for (const auto& tet : mesh.tets) {
        for (const VertexId v : tet) used[v] = true;
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) result.isolated_points.add(v);
    }
    for (VertexId point = 0; point < places.size(); ++point) {
        if (places[point] == point) continue;
        result.coincident_points.add(point);
        for (const Field& field : mesh.point_fields) {
            const auto n = static_cast<std::size_t>(field.components);
            for (std::size_t k = 0; k < n; ++k) {
                const double difference = std::abs(field.values[point * n + k] - field.values[places[point] * n + k]);
                if (!(difference > result.coincident_difference)) continue;
                result.coincident_difference = difference;
                result.coincident_field = field.name;
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
    return overlapping_cells.count == 0 && overused_faces.count == 0 && conforming() && not_finite.empty();
}

MeshCheck check(const TetMesh& mesh, const Adjacency& adjacency) {
    MeshCheck result;
    check_cells(mesh, result);
    check_faces(mesh, adjacency, result);
    std::vector<BoundaryFace> boundary = boundary_faces(adjacency);
    check_boundary(mesh, boundary, result);
    check_overused(mesh, adjacency, boundary, result);
    const std::vector<VertexId> places = find_places(mesh.points);
    check_contacts(mesh, boundary, places, result);
    check_points(mesh, places, result);
    check_fields(mesh.point_fields, result);
    check_fields(mesh.cell_fields, result);
    return result;
}

}  // namespace cellproj
