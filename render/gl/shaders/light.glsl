// SPDX-License-Identifier: BSD-3-Clause
// What methods share.
// (1 - exp(-d)) / d. Below 1/16 the difference would lose digits; the next term of the series is d^4 / 120 < 2e-7.
float attenuation_mean(float d) {
    float series = 1.0 - d * (0.5 - d * (1.0 / 6.0 - d * (1.0 / 24.0)));
    return d < 0.0625 ? series : (1.0 - exp(-d)) / d;
}

// 1 - exp(-d), without rounding above 1.
float opacity_of_depth(float d) { return min(d * attenuation_mean(d), 1.0); }

// Of a segment with the same emission and extinction [per length] everywhere.
vec4 homogeneous_light(vec3 emission, float extinction, float segment) {
    float depth = extinction * segment;
    return vec4(emission * segment * attenuation_mean(depth), opacity_of_depth(depth));
}

