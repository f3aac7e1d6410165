// SPDX-License-Identifier: BSD-3-Clause
// classify/mean_tables.hpp, MeanLengthTable: colour and opacity at the mean length, times length / mean length.
layout(binding = 0) uniform sampler2D table;
uniform float table_size;           // texels per axis
uniform vec4 table_range;           // what a texel is multiplied by
uniform float inverse_mean_length;

vec4 light_of_segment(float s_front, float s_back, float segment) {
    vec4 light = texture(table, (vec2(s_front, s_back) * (table_size - 1.0) + 0.5) / table_size) * table_range;
    float factor = segment * inverse_mean_length;
    if (light.a * factor > 1.0) factor = 1.0 / light.a;
    return vec4(light.rgb * factor, min(light.a * factor, 1.0));
}
