// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell of a grid: the ray cut by the cell's planes. Neighbours compute the same place on the plane between them
// from the same numbers, so that segments follow each other without gap or overlap. Behind grid_rays.frag; the method's file, behind
// this one, says what light a segment gives.
flat in vec3 v_low, v_high, v_inverse_edges;
flat in vec4 v_bottom, v_top;

#ifdef WINDOW
layout(binding = 10) uniform samplerBuffer windows;  // of the pixels: what is kept of their rays, by the ray's parameter
uniform float window_width;                          // pixels in a row
#endif

layout(location = 0) out vec4 light;  // associated colour, opacity

#define scalars float

// Scalars 0..1, length >= 0, all in scene units.
vec4 light_of_segment(float s_front, float s_back, float segment);

#ifdef ON_CELLS
float scalar_at(vec3 place) { return v_bottom.x; }
#else
float scalar_at(vec3 place) {
    vec3 u = clamp((place - v_low) * v_inverse_edges, 0.0, 1.0);
    vec4 slice = mix(v_bottom, v_top, u.z);
    vec2 row = mix(slice.xy, slice.zw, u.y);
    return mix(row.x, row.y, u.x);
}
#endif

void main() {
    Ray ray = ray_of_pixel();
    vec2 inside = part_between(ray, v_low, v_high);
#ifdef WINDOW
    vec2 window = texelFetch(windows, int(gl_FragCoord.x) + int(window_width) * int(gl_FragCoord.y)).xy;
    inside = vec2(max(inside.x, window.x), min(inside.y, window.y));
#endif
    if (!(inside.x < inside.y)) discard;
    float s_front = scalar_at(ray.origin + inside.x * ray.direction), s_back = scalar_at(ray.origin + inside.y * ray.direction);
    light = light_of_segment(s_front, s_back, (inside.y - inside.x) * ray.stretch);
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
}
