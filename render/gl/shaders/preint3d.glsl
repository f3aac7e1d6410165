// SPDX-License-Identifier: BSD-3-Clause
// classify/preintegration_table.hpp: effective emission and mean extinction over (s_f, s_b, u(l)).
layout(binding = 0) uniform sampler3D table;
uniform float table_size;            // texels per axis
uniform vec4 table_range;            // what a texel is multiplied by
uniform float inverse_length_scale;  // 1 / l0
uniform float inverse_log_range;     // 1 / log2(1 + l_max / l0)

vec4 light_of_segment(float s_front, float s_back, float segment) {
    float u = log2(1.0 + segment * inverse_length_scale) * inverse_log_range;
    vec3 texel = (vec3(s_front, s_back, u) * (table_size - 1.0) + 0.5) / table_size;
    vec4 emission_extinction = texture(table, texel) * table_range;
    return homogeneous_light(emission_extinction.rgb, emission_extinction.a, segment);
}
