#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell of a grid: the ray cut by the cell's planes. Neighbours compute the same place on the plane between them
// from the same numbers, so that segments follow each other without gap or overlap. The method's file, behind this one, says what
// light a segment gives.
flat in vec3 v_low, v_high, v_inverse_edges;
flat in vec4 v_bottom, v_top;

uniform vec2 ray_center;
uniform float pixels_per_unit;
uniform vec3 axis_right, axis_down, axis_forward;
#ifndef PERSPECTIVE
// 1 / axis_forward. Where that is 0, a large number, and a little to add to the ray's place there: a ray on a plane of the grid is in
// the cell above it.
uniform vec3 inverse_forward, nudge;
#endif

layout(location = 0) out vec4 light;  // associated colour, opacity

#define scalars float

// Scalars 0..1, length >= 0, all in scene units.
vec4 light_of_segment(float s_front, float s_back, float segment);

float scalar_at(vec3 place) {
    vec3 u = clamp((place - v_low) * v_inverse_edges, 0.0, 1.0);
    vec4 slice = mix(v_bottom, v_top, u.z);
    vec2 row = mix(slice.xy, slice.zw, u.y);
    return mix(row.x, row.y, u.x);
}

void main() {
    vec2 pixel = (gl_FragCoord.xy - ray_center) / pixels_per_unit;
    vec3 across = pixel.x * axis_right + pixel.y * axis_down;
#ifdef PERSPECTIVE
    // The eye is the origin: of two cells on whose common plane a ray runs, the one below it ends there at once.
    vec3 origin = vec3(0.0), direction = axis_forward + across;
    direction = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
    vec3 inverse = 1.0 / direction;
    vec3 to_low = v_low, to_high = v_high;
    float enter = 0.0, stretch = length(direction);
#else
    vec3 origin = across, direction = axis_forward, inverse = inverse_forward;
    vec3 to_low = v_low - origin - nudge, to_high = v_high - origin - nudge;
    float enter = -1e30, stretch = 1.0;
#endif
    vec3 at_low = to_low * inverse, at_high = to_high * inverse;
    vec3 nearer = min(at_low, at_high), farther = max(at_low, at_high);
    enter = max(max(enter, nearer.x), max(nearer.y, nearer.z));
    float leave = min(farther.x, min(farther.y, farther.z));
    if (!(enter < leave)) discard;
    float s_front = scalar_at(origin + enter * direction), s_back = scalar_at(origin + leave * direction);
    light = light_of_segment(s_front, s_back, (leave - enter) * stretch);
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
}
