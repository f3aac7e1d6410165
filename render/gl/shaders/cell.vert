#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Projected cells: positions are final, w = 1, so that all terms are interpolated linearly on the screen.
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in vec4 terms;     // front depth, thickness, front scalar, back scalar (tet_projection.hpp)
layout(location = 2) in vec3 bounds;    // scalar low, scalar high, depth range of the cell

out vec4 v_terms;
flat out vec3 v_bounds;

void main() {
    v_terms = terms;
    v_bounds = bounds;
    gl_Position = vec4(position, 0.0, 1.0);
}
