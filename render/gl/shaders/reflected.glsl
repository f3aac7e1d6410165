// SPDX-License-Identifier: BSD-3-Clause
//   HEADLIGHT  one light at the eye: nothing to be read, and no middle between two directions
uniform vec4 ambient;  // and the exponent
uniform float two_sided;
#ifdef HEADLIGHT
uniform vec4 headlight_diffuse, headlight_specular;
#else
uniform float light_count;
layout(binding = 13) uniform samplerBuffer lights;  // two each: direction to it, of length 1 (0: to the eye), diffuse; colour, specular
#endif

// classify/lighting.hpp: what of its colour a surface reflects. `to_eye` has length 1.
vec3 reflected(vec3 gradient, vec3 to_eye) {
    vec3 size = abs(gradient);
    float largest = max(max(size.x, size.y), size.z);
    vec3 normal = -normalize(gradient / largest);
#ifdef HEADLIGHT
    float facing = dot(normal, to_eye);
    facing = clamp(two_sided > 0.0 ? abs(facing) : facing, 0.0, 1.0);
    vec3 sum = ambient.rgb + headlight_diffuse.rgb * facing + headlight_specular.rgb * (facing > 0.0 ? pow(facing, ambient.w) : 0.0);
#else
    if (two_sided > 0.0 && dot(normal, to_eye) < 0.0) normal = -normal;
    vec3 sum = ambient.rgb;
    for (float i = 0.0; i < light_count; ++i) {
        vec4 first = texelFetch(lights, 2 * int(i));
        vec4 second = texelFetch(lights, 2 * int(i) + 1);
        vec3 to_light = first.xyz == vec3(0.0) ? to_eye : first.xyz;
        float facing = dot(normal, to_light);
        vec3 middle = to_light + to_eye;
        float highlight = pow(clamp(dot(normal, middle) / max(length(middle), 1e-30), 0.0, 1.0), ambient.w);
        sum += facing > 0.0 ? second.rgb * (first.w * min(facing, 1.0) + second.w * highlight) : vec3(0.0);
    }
#endif
    return largest > 0.0 ? sum : vec3(1.0);
}
