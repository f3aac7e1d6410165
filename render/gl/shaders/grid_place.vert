#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Where a cell of a grid lies and what it holds, for the vertex stage. Places are about the view's reference point, the eye in
// perspective, in scene units.
layout(binding = 8) uniform sampler3D values;         // scalars 0..1, at points or cells
layout(binding = 9) uniform samplerBuffer planes;     // of the x axis, then y, then z
uniform vec3 grid_cells;                              // along each axis
uniform vec2 ray_center;                              // pixels: of the reference point (perspective: the principal point)
uniform float pixels_per_unit;                        // perspective: at depth 1
uniform vec3 axis_right, axis_down, axis_forward;
uniform vec2 picture;                                 // pixels

struct Box {
    ivec3 cell;
    vec3 low, high;
};

float plane(int i) { return texelFetch(planes, i >> 2)[i & 3]; }

Box box_of(int id) {
    ivec3 n = ivec3(grid_cells);
    int row = id / n.x;
    ivec3 cell = ivec3(id - row * n.x, row % n.y, row / n.y);
    ivec3 first = cell + ivec3(0, n.x + 1, n.x + n.y + 2);
    return Box(cell, vec3(plane(first.x), plane(first.y), plane(first.z)),
               vec3(plane(first.x + 1), plane(first.y + 1), plane(first.z + 1)));
}

// Corners 0 to 3 and 4 to 7 (mesh/grid.hpp).
void corner_scalars(ivec3 cell, out vec4 bottom, out vec4 top) {
#ifdef ON_CELLS
    bottom = top = vec4(texelFetch(values, cell, 0).r);
#else
    for (int i = 0; i < 4; ++i) {
        ivec3 corner = cell + ivec3(i & 1, i >> 1, 0);
        bottom[i] = texelFetch(values, corner, 0).r;
        top[i] = texelFetch(values, corner + ivec3(0, 0, 1), 0).r;
    }
#endif
}

vec2 on_screen(vec3 p) {
    vec2 place = vec2(dot(axis_right, p), dot(axis_down, p)) * pixels_per_unit;
#ifdef PERSPECTIVE
    place /= dot(axis_forward, p);
#endif
    return ray_center + place;
}

vec4 clip_space(vec2 pixel) { return vec4(2.0 * pixel / picture - 1.0, 0.0, 1.0); }
