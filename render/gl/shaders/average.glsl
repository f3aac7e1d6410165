// SPDX-License-Identifier: BSD-3-Clause
// WVG91 Eq. 9-10, means of both ends times length. At opacity 1 the segment ends, for the colour as well.
vec4 light_of_segment(scalars s_front, scalars s_back, float segment) {
    vec4 mean = 0.5 * (function_at(s_front) + function_at(s_back));
    float depth = mean.a * segment;
    float seen = depth > 1.0 ? 1.0 / mean.a : segment;
    return vec4(mean.rgb * seen, min(depth, 1.0));
}
