// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "mesh/mesher.hpp"
#include "mesh/tetrahedralize.hpp"

namespace cellproj::testing_support {

TetMesh unit_tet() {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    return mesh;
}

TetMesh relabelled(const TetMesh& mesh, std::mt19937_64& random) {
    std::vector<VertexId> label(mesh.points.size());
    std::iota(label.begin(), label.end(), 0U);
    std::shuffle(label.begin(), label.end(), random);
    TetMesh other = mesh;
    for (std::size_t v = 0; v < label.size(); ++v)
        other.points[label[v]] = mesh.points[v];
    for (auto& tet : other.tets) {
        for (auto& v : tet)
            v = label[v];
    }
    return other;
}

TetMesh shuffled(TetMesh mesh, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
    return relabelled(mesh, random);
}

Dataset single_cell(CellKind kind, std::vector<glm::dvec3> points, std::vector<VertexId> vertices) {
    Dataset dataset;
    dataset.source = "cell";
    dataset.points = std::move(points);
    dataset.cells = {{kind}, {0, vertices.size()}, vertices};
    return dataset;
}

TetMesh grid_mesh(int n, double jitter, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> offset(-jitter / n, jitter / n);
    Dataset dataset;
    const auto side = static_cast<std::size_t>(n) + 1;
    dataset.grid = GridDimensions{side, side, side};
    for (int k = 0; k <= n; ++k) {
        for (int j = 0; j <= n; ++j) {
            for (int i = 0; i <= n; ++i) {
                glm::dvec3 p = glm::dvec3(i, j, k) / static_cast<double>(n);
                const bool inner = i > 0 && i < n && j > 0 && j < n && k > 0 && k < n;
                if (jitter > 0 && inner) p += glm::dvec3(offset(random), offset(random), offset(random));
                dataset.points.push_back(p);
            }
        }
    }
    return tetrahedralize(dataset);
}

TetMesh delaunay_mesh(int points, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> inside(0.001, 0.999);
    PiecewiseLinearComplex complex;
    for (int corner = 0; corner < 8; ++corner) complex.points.emplace_back(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    for (int i = 0; i < points; ++i) {
        const double x = inside(random), y = inside(random), z = inside(random);
        complex.points.emplace_back(x, y, z);
    }
    complex.facets = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    return tetrahedralize(complex);
}

double total_volume(const TetMesh& mesh) {
    double sum = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) sum += signed_volume(mesh, cell);
    return sum;
}

ScalarField point_field(const TetMesh& mesh, const std::function<double(const glm::dvec3&)>& f) {
    ScalarField field{"f", FieldLocation::points, {}};
    for (const glm::dvec3& p : mesh.points) field.values.push_back(f(p));
    return field;
}

TetMesh cyclic_ring(int sectors) {
    TetMesh mesh;
    const auto at = [](double angle, double radius, double z) {
        return glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), z);
    };
    for (int i = 0; i < sectors; ++i) {  // a triangle per common face: two points below, one above and ahead
        const double angle = 2 * std::numbers::pi * i / sectors;
        mesh.points.push_back(at(angle, 1, 0));
        mesh.points.push_back(at(angle, 2, 0));
        mesh.points.push_back(at(angle + 0.9 * 2 * std::numbers::pi / sectors, 1.5, 0.5));
    }
    for (int i = 0; i < sectors; ++i) {
        const auto a = static_cast<VertexId>(3 * i), b = static_cast<VertexId>(3 * ((i + 1) % sectors));
        mesh.tets.push_back({a, a + 1, a + 2, b + 2});
        mesh.tets.push_back({a, a + 1, b + 1, b + 2});
        mesh.tets.push_back({a, b, b + 1, b + 2});
    }
    orient_cells(mesh);
    return mesh;
}

}  // namespace cellproj::testing_support
