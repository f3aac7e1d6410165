// SPDX-License-Identifier: BSD-3-Clause
// The segments of a ray in some slabs of a grid, from front to back: EKE01 section 4.2. Each is cut by the box of the grid, so that the first
// and the last are as long as they are. Slices that two slabs share are looked up once. Behind
// grid_rays.frag and grid_light.glsl; light.glsl and the method's file are behind this one.
//   SURFACES  a slab is cut where isosurfaces cross it (grid_surfaces.glsl)
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

#if !defined(SURFACES) || defined(MEDIUM)
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
#endif

#ifdef LIT
vec3 gradient_at(vec3 place) {
    vec3 at = place * point_scale + point_offset;
#ifdef SMOOTH
    return texture(gradients, at).rgb;
#else
    // The derivative of the trilinear scalar along an axis: between the faces of the cell across it.
    vec3 size = vec3(textureSize(values, 0));
    vec3 low = clamp(floor(at * size - 0.5), vec3(0.0), size - 2.0);
    vec3 from = (low + 0.5) / size, to = (low + 1.5) / size;
    vec3 difference = vec3(texture(values, vec3(to.x, at.yz)).r - texture(values, vec3(from.x, at.yz)).r,
                           texture(values, vec3(at.x, to.y, at.z)).r - texture(values, vec3(at.x, from.y, at.z)).r,
                           texture(values, vec3(at.xy, to.z)).r - texture(values, vec3(at.xy, from.z)).r);
    return difference * point_scale * size;
#endif
}
#endif

#ifdef LIT_MEDIUM
// What the medium of a slice sends to the eye.
vec3 share_at(vec3 place, vec3 to_eye) { return lit_share(per_weak_gradient * gradient_at(place), to_eye); }
#endif

#ifdef SURFACES
// What a slab shows that surfaces cut.
vec4 light_of_cut_slab(vec3 front, vec3 back, float s_front, float s_back, float segment, vec3 to_eye) {
    int k = rank(s_front), end = rank(s_back);
    bool rising = k < end;
    vec4 sum = vec4(0.0);
    float at = 0.0, s_at = s_front;  // the last crossing
    for (;;) {
        bool crossed = k != end;
        int surface = surface_behind(k, rising);
        vec4 about = texelFetch(surfaces, surface);
        float share = crossed && s_front != s_back ? clamp((about.y - s_front) / (s_back - s_front), at, 1.0) : 1.0;
#ifdef MEDIUM
        float s_here = crossed ? clamp(about.y, min(s_front, s_back), max(s_front, s_back)) : s_back;
        sum += (1.0 - sum.a) * lit(light_of_slab(front, back, s_at, s_here, (share - at) * segment), at, share);
        s_at = s_here;
#endif
        if (!crossed) break;
        vec4 layer = layer_of(surface, rising);
#ifdef LIT
        layer.rgb *= reflected(gradient_at(mix(front, back, share)), to_eye);
#endif
        sum += (1.0 - sum.a) * layer;
        at = share;
        k += rising ? 1 : -1;
    }
    return sum;
}
#endif

// Where a ray crosses a slice. Slices that two polygons share must get the same number from both: never rearranged.
float crossing(float slice, float start, float inverse, vec2 inside) {
    precise float t = (slices.x + slice * slices.y - start) * inverse;
    return clamp(t, inside.x, inside.y);
}
vec3 place_on(Ray ray, float t) {
    precise vec3 place = ray.origin + t * ray.direction;
    return place;
}

void main() {
    Ray ray = ray_of_pixel();
    vec2 inside = part_between(ray, box_low, box_high);
    if (!(inside.x < inside.y)) discard;
    float approach = dot(slice_normal, ray.direction), start = dot(slice_normal, ray.origin);
    float inverse = 1.0 / (abs(approach) < 1e-20 ? 1e-20 : approach);

    light = vec4(0.0);
    float t = crossing(v_slabs.x, start, inverse, inside);
    vec3 place = place_on(ray, t);
#if defined(PRE) || defined(POST)
    float s = 0.0;
#else
    float s = scalar_at(place);
#endif
    vec3 to_eye = -ray.direction / ray.stretch;
#ifdef LIT_MEDIUM
    vec3 share = share_at(place, to_eye);
#endif
    for (int k = 1; k <= SLABS; ++k) {
        float next_t = crossing(v_slabs.x + float(k) * v_slabs.y, start, inverse, inside);
        vec3 next_place = place_on(ray, next_t);
#if defined(PRE) || defined(POST)
        float next_s = 0.0;
#else
        float next_s = scalar_at(next_place);
#endif
        // Rays towards the other side of the eye end in its slab.
        bool away = next_t >= t;
#ifdef LIT_MEDIUM
        vec3 next_share = share_at(next_place, to_eye);
        share_in_front = away ? share : next_share;
        share_behind = away ? next_share : share;
        share = next_share;
#endif
#ifdef SURFACES
        vec4 slab = light_of_cut_slab(away ? place : next_place, away ? next_place : place, away ? s : next_s, away ? next_s : s,
                                      abs(next_t - t) * ray.stretch, to_eye);
#else
        vec4 slab = lit(light_of_slab(place, next_place, away ? s : next_s, away ? next_s : s, abs(next_t - t) * ray.stretch), 0.0, 1.0);
#endif
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
        slab *= vec4(vec3(1.0 - 0.5 * slab.a), 1.0 - 0.25 * slab.a);
#endif
        light += (1.0 - light.a) * slab;
        t = next_t;
        place = next_place;
        s = next_s;
    }
}
