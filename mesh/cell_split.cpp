// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/cell_split.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "mesh/cell_faces.hpp"
#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

template <std::size_t N>
bool contains(const std::array<VertexId, N>& simplex, VertexId vertex) {
    return std::find(simplex.begin(), simplex.end(), vertex) != simplex.end();
}

// The corner k, 0..2, of a triangle at which an edge from `from` to `to` starts; 3 when it has no such edge.
std::size_t edge_start(const std::array<VertexId, 3>& triangle, VertexId from, VertexId to) {
    std::size_t k = 0;
    while (k < 3 && (triangle[k] != from || triangle[(k + 1) % 3] != to))
        ++k;
    return k;
}

enum class Contact { none, turned_alike, turned_against };

// Two triangles of one closed surface turn alike when they pass their common edge in opposite directions.
Contact contact(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        const VertexId from = a[k];
        const VertexId to = a[(k + 1) % 3];
        if (edge_start(b, to, from) < 3) return Contact::turned_alike;
        if (edge_start(b, from, to) < 3) return Contact::turned_against;
    }
    return Contact::none;
}

}  // namespace

const CellCentre* CellSplitter::split(CellKind kind, std::span<const VertexId> cell, VertexId centre_id,
                                      std::vector<std::array<VertexId, 4>>& tets) {
    if (kind == CellKind::tetrahedron) {
        const std::array<VertexId, 4> tet{cell[0], cell[1], cell[2], cell[3]};
        if (!contains<3>({tet[1], tet[2], tet[3]}, tet[0]) && tet[1] != tet[2] && tet[1] != tet[3] &&
            tet[2] != tet[3]) {
            tets.push_back(tet);
        }
        return nullptr;
    }
    triangulate_surface(kind, cell);
    if (surface_.empty()) return nullptr;
    if (kind == CellKind::polyhedron) {
        place_centre(kind, centre_id);
        join(centre_id, tets);
        return &centre_;
    }
    const VertexId lowest = *std::min_element(cell.begin(), cell.end());
    const Flaws pulled = flaws(points_[lowest], lowest);
    if (pulled == Flaws{} || place_centre(kind, centre_id) >= pulled) {
        join(lowest, tets);
        return nullptr;
    }
    join(centre_id, tets);
    return &centre_;
}

void CellSplitter::triangulate_surface(CellKind kind, std::span<const VertexId> cell) {
    surface_.clear();
    for_each_face(kind, cell, [&](std::span<const VertexId> face) { triangulate_face(face, points_, surface_); });
    if (kind == CellKind::polyhedron) cancel_coincident_triangles();
}

// A vertex on the edge between two faces of a cell, and on no third of them, can give both faces the same triangle. The
// two enclose nothing, and without them the cells behind these faces meet each other there.
void CellSplitter::cancel_coincident_triangles() {
    const auto sorted = [](Triangle t) {
        std::sort(t.begin(), t.end());
        return t;
    };
    std::sort(surface_.begin(), surface_.end(),
              [&](const Triangle& a, const Triangle& b) { return sorted(a) < sorted(b); });
    std::size_t kept = 0;
    for (std::size_t n = 0; n < surface_.size(); ++n) {
        if (kept > 0 && sorted(surface_[kept - 1]) == sorted(surface_[n])) {
            --kept;
        } else {
            surface_[kept++] = surface_[n];
        }
    }
    surface_.resize(kept);
}

// Turns the triangles until all agree with the first one of their connected part.
void CellSplitter::turn_alike() {
    // surface_[0 .. done) agree with each other and have met all they touch; [done .. reached) agree.
    std::size_t reached = 0;
    for (std::size_t done = 0; done < surface_.size(); ++done) {
        reached = std::max(reached, done + 1);
        for (std::size_t other = reached; other < surface_.size(); ++other) {
            const Contact met = contact(surface_[done], surface_[other]);
            if (met == Contact::none) continue;
            if (met == Contact::turned_against) std::swap(surface_[other][1], surface_[other][2]);
            std::swap(surface_[reached++], surface_[other]);
        }
    }
}

CellSplitter::Flaws CellSplitter::flaws(const glm::dvec3& apex, VertexId apex_id) const {
    // Sums of the largest numbers overflow; such a point has no exact sign on any side.
    const bool finite = std::isfinite(apex.x) && std::isfinite(apex.y) && std::isfinite(apex.z);
    if (!finite) return {surface_.size() + 1, surface_.size() + 1};
    std::size_t positive = 0;
    std::size_t negative = 0;
    std::size_t flat = 0;
    for (const Triangle& t : surface_) {
        if (contains(t, apex_id)) continue;
        const int sign = orientation(apex, points_[t[0]], points_[t[1]], points_[t[2]]);
        ++(sign > 0 ? positive : sign < 0 ? negative : flat);
    }
    return {std::min(positive, negative), flat};
}

