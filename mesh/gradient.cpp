// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/gradient.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// det(u, v, w) of three rounded edges is off by at most about 8 ulps of |u||v||w|: below twice that its sign says nothing.
constexpr double flat = 4e-15;

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// A cell as seen from its first vertex, lengths relative to its longest extent, so that no product leaves float64's range.
struct Shape {
    double size;                      // [mesh units], > 0 unless all points are one
    std::array<glm::dvec3, 3> edges;  // to the other three, over size
    double det;                       // six times the volume, over size³

    Shape(const TetMesh& mesh, CellId cell) {
        const auto& tet = mesh.tets[cell];
        for (std::size_t i = 0; i < 3; ++i)
            edges[i] = mesh.points[tet[i + 1]] - mesh.points[tet[0]];
        size = std::max({largest(edges[0]), largest(edges[1]), largest(edges[2])});
        for (glm::dvec3& edge : edges)
            edge = size > 0 ? edge / size : glm::dvec3(0);
        det = glm::dot(edges[0], glm::cross(edges[1], edges[2]));
    }

    bool is_flat() const {
        const double product = glm::length(edges[0]) * glm::length(edges[1]) * glm::length(edges[2]);
        return !(std::abs(det) > flat * product) || !std::isfinite(size);
    }
};

// g with g · (p_i − p_0) = s_i − s_0 for i = 1, 2, 3, by Cramer's rule; nothing where there is none.
std::optional<glm::dvec3> gradient_in(const TetMesh& mesh, const ScalarField& field, CellId cell) {
    std::array<double, 4> s;
    for (int corner = 0; corner < 4; ++corner)
        s[static_cast<std::size_t>(corner)] = field.at(mesh, cell, corner);
    const std::array<double, 3> rise{s[1] - s[0], s[2] - s[0], s[3] - s[0]};
    const double highest = std::max({std::abs(rise[0]), std::abs(rise[1]), std::abs(rise[2])});
    if (!std::isfinite(rise[0] + rise[1] + rise[2]) || !std::isfinite(highest)) return std::nullopt;
    const Shape shape(mesh, cell);
    if (shape.is_flat()) return std::nullopt;
    if (highest == 0) return glm::dvec3(0);
    const auto& [u, v, w] = shape.edges;
    const glm::dvec3 g =
        (rise[0] / highest * glm::cross(v, w) + rise[1] / highest * glm::cross(w, u) + rise[2] / highest * glm::cross(u, v)) /
        shape.det * (highest / shape.size);
    return std::isfinite(largest(g)) ? std::optional(g) : std::nullopt;
}

bool has_finite_scalars(const TetMesh& mesh, const ScalarField& field, CellId cell) {
    for (int corner = 0; corner < 4; ++corner) {
        if (!std::isfinite(field.at(mesh, cell, corner))) return false;
    }
    return true;
}

}  // namespace

Gradients cell_gradients(const TetMesh& mesh, const ScalarField& field) {
    assert(field.values.size() == (field.location == FieldLocation::points ? mesh.points.size() : mesh.tets.size()));
    Gradients gradients{std::vector<glm::dvec3>(mesh.tets.size(), glm::dvec3(0)), 0};
    std::atomic<std::size_t> undefined = 0;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, mesh.tets.size(), 4096), [&](const Range& range) {
        std::size_t here = 0;
        for (std::size_t cell = range.begin(); cell != range.end(); ++cell) {
            const auto gradient = gradient_in(mesh, field, static_cast<CellId>(cell));
            if (gradient) gradients.values[cell] = *gradient;
            here += !gradient;
        }
        undefined += here;
    });
    gradients.undefined = undefined;
    return gradients;
}

Gradients vertex_gradients(const TetMesh& mesh, const ScalarField& field, const Gradients& cells) {
    assert(cells.values.size() == mesh.tets.size());
    const double extent = bounds(mesh.points).diagonal();
    const double unit = extent > 0 ? extent : 1.0;
    Gradients gradients{std::vector<glm::dvec3>(mesh.points.size(), glm::dvec3(0)), 0};
    std::vector<double> weights(mesh.points.size(), 0.0);
    for (std::size_t cell = 0; cell < mesh.tets.size(); ++cell) {
        const auto id = static_cast<CellId>(cell);
        const Shape shape(mesh, id);
        if (shape.is_flat() || !has_finite_scalars(mesh, field, id)) continue;
        const double volume = std::abs(shape.det) * std::pow(shape.size / unit, 3);
        if (!(volume > 0)) continue;
        for (const VertexId v : mesh.tets[cell]) {
            // A running mean: its values stay among those of the cells, whatever their size.
            weights[v] += volume;
            gradients.values[v] = glm::mix(gradients.values[v], cells.values[cell], volume / weights[v]);
        }
    }
    gradients.undefined = static_cast<std::size_t>(std::count(weights.begin(), weights.end(), 0.0));
    return gradients;
}

Gradients vertex_gradients(const TetMesh& mesh, const ScalarField& field) {
    return vertex_gradients(mesh, field, cell_gradients(mesh, field));
}

}  // namespace cellproj
