// SPDX-License-Identifier: BSD-3-Clause
#include "sort/boundary_overlaps.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace cellproj {

namespace {

using Triangle = std::array<glm::dvec3, 3>;

// A boundary face that is seen from one side.
struct SeenFace {
    Triangle corners;  // clockwise as seen from the eye: the eye is on the negative side
    CellId cell;
    bool is_entry;  // seen from the back: the cell begins here and goes on towards the eye
};

std::vector<SeenFace> seen_faces(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const Eye& eye) {
    std::vector<SeenFace> faces(boundary.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, boundary.size(), 1024), [&](const Range& range) {
        for (std::size_t b = range.begin(); b != range.end(); ++b) {
            const CellId cell = boundary[b].cell;
            const auto v = face_vertices(mesh.tets[cell], boundary[b].face);
            const auto& t = mesh.tets[cell];
            SeenFace& face = faces[b];
            face = {{mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]]}, no_cell, false};
            const int side = side_of_plane(eye, face.corners[0], face.corners[1], face.corners[2]);
            if (side == 0) continue;  // no ray crosses it
            if (side > 0) std::swap(face.corners[1], face.corners[2]);
            face.cell = cell;
            face.is_entry = side * orientation(mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]], mesh.points[t[3]]) < 0;
        }
    });
    std::erase_if(faces, [](const SeenFace& face) { return face.cell == no_cell; });
    return faces;
}

// ---- Parts of faces ----

// A triangle clipped by up to four planes. Each adds a corner; where rounding makes heights change sign more than twice, half as many as
// there are: 3, 4, 6, 9, 13.
class Polygon {
public:
    void add(const glm::dvec3& corner) {
        assert(size_ < corners_.size());
        corners_[size_++] = corner;
    }
    std::size_t size() const { return size_; }
    const glm::dvec3* begin() const { return corners_.data(); }
    const glm::dvec3* end() const { return corners_.data() + size_; }

    // What lies where height(point), a linear function, is not negative.
    template <class Height>
    Polygon clipped(Height height) const {
        Polygon rest;
        for (std::size_t i = 0; i < size_; ++i) {
            const glm::dvec3 &p = corners_[i], &q = corners_[(i + 1) % size_];
            const double hp = height(p), hq = height(q);
            if (hp >= 0) rest.add(p);
            if ((hp > 0 && hq < 0) || (hp < 0 && hq > 0)) rest.add(p + hp / (hp - hq) * (q - p));
        }
        return rest;
    }

private:
    std::array<glm::dvec3, 16> corners_;
    std::size_t size_ = 0;
};

// ---- Which of two faces is in front ----

// Sides of the plane through the eye and the edge k of a face; inside the face's cone all are negative.
int edge_side(const Eye& eye, const Triangle& t, std::size_t k, const glm::dvec3& point) {
    return side_of_plane(eye, t[k], t[(k + 1) % 3], point);
}

// Sides of the edges of `a` (rows) for the corners of `b`.
using EdgeSides = std::array<std::array<int, 3>, 3>;
EdgeSides edge_sides(const Eye& eye, const Triangle& a, const Triangle& b) {
    EdgeSides sides;
    for (std::size_t edge = 0; edge < 3; ++edge) {
        for (std::size_t k = 0; k < 3; ++k)
            sides[edge][k] = edge_side(eye, a, edge, b[k]);
    }
    return sides;
}

// Whether an edge of the one has all corners of the other on its outer side.
bool separated(const EdgeSides& sides) {
    return std::any_of(sides.begin(), sides.end(), [](const auto& row) { return row[0] >= 0 && row[1] >= 0 && row[2] >= 0; });
}

// −1: all corners of `b` lie beyond the plane of `a` or in it; +1: on the eye's side or in it; 0: on both sides; 2: all in it.
int side_of_face(const Triangle& a, const Triangle& b) {
    bool beyond = false, before = false;
    for (const glm::dvec3& p : b) {
        const int side = -orientation(a[0], a[1], a[2], p);  // the eye is on the negative side
        beyond = beyond || side < 0;
        before = before || side > 0;
    }
    return beyond && before ? 0 : beyond ? -1 : before ? 1 : 2;
}

// Where the cones of both overlap, by rounded values: the sign of how much nearer `g` is than `f`; 0 without overlap.
int nearer_by_rounded_values(const Eye& eye, const Triangle& f, const Triangle& g) {
    // Clip f with the planes through the eye and the edges of g.
    Polygon part;
    for (const glm::dvec3& p : f)
        part.add(p);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 &a = g[k], &b = g[(k + 1) % 3];
        const glm::dvec3 n = eye.at_infinity ? glm::cross(b - a, eye.xyz) : glm::cross(a - eye.xyz, b - eye.xyz);
        part = part.clipped([&](const glm::dvec3& p) { return glm::dot(n, p - a); });
    }
    if (part.size() < 3) return 0;
    glm::dvec3 middle(0);
    for (const glm::dvec3& p : part)
        middle += p / static_cast<double>(part.size());
    const glm::dvec3 n = glm::cross(g[1] - g[0], g[2] - g[0]);
    const double height = glm::dot(n, middle - g[0]);  // positive: beyond g
    return height > 0 ? 1 : height < 0 ? -1 : 0;
}

