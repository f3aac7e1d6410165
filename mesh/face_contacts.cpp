// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/face_contacts.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "mesh/box_tree.hpp"

namespace cellproj {

namespace {

struct Face {
    std::array<VertexId, 3> places;  // counter-clockwise from outside the cell, the lowest first
    CellId cell;
    VertexId apex;  // the cell's vertex that is not on the face

    std::array<VertexId, 3> key() const {
        return {places[0], std::min(places[1], places[2]), std::max(places[1], places[2])};
    }
    bool degenerate() const { return places[0] == places[1] || places[0] == places[2] || places[1] == places[2]; }
};

std::vector<Face> usable_faces(const TetMesh& mesh, std::span<const BoundaryFace> boundary, std::span<const VertexId> places) {
    std::vector<Face> faces;
    faces.reserve(boundary.size());
    for (const auto& [cell, face] : boundary) {
        auto v = face_vertices(mesh.tets[cell], face);
        for (VertexId& x : v) x = places[x];
        std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
        const Face usable{v, cell, mesh.tets[cell][static_cast<std::size_t>(face)]};
        if (!usable.degenerate()) faces.push_back(usable);
    }
    return faces;
}

// ---- Faces with the same three places ----

// Moves these from `faces` to the result.
void match_by_place(std::vector<Face>& faces, FaceContacts& result) {
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
        return std::pair(a.key(), a.cell) < std::pair(b.key(), b.cell);
    });
    std::vector<Face> alone;
    for (auto run = faces.begin(); run != faces.end();) {
        const auto end = std::find_if(run, faces.end(), [&](const Face& f) { return f.key() != run->key(); });
        for (auto other = run + 1; other != end; ++other) {
            (other->places == run->places ? result.doubled : result.seams).push_back(run->cell);
        }
        if (end == run + 1) alone.push_back(*run);
        run = end;
    }
    faces = std::move(alone);
}

// ---- Quadrangles cut along different diagonals, planar or not ----

struct EdgeUse {
    std::array<VertexId, 2> edge;  // ascending
    std::uint32_t face;
    VertexId apex;  // the third corner

    bool operator<(const EdgeUse& o) const { return std::pair(edge, face) < std::pair(o.edge, o.face); }
};

struct Quadrangle {
    std::array<VertexId, 4> corners;   // ascending
    std::array<VertexId, 2> diagonal;  // the edge between its two faces
    std::array<VertexId, 2> apices;
    std::array<std::uint32_t, 2> faces;
};

std::vector<Quadrangle> quadrangles(const std::vector<Face>& faces) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * faces.size());
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId a = faces[f].places[k], b = faces[f].places[(k + 1) % 3];
            uses.push_back({{std::min(a, b), std::max(a, b)}, f, faces[f].places[(k + 2) % 3]});
        }
    }
    std::sort(uses.begin(), uses.end());
    std::vector<Quadrangle> result;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        for (std::size_t j = i + 1; j < uses.size() && uses[j].edge == uses[i].edge; ++j) {
            const bool one_cell = faces[uses[i].face].cell == faces[uses[j].face].cell;  // then the cell is the quadrangle
            if (one_cell || uses[i].apex == uses[j].apex) continue;
            Quadrangle q{{uses[i].edge[0], uses[i].edge[1], uses[i].apex, uses[j].apex},
                         uses[i].edge,
                         {uses[i].apex, uses[j].apex},
                         {uses[i].face, uses[j].face}};
            std::sort(q.corners.begin(), q.corners.end());
            result.push_back(q);
        }
    }
    return result;
}

glm::dvec3 normal(const TetMesh& mesh, const Face& f) {
    const glm::dvec3& a = mesh.points[f.places[0]];
    return glm::cross(mesh.points[f.places[1]] - a, mesh.points[f.places[2]] - a);
}

