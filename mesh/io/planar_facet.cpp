// SPDX-License-Identifier: BSD-3-Clause
//
// Each polygon minus those directly within it: bridges make one chain of them (de Berg et al., Computational Geometry,
// 2008, section 3.1), whose ears are clipped (Meisters, Polygons Have Ears, American Mathematical Monthly 82(6), 1975).
#include "mesh/io/planar_facet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/predicates.hpp"

namespace cellproj {

namespace {

using Loop = std::vector<VertexId>;
using Triangles = std::vector<std::array<VertexId, 3>>;

// Twice the area times the unit normal (Newell).
glm::dvec3 area_vector(const std::vector<glm::dvec3>& points, const Loop& loop) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 2; i < loop.size(); ++i) {
        const glm::dvec3& first = points[loop[0]];
        sum += glm::cross(points[loop[i - 1]] - first, points[loop[i]] - first);
    }
    return sum;
}

int sign(double value) {
    return (value > 0.0) - (value < 0.0);
}

// The plane of the facet without one coordinate, so that the largest polygon turns counter-clockwise.
class Plane {
public:
    Plane(const std::vector<glm::dvec3>& points, const glm::dvec3& normal) : points_(points) {
        const glm::dvec3 n = glm::abs(normal);
        const int dropped = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
        u_ = (dropped + 1) % 3;
        v_ = (dropped + 2) % 3;
        if (normal[dropped] < 0.0) std::swap(u_, v_);
    }

    glm::dvec2 flat(const glm::dvec3& p) const { return {p[u_], p[v_]}; }
    glm::dvec2 at(VertexId v) const { return flat(points_[v]); }
    int turn(VertexId a, VertexId b, VertexId c) const { return sign(doubled_area(at(a), at(b), at(c))); }
    double area(const Loop& loop) const {
        double sum = 0.0;
        for (std::size_t i = 2; i < loop.size(); ++i)
            sum += doubled_area(at(loop[0]), at(loop[i - 1]), at(loop[i]));
        return sum;
    }

private:
    const std::vector<glm::dvec3>& points_;
    int u_ = 0, v_ = 1;
};

bool is_on_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    return doubled_area(a, b, p) == 0.0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
           std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

// +1 inside, −1 outside, 0 on the loop.
int side_of_loop(const Plane& plane, const Loop& loop, const glm::dvec2& p) {
    bool inside = false;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::dvec2 a = plane.at(loop[i]), b = plane.at(loop[(i + 1) % loop.size()]);
        if (is_on_segment(p, a, b)) return 0;
        if ((a.y > p.y) == (b.y > p.y)) continue;
        inside ^= (doubled_area(a, b, p) > 0.0) == (b.y > a.y);
    }
    return inside ? 1 : -1;
}

// Loops may touch: the first place of the inner one that is not on the outer one decides.
bool contains(const Plane& plane, const Loop& outer, const Loop& inner) {
    for (const VertexId v : inner) {
        if (const int side = side_of_loop(plane, outer, plane.at(v)); side != 0) return side > 0;
    }
    for (std::size_t i = 0; i < inner.size(); ++i) {
        const glm::dvec2 middle = 0.5 * (plane.at(inner[i]) + plane.at(inner[(i + 1) % inner.size()]));
        if (const int side = side_of_loop(plane, outer, middle); side != 0) return side > 0;
    }
    return false;
}

// Whether the open segment from a to b meets the edge from c to d elsewhere than in common ends.
bool is_blocked(const Plane& plane, VertexId a, VertexId b, VertexId c, VertexId d) {
    const glm::dvec2 pa = plane.at(a), pb = plane.at(b);
    const auto lies_between = [&](VertexId v) { return v != a && v != b && is_on_segment(plane.at(v), pa, pb); };
    if (lies_between(c) || lies_between(d)) return true;
    return plane.turn(a, b, c) * plane.turn(a, b, d) < 0 && plane.turn(c, d, a) * plane.turn(c, d, b) < 0;
}

// Whether a segment from vertex k of a chain to p starts into its inside, which is on the left.
bool starts_inside(const Plane& plane, const Loop& chain, std::size_t k, VertexId p) {
    const VertexId before = chain[(k + chain.size() - 1) % chain.size()], here = chain[k],
                   after = chain[(k + 1) % chain.size()];
    const bool left_of_in = plane.turn(before, here, p) > 0, left_of_out = plane.turn(here, after, p) > 0;
    return plane.turn(before, here, after) > 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
}

bool is_free(const Plane& plane, VertexId a, VertexId b, const std::vector<const Loop*>& obstacles) {
    return std::none_of(obstacles.begin(), obstacles.end(), [&](const Loop* loop) {
        for (std::size_t i = 0; i < loop->size(); ++i) {
            if (is_blocked(plane, a, b, (*loop)[i], (*loop)[(i + 1) % loop->size()])) return true;
        }
        return false;
    });
}

// The corners of a loop from `start` on, all around.
Loop turned(const Loop& loop, std::size_t start) {
    Loop result = loop;
    std::rotate(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(start), result.end());
    return result;
}

// Goes around a clockwise hole that shares a vertex with the chain before it goes on from there.
bool join_at_common_vertex(const Plane& plane, Loop& chain, const Loop& hole) {
    for (std::size_t k = 0; k < chain.size(); ++k) {
        const auto common = std::find(hole.begin(), hole.end(), chain[k]);
        if (common == hole.end()) continue;
        const Loop detour = turned(hole, static_cast<std::size_t>(common - hole.begin()));
        if (!starts_inside(plane, chain, k, detour[1])) continue;
        chain.insert(chain.begin() + static_cast<std::ptrdiff_t>(k), detour.begin(), detour.end());
        return true;
    }
    return false;
}

