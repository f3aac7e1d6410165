#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// The classical split of cells with light at its vertices (classify/vertex_light.hpp): positions are final and w = 1, so
// that all terms are interpolated linearly on the screen.
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in float share;    // of the thick vertex
layout(location = 2) in vec3 color;
layout(location = 3) in vec3 thick;     // weight and opacity at the thick vertex, largest channel of the cell's colours

out float v_share;
out vec3 v_color;
flat out vec3 v_thick;

void main() {
    v_share = share;
    v_color = color;
    v_thick = thick;
    gl_Position = vec4(position, 0.0, 1.0);
}
