// SPDX-License-Identifier: BSD-3-Clause
//
// The embedded scene: potential flow around a sphere of radius R = 1 at the origin, free stream U = 1 along +x, in a
// box with a hole where the sphere is. It needs no input file, and its field is known in closed form (Batchelor, An
// Introduction to Fluid Dynamics, 1967, §6.8): the velocity is the gradient of φ = U (x + R³ x / (2 r³)), and the
// pressure coefficient Cp = 1 − |u|² / U².
#pragma once

#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"
#include "mesh/tet_mesh.hpp"
#include "project/camera.hpp"

namespace cellproj {

inline constexpr double sphere_flow_box = 4.0;  // half the edge of the box [mesh units; the sphere has radius 1]

// ∇φ; 0 at the stagnation points (±1, 0, 0), 3/2 U along the belt x = 0 of the sphere. r > 0; the flow is outside r
// ≥ 1.
glm::dvec3 sphere_flow_velocity(const glm::dvec3& point);

// Cp: 1 at the stagnation points, −5/4 on the belt, towards 0 as r⁻³ far away. r > 0.
double sphere_pressure_coefficient(const glm::dvec3& point);

// The sphere (an icosphere whose vertices have radius 1) and the box, with points on concentric shells between them
// that grow coarser outwards: the same complex on every machine.
PiecewiseLinearComplex make_sphere_flow_complex();

// The sphere alone, as a body in the flow: the facets of the hole in that complex.
Surface make_sphere_surface();

// That complex cut into about 100 000 tetrahedra, with the point fields "cp" (first) and "velocity". Errors of
// `tetrahedralize`.
TetMesh make_sphere_flow_mesh(const MesherOptions& options = {});

// Cool to warm over Cp: a blue belt of low pressure, red lobes at the stagnation points, nothing where |Cp| ≤ 0.08.
TransferFunction sphere_flow_transfer_function();

// Perspective, three-quarter view from upstream and above; the stream comes from the left.
Camera sphere_flow_camera();

}  // namespace cellproj
