// SPDX-License-Identifier: BSD-3-Clause
// WVG91, exponential linear: homogeneous steps of equal length, each as the function is in its middle.
uniform float steps;

vec4 light_of_segment(scalars s_front, scalars s_back, float segment) {
    float step_length = segment / steps;
    vec3 color = vec3(0.0);
    float depth = 0.0;
    for (float k = 0.5; k < steps; k += 1.0) {
        vec4 middle = function_at(mix(s_front, s_back, k / steps));
        color += exp(-depth) * homogeneous_light(middle.rgb, middle.a, step_length).rgb;
        depth += middle.a * step_length;
    }
    return vec4(color, opacity_of_depth(depth));
}
