// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/gradient.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
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
    if (std::ranges::any_of(rise, [](double r) { return !std::isfinite(r); })) return std::nullopt;
    const Shape shape(mesh, cell);
    if (shape.is_flat()) return std::nullopt;
    if (highest == 0) return glm::dvec3(0);
    const auto& [u, v, w] = shape.edges;
    const glm::dvec3 g =
        (rise[0] / highest * glm::cross(v, w) + rise[1] / highest * glm::cross(w, u) + rise[2] / highest * glm::cross(u, v)) /
        shape.det * (highest / shape.size);
    return std::isfinite(largest(g)) ? std::optional(g) : std::nullopt;
}

// One for each cell, NaN where there is none.
std::vector<glm::dvec3> gradients_or_nan(const TetMesh& mesh, const ScalarField& field) {
    assert(field.values.size() == (field.location == FieldLocation::points ? mesh.points.size() : mesh.tets.size()));
    std::vector<glm::dvec3> gradients(mesh.tets.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, mesh.tets.size(), 4096), [&](const Range& range) {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t cell = range.begin(); cell != range.end(); ++cell)
            gradients[cell] = gradient_in(mesh, field, static_cast<CellId>(cell)).value_or(glm::dvec3(nan));
    });
    return gradients;
}

}  // namespace

bool is_flat(const TetMesh& mesh, CellId cell) { return Shape(mesh, cell).is_flat(); }

Gradients cell_gradients(const TetMesh& mesh, const ScalarField& field) {
    Gradients gradients{gradients_or_nan(mesh, field), 0};
    for (glm::dvec3& gradient : gradients.values) {
        if (!std::isnan(gradient.x)) continue;
        gradient = glm::dvec3(0);
        ++gradients.undefined;
    }
    return gradients;
}

Gradients vertex_gradients(const TetMesh& mesh, const ScalarField& field) {
    const std::vector<glm::dvec3> of_cells = gradients_or_nan(mesh, field);
    const double extent = bounds(mesh.points).diagonal();
    const double unit = extent > 0 ? extent : 1.0;
    Gradients gradients{std::vector<glm::dvec3>(mesh.points.size(), glm::dvec3(0)), 0};
    std::vector<double> weights(mesh.points.size(), 0.0);
    for (std::size_t cell = 0; cell < mesh.tets.size(); ++cell) {
        if (std::isnan(of_cells[cell].x)) continue;
        const Shape shape(mesh, static_cast<CellId>(cell));
        const double volume = std::abs(shape.det) * std::pow(shape.size / unit, 3);
        if (!(volume > 0)) continue;
        for (const VertexId v : mesh.tets[cell]) {
            // A running mean: its values stay among those of the cells, whatever their size.
            weights[v] += volume;
            gradients.values[v] = glm::mix(gradients.values[v], of_cells[cell], volume / weights[v]);
        }
    }
    gradients.undefined = static_cast<std::size_t>(std::count(weights.begin(), weights.end(), 0.0));
    return gradients;
}

}  // namespace cellproj
