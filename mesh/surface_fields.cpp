// SPDX-License-Identifier: BSD-3-Clause
//
// Closest points on a surface through a tree of boxes.
// Ericson, Real-Time Collision Detection, 2005, section 5.1.5: the closest point of a triangle by its Voronoi regions.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/face_triangles.hpp"
#include "mesh/surface.hpp"

namespace cellproj {

namespace {

// Where on the surface, and how far away.
struct Closest {
    Triangle corners{};
    glm::dvec3 weights{0.0};  // of the corners; their sum is 1
    double squared_distance = std::numeric_limits<double>::infinity();
};

std::vector<Triangle> fans(const Surface& surface) {
    std::vector<Triangle> triangles;
    for (const std::vector<VertexId>& polygon : surface.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i)
            triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
    return triangles;
}

// The share of `to` at the point of the segment that is closest to `p`; 0 for a segment of no length.
double closest_on_segment(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    const double square = glm::dot(along, along);
    return square > 0.0 ? std::clamp(glm::dot(p - from, along) / square, 0.0, 1.0) : 0.0;
}

// The weights of a, b and c at the point of their triangle that is closest to p.
glm::dvec3 closest_weights(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double square = glm::dot(normal, normal);
    if (square > 0.0) {
        const double wa = glm::dot(glm::cross(b - p, c - p), normal) / square;
        const double wb = glm::dot(glm::cross(c - p, a - p), normal) / square;
        const double wc = 1.0 - wa - wb;
        if (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) return {wa, wb, wc};
    }
    // The foot of the perpendicular lies outside, or there is none: the closest point is on an edge.
    const double ab = closest_on_segment(p, a, b), bc = closest_on_segment(p, b, c), ca = closest_on_segment(p, c, a);
    const std::array<glm::dvec3, 3> candidates{glm::dvec3(1.0 - ab, ab, 0.0), glm::dvec3(0.0, 1.0 - bc, bc),
                                               glm::dvec3(ca, 0.0, 1.0 - ca)};
    const auto squared_distance = [&](const glm::dvec3& w) {
        const glm::dvec3 d = w.x * a + w.y * b + w.z * c - p;
        return glm::dot(d, d);
    };
    return *std::min_element(candidates.begin(), candidates.end(), [&](const glm::dvec3& u, const glm::dvec3& v) {
        return squared_distance(u) < squared_distance(v);
    });
}

class TriangleTree {
public:
    TriangleTree(const std::vector<glm::dvec3>& points, std::vector<Triangle> triangles)
        : points_(points), triangles_(std::move(triangles)) {
        if (!triangles_.empty()) build(0, triangles_.size());
    }

    Closest closest(const glm::dvec3& p) const {
        Closest best;
        if (!nodes_.empty()) search(0, p, best);
        return best;
    }

private:
    static constexpr std::size_t leaf_size = 4;

    // A leaf holds the triangles first..last; of an inner node, the first child follows it, the second is `second`.
    struct Node {
        Bounds box;
        std::size_t first, last, second;
    };

    Bounds box_of(std::size_t first, std::size_t last) const {
        std::vector<glm::dvec3> corners;
        for (std::size_t i = first; i < last; ++i) {
            for (const VertexId v : triangles_[i])
                corners.push_back(points_[v]);
        }
        return bounds(corners);
    }

    std::size_t build(std::size_t first, std::size_t last) {
        const std::size_t node = nodes_.size();
        nodes_.push_back({box_of(first, last), first, last, 0});
        if (last - first <= leaf_size) return node;
        const glm::dvec3 size = nodes_[node].box.high - nodes_[node].box.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto centre = [&](const Triangle& t) {
            return points_[t[0]][axis] + points_[t[1]][axis] + points_[t[2]][axis];
        };
        const std::size_t middle = first + (last - first) / 2;
        const auto at = [&](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(first), at(middle), at(last),
                         [&](const Triangle& s, const Triangle& t) { return centre(s) < centre(t); });
        build(first, middle);
        const std::size_t second = build(middle, last);
        nodes_[node].second = second;
        return node;
    }

    double squared_distance_to_box(std::size_t node, const glm::dvec3& p) const {
        const glm::dvec3 d = p - glm::clamp(p, nodes_[node].box.low, nodes_[node].box.high);
        return glm::dot(d, d);
    }

    void search(std::size_t index, const glm::dvec3& p, Closest& best) const {
        const Node& node = nodes_[index];
        if (node.second == 0) {
            for (std::size_t i = node.first; i < node.last; ++i)
                improve(triangles_[i], p, best);
            return;
        }
        std::array<std::size_t, 2> children{index + 1, node.second};
        std::array<double, 2> nearest{squared_distance_to_box(children[0], p), squared_distance_to_box(children[1], p)};
        if (nearest[1] < nearest[0]) {
            std::swap(children[0], children[1]);
            std::swap(nearest[0], nearest[1]);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (nearest[i] < best.squared_distance) search(children[i], p, best);
        }
    }

    void improve(const Triangle& t, const glm::dvec3& p, Closest& best) const {
        const glm::dvec3 &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];
        const glm::dvec3 w = closest_weights(p, a, b, c);
        const glm::dvec3 d = w.x * (a - p) + w.y * (b - p) + w.z * (c - p);
        if (const double square = glm::dot(d, d); square < best.squared_distance) best = {t, w, square};
    }

    const std::vector<glm::dvec3>& points_;
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

Field interpolated(const Field& field, const std::vector<Closest>& places) {
    const auto components = static_cast<std::size_t>(field.components);
    Field result{field.name, field.components, {}};
    result.values.reserve(places.size() * components);
    for (const Closest& place : places) {
        for (std::size_t k = 0; k < components; ++k) {
            double sum = 0.0;
            // A corner without weight must not count: 0 × NaN is NaN.
            for (int i = 0; i < 3; ++i) {
                const std::size_t row = place.corners[static_cast<std::size_t>(i)];
                if (place.weights[i] != 0.0) sum += place.weights[i] * field.values[row * components + k];
            }
            result.values.push_back(sum);
        }
    }
    return result;
}

}  // namespace

std::vector<std::array<VertexId, 3>> triangles_of(const Surface& surface) {
    std::vector<std::array<VertexId, 3>> triangles;
    for (const auto& polygon : surface.polygons) triangulate_face(polygon, surface.points, triangles);
    return triangles;
}

void carry_fields(const Surface& surface, TetMesh& mesh) {
    const TriangleTree tree(surface.points, fans(surface));
    std::vector<Closest> places(mesh.points.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) { places[i] = tree.closest(mesh.points[i]); });
    for (const Field& field : surface.point_fields)
        mesh.point_fields.push_back(interpolated(field, places));
    if (!surface.point_fields.empty()) return;
    Field distance{"distance", 1, {}};
    for (const Closest& place : places)
        distance.values.push_back(std::sqrt(place.squared_distance));
    mesh.point_fields.push_back(std::move(distance));
}

}  // namespace cellproj
