#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell, from the pre-integration table (classify/preintegration_table.hpp).
in vec4 v_terms;
flat in vec3 v_bounds;

layout(binding = 0) uniform sampler3D table;  // (s_f, s_b, u(l)) -> effective emission g, mean extinction
uniform float table_size;                     // texels per axis
uniform float inverse_length_scale;           // 1 / l0
uniform float inverse_log_range;              // 1 / log2(1 + l_max / l0)
uniform vec2 principal_point;                 // pixels
uniform float pixels_per_unit;                // perspective: pixels per length at depth 1

layout(location = 0) out vec4 light;  // associated colour, opacity

// (1 - exp(-d)) / d. Below 1/16 the difference would lose digits; the next term of the series is d^4 / 120 < 2e-7.
float attenuation_mean(float d) {
    float series = 1.0 - d * (0.5 - d * (1.0 / 6.0 - d * (1.0 / 24.0)));
    return d < 0.0625 ? series : (1.0 - exp(-d)) / d;
}

void main() {
#ifdef PERSPECTIVE
    float inverse_front = v_terms.x;
    float inverse_back = inverse_front - v_terms.y;
    vec2 offset = (gl_FragCoord.xy - principal_point) / pixels_per_unit;
    float ray = length(vec3(offset, 1.0));
    float depth_difference = v_terms.y / (inverse_front * inverse_back);
    vec2 s = v_terms.zw / vec2(inverse_front, inverse_back);
#else
    float ray = 1.0;
    float depth_difference = v_terms.y;
    vec2 s = v_terms.zw;
#endif
    // Pixel centres just outside a sliver extrapolate; no segment leaves the cell's own range.
    float segment = clamp(depth_difference, 0.0, v_bounds.z) * ray;
    s = clamp(s, v_bounds.x, v_bounds.y);

    float u = log2(1.0 + segment * inverse_length_scale) * inverse_log_range;
    vec3 texel = (vec3(s, u) * (table_size - 1.0) + 0.5) / table_size;
    vec4 emission_extinction = texture(table, texel);
    float depth = emission_extinction.a * segment;  // optical depth
    float mean = attenuation_mean(depth);
    light = vec4(emission_extinction.rgb * segment * mean, depth * mean);
}
