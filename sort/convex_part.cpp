// SPDX-License-Identifier: BSD-3-Clause
#include "sort/convex_part.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace cellproj {

namespace {

constexpr double on_plane = 1e-13;         // of the largest height
constexpr double least_volume = 1e-15;     // of the cell's
constexpr auto none = std::numeric_limits<std::uint32_t>::max();

// The height of each vertex, 0 where it lies in the plane.
std::vector<double> vertex_heights(const ConvexPart& part, const CornerHeights& h) {
    const glm::dvec4 corner(h[0], h[1], h[2], h[3]);
    const double tolerance =
        on_plane * std::max(std::max(std::abs(h[0]), std::abs(h[1])), std::max(std::abs(h[2]), std::abs(h[3])));
    std::vector<double> heights;
    heights.reserve(part.vertices.size());
    for (const glm::dvec4& w : part.vertices) {
        const double height = glm::dot(w, corner);
        heights.push_back(std::abs(height) > tolerance ? height : 0.0);
    }
    return heights;
}

// The vertices of a cut, which lie in one plane and in convex position, in turn: by their angle about the middle. An affine map
// of the plane, such as weights are, keeps the turn.
std::vector<std::uint32_t> in_turn(std::vector<std::uint32_t> loop, const std::vector<glm::dvec4>& vertices) {
    glm::dvec4 middle(0);
    for (const auto v : loop)
        middle += vertices[v] / static_cast<double>(loop.size());
    const auto longest = [&](const auto& vector) {
        glm::dvec4 best(0);
        for (const auto v : loop) {
            const glm::dvec4 candidate = vector(vertices[v] - middle);
            if (glm::dot(candidate, candidate) > glm::dot(best, best)) best = candidate;
        }
        const double length = glm::length(best);
        return length > 0 ? best / length : best;
    };
    const glm::dvec4 x = longest([](const glm::dvec4& d) { return d; });
    const glm::dvec4 y = longest([&](const glm::dvec4& d) { return d - glm::dot(d, x) * x; });
    std::vector<std::pair<double, std::uint32_t>> by_angle;
    for (const auto v : loop) {
        const glm::dvec4 d = vertices[v] - middle;
        by_angle.emplace_back(std::atan2(glm::dot(d, y), glm::dot(d, x)), v);
    }
    std::sort(by_angle.begin(), by_angle.end());
    for (std::size_t i = 0; i < loop.size(); ++i)
        loop[i] = by_angle[i].second;
    return loop;
}

// Drops the vertices that no face uses and renumbers the others.
ConvexPart compact(const std::vector<glm::dvec4>& vertices, std::vector<std::vector<std::uint32_t>> faces) {
    ConvexPart part;
    std::vector<std::uint32_t> label(vertices.size(), none);
    for (auto& face : faces) {
        for (auto& v : face) {
            if (label[v] == none) {
                label[v] = static_cast<std::uint32_t>(part.vertices.size());
                part.vertices.push_back(vertices[v]);
            }
            v = label[v];
        }
    }
    part.faces = std::move(faces);
    return part;
}

}  // namespace

ConvexPart whole_cell() {
    return {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
}

PlaneSides sides(const ConvexPart& part, const CornerHeights& heights) {
    PlaneSides found{false, false};
    for (const double height : vertex_heights(part, heights)) {
        found.below = found.below || height < 0;
        found.above = found.above || height > 0;
    }
    return found;
}

CutPart cut(const ConvexPart& part, const CornerHeights& corner_heights) {
    std::vector<double> heights = vertex_heights(part, corner_heights);
    std::vector<glm::dvec4> vertices = part.vertices;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings;  // of edges, both ways the same
    const auto crossing = [&](std::uint32_t a, std::uint32_t b) {
        if (b < a) std::swap(a, b);
        const auto [place, is_new] = crossings.try_emplace({a, b}, static_cast<std::uint32_t>(vertices.size()));
        if (is_new) {
            const double share = heights[a] / (heights[a] - heights[b]);
            vertices.push_back((1 - share) * vertices[a] + share * vertices[b]);
        }
        return place->second;
    };

    std::array<std::vector<std::vector<std::uint32_t>>, 2> faces;  // below, above
    std::vector<std::uint32_t> rim;                               // vertices of the cut
    for (const auto& face : part.faces) {
        std::array<std::vector<std::uint32_t>, 2> loops;
        for (std::size_t i = 0; i < face.size(); ++i) {
            const std::uint32_t v = face[i], w = face[(i + 1) % face.size()];
            if (heights[v] <= 0) loops[0].push_back(v);
            if (heights[v] >= 0) loops[1].push_back(v);
            if (heights[v] == 0) rim.push_back(v);
            if ((heights[v] < 0 && heights[w] > 0) || (heights[v] > 0 && heights[w] < 0)) {
                const std::uint32_t x = crossing(v, w);
                loops[0].push_back(x);
                loops[1].push_back(x);
                rim.push_back(x);
            }
        }
        for (std::size_t side : {0U, 1U}) {
            if (loops[side].size() >= 3) faces[side].push_back(std::move(loops[side]));
        }
    }
    std::sort(rim.begin(), rim.end());
    rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
    if (rim.size() >= 3) {
        rim = in_turn(std::move(rim), vertices);
        faces[0].push_back(rim);
        faces[1].push_back(std::move(rim));
    }
    return {compact(vertices, std::move(faces[0])), compact(vertices, std::move(faces[1]))};
}

std::vector<std::array<glm::dvec4, 4>> tetrahedra(const ConvexPart& part) {
    // From the vertex that most faces hold: the fewest cones.
    std::vector<std::uint32_t> uses(part.vertices.size(), 0);
    for (const auto& face : part.faces) {
        for (const auto v : face)
            ++uses[v];
    }
    const auto apex = static_cast<std::uint32_t>(std::max_element(uses.begin(), uses.end()) - uses.begin());
    std::vector<std::array<glm::dvec4, 4>> tets;
    for (const auto& face : part.faces) {
        if (std::find(face.begin(), face.end(), apex) != face.end()) continue;
        // A fan from the lowest vertex: pulling vertices in one order gives a regular subdivision, which has no cycles.
        const auto first = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
        for (std::size_t i = 1; i + 1 < face.size(); ++i) {
            const auto at = [&](std::size_t k) { return part.vertices[face[(first + k) % face.size()]]; };
            const std::array<glm::dvec4, 4> tet{part.vertices[apex], at(0), at(i), at(i + 1)};
            if (std::abs(glm::determinant(glm::dmat4(tet[0], tet[1], tet[2], tet[3]))) > least_volume) tets.push_back(tet);
        }
    }
    return tets;
}

}  // namespace cellproj
