#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// What is still to be drawn of a grid may cover.
layout(location = 0) in vec2 position;  // clip space

void main() {
    gl_Position = vec4(position, -1.0, 1.0);  // the least depth: open (grid_closed_tiles.cpp)
}
