#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes of cells (project/silhouette.hpp): positions are final and w = 1, so that all terms are interpolated linearly
// on the screen.
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in vec2 base;      // depth term, scalar term on the base
layout(location = 2) in vec3 ridges;
layout(location = 3) in vec4 cell;      // scalar slope, lowest and highest scalar, depth range (negative: base at the back)

out vec2 v_base;
out vec3 v_ridges;
flat out vec4 v_cell;

// What the method wants to know of a cell between two scalars.
void prepare_cell(float low, float high);

void main() {
    prepare_cell(cell.y, cell.z);
    v_base = base;
    v_ridges = ridges;
    v_cell = cell;
    gl_Position = vec4(position, 0.0, 1.0);
}
