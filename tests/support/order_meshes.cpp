// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/order_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tetrahedralize.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj::testing_support {

namespace {

constexpr double turn = 2 * std::numbers::pi;

// The same cells without the points that none of them uses.
TetMesh compact(TetMesh mesh) {
    std::vector<VertexId> label(mesh.points.size(), no_cell);
    std::vector<glm::dvec3> points;
    for (auto& tet : mesh.tets) {
        for (auto& v : tet) {
            if (label[v] == no_cell) {
                label[v] = static_cast<VertexId>(points.size());
                points.push_back(mesh.points[v]);
            }
            v = label[v];
        }
    }
    mesh.points = std::move(points);
    return mesh;
}

void append(TetMesh& mesh, const TetMesh& other) {
    const auto offset = static_cast<VertexId>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    for (auto tet : other.tets) {
        for (auto& v : tet)
            v += offset;
        mesh.tets.push_back(tet);
    }
}

void append_cell(TetMesh& mesh, const std::array<glm::dvec3, 4>& corners) {
    TetMesh cell;
    cell.points.assign(corners.begin(), corners.end());
    cell.tets = {{0, 1, 2, 3}};
    append(mesh, cell);
}

// A tube of boxes: `place(s, u, v)` maps segment ends s = 0, 1, …, segments and the section −1 ≤ u, v ≤ 1 to space.
TetMesh tube(int segments, int across, bool closed, const std::function<glm::dvec3(int, double, double)>& place) {
    const int rings = closed ? segments : segments + 1, side = across + 1;
    Dataset dataset;
    dataset.source = "tube";
    for (int s = 0; s < rings; ++s) {
        for (int j = 0; j < side; ++j) {
            for (int i = 0; i < side; ++i)
                dataset.points.push_back(place(s, 2.0 * i / across - 1, 2.0 * j / across - 1));
        }
    }
    const auto id = [&](int s, int i, int j) { return static_cast<VertexId>(((s % rings) * side + j) * side + i); };
    dataset.cells.offsets = {0};
    for (int s = 0; s < segments; ++s) {
        for (int j = 0; j < across; ++j) {
            for (int i = 0; i < across; ++i) {
                for (const int r : {s, s + 1}) {
                    for (const VertexId v : {id(r, i, j), id(r, i + 1, j), id(r, i + 1, j + 1), id(r, i, j + 1)})
                        dataset.cells.vertices.push_back(v);
                }
                dataset.cells.kinds.push_back(CellKind::hexahedron);
                dataset.cells.offsets.push_back(dataset.cells.vertices.size());
            }
        }
    }
    return tetrahedralize(dataset);
}

glm::dmat3 random_rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const double a = normal(random), b = normal(random), c = normal(random), d = normal(random), e = normal(random), f = normal(random);
    const glm::dvec3 x = glm::normalize(glm::dvec3(a, b, c)), z = glm::normalize(glm::cross(x, glm::dvec3(d, e, f)));
    return {x, glm::cross(z, x), z};
}

}  // namespace

TetMesh carved(const TetMesh& mesh, const std::function<bool(const glm::dvec3&)>& keep) {
    TetMesh rest;
    rest.points = mesh.points;
    for (const auto& t : mesh.tets) {
        if (keep(0.25 * (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]] + mesh.points[t[3]]))) rest.tets.push_back(t);
    }
    return compact(std::move(rest));
}

TetMesh torus_mesh(int segments) {
    return tube(segments, 4, true, [&](int s, double u, double v) {
        const double angle = turn * s / segments, radius = 0.35 + 0.1 * u;
        return glm::dvec3(0.5) + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 0.1 * v);
    });
}

TetMesh cavity_mesh(int n, int cavities, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> inside(0.1, 0.9), radius(0.03, 0.1);
    struct Ball {
        glm::dvec3 center;
        double radius;
    };
    std::vector<Ball> balls;
    for (int i = 0; i < cavities; ++i) {
        const double x = inside(random), y = inside(random), z = inside(random);
        balls.push_back({{x, y, z}, radius(random)});
    }
    return carved(grid_mesh(n, 0.2, seed), [&](const glm::dvec3& p) {
        return std::none_of(balls.begin(), balls.end(), [&](const Ball& b) { return glm::distance(p, b.center) < b.radius; });
    });
}

TetMesh springs_mesh(int segments) {
    TetMesh both;
    for (const double phase : {0.0, 0.5}) {
        append(both, tube(segments, 2, false, [&](int s, double u, double v) {
            const double angle = turn * (3.0 * s / segments + phase), radius = 0.35 + 0.05 * u;
            return glm::dvec3(0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle), 0.1 + 0.8 * s / segments + 0.05 * v);
        }));
    }
    return both;
}

TetMesh pieces_mesh(int pieces, int n, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const int side = static_cast<int>(std::ceil(std::cbrt(pieces)));
    TetMesh all;
    for (int i = 0; i < pieces; ++i) {
        const glm::dvec3 center = (glm::dvec3(i % side, i / side % side, i / side / side) + 0.5) / static_cast<double>(side);
        const glm::dmat3 rotation = random_rotation(random);
        TetMesh piece = grid_mesh(n, 0.2, random());
        // Its diagonal fits into its share of space.
        for (auto& p : piece.points)
            p = center + rotation * (p - 0.5) * (0.57 / side);
        append(all, piece);
    }
    return all;
}

