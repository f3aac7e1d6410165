// SPDX-License-Identifier: BSD-3-Clause
#include "apps/scenes/sphere_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <utility>
#include <vector>

namespace cellproj {

namespace {

// An icosahedron whose triangles were cut into four `level` times: 10·4^level + 2 unit vectors.
struct Icosphere {
    std::vector<glm::dvec3> points;
    std::vector<std::array<VertexId, 3>> triangles;
};

Icosphere icosahedron() {
    const double g = (1.0 + std::sqrt(5.0)) / 2.0;  // golden ratio
    Icosphere sphere;
    // Three golden rectangles in the coordinate planes.
    for (const glm::dvec3& p : {glm::dvec3(-1, g, 0),
                                {1, g, 0},
                                {-1, -g, 0},
                                {1, -g, 0},
                                {0, -1, g},
                                {0, 1, g},
                                {0, -1, -g},
                                {0, 1, -g},
                                {g, 0, -1},
                                {g, 0, 1},
                                {-g, 0, -1},
                                {-g, 0, 1}}) {
        sphere.points.push_back(glm::normalize(p));
    }
    sphere.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return sphere;
}

Icosphere subdivide(const Icosphere& coarse) {
    Icosphere fine{coarse.points, {}};
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) {
        const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<VertexId>(fine.points.size()));
        if (is_new) fine.points.push_back(glm::normalize(fine.points[a] + fine.points[b]));
        return entry->second;
    };
    for (const auto& [a, b, c] : coarse.triangles) {
        const VertexId ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    return fine;
}

Icosphere icosphere(int level) {
    Icosphere sphere = icosahedron();
    for (int i = 0; i < level; ++i)
        sphere = subdivide(sphere);
    return sphere;
}

// Length of an edge of the unit icosphere: the icosahedron's, halved by every level (a little more or less from edge to
// edge).
double edge_length(int level) {
    return 1.0515 / std::exp2(level);
}

void add_sphere(PiecewiseLinearComplex& complex, const Icosphere& sphere) {
    const auto first = static_cast<VertexId>(complex.points.size());
    complex.points.insert(complex.points.end(), sphere.points.begin(), sphere.points.end());
    for (const auto& [a, b, c] : sphere.triangles)
        complex.facets.push_back({first + a, first + b, first + c});
    complex.holes.emplace_back(0.0);
}

// The surface of the box [−half, half]³, each side cut into n by n squares, so that the cells on it stay well shaped.
void add_box(PiecewiseLinearComplex& complex, double half, int n) {
    std::map<std::array<int, 3>, VertexId> ids;
    const auto vertex = [&](const std::array<int, 3>& at) {
        const auto [entry, is_new] = ids.try_emplace(at, static_cast<VertexId>(complex.points.size()));
        if (is_new) complex.points.push_back(half * (2.0 * glm::dvec3(at[0], at[1], at[2]) / double(n) - 1.0));
        return entry->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int side : {0, n}) {
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    const auto corner = [&](int di, int dj) {
                        std::array<int, 3> at{};
                        at[axis] = side;
                        at[(axis + 1) % 3] = i + di;
                        at[(axis + 2) % 3] = j + dj;
                        return vertex(at);
                    };
                    complex.facets.push_back({corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)});
                }
            }
        }
    }
}

glm::dmat3 rotation(const glm::dvec3& axis, double angle) {
    const glm::dvec3 a = glm::normalize(axis);
    const auto turn = [&](const glm::dvec3& v) {  // Rodrigues
        return v * std::cos(angle) + glm::cross(a, v) * std::sin(angle) +
               a * (glm::dot(a, v) * (1.0 - std::cos(angle)));
    };
    return {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})};
}

// Points between sphere and box on shells, each one edge length from the last, so that cells have about equal sides.
// Every shell is turned by the golden angle against the last: shells in line would put many points on common spheres
// and planes, of which Delaunay makes flat cells.
void add_shells(PiecewiseLinearComplex& complex, double half) {
    struct Zone {
        int level;
        double outer_radius;
    };
    const std::array<Zone, 3> zones{{{4, 1.35}, {3, 3.7}, {2, half * std::sqrt(3.0)}}};
    const double golden_angle = 2.399963229728653;
    const double margin = 0.25;  // shell points closer to the box would make thin cells on it
    double radius = 1.0;
    int shell = 0;
    for (const Zone& zone : zones) {
        const Icosphere sphere = icosphere(zone.level);
        const double growth = 1.0 + edge_length(zone.level);
        while (radius * growth < zone.outer_radius) {
            radius *= growth;
            const glm::dmat3 turn = rotation({1.0, 2.0, 3.0}, golden_angle * ++shell);
            for (const glm::dvec3& direction : sphere.points) {
                const glm::dvec3 p = radius * (turn * direction);
                if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < half - margin)
                    complex.points.push_back(p);
            }
        }
    }
}

}  // namespace

glm::dvec3 sphere_flow_velocity(const glm::dvec3& point) {
    const double r2 = glm::dot(point, point);
    const double r3 = r2 * std::sqrt(r2);
    // ∂/∂p of x + x/(2 r³), U = R = 1
    return glm::dvec3(1.0 + 0.5 / r3, 0.0, 0.0) - point * (1.5 * point.x / (r3 * r2));
}

double sphere_pressure_coefficient(const glm::dvec3& point) {
    const glm::dvec3 u = sphere_flow_velocity(point);
    return 1.0 - glm::dot(u, u);
}

PiecewiseLinearComplex make_sphere_flow_complex() {
    PiecewiseLinearComplex complex;
    add_sphere(complex, icosphere(4));
    add_box(complex, sphere_flow_box, 8);
    add_shells(complex, sphere_flow_box);
    return complex;
}

Surface make_sphere_surface() {
    PiecewiseLinearComplex sphere;
    add_sphere(sphere, icosphere(4));
    return {.name = "demo:sphere", .points = std::move(sphere.points), .polygons = std::move(sphere.facets), .point_fields = {}};
}

TetMesh make_sphere_flow_mesh(const MesherOptions& options) {
    TetMesh mesh = tetrahedralize(make_sphere_flow_complex(), options);
    Field pressure{"cp", 1, {}};
    Field velocity{"velocity", 3, {}};
    for (const glm::dvec3& p : mesh.points) {
        pressure.values.push_back(sphere_pressure_coefficient(p));
        const glm::dvec3 u = sphere_flow_velocity(p);
        velocity.values.insert(velocity.values.end(), {u.x, u.y, u.z});
    }
    mesh.point_fields = {std::move(pressure), std::move(velocity)};
    return mesh;
}

TransferFunction sphere_flow_transfer_function() {
    return TransferFunction(OpticalModel::density,
                            {{-1.25, {0.08, 0.16, 0.60}},
                             {-0.50, {0.23, 0.45, 0.90}},
                             {0.00, {0.87, 0.87, 0.87}},
                             {0.40, {0.93, 0.42, 0.28}},
                             {1.00, {0.66, 0.02, 0.14}}},
                            {{-1.25, 7.0}, {-0.60, 2.0}, {-0.08, 0.0}, {0.08, 0.0}, {0.30, 0.6}, {1.00, 7.0}});
}

Camera sphere_flow_camera() {
    Camera camera;
    camera.projection = Camera::Projection::perspective;
    camera.eye = {-5.0, -7.5, 4.0};
    camera.center = {0.0, 0.0, 0.0};
    camera.up = {0.0, 0.0, 1.0};
    camera.fov_y_degrees = 28.0;
    return camera;
}

}  // namespace cellproj