// Whether the two cuts of four corners face each other and pass closely; otherwise a tetrahedron is missing there.
bool one_face_cut_twice(const TetMesh& mesh, const std::vector<Face>& faces, const Quadrangle& q, const Quadrangle& r) {
    const auto normal_of = [&](const Quadrangle& x) { return normal(mesh, faces[x.faces[0]]) + normal(mesh, faces[x.faces[1]]); };
    if (glm::dot(normal_of(q), normal_of(r)) >= 0.0) return false;
    const glm::dvec3& a = mesh.points[q.diagonal[0]];
    const glm::dvec3& c = mesh.points[q.apices[0]];
    const glm::dvec3 u = mesh.points[q.diagonal[1]] - a, v = mesh.points[q.apices[1]] - c;
    const glm::dvec3 across = glm::cross(u, v);
    const double distance = std::abs(glm::dot(c - a, across)) / glm::length(across);
    return distance <= 0.25 * std::max(glm::length(u), glm::length(v));
}

// Marks the faces of such quadrangles.
void find_crossed_quadrangles(const TetMesh& mesh, const std::vector<Face>& faces, std::vector<char>& crossing) {
    std::vector<Quadrangle> all = quadrangles(faces);
    std::sort(all.begin(), all.end(), [](const Quadrangle& a, const Quadrangle& b) { return a.corners < b.corners; });
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size() && all[j].corners == all[i].corners; ++j) {
            auto apices = all[i].apices;
            std::sort(apices.begin(), apices.end());
            if (all[j].diagonal != apices || !one_face_cut_twice(mesh, faces, all[i], all[j])) continue;
            for (const std::uint32_t f : all[i].faces) crossing[f] = 1;
            for (const std::uint32_t f : all[j].faces) crossing[f] = 1;
        }
    }
}

// ---- Faces that lie on each other with any corners ----

using Corners = std::array<glm::dvec3, 3>;

double longest_edge(const Corners& c) {
    return std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
}

// A polygon of few corners without memory of its own: a triangle clipped by three lines has at most six.
struct Polygon {
    std::array<glm::dvec3, 8> corners;
    std::size_t size = 0;

    void add(const glm::dvec3& p) { corners[size++] = p; }
};

// Signed distance in the plane of x and y from the line a → b, positive to its left.
double left_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
    const glm::dvec2 along = glm::dvec2(b) - glm::dvec2(a), to = glm::dvec2(p) - glm::dvec2(a);
    return (along.x * to.y - along.y * to.x) / glm::length(along);
}

// What of `polygon` lies left of the line a → b (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, const glm::dvec3& a, const glm::dvec3& b) {
    Polygon result;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const glm::dvec3& p = polygon.corners[i];
        const glm::dvec3& q = polygon.corners[(i + 1) % polygon.size];
        const double dp = left_of(a, b, p), dq = left_of(a, b, q);
        if (dp >= 0.0) result.add(p);
        if ((dp < 0.0) != (dq < 0.0)) result.add(p + dp / (dp - dq) * (q - p));
    }
    return result;
}

// Its area in the plane of x and y is more than a strip of the given width has around its outline.
bool wider_than(const Polygon& polygon, double width) {
    double doubled_area = 0.0, outline = 0.0;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const glm::dvec2 p = polygon.corners[i] - polygon.corners[0];
        const glm::dvec2 q = polygon.corners[(i + 1) % polygon.size] - polygon.corners[0];
        doubled_area += p.x * q.y - p.y * q.x;
        outline += glm::distance(p, q);
    }
    return polygon.size >= 3 && std::abs(doubled_area) > 2.0 * width * outline;
}

struct Meeting {
    enum class Kind { none, same_corners, same_side, hanging, crossing } kind = Kind::none;
    std::array<bool, 3> hangs_of_a{}, hangs_of_b{};  // corners of each that hang in the other
};

// Corners of `p` in or on the triangle `q`, but at none of its corners. In the plane of x and y, `q` counter-clockwise.
std::array<bool, 3> hanging_in(const Corners& p, const Corners& q, double tolerance) {
    std::array<bool, 3> hangs{};
    for (std::size_t i = 0; i < 3; ++i) {
        hangs[i] = true;
        for (std::size_t k = 0; k < 3; ++k) {
            hangs[i] = hangs[i] && left_of(q[k], q[(k + 1) % 3], p[i]) >= -tolerance &&
                       glm::distance(glm::dvec2(p[i]), glm::dvec2(q[k])) > tolerance;
        }
    }
    return hangs;
}

