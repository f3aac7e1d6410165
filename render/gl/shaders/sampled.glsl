// SPDX-License-Identifier: BSD-3-Clause
// classify/sampled_function.hpp: the transfer function at 4096 scalars. The method stands behind this file.
layout(binding = 0) uniform samplerBuffer samples;

vec4 sample_at(float s) {
    float position = clamp(s, 0.0, 1.0) * 4095.0;
    float first = min(floor(position), 4094.0);
    return mix(texelFetch(samples, int(first)), texelFetch(samples, int(first) + 1), position - first);
}

// Emission or chromaticity, extinction. s in 0..1.
#ifdef TWO_FIELDS
uniform float is_product;  // 1: emission is what is sampled times the extinction, 0: as sampled

vec4 function_at(vec2 s) {
    float extinction = sample_at(s.y).a;
    return vec4(sample_at(s.x).rgb * mix(1.0, extinction, is_product), extinction);
}
#else
vec4 function_at(float s) { return sample_at(s); }
#endif