void CellSplitter::join(VertexId apex_id, std::vector<std::array<VertexId, 4>>& tets) const {
    for (const Triangle& t : surface_) {
        if (!contains(t, apex_id)) tets.push_back({apex_id, t[0], t[1], t[2]});
    }
}

// The first of these that sees all triangles of the surface from inside: the mean of the vertices, the centroid of the
// volume, and where relaxation leads from there. Where none does, the one with the fewest contradictions.
CellSplitter::Flaws CellSplitter::place_centre(CellKind kind, VertexId centre_id) {
    collect_vertices();
    const glm::dvec3 mean = mean_of_vertices();
    Flaws least = flaws(mean, centre_id);
    if (least.contradictions > 0 && kind == CellKind::polyhedron) {
        turn_alike();  // what files say of the faces of polyhedra is not trusted either
        least = flaws(mean, centre_id);
    }
    centre_.position = mean;
    glm::dvec3 candidate = mean;
    for (const auto next : {&CellSplitter::centroid, &CellSplitter::relaxed}) {
        if (least.contradictions == 0) break;
        candidate = (this->*next)(candidate);
        const Flaws found = flaws(candidate, centre_id);
        if (found >= least) continue;
        least = found;
        centre_.position = candidate;
    }
    weigh_vertices(mean);
    return least;
}

void CellSplitter::collect_vertices() {
    std::vector<VertexId>& v = centre_.vertices;
    v.clear();
    for (const Triangle& t : surface_)
        v.insert(v.end(), t.begin(), t.end());
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
}

glm::dvec3 CellSplitter::mean_of_vertices() const {
    glm::dvec3 sum(0.0);
    for (const VertexId v : centre_.vertices)
        sum += points_[v];
    return sum / static_cast<double>(centre_.vertices.size());
}

// Six times the volume between `apex` and a triangle.
double CellSplitter::volume_below(const Triangle& t, const glm::dvec3& apex) const {
    return glm::dot(glm::cross(points_[t[0]] - apex, points_[t[1]] - apex), points_[t[2]] - apex);
}

// Of the cell's volume; `start` where that is too close to 0 to divide by.
glm::dvec3 CellSplitter::centroid(const glm::dvec3& start) const {
    glm::dvec3 moment(0.0);
    double volume = 0.0;
    double size = 0.0;
    for (const Triangle& t : surface_) {
        const double part = volume_below(t, start);
        volume += part;
        size += std::abs(part);
        moment += 0.25 * part * ((points_[t[0]] - start) + (points_[t[1]] - start) + (points_[t[2]] - start));
    }
    return std::abs(volume) > 1e-6 * size ? start + moment / volume : start;
}

// Steps away from the plane of the triangle that is nearest in front or farthest behind, until all planes are behind by
// a margin (Agmon's and Motzkin's relaxation, 1954): finds a point that sees everything where there is one with that
// margin.
glm::dvec3 CellSplitter::relaxed(const glm::dvec3& start) const {
    double volume = 0.0;
    double area = 0.0;
    for (const Triangle& t : surface_) {
        volume += volume_below(t, start);
        area += glm::length(normal_of(t));
    }
    if (!(area > 0.0)) return start;
    const double inside = volume < 0.0 ? -1.0 : 1.0;
    glm::dvec3 point = start;
    double margin = 0.1 * std::abs(volume) / area;  // a tenth of a third of the radius of a ball of this shape
    for (int step = 0; step < 120; ++step) {
        if (step % 40 == 39) margin *= 0.1;
        double nearest = margin;
        glm::dvec3 away(0.0);
        for (const Triangle& t : surface_) {
            const glm::dvec3 normal = normal_of(t);
            const double length = glm::length(normal);
            if (!(length > 0.0)) continue;
            const double distance = inside * volume_below(t, point) / length;
            if (distance >= nearest) continue;
            nearest = distance;
            away = normal * (-inside / length);
        }
        if (nearest >= margin) break;
        point += 1.5 * (margin - nearest) * away;
    }
    return point;
}

glm::dvec3 CellSplitter::normal_of(const Triangle& t) const {
    return glm::cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
}

// The smallest weights (in the sum of squares) that make the centre the mean of the vertices: 1/n each for the mean
// itself, plus what is linear in the vertex's place. Fields that are linear in space are continued exactly.
void CellSplitter::weigh_vertices(const glm::dvec3& mean) {
    const double equal = 1.0 / static_cast<double>(centre_.vertices.size());
    centre_.weights.assign(centre_.vertices.size(), equal);
    if (centre_.position == mean) return;
    glm::dmat3 spread(0.0);
    for (const VertexId v : centre_.vertices)
        spread += glm::outerProduct(points_[v] - mean, points_[v] - mean);
    const glm::dvec3 slope = glm::inverse(spread) * (centre_.position - mean);
    for (std::size_t n = 0; n < centre_.vertices.size(); ++n)
        centre_.weights[n] += glm::dot(points_[centre_.vertices[n]] - mean, slope);
}

}  // namespace cellproj
