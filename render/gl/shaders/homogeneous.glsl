// SPDX-License-Identifier: BSD-3-Clause
// WVG91, exponential homogeneous: means of both ends.
vec4 light_of_segment(scalars s_front, scalars s_back, float segment) {
    vec4 mean = 0.5 * (function_at(s_front) + function_at(s_back));
    return homogeneous_light(mean.rgb, mean.a, segment);
}
