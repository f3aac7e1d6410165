#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes of cells that isosurfaces may cross (render/surface_vertex.hpp): positions are final and w = 1. What belongs to a
// triangle comes from its last vertex.
layout(location = 0) in vec4 position;      // clip space; of the opacity field: value at the frame's place and slope along x
layout(location = 1) in vec4 ridges;        // three; slope of the opacity field along y
layout(location = 2) in vec4 faces[8];      // two for each face, the base first: nearness, scalar term; planes and x, y of the origin
layout(location = 10) in vec4 scalars;      // of the corners opposite to the faces
layout(location = 11) in vec4 cell;         // first and last surface, depth range (negative: base at the back); slope along z
layout(location = 12) in vec4 maps[4];      // gradient and scalar at the frame's place, what they change by along x, y, z

out vec3 v_ridges;
flat out vec4 v_faces[8];
flat out vec4 v_scalars;
flat out vec3 v_cell;
#ifdef TWO_FIELDS
flat out vec4 v_opacity;
#endif
flat out vec4 v_map;
flat out mat3x4 v_slopes;

// What the method wants to know of a cell between two scalars.
void prepare_cell(float low, float high);

void main() {
    prepare_cell(min(min(scalars.x, scalars.y), min(scalars.z, scalars.w)), max(max(scalars.x, scalars.y), max(scalars.z, scalars.w)));
    v_ridges = ridges.xyz;
    v_faces = faces;
    v_scalars = scalars;
    v_cell = cell.xyz;
#ifdef TWO_FIELDS
    v_opacity = vec4(position.zw, ridges.w, cell.w);
#endif
    v_map = maps[0];
    v_slopes = mat3x4(maps[1], maps[2], maps[3]);
    gl_Position = vec4(position.xy, 0.0, 1.0);
}
