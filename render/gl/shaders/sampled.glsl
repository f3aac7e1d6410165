// SPDX-License-Identifier: BSD-3-Clause
// classify/sampled_function.hpp: the transfer function at 4096 scalars. The method stands behind this file.
layout(binding = 0) uniform samplerBuffer samples;

// Emission or chromaticity, extinction. s in 0..1.
vec4 function_at(float s) {
    float position = clamp(s, 0.0, 1.0) * 4095.0;
    float first = min(floor(position), 4094.0);
    return mix(texelFetch(samples, int(first)), texelFetch(samples, int(first) + 1), position - first);
}
