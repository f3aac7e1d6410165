#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// Light interpolated over the polygons of a template.
in vec4 v_light;

layout(location = 0) out vec4 light;  // associated colour, opacity

void main() {
    // Pixel centres just outside a sliver extrapolate.
    light = vec4(max(v_light.rgb, 0.0), clamp(v_light.a, 0.0, 1.0));
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
}