TetMesh overlapping_sticks() {
    TetMesh mesh;
    for (int i = 0; i < 3; ++i) {
        const double angle = turn * i / 3;
        const glm::dvec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y, along.x, 0), up(0, 0, 1);
        // Past the middle on one side; from low to high.
        const glm::dvec3 middle = 0.25 * across;
        const glm::dvec3 low = middle - along - 0.3 * up, high = middle + along + 0.3 * up;
        append_cell(mesh, {low - 0.1 * across, low + 0.1 * across, high - 0.05 * up, high + 0.05 * up});
    }
    orient_cells(mesh);
    return mesh;
}

TetMesh spiral_stair(int steps) {
    TetMesh mesh;
    const double length = 1.7 * turn / steps;  // of a step along the circle of radius 1; the next one starts after one of 1.7
    const glm::dvec3 up(0, 0, 1);
    for (int i = 0; i < steps; ++i) {
        const double angle = turn * i / steps;
        const glm::dvec3 outward(std::cos(angle), std::sin(angle), 0), along(-outward.y, outward.x, 0);
        const glm::dvec3 low = outward - 0.5 * length * along - 0.5 * length * up;
        const glm::dvec3 high = outward + 0.5 * length * along + 0.5 * length * up;
        append_cell(mesh, {low - 0.2 * outward, low + 0.2 * outward, high - 0.1 * outward, high + 0.1 * outward + 0.05 * length * up});
    }
    orient_cells(mesh);
    return mesh;
}

namespace {

// Turns the points in a ball about a vertical axis through its middle, by an angle that grows with height: the largest that just keeps all
// cells positive.
void whirl(TetMesh& mesh, const glm::dvec3& center, double radius) {
    for (double angle = 9.0; angle > 0.1; angle *= 0.8) {
        TetMesh turned = mesh;
        for (auto& p : turned.points) {
            const glm::dvec3 d = p - center;
            const double share = glm::length(d) / radius;
            if (share >= 1) continue;
            const double a = angle * d.z / radius * (1 - share * share);
            p = center + glm::dvec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
        }
        const bool positive = std::all_of(turned.tets.begin(), turned.tets.end(), [&](const auto& t) {
            return orientation(turned.points[t[0]], turned.points[t[1]], turned.points[t[2]], turned.points[t[3]]) > 0;
        });
        if (!positive) continue;
        mesh = std::move(turned);
        return;
    }
}

}  // namespace

TetMesh twisted_mesh(int n, int whirls, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> inside(0.15, 0.85);
    std::uniform_real_distribution<double> jitter(-0.1 / n, 0.1 / n);
    // One number after the other: the order of arguments is the compiler's.
    const auto triple = [&](auto& distribution) {
        const double x = distribution(random), y = distribution(random), z = distribution(random);
        return glm::dvec3(x, y, z);
    };
    TetMesh mesh = grid_mesh(n);
    for (auto& p : mesh.points) {
        const glm::dvec3 step = triple(jitter);
        const auto inner = [](double x) { return x > 0 && x < 1; };
        if (inner(p.x) && inner(p.y) && inner(p.z)) p += step;
    }
    for (int i = 0; i < whirls; ++i) whirl(mesh, triple(inside), 8.0 / n);
    return mesh;
}

TetMesh twisted_cube(int n) {
    TetMesh mesh = grid_mesh(n);
    whirl(mesh, glm::dvec3(0.5), 0.499);
    return mesh;
}

TetMesh damaged_mesh(int n, int each, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    TetMesh mesh = grid_mesh(n, 0.2, seed);
    const auto sound = static_cast<CellId>(mesh.tets.size());
    const auto any_cell = [&] { return mesh.tets[random() % sound]; };
    for (int i = 0; i < each; ++i) {
        // Flat: a face with one of its vertices again, as a point of its own; a quadrangle of the cube's side.
        const auto t = any_cell();
        mesh.points.push_back(mesh.points[t[0]]);
        mesh.tets.push_back({t[0], t[1], t[2], static_cast<VertexId>(mesh.points.size() - 1)});
        const auto side = static_cast<VertexId>(n + 1);
        const VertexId corner = static_cast<VertexId>(random() % static_cast<unsigned>(n)) +
                                side * static_cast<VertexId>(random() % static_cast<unsigned>(n));
        mesh.tets.push_back({corner, corner + 1, corner + 1 + side, corner + side});
        const auto needle = any_cell();
        mesh.tets.push_back({needle[0], needle[1], needle[1], needle[2]});
        const auto line = any_cell();
        mesh.tets.push_back({line[0], line[1], line[0], line[1]});
        const VertexId point = any_cell()[0];
        mesh.tets.push_back({point, point, point, point});
        auto& inverted = mesh.tets[random() % sound];
        std::swap(inverted[2], inverted[3]);
    }
    std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
    return mesh;
}

TetMesh moved(TetMesh mesh, double scale, double offset) {
    for (auto& p : mesh.points)
        p = p * scale + offset;
    return mesh;
}

}  // namespace cellproj::testing_support
