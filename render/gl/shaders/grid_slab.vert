#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// What some slabs of a grid that follow each other cover on the screen.
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in vec2 slabs;     // the slice in front of the first one; +1 or -1: how slices are counted away from the eye

flat out vec2 v_slabs;

// What the method wants to know of a cell between two scalars.
void prepare_cell(float low, float high);

void main() {
    prepare_cell(0.0, 1.0);  // a slab may hold any
    v_slabs = slabs;
    gl_Position = vec4(position, 0.0, 1.0);
}