// Goes into the clockwise `hole` and back at the nearest vertex of the chain that its vertex `start` sees.
bool bridge(const Plane& plane, Loop& chain, const Loop& hole, std::size_t start,
            const std::vector<const Loop*>& other_holes) {
    const VertexId from = hole[start];
    const auto distance = [&](std::size_t k) {
        const glm::dvec2 d = plane.at(chain[k]) - plane.at(from);
        return glm::dot(d, d);
    };
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t k = 0; k < chain.size(); ++k)
        candidates.emplace_back(distance(k), k);
    std::sort(candidates.begin(), candidates.end());
    std::vector<const Loop*> obstacles = other_holes;
    obstacles.push_back(&chain);
    obstacles.push_back(&hole);
    for (const auto& [square, k] : candidates) {
        const VertexId to = chain[k];
        if (!starts_inside(plane, chain, k, from) || !is_free(plane, from, to, obstacles)) continue;
        Loop detour = turned(hole, start);
        detour.push_back(from);
        detour.push_back(to);
        chain.insert(chain.begin() + static_cast<std::ptrdiff_t>(k) + 1, detour.begin(), detour.end());
        return true;
    }
    return false;
}

bool is_ear(const Plane& plane, const Loop& chain, std::size_t k) {
    const VertexId a = chain[(k + chain.size() - 1) % chain.size()], b = chain[k], c = chain[(k + 1) % chain.size()];
    if (plane.turn(a, b, c) <= 0) return false;
    return std::none_of(chain.begin(), chain.end(), [&](VertexId v) {
        return v != a && v != b && v != c && plane.turn(a, b, v) >= 0 && plane.turn(b, c, v) >= 0 &&
               plane.turn(c, a, v) >= 0;
    });
}

bool clip_ears(const Plane& plane, Loop chain, Triangles& triangles) {
    std::size_t k = 0, rejected = 0;
    while (chain.size() > 2) {
        if (rejected == chain.size()) return false;
        k %= chain.size();
        if (!is_ear(plane, chain, k)) {
            ++k;
            ++rejected;
            continue;
        }
        triangles.push_back({chain[(k + chain.size() - 1) % chain.size()], chain[k], chain[(k + 1) % chain.size()]});
        chain.erase(chain.begin() + static_cast<std::ptrdiff_t>(k));
        rejected = 0;
        ++k;  // ears from all around: fans from one vertex would be slivers
    }
    return true;
}

bool triangulate_part(const Plane& plane, const Loop& outer, std::vector<Loop> inner, Triangles& triangles) {
    const auto right_end = [&](const Loop& loop) {
        return std::max_element(loop.begin(), loop.end(),
                                [&](VertexId a, VertexId b) { return plane.at(a).x < plane.at(b).x; });
    };
    // From right to left: the right end of each sees the chain, whatever lies further left.
    std::sort(inner.begin(), inner.end(),
              [&](const Loop& a, const Loop& b) { return plane.at(*right_end(a)).x > plane.at(*right_end(b)).x; });
    Loop chain = outer;
    for (std::size_t i = 0; i < inner.size(); ++i) {
        if (join_at_common_vertex(plane, chain, inner[i])) continue;
        std::vector<const Loop*> rest;
        for (std::size_t j = i + 1; j < inner.size(); ++j)
            rest.push_back(&inner[j]);
        const auto start = static_cast<std::size_t>(right_end(inner[i]) - inner[i].begin());
        if (!bridge(plane, chain, inner[i], start, rest)) return false;
    }
    return clip_ears(plane, std::move(chain), triangles);
}

}  // namespace

std::optional<std::vector<std::array<VertexId, 3>>> triangulate_facet(const std::vector<glm::dvec3>& points,
                                                                      const std::vector<std::vector<VertexId>>& loops,
                                                                      const std::vector<glm::dvec3>& holes) {
    glm::dvec3 normal(0.0);
    for (const Loop& loop : loops) {
        const glm::dvec3 area = area_vector(points, loop);
        if (glm::dot(area, area) > glm::dot(normal, normal)) normal = area;
    }
    if (!(glm::dot(normal, normal) > 0.0)) return std::nullopt;
    const Plane plane(points, normal);

    struct Part {
        Loop loop;  // counter-clockwise
        double area;
    };
    std::vector<Part> parts;
    for (Loop loop : loops) {
        const double area = plane.area(loop);
        if (area < 0.0) std::reverse(loop.begin(), loop.end());
        parts.push_back({std::move(loop), std::abs(area)});
    }
    std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.area > b.area; });

    // The parent of a loop is the smallest one around it.
    std::vector<std::vector<std::size_t>> children(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (std::size_t j = i; j-- > 0;) {
            if (!contains(plane, parts[j].loop, parts[i].loop)) continue;
            children[j].push_back(i);
            break;
        }
    }
    const auto holds = [&](std::size_t i, const glm::dvec2& p) { return side_of_loop(plane, parts[i].loop, p) > 0; };
    const auto is_empty = [&](std::size_t i) {
        return std::any_of(holes.begin(), holes.end(), [&](const glm::dvec3& hole) {
            const glm::dvec2 p = plane.flat(hole);
            return holds(i, p) && std::none_of(children[i].begin(), children[i].end(),
                                               [&](std::size_t child) { return holds(child, p); });
        });
    };
    Triangles triangles;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (is_empty(i)) continue;
        std::vector<Loop> inner;
        for (const std::size_t child : children[i])
            inner.emplace_back(parts[child].loop.rbegin(), parts[child].loop.rend());
        if (!triangulate_part(plane, parts[i].loop, std::move(inner), triangles)) return std::nullopt;
    }
    return triangles;
}

}  // namespace cellproj
