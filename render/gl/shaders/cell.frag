#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell. The method's file, behind this one, says what light it gives.
in vec3 v_ridges;
flat in vec4 v_base_depth, v_base_scalar;
flat in mat3 v_thickness;
flat in vec4 v_cell;
#ifdef TWO_FIELDS
flat in vec4 v_opacity_scalar;
flat in vec2 v_opacity_range;
#define scalars vec2  // that of the colour, that of the extinction
#else
#define scalars float
#endif

uniform vec2 principal_point;   // pixels
uniform float pixels_per_unit;  // perspective: pixels per length at depth 1
uniform float inverse_near;     // perspective: 1 / depth of the near plane

#ifdef WINDOW
layout(binding = 10) uniform samplerBuffer windows;  // of the pixels: what is kept of their rays, nearest and farthest nearness
uniform float window_width;                          // pixels in a row
#endif

layout(location = 0) out vec4 light;  // associated colour, opacity

// Scalars 0..1, length >= 0, all in scene units.
vec4 light_of_segment(scalars s_front, scalars s_back, float segment);

void main() {
    // About a pixel of the cell: the rasterizer's own interpolation, from a corner of the picture on, loses what slopes per pixel
    // times the picture's size.
    vec3 place = vec3(1.0, gl_FragCoord.xy - vec2(v_base_depth.w, v_base_scalar.w));
    float ridge = min(min(v_ridges.x, v_ridges.y), v_ridges.z);
    vec3 plane = ridge == v_ridges.x ? v_thickness[0] : ridge == v_ridges.y ? v_thickness[1] : v_thickness[2];
    float thickness = dot(plane, place);
    float base_depth = dot(v_base_depth.xyz, place);
    float base_scalar = dot(v_base_scalar.xyz, place);
    float other_scalar = base_scalar + v_cell.x * thickness;
    bool base_is_front = v_cell.w > 0.0;
    vec2 s = base_is_front ? vec2(base_scalar, other_scalar) : vec2(other_scalar, base_scalar);  // front, back
#ifdef TWO_FIELDS
    float base_opacity = dot(v_opacity_scalar.xyz, place);
    float other_opacity = base_opacity + v_opacity_scalar.w * thickness;
    vec2 s_opacity = base_is_front ? vec2(base_opacity, other_opacity) : vec2(other_opacity, base_opacity);
#endif
#ifdef PERSPECTIVE
    float front = base_is_front ? base_depth : base_depth + thickness;  // 1 / depth, nearer is larger
    float back = front - thickness;
    // Cells cut by the near plane are drawn from the eye on (cell_stream.hpp).
    bool at_near_plane = front > 0.999 * inverse_near;
    float depth_difference = at_near_plane ? 1.0 / back : thickness / (front * back);
    s /= vec2(front, back);
#ifdef TWO_FIELDS
    s_opacity /= vec2(front, back);
#endif
    vec2 offset = (gl_FragCoord.xy - principal_point) / pixels_per_unit;
    float ray = length(vec3(offset, 1.0));
#else
    float depth_difference = thickness;
    float ray = 1.0;
#endif
#ifdef WINDOW
#ifndef PERSPECTIVE
    const bool at_near_plane = false;
    float front = base_is_front ? -base_depth : thickness - base_depth;  // nearness, as that of the window
    float back = front - thickness;
#endif
    vec2 window = texelFetch(windows, int(gl_FragCoord.x) + int(window_width) * int(gl_FragCoord.y)).xy;
    if (window.x <= window.y) discard;
    vec2 ends = clamp(vec2(front, back), window.y, window.x);
    vec2 shares = front == back ? vec2(0.0, 1.0) : (front - ends) / (front - back);  // of the way from front to back, by depth
#ifdef PERSPECTIVE
    shares *= back / ends;
    depth_difference = (ends.x - ends.y) / (ends.x * ends.y);
    if (at_near_plane && window.x >= front) {  // from the eye, or from where the window begins before the near plane
        depth_difference = 1.0 / max(back, window.y) - (window.x < 1e30 ? 1.0 / window.x : 0.0);
        ends = vec2(depth_difference, 0.0);
    }
#else
    depth_difference = ends.x - ends.y;
#endif
    if (ends.x == ends.y) discard;
    s = clamp(s, v_cell.y, v_cell.z);
    s = mix(s.xx, s.yy, clamp(shares, 0.0, 1.0));
#ifdef TWO_FIELDS
    s_opacity = clamp(s_opacity, v_opacity_range.x, v_opacity_range.y);
    s_opacity = mix(s_opacity.xx, s_opacity.yy, clamp(shares, 0.0, 1.0));
#endif
#endif
    // Pixel centres just outside a sliver extrapolate; no segment leaves the cell's own range.
    float segment = min(abs(depth_difference), abs(v_cell.w)) * ray;
    s = clamp(s, v_cell.y, v_cell.z);
#ifdef TWO_FIELDS
    s_opacity = clamp(s_opacity, v_opacity_range.x, v_opacity_range.y);
    light = light_of_segment(vec2(s.x, s_opacity.x), vec2(s.y, s_opacity.y), segment);
#else
    light = light_of_segment(s.x, s.y, segment);
#endif
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
    // Less than nothing, close to an edge: what undoes the blending of this light. Dense media hide it.
    if (depth_difference < 0.0) light *= light.a < 0.25 ? -1.0 / (1.0 - light.a) : 0.0;
}
