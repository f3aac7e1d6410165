// SPDX-License-Identifier: BSD-3-Clause
// RKE00 section 2, after Stein et al.: mean chromaticity of both ends, opacity of their mean extinction.
uniform float by_chromaticity;  // 1: the samples hold chromaticity, 0: emission

vec4 light_of_segment(scalars s_front, scalars s_back, float segment) {
    vec4 mean = 0.5 * (function_at(s_front) + function_at(s_back));
    return homogeneous_light(mean.rgb * mix(1.0, mean.a, by_chromaticity), mean.a, segment);
}
