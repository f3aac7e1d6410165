// SPDX-License-Identifier: BSD-3-Clause
//
// Gradients against fields whose gradient is known: linear ones exactly, quadratic ones to their order.
#include "mesh/gradient.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>

#include "tests/support/meshes.hpp"

namespace cellproj {
namespace gradient_test {

using testing_support::grid_mesh;
using testing_support::point_field;
using testing_support::unit_tet;

double largest_error(const Gradients& gradients, const glm::dvec3& expected) {
    double largest = 0;
    for (const glm::dvec3& g : gradients.values)
        largest = std::max(largest, glm::length(g - expected));
    return largest / glm::length(expected);
}

TEST(Gradient, OfALinearFieldIsExactAlsoAtTheBoundary) {
    const glm::dvec3 slope(1.5, -0.25, 3);
    const TetMesh mesh = grid_mesh(7, 0.2, 3);
    const ScalarField field = point_field(mesh, [&](const glm::dvec3& p) { return glm::dot(slope, p) - 4; });
    // Scalars of size 8 have 1e-15 of rounding, over a box's edge of 1/7: ten times that for the flattest cells.
    EXPECT_LT(largest_error(cell_gradients(mesh, field), slope), 1e-13);
    EXPECT_LT(largest_error(vertex_gradients(mesh, field), slope), 1e-13);
    EXPECT_EQ(cell_gradients(mesh, field).undefined, 0U);
    EXPECT_EQ(vertex_gradients(mesh, field).undefined, 0U);
}

TEST(Gradient, AtAnyScaleAndPlace) {
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const double scale : {1e-100, 1e-12, 1e-3, 1.0, 1e12, 1e100}) {
        for (const double height : {1e-150, 1e-12, 1.0, 1e12, 1e150}) {
            TetMesh mesh = grid_mesh(3, 0.2, random());
            for (glm::dvec3& p : mesh.points)
                p *= scale;
            const glm::dvec3 slope(any(random), any(random), any(random));
            const ScalarField field =
                point_field(mesh, [&](const glm::dvec3& p) { return height * glm::dot(slope, p / scale); });
            for (const Gradients& g : {cell_gradients(mesh, field), vertex_gradients(mesh, field)}) {
                EXPECT_EQ(g.undefined, 0U);
                for (const glm::dvec3& v : g.values)
                    EXPECT_LT(glm::length(v * (scale / height) - slope), 1e-13) << scale << " " << height;
            }
        }
    }
    // Far away the points are rounded to 1e-10, the field is that of the rounded points.
    TetMesh far = grid_mesh(4, 0.2, 8);
    for (glm::dvec3& p : far.points)
        p += glm::dvec3(1e6, -1e6, 1e6);
    const glm::dvec3 slope(0, 2, 1);
    const ScalarField field =
        point_field(far, [&](const glm::dvec3& p) { return glm::dot(slope, p - glm::dvec3(1e6, -1e6, 1e6)); });
    EXPECT_LT(largest_error(cell_gradients(far, field), slope), 1e-13);
    EXPECT_LT(largest_error(vertex_gradients(far, field), slope), 1e-13);
}

TEST(Gradient, OfFlatCellsIsZeroAndCounted) {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.3, 0.6, 0.9}};
    mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 5, 6, 7}, {5, 5, 5, 5}, {0, 1, 2, 2}};
    const ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.x + 2 * p.y + p.x * p.y + 3 * p.z; });
    const Gradients cells = cell_gradients(mesh, field);
    EXPECT_EQ(cells.undefined, 4U);
    EXPECT_LT(glm::length(cells.values[0] - glm::dvec3(1, 2, 3)), 1e-15);
    for (std::size_t cell = 1; cell < 5; ++cell)
        EXPECT_EQ(cells.values[cell], glm::dvec3(0));
    const Gradients vertices = vertex_gradients(mesh, field);
    EXPECT_EQ(vertices.undefined, 4U);  // 4 to 7: in flat cells only
    for (std::size_t v = 0; v < 4; ++v)
        EXPECT_LT(glm::length(vertices.values[v] - glm::dvec3(1, 2, 3)), 1e-15);
}