bool same_corners(const Corners& p, const Corners& q, double tolerance) {
    return std::all_of(p.begin(), p.end(), [&](const glm::dvec3& a) {
        return std::any_of(q.begin(), q.end(), [&](const glm::dvec3& b) { return glm::distance(a, b) <= tolerance; });
    });
}

double height(const Corners& face, const glm::dvec3& p) {
    return glm::dot(glm::normalize(glm::cross(face[1] - face[0], face[2] - face[0])), p - face[0]);
}

// Two faces, counter-clockwise from outside their cells, whose other vertices are the apices.
Meeting meet(const Corners& a, const glm::dvec3& apex_a, const Corners& b, const glm::dvec3& apex_b, double tolerance) {
    // A's frame: its first edge along x, outside along z. Differences come first: no digits are lost far from the origin.
    const glm::dvec3 x = glm::normalize(a[1] - a[0]);
    const glm::dvec3 z = glm::normalize(glm::cross(a[1] - a[0], a[2] - a[0]));
    const glm::dvec3 y = glm::cross(z, x);
    const auto local = [&](const glm::dvec3& p) {
        const glm::dvec3 d = p - a[0];
        return glm::dvec3(glm::dot(d, x), glm::dot(d, y), glm::dot(d, z));
    };
    const Corners p{local(a[0]), local(a[1]), local(a[2])};
    Corners q{local(b[0]), local(b[1]), local(b[2])};
    const double rise_b = local(apex_b).z, rise_a = height(b, apex_a);
    const bool against = rise_a > tolerance && rise_b > tolerance;    // the cells lie on both sides
    const bool together = rise_a < -tolerance && rise_b < -tolerance;  // on one
    if (!against && !together) return {};

    Polygon overlap;
    for (const glm::dvec3& corner : q) overlap.add(corner);
    for (std::size_t k = 0; k < 3 && overlap.size > 0; ++k) overlap = clipped(overlap, p[k], p[(k + 1) % 3]);
    if (!wider_than(overlap, tolerance)) return {};
    for (std::size_t i = 0; i < overlap.size; ++i) {
        if (std::abs(overlap.corners[i].z) > tolerance) return {};
    }
    using Kind = Meeting::Kind;
    if (together) return {Kind::same_side, {}, {}};
    if (same_corners(q, p, tolerance)) return {Kind::same_corners, {}, {}};
    const auto of_b = hanging_in(q, p, tolerance);
    std::swap(q[1], q[2]);  // B turns clockwise in A's frame
    Meeting result{Kind::crossing, hanging_in(p, q, tolerance), of_b};
    const auto any = [](const std::array<bool, 3>& hangs) { return hangs[0] || hangs[1] || hangs[2]; };
    if (any(result.hangs_of_a) || any(of_b)) result.kind = Kind::hanging;
    return result;
}

struct FacePair {
    std::size_t a, b;
    Meeting meeting;
};

class OverlapSearch {
public:
    OverlapSearch(const TetMesh& mesh, const std::vector<Face>& faces)
        : mesh_(mesh), faces_(faces), tolerances_(tolerances()), tree_(boxes()) {}

