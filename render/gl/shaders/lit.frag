#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Light interpolated between the vertices of the classical split.
in float v_share;
in vec3 v_color;
flat in vec3 v_thick;

layout(location = 0) out vec4 light;  // associated colour, opacity

void main() {
    // Pixel centres just outside a sliver extrapolate; nothing leaves the cell's own range.
    float share = clamp(v_share, 0.0, 1.0);
    vec3 color = clamp(v_color, 0.0, v_thick.z);
    light = share * vec4(color * v_thick.x, v_thick.y);
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
}