// Thinner and thinner, down to nothing: right to the rounding of what is left, then 0, never NaN.
TEST(Gradient, OfSliversIsRightOrZero) {
    for (double height = 1; height > 1e-18; height /= 7) {
        TetMesh mesh = unit_tet();
        mesh.points[3] = {0.3, 0.3, height};
        const ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.x + 2 * p.y + 3 * p.z; });
        const Gradients cells = cell_gradients(mesh, field);
        if (cells.undefined == 0) {
            EXPECT_LT(glm::length(cells.values[0] - glm::dvec3(1, 2, 3)), 1e-15 / height + 1e-14) << height;
        } else {
            EXPECT_LT(height, 1e-14);
            EXPECT_EQ(cells.values[0], glm::dvec3(0));
        }
    }
}

TEST(Gradient, LeavesOutWhatIsNotFinite) {
    const TetMesh mesh = grid_mesh(4, 0.1, 6);
    ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.x; });
    field.values[62] = std::numeric_limits<double>::quiet_NaN();
    field.values[0] = std::numeric_limits<double>::infinity();
    const Gradients cells = cell_gradients(mesh, field), vertices = vertex_gradients(mesh, field);
    EXPECT_GT(cells.undefined, 0U);
    for (std::size_t c = 0; c < mesh.tets.size(); ++c) {
        const bool finite = std::ranges::none_of(mesh.tets[c], [](VertexId v) { return v == 62 || v == 0; });
        EXPECT_LT(glm::length(cells.values[c] - glm::dvec3(finite, 0, 0)), 1e-13);
    }
    for (std::size_t v = 1; v < mesh.points.size(); ++v) {
        if (v != 62) {
            EXPECT_LT(glm::length(vertices.values[v] - glm::dvec3(1, 0, 0)), 1e-13) << v;
        }
    }
    EXPECT_EQ(vertices.values[62], glm::dvec3(0));

    // What float64 cannot hold: a rise of 1e300 over 1e-20.
    TetMesh steep = unit_tet();
    for (glm::dvec3& p : steep.points)
        p *= 1e-20;
    const ScalarField high{"s", FieldLocation::points, {0, 1e300, 0, 0}};
    EXPECT_EQ(cell_gradients(steep, high).undefined, 1U);
    EXPECT_EQ(vertex_gradients(steep, high).undefined, 4U);
}

TEST(Gradient, OfAFieldOnCellsIsZeroInEach) {
    const TetMesh mesh = grid_mesh(2);
    ScalarField field{"c", FieldLocation::cells, std::vector<double>(mesh.tets.size())};
    for (std::size_t c = 0; c < field.values.size(); ++c)
        field.values[c] = static_cast<double>(c);
    const Gradients cells = cell_gradients(mesh, field);
    EXPECT_EQ(cells.undefined, 0U);
    for (const glm::dvec3& g : cells.values)
        EXPECT_EQ(g, glm::dvec3(0));
}

// Of x² + 2y² − z²: in a cell of size h off by at most its curvature times h; at inner vertices of the regular grid, whose
// cells lie symmetrically, exact.
TEST(Gradient, OfAQuadraticFieldConverges) {
    const auto f = [](const glm::dvec3& p) { return p.x * p.x + 2 * p.y * p.y - p.z * p.z; };
    const auto slope = [](const glm::dvec3& p) { return glm::dvec3(2 * p.x, 4 * p.y, -2 * p.z); };
    double before = 0;
    for (const int n : {4, 8, 16}) {
        const TetMesh mesh = grid_mesh(n, 0.2, 9);
        const Gradients vertices = vertex_gradients(mesh, point_field(mesh, f));
        double largest = 0;
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
            largest = std::max(largest, glm::length(vertices.values[v] - slope(mesh.points[v])));
        EXPECT_LT(largest, 4.0 * std::sqrt(3) * 1.4 / n);
        if (before > 0) {
            EXPECT_LT(largest, 0.75 * before);
        }
        before = largest;
    }
    const TetMesh regular = grid_mesh(6);
    const Gradients vertices = vertex_gradients(regular, point_field(regular, f));
    for (std::size_t v = 0; v < regular.points.size(); ++v) {
        const glm::dvec3& p = regular.points[v];
        if (std::min({p.x, p.y, p.z}) > 0.01 && std::max({p.x, p.y, p.z}) < 0.99) {
            EXPECT_LT(glm::length(vertices.values[v] - slope(p)), 1e-13);
        }
    }
}

}  // namespace
}  // namespace cellproj
