// SPDX-License-Identifier: BSD-3-Clause
// classify/preintegration_table.hpp, TableScale::linear: colour and opacity over (s_f, s_b, l / l_max), RKE00 section 3.
layout(binding = 0) uniform sampler3D table;
uniform float table_size;      // texels per axis
uniform vec4 table_range;      // what a texel is multiplied by
uniform float inverse_longest; // 1 / l_max

vec4 light_of_segment(float s_front, float s_back, float segment) {
    vec3 texel = (vec3(s_front, s_back, segment * inverse_longest) * (table_size - 1.0) + 0.5) / table_size;
    vec4 light = texture(table, texel) * table_range;
    return vec4(light.rgb, min(light.a, 1.0));
}