// Whether face `f`, where it overlaps face `g` as seen from the eye, lies behind it. False where they do not overlap.
bool is_behind(const Eye& eye, const Triangle& f, const Triangle& g) {
    const EdgeSides of_f = edge_sides(eye, f, g);  // the corners of g at the edges of f
    if (separated(of_f)) return false;
    const EdgeSides of_g = edge_sides(eye, g, f);
    if (separated(of_g)) return false;

    // One of them on one side of the other's plane: nearly always. In one plane they touch, and f is left where g is entered.
    const int f_at_g = side_of_face(g, f);
    if (f_at_g != 0) return f_at_g != 1;
    const int g_at_f = side_of_face(f, g);
    if (g_at_f != 0) return g_at_f != -1;

    // Each crosses the plane of the other, not the other itself. Any corner of their overlap tells.
    const auto inside = [](const EdgeSides& sides, std::size_t k) { return sides[0][k] < 0 && sides[1][k] < 0 && sides[2][k] < 0; };
    for (std::size_t k = 0; k < 3; ++k) {
        if (inside(of_g, k)) {
            if (const int s = orientation(g[0], g[1], g[2], f[k])) return s > 0;
        }
        if (inside(of_f, k)) {
            if (const int s = orientation(f[0], f[1], f[2], g[k])) return s < 0;
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t i1 = (i + 1) % 3, k1 = (k + 1) % 3;
            if (of_f[i][k] * of_f[i][k1] >= 0 || of_g[k][i] * of_g[k][i1] >= 0) continue;
            // The planes through the eye and the two edges meet in a line, of which one may hold a point before the eye and the
            // other one behind it. With p, q and r, s relative to the eye: (p×q)×(r×s) = det(p,r,s)·q − det(q,r,s)·p
            // = det(p,q,s)·r − det(p,q,r)·s, so the sign of det(p,r,s) says on which end of the line p q crosses, that of
            // det(p,q,s) says it for r s.
            if (!eye.at_infinity && of_g[k][i] != of_f[i][k1]) continue;
            // Edge k of g passes edge i of f on the side of the plane (f[i], f[i1], g[k]) that g[k1] is on.
            if (const int s = orientation(f[i], f[i1], g[k], g[k1])) return of_f[i][k] * s > 0;
        }
    }
    return nearer_by_rounded_values(eye, f, g) > 0;
}

// ---- Which faces can overlap ----

struct Box {
    glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec2& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    bool empty() const { return !(low.x <= high.x); }
    bool meets(const Box& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y;
    }
};

// Boxes are wider by this share, more than any rounding of what is seen: a face is missed by no ray.
constexpr double margin = 1e-9;

// What a face covers of one side of a cube round the eye (in its own frame: z towards the side, |x|, |y| ≤ z), or of the plane across
// a parallel view.
Box seen_box(const Eye& eye, const glm::dmat3& to_frame, const Triangle& corners) {
    Box box;
    if (eye.at_infinity) {
        for (const glm::dvec3& p : corners)
            box.add(glm::dvec2(to_frame * p));
        return box;
    }
    Polygon part;
    for (const glm::dvec3& p : corners)
        part.add(to_frame * (p - eye.xyz));
    for (const glm::dvec3& side : {glm::dvec3(1, 0, 1 + margin), glm::dvec3(-1, 0, 1 + margin), glm::dvec3(0, 1, 1 + margin),
                                   glm::dvec3(0, -1, 1 + margin)})
        part = part.clipped([&](const glm::dvec3& p) { return glm::dot(side, p); });
    for (const glm::dvec3& p : part) {
        // The apex, where an edge of the face passes by the eye closer than rounding: all directions.
        if (p.z > 0) box.add(glm::clamp(glm::dvec2(p) / p.z, -1.0 - 2 * margin, 1.0 + 2 * margin));
        else box = {glm::dvec2(-1), glm::dvec2(1)};
    }
    return box;
}

// Frames whose z axes look where faces may be seen.
std::vector<glm::dmat3> frames(const Eye& eye, const TetMesh& mesh) {
    const glm::dvec3 ahead = eye.at_infinity ? -eye.xyz : bounds(mesh.points).center() - eye.xyz;
    const glm::dvec3 z = glm::dot(ahead, ahead) > 0 ? glm::normalize(ahead) : glm::dvec3(0, 0, 1);
    const glm::dvec3 a = glm::abs(z);
    const glm::dvec3 least = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0) : a.y <= a.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 x = glm::normalize(glm::cross(z, least)), y = glm::cross(z, x);
    const auto rows = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) { return glm::transpose(glm::dmat3(p, q, r)); };
    if (eye.at_infinity) return {rows(x, y, z)};
    return {rows(x, y, z), rows(y, x, -z), rows(y, z, x), rows(z, y, -x), rows(z, x, y), rows(x, z, -y)};
}

