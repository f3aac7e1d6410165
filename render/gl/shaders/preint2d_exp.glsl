// SPDX-License-Identifier: BSD-3-Clause
// classify/mean_tables.hpp, MeanValueTable: mean emission and extinction over (s_f, s_b).
layout(binding = 0) uniform sampler2D table;
uniform float table_size;  // texels per axis
uniform vec4 table_range;  // what a texel is multiplied by

vec4 light_of_segment(float s_front, float s_back, float segment) {
    vec4 mean = texture(table, (vec2(s_front, s_back) * (table_size - 1.0) + 0.5) / table_size) * table_range;
    return homogeneous_light(mean.rgb, mean.a, segment);
}
