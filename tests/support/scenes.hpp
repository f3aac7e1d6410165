// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes in the unit cube whose light is known along every ray: what the tests of the renderer and of the judge share.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "project/camera.hpp"
#include "render/scene.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj::testing_support {

inline Scene scene_of(TetMesh mesh, ScalarField field, TransferFunction transfer) {
    return {std::make_shared<TetMesh>(std::move(mesh)), std::make_shared<ScalarField>(std::move(field)),
            std::make_shared<TransferFunction>(std::move(transfer))};
}

inline Scene scene_of(TetMesh mesh, const std::function<double(const glm::dvec3&)>& f, TransferFunction transfer) {
    ScalarField field = point_field(mesh, f);
    return scene_of(std::move(mesh), std::move(field), std::move(transfer));
}

inline TransferFunction constant_medium(double extinction) {
    return {OpticalModel::density, {{0, {1.0, 0.5, 0.25}}}, {{0, extinction}}};
}

// Where isosurfaces are alone.
inline TransferFunction nothing() { return constant_medium(0); }

// A ramp in colour and extinction, with self-attenuation that matters (optical depth up to about 3 through the cube).
inline TransferFunction ramp() {
    return {OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.2}, {1, 4.0}}};
}

inline Scene with_surfaces(Scene scene, std::vector<IsoSurface> list, Shading shading = Shading::smooth, const Lighting& lighting = {}) {
    scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), shading, lighting});
    return scene;
}

// 0..1 over the unit cube.
inline double linear(const glm::dvec3& p) { return (p.x + 0.5 * p.y + 0.25 * p.z) / 1.75; }

inline Camera view_of_unit_cube(Camera::Projection projection, const glm::dvec3& from = {1.3, -2.1, 0.9}) {
    return frame_bounds({glm::dvec3(0), glm::dvec3(1)}, projection, from, {0, 0, 1}, 1.0);
}

struct Chord {
    double enter = 0, leave = 0;
    double length() const { return std::max(0.0, leave - enter); }
};

// The part of a ray inside the unit cube [lengths along the ray]; perspective rays start at the eye.
inline Chord chord_in_unit_cube(const ScreenTransform::Ray& ray, bool from_origin) {
    Chord chord{from_origin ? 0 : -1e9, 1e9};
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (0 - ray.origin[axis]) / ray.direction[axis], b = (1 - ray.origin[axis]) / ray.direction[axis];
        chord.enter = std::max(chord.enter, std::min(a, b));
        chord.leave = std::min(chord.leave, std::max(a, b));
    }
    return chord;
}

// The part of a ray inside the first cell of a mesh, by its four planes, from the eye on; none is a length of 0.
inline Chord chord_in_first_cell(const TetMesh& mesh, const ScreenTransform::Ray& ray, bool from_origin) {
    Chord chord{from_origin ? 0 : -1e9, 1e9};
    for (int face = 0; face < 4; ++face) {
        const auto v = face_vertices(mesh.tets[0], face);
        const glm::dvec3 a = mesh.points[v[0]], outward = glm::cross(mesh.points[v[1]] - a, mesh.points[v[2]] - a);
        const double speed = glm::dot(outward, ray.direction), t = glm::dot(outward, a - ray.origin) / speed;
        if (speed > 0) chord.leave = std::min(chord.leave, t);
        if (speed < 0) chord.enter = std::max(chord.enter, t);
    }
    return chord;
}

}  // namespace cellproj::testing_support
