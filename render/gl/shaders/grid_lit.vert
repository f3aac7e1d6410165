// SPDX-License-Identifier: BSD-3-Clause
// A pair of points of a cell's template (project/cell_template.hpp) with the light of the segment between them, for the rasterizer to
// interpolate (WVG91's Gouraud). Either from the cell and the template (vertex = 16 * cell + pair of the template), behind
// grid_place.vert; or STREAMED from the CPU. The method's files, behind this one, say what light a segment gives.
#ifdef STREAMED
layout(location = 0) in vec2 position;  // clip space
layout(location = 1) in vec3 segment;   // scalars in front and at the back, length; a length of 0 on the silhouette
#else
layout(binding = 10) uniform samplerBuffer template_pairs;  // two texels a pair: in front and at the back, in the cell; of the first, .w is the length
#endif

out vec4 v_light;

#define scalars float

void prepare_cell(float low, float high);
vec4 light_of_segment(float s_front, float s_back, float segment);

#ifndef STREAMED
// At the low and high ends exact, so that neighbours meet.
vec3 place_in(Box box, vec3 u) { return (1.0 - u) * box.low + u * box.high; }

float scalar_in(vec4 bottom, vec4 top, vec3 u) {
    vec4 slice = mix(bottom, top, u.z);
    vec2 row = mix(slice.xy, slice.zw, u.y);
    return mix(row.x, row.y, u.x);
}
#endif

void main() {
#ifdef STREAMED
    gl_Position = vec4(position, 0.0, 1.0);
#else
    Box box = box_of(gl_VertexID >> 4);
    vec4 front = texelFetch(template_pairs, 2 * (gl_VertexID & 15)), back = texelFetch(template_pairs, 2 * (gl_VertexID & 15) + 1);
    vec4 bottom, top;
    corner_scalars(box.cell, bottom, top);
    vec3 segment = vec3(scalar_in(bottom, top, front.xyz), scalar_in(bottom, top, back.xyz), front.w);
    gl_Position = clip_space(on_screen(place_in(box, front.xyz)));
#endif
    prepare_cell(min(segment.x, segment.y), max(segment.x, segment.y));
    v_light = segment.z > 0.0 ? light_of_segment(segment.x, segment.y, segment.z) : vec4(0.0);
}