    // All pairs a < b that lie on each other, ascending in a.
    std::vector<FacePair> pairs() const {
        using Range = oneapi::tbb::blocked_range<std::size_t>;
        return oneapi::tbb::parallel_reduce(
            Range(0, faces_.size(), 256), std::vector<FacePair>(),
            [this](const Range& range, std::vector<FacePair> found) {
                for (std::size_t a = range.begin(); a != range.end(); ++a) append_pairs_of(a, found);
                return found;
            },
            [](std::vector<FacePair> left, const std::vector<FacePair>& right) {
                left.insert(left.end(), right.begin(), right.end());
                return left;
            });
    }

private:
    Corners corners(std::size_t f) const {
        const auto& v = faces_[f].places;
        return {mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]]};
    }

    std::vector<double> tolerances() const {
        const double rounding = coordinate_rounding(mesh_.points);
        std::vector<double> result(faces_.size());
        for (std::size_t f = 0; f < faces_.size(); ++f) result[f] = contact_tolerance(longest_edge(corners(f)), rounding);
        return result;
    }

    Bounds box(std::size_t f) const {
        const Corners c = corners(f);
        Bounds result = bounds({c[0], c[1], c[2]});
        result.low -= tolerances_[f];
        result.high += tolerances_[f];
        return result;
    }

    std::vector<Bounds> boxes() const {
        std::vector<Bounds> result(faces_.size());
        for (std::size_t f = 0; f < faces_.size(); ++f) result[f] = box(f);
        return result;
    }

    void append_pairs_of(std::size_t a, std::vector<FacePair>& found) const {
        const glm::dvec3 normal_a = normal(mesh_, faces_[a]);
        const double length_a = glm::length(normal_a);
        if (length_a == 0.0) return;
        tree_.visit_touching(box(a), [&](std::size_t b) {
            if (b <= a || faces_[a].cell == faces_[b].cell) return;
            const glm::dvec3 normal_b = normal(mesh_, faces_[b]);
            // Faces that lie on each other within the tolerance and are wider than it lie flat on each other; those of slivers
            // may be turned by more, so half a right angle is allowed.
            if (std::abs(glm::dot(normal_a, normal_b)) <= 0.7 * length_a * glm::length(normal_b)) return;
            const Meeting meeting = meet(corners(a), mesh_.points[faces_[a].apex], corners(b), mesh_.points[faces_[b].apex],
                                         std::min(tolerances_[a], tolerances_[b]));
            if (meeting.kind != Meeting::Kind::none) found.push_back({a, b, meeting});
        });
    }

    const TetMesh& mesh_;
    const std::vector<Face>& faces_;
    std::vector<double> tolerances_;
    BoxTree tree_;
};

void sort_unique(std::vector<VertexId>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

}  // namespace

double coordinate_rounding(std::span<const glm::dvec3> points) {
    double largest = 0.0;
    bool single = true;
    for (const glm::dvec3& p : points) {
        for (int k = 0; k < 3; ++k) {
            largest = std::max(largest, std::abs(p[k]));
            single = single && static_cast<double>(static_cast<float>(p[k])) == p[k];
        }
    }
    const double epsilon = single ? double{std::numeric_limits<float>::epsilon()} : std::numeric_limits<double>::epsilon();
    return 0.5 * epsilon * largest;
}

double contact_tolerance(double edge, double rounding) {
    return std::min(1e-6 * edge + 4.0 * rounding, 0.01 * edge);
}

FaceContacts find_face_contacts(const TetMesh& mesh, std::span<const BoundaryFace> boundary,
                                std::span<const VertexId> places) {
    FaceContacts result;
    std::vector<Face> faces = usable_faces(mesh, boundary, places);
    match_by_place(faces, result);
    std::vector<char> crossing(faces.size(), 0), hanging(faces.size(), 0);
    find_crossed_quadrangles(mesh, faces, crossing);
    for (const auto& [a, b, meeting] : OverlapSearch(mesh, faces).pairs()) {
        const CellId lower = std::min(faces[a].cell, faces[b].cell);
        switch (meeting.kind) {
            case Meeting::Kind::none: break;
            case Meeting::Kind::same_corners: result.seams.push_back(lower); break;
            case Meeting::Kind::same_side: result.doubled.push_back(lower); break;
            case Meeting::Kind::crossing: crossing[a] = crossing[b] = 1; break;
            case Meeting::Kind::hanging:
                hanging[a] = hanging[b] = 1;
                for (std::size_t k = 0; k < 3; ++k) {
                    if (meeting.hangs_of_a[k]) result.hanging.push_back(faces[a].places[k]);
                    if (meeting.hangs_of_b[k]) result.hanging.push_back(faces[b].places[k]);
                }
        }
    }
    // Faces of grids that do not match cross each other, too; their hanging points say it all.
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (crossing[f] && !hanging[f]) result.crossing.push_back(faces[f].cell);
    }
    std::sort(result.seams.begin(), result.seams.end());
    sort_unique(result.doubled);
    sort_unique(result.hanging);
    std::sort(result.crossing.begin(), result.crossing.end());
    return result;
}

}  // namespace cellproj