// A grid over the boxes of some faces, and each pair of boxes once that meet.
class PairGrid {
public:
    explicit PairGrid(std::vector<Box> boxes) : boxes_(std::move(boxes)) {
        Box all;
        std::size_t seen = 0;
        for (const Box& box : boxes_) {
            if (box.empty()) continue;
            all.add(box.low);
            all.add(box.high);
            ++seen;
        }
        if (seen == 0) return;
        side_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(seen))), 1, 1024);
        const glm::dvec2 pad = margin * (all.high - all.low);
        for (Box& box : boxes_) {
            if (box.empty()) continue;
            box.low -= pad;
            box.high += pad;
        }
        low_ = all.low;
        for (int k = 0; k < 2; ++k)
            scale_[k] = all.high[k] > all.low[k] ? side_ / (all.high[k] - all.low[k]) : 0.0;
        const auto squares = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
        starts_.assign(squares + 1, 0);
        for (const Box& box : boxes_)
            visit(box, [&](std::size_t square) { ++starts_[square + 1]; });
        std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
        members_.resize(starts_.back());
        std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
        for (std::uint32_t f = 0; f < boxes_.size(); ++f)
            visit(boxes_[f], [&](std::size_t square) { members_[next[square]++] = f; });
    }

    std::size_t squares() const { return starts_.empty() ? 0 : starts_.size() - 1; }
    std::span<const std::uint32_t> in(std::size_t square) const {
        return std::span(members_).subspan(starts_[square], starts_[square + 1] - starts_[square]);
    }
    // Whether two boxes meet, and this is the square of their first common corner.
    bool meet_first(std::uint32_t f, std::uint32_t g, std::size_t square) const {
        if (!boxes_[f].meets(boxes_[g])) return false;
        const glm::dvec2 corner = glm::max(boxes_[f].low, boxes_[g].low);
        return static_cast<std::size_t>(line(corner.y, 1) * side_ + line(corner.x, 0)) == square;
    }

private:
    int line(double x, int k) const { return static_cast<int>(std::clamp((x - low_[k]) * scale_[k], 0.0, side_ - 1.0)); }

    template <class Visit>
    void visit(const Box& box, Visit visit_square) const {
        if (box.empty()) return;
        for (int j = line(box.low.y, 1); j <= line(box.high.y, 1); ++j) {
            for (int i = line(box.low.x, 0); i <= line(box.high.x, 0); ++i)
                visit_square(static_cast<std::size_t>(j * side_ + i));
        }
    }

    std::vector<Box> boxes_;
    int side_ = 0;  // squares per side
    glm::dvec2 low_{0.0}, scale_{0.0};
    std::vector<std::size_t> starts_;
    std::vector<std::uint32_t> members_;
};

}  // namespace

std::vector<OrderArc> boundary_overlaps(const TetMesh& mesh, std::span<const BoundaryFace> boundary, const Eye& eye) {
    const std::vector<SeenFace> faces = seen_faces(mesh, boundary, eye);
    oneapi::tbb::enumerable_thread_specific<std::vector<OrderArc>> found;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    for (const glm::dmat3& frame : frames(eye, mesh)) {
        std::vector<Box> boxes(faces.size());
        oneapi::tbb::parallel_for(Range(0, faces.size(), 1024), [&](const Range& range) {
            for (std::size_t f = range.begin(); f != range.end(); ++f)
                boxes[f] = seen_box(eye, frame, faces[f].corners);
        });
        const PairGrid grid(std::move(boxes));
        oneapi::tbb::parallel_for(Range(0, grid.squares(), 16), [&](const Range& range) {
            auto& arcs = found.local();
            for (std::size_t square = range.begin(); square != range.end(); ++square) {
                for (const std::uint32_t f : grid.in(square)) {
                    if (faces[f].is_entry) continue;
                    for (const std::uint32_t g : grid.in(square)) {
                        if (!faces[g].is_entry || faces[f].cell == faces[g].cell || !grid.meet_first(f, g, square)) continue;
                        if (is_behind(eye, faces[f].corners, faces[g].corners)) arcs.push_back({faces[f].cell, faces[g].cell});
                    }
                }
            }
        });
    }
    std::vector<OrderArc> arcs;
    for (const auto& some : found)
        arcs.insert(arcs.end(), some.begin(), some.end());
    std::sort(arcs.begin(), arcs.end());
    arcs.erase(std::unique(arcs.begin(), arcs.end()), arcs.end());
    return arcs;
}

}  // namespace cellproj
