// SPDX-License-Identifier: BSD-3-Clause
//
// What the tests of clip regions and bodies share.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include <glm/vec3.hpp>

#include "project/camera.hpp"
#include "render/body_scene.hpp"
#include "render/renderer.hpp"
#include "render/scene.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj::testing_support {

inline Renderer& cpu_backend() {
    static const auto renderer = make_renderer(Backend::cpu);
    return *renderer;
}

inline Renderer& gl_backend() {
    static const auto renderer = make_renderer(Backend::gl_osmesa);
    return *renderer;
}

// An eye in the cube; parallel views have none, and look across it.
inline Camera inside_of_unit_cube(Camera::Projection projection) {
    return {.projection = projection, .eye = {0.31, 0.42, 0.53}, .center = {0.9, 0.8, 0.6}, .up = {0, 0, 1}, .height = 1.1, .fov_y_degrees = 70};
}

// What pictures of the CPU backend of the scenes here may be off by: float32 from outside; where the eye is in a cell, its nearness reaches a
// thousand times that of the cells beyond, which costs digits with and without cuts (6e-5 of a ramp without).
inline double cpu_bound(const Camera& camera) {
    const auto inside = [](double x) { return x > 0 && x < 1; };
    return camera.projection == Camera::Projection::perspective && inside(camera.eye.x) && inside(camera.eye.y) && inside(camera.eye.z) ? 1e-4 : 1e-5;
}

// Points are rounded to float32, which moves edges of isosurfaces at the sides of the mesh and at cuts by some 1e-5 of a pixel. The light
// of a medium has no edges: it is judged without a slack, which would hide much of an error.
inline constexpr double cpu_slack = 2e-5;

// Two-coloured, under two lights.
inline std::shared_ptr<const SurfaceScene> three_surfaces(double opacity, Shading shading) {
    const Lighting lighting{.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}};
    return std::make_shared<const SurfaceScene>(SurfaceScene{
        IsoSurfaces({{0.3, {0.2, 0.9, 0.4}, opacity, {}}, {0.5, {1, 0, 0}, opacity, glm::dvec3(0, 0, 1)}, {0.7, {0.5, 0.5, 0.5}, opacity, {}}}),
        shading, lighting});
}

// A sphere of 2·rings·(rings − 1) triangles about the z-axis, its points on the sphere.
inline Body sphere(const glm::dvec3& center, double radius, int rings, const glm::dvec3& color) {
    const double pi = std::acos(-1.0);
    Body body{.points = {}, .triangles = {}, .color = color};
    const auto id = [&](int ring, int i) { return static_cast<VertexId>(ring * rings + i % rings); };
    for (int ring = 0; ring <= rings; ++ring)
        for (int i = 0; i < rings; ++i) {
            const double polar = pi * ring / rings, around = 2 * pi * i / rings;
            const double sine = ring == 0 || ring == rings ? 0.0 : std::sin(polar);
            body.points.push_back(center + radius * glm::dvec3(sine * std::cos(around), sine * std::sin(around), std::cos(polar)));
        }
    for (int ring = 0; ring < rings; ++ring)
        for (int i = 0; i < rings; ++i) {
            if (ring > 0) body.triangles.push_back({id(ring, i), id(ring + 1, i), id(ring, i + 1)});
            if (ring + 1 < rings) body.triangles.push_back({id(ring, i + 1), id(ring + 1, i), id(ring + 1, i + 1)});
        }
    return body;
}

// A rectangle of two triangles, center ± u ± v.
inline Body rectangle(const glm::dvec3& center, const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& color) {
    return {.points = {center - u - v, center + u - v, center + u + v, center - u + v}, .triangles = {{0, 1, 2}, {0, 2, 3}}, .color = color};
}

inline Scene with_bodies(Scene scene, std::vector<Body> bodies, const Lighting& lighting = {}) {
    scene.bodies = std::make_shared<const BodyScene>(BodyScene{std::move(bodies), lighting});
    return scene;
}

}  // namespace cellproj::testing_support
