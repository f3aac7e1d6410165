// SPDX-License-Identifier: BSD-3-Clause
//
// How a surface of a given normal reflects light (EKE01 §5.4):
//
//   I = I_a + Σ I_d C (n · l₁) + I_s C (n · l₂)^p
//
// summed over the lights, C the material's colour, n the unit normal. What the paper leaves open is chosen as in Blinn's
// model: l₁ points towards the light, l₂ is the middle between that and the direction to the eye, I_a is a share of C, so that what
// is in shadow keeps its hue, and a light behind the surface gives nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace cellproj {

struct DirectionalLight {
    std::optional<glm::dvec3> towards{};  // from the scene to the light, of any length > 0; nothing: to the eye (a headlight)
    glm::dvec3 color{1.0};                // ≥ 0, times both parts below
    double diffuse = 0.7;                 // I_d, ≥ 0
    double specular = 0.2;                // I_s, ≥ 0
};

// By default a headlight, in which a surface that faces the eye has just its own colour.
struct Lighting {
    glm::dvec3 ambient{0.1};  // I_a as a share of C, ≥ 0
    double exponent = 20;     // p, ≥ 1
    bool two_sided = true;    // the back side is lit as if it were a front
    std::vector<DirectionalLight> lights = std::vector<DirectionalLight>(1);  // none: ambient light only
};

// Throws Error (option) at `place`, naming the light (counted from 0), for a direction without length, a number out of range
// or not finite.
void validate(const Lighting& lighting, const std::string& place);

// The reflected light of a surface of colour C ≥ 0, ≥ 0 and finite, not clamped: several lights may exceed 1. `normal`: points
// out of the front side, of any length; without a direction (0, or not finite) there is nothing to shade, and it is C. `to_eye`:
// of any length > 0. Independent of the lengths of all three directions.
glm::dvec3 shade(const Lighting& lighting, const glm::dvec3& color, const glm::dvec3& normal, const glm::dvec3& to_eye);

// The gradient below which a medium has no direction to be lit from [field's range over half the diagonal of the mesh]: a change of a
// thousandth across the scene, far above the rounding of data in float32 and of interpolation.
inline constexpr double weak_gradient = 1e-3;

// What a place in a medium sends to the eye of the light that its colour gives, by channel (EKE01 §5.4, RS00 §8): `shade` of a white surface
// whose normal is the gradient's, pointing to lower scalars, where there is a gradient:
//
//   1 + w (shade − 1),   w = g² / (g² + g₀²)
//
// `gradient`: over g₀ = weak_gradient. So it has no jumps, goes to 1 where the scalar is constant, and does not light noise.
glm::dvec3 lit_share(const Lighting& lighting, const glm::dvec3& gradient, const glm::dvec3& to_eye);

}  // namespace cellproj
