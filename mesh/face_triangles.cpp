// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/face_triangles.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

constexpr std::size_t most_vertices_to_optimise = 64;  // the time grows with the cube
constexpr double least_share = 0.01;                   // of a face's area, for a triangle of its fan

// The vertices from the lowest on, towards the lower one of its two neighbours, without immediate repetitions.
struct CanonicalFace {
    std::vector<VertexId> vertices;
    bool reversed = false;
};

void canonicalise(std::span<const VertexId> face, CanonicalFace& result) {
    std::vector<VertexId>& v = result.vertices;
    v.assign(face.begin(), face.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
    while (v.size() > 1 && v.front() == v.back())
        v.pop_back();
    if (v.size() < 3) return;
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    result.reversed = v.back() < v[1];
    if (result.reversed) std::reverse(v.begin() + 1, v.end());
}

void append(Triangle t, bool reversed, std::vector<Triangle>& triangles) {
    if (t[0] == t[1] || t[0] == t[2] || t[1] == t[2]) return;
    if (reversed) std::swap(t[1], t[2]);
    triangles.push_back(t);
}

// Twice the area vector.
glm::dvec3 normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::cross(b - a, c - a);
}

// Twice the area vector of a polygon.
glm::dvec3 normal(const std::vector<VertexId>& face, std::span<const glm::dvec3> points) {
    glm::dvec3 sum(0.0);
    for (std::size_t n = 1; n + 1 < face.size(); ++n)
        sum += normal(points[face[0]], points[face[n]], points[face[n + 1]]);
    return sum;
}

bool fan_is_good(const std::vector<VertexId>& face, std::span<const glm::dvec3> points, const glm::dvec3& area) {
    const double least = least_share * glm::dot(area, area);
    for (std::size_t n = 1; n + 1 < face.size(); ++n) {
        if (!(glm::dot(normal(points[face[0]], points[face[n]], points[face[n + 1]]), area) > least)) return false;
    }
    return true;
}

// Of all triangulations the one with the largest smallest quality. quality(i, k, j) belongs to the corners i < k < j.
template <class Quality, class Emit>
void emit_best_triangulation(std::size_t size, Quality quality, Emit emit) {
    struct Part {  // of the face, cut off by the diagonal from i to j
        double worst = std::numeric_limits<double>::infinity();
        std::size_t apex = 0;
    };
    std::vector<Part> parts(size * size);
    for (std::size_t length = 2; length < size; ++length) {
        for (std::size_t i = 0; i + length < size; ++i) {
            const std::size_t j = i + length;
            Part& part = parts[i * size + j];
            part.worst = -std::numeric_limits<double>::infinity();
            for (std::size_t k = i + 1; k < j; ++k) {
                const double worst = std::min({quality(i, k, j), parts[i * size + k].worst, parts[k * size + j].worst});
                if (k == i + 1 || worst > part.worst) part = {worst, k};
            }
        }
    }
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, size - 1}};
    while (!open.empty()) {
        const auto [i, j] = open.back();
        open.pop_back();
        if (j - i < 2) continue;
        const std::size_t k = parts[i * size + j].apex;
        emit(i, k, j);
        open.push_back({i, k});
        open.push_back({k, j});
    }
}

// 0 for flat triangles, below 0 for those turned against `area`, otherwise the share of the square over the longest
// edge.
double quality(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& area) {
    const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
    return longest > 0.0 ? glm::dot(normal(a, b, c), area) / longest : 0.0;
}

}  // namespace

void triangulate_face(std::span<const VertexId> face, std::span<const glm::dvec3> points,
                      std::vector<Triangle>& triangles) {
    if (face.size() == 3) return append({face[0], face[1], face[2]}, false, triangles);
    thread_local CanonicalFace canonical;  // its memory is used again for the next face
    canonicalise(face, canonical);
    const std::vector<VertexId>& v = canonical.vertices;
    if (v.size() < 3) return;
    const glm::dvec3 area = normal(v, points);
    if (v.size() > most_vertices_to_optimise || fan_is_good(v, points, area)) {
        for (std::size_t n = 1; n + 1 < v.size(); ++n)
            append({v[0], v[n], v[n + 1]}, canonical.reversed, triangles);
        return;
    }
    emit_best_triangulation(
        v.size(),
        [&](std::size_t i, std::size_t k, std::size_t j) {
            return quality(points[v[i]], points[v[k]], points[v[j]], area);
        },
        [&](std::size_t i, std::size_t k, std::size_t j) {
            append({v[i], v[k], v[j]}, canonical.reversed, triangles);
        });
}

}  // namespace cellproj
