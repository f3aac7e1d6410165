// SPDX-License-Identifier: BSD-3-Clause
// The segments of a ray in some slabs of a grid, from front to back: EKE01 section 4.2. Each is cut by the box of the grid, so that the first
// and the last are as long as they are. Slices that two slabs share are looked up once. Behind
// grid_rays.frag; light.glsl and the method's file are behind this one.
flat in vec2 v_slabs;

layout(binding = 8) uniform sampler3D values;  // scalars 0..1 at points, interpolated between them
#ifdef PRE
layout(binding = 10) uniform sampler3D classified;  // emission, extinction at points
#endif
uniform vec3 box_low, box_high;                 // about the view's reference point, scene units
uniform vec3 point_scale, point_offset;         // from there to texture coordinates
uniform vec3 slice_normal;
uniform vec2 slices;                            // where the first is along the normal, and how far apart they are

layout(location = 0) out vec4 light;  // associated colour, opacity

#define scalars float

#ifdef PRE
vec4 homogeneous_light(vec3 emission, float extinction, float segment);  // light.glsl
#else
vec4 light_of_segment(float s_front, float s_back, float segment);
#endif

float scalar_at(vec3 place) { return texture(values, place * point_scale + point_offset).r; }

// What a slab between two places shows; s: of its slices.
vec4 light_of_slab(vec3 front, vec3 back, float s_front, float s_back, float segment) {
#if defined(PRE)
    vec4 middle = texture(classified, 0.5 * (front + back) * point_scale + point_offset);
    return homogeneous_light(middle.rgb, middle.a, segment);
#elif defined(POST)
    float s = scalar_at(0.5 * (front + back));
    return light_of_segment(s, s, segment);
#else
    return light_of_segment(s_front, s_back, segment);
#endif
}

void main() {
    Ray ray = ray_of_pixel();
    vec2 inside = part_between(ray, box_low, box_high);
    if (!(inside.x < inside.y)) discard;
    float approach = dot(slice_normal, ray.direction), start = dot(slice_normal, ray.origin);
    float inverse = 1.0 / (abs(approach) < 1e-20 ? 1e-20 : approach);

    light = vec4(0.0);
    float t = clamp((slices.x + v_slabs.x * slices.y - start) * inverse, inside.x, inside.y);
    vec3 place = ray.origin + t * ray.direction;
#if defined(PRE) || defined(POST)
    float s = 0.0;
#else
    float s = scalar_at(place);
#endif
    for (int k = 1; k <= SLABS; ++k) {
        float next_t = clamp((slices.x + (v_slabs.x + float(k) * v_slabs.y) * slices.y - start) * inverse, inside.x, inside.y);
        vec3 next_place = ray.origin + next_t * ray.direction;
#if defined(PRE) || defined(POST)
        float next_s = 0.0;
#else
        float next_s = scalar_at(next_place);
#endif
        // Rays towards the other side of the eye end in its slab.
        bool away = next_t >= t;
        vec4 slab = light_of_slab(place, next_place, away ? s : next_s, away ? next_s : s, abs(next_t - t) * ray.stretch);
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
        slab *= vec4(vec3(1.0 - 0.5 * slab.a), 1.0 - 0.25 * slab.a);
#endif
        light += (1.0 - light.a) * slab;
        t = next_t;
        place = next_place;
        s = next_s;
    }
}
