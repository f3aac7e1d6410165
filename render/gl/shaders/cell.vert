#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes of cells (project/silhouette.hpp): positions are final and w = 1, so that ridges are interpolated linearly on the
// screen. What belongs to a triangle comes from its last vertex.
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in vec3 ridges;
layout(location = 2) in vec4 base_depth;   // depth term on the base, as a plane; x of the origin
layout(location = 3) in vec4 base_scalar;  // scalar term on the base, as a plane; y of the origin
layout(location = 4) in mat3 thickness;    // a plane for each ridge
layout(location = 7) in vec4 cell;         // scalar slope, lowest and highest scalar, depth range (negative: base at the back)
#ifdef TWO_FIELDS
layout(location = 8) in vec4 opacity_scalar;  // of the opacity field: term on the base, as a plane; slope
layout(location = 9) in vec2 opacity_range;   // lowest and highest

flat out vec4 v_opacity_scalar;
flat out vec2 v_opacity_range;
#endif

out vec3 v_ridges;
flat out vec4 v_base_depth, v_base_scalar;
flat out mat3 v_thickness;
flat out vec4 v_cell;

// What the method wants to know of a cell between two scalars.
void prepare_cell(float low, float high);

void main() {
    prepare_cell(cell.y, cell.z);
    v_ridges = ridges;
    v_base_depth = base_depth;
    v_base_scalar = base_scalar;
    v_thickness = thickness;
    v_cell = cell;
#ifdef TWO_FIELDS
    v_opacity_scalar = opacity_scalar;
    v_opacity_range = opacity_range;
#endif
    gl_Position = vec4(position, 0.0, 1.0);
}
