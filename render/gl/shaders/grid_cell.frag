// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell of a grid: the ray cut by the cell's planes. Neighbours compute the same place on the plane between them
// from the same numbers, so that segments follow each other without gap or overlap. Behind grid_rays.frag and grid_light.glsl; the method's
// file, behind this one, says what light a segment gives.
//   SURFACES  rays are cut at all places where the trilinear scalar passes an isovalue (grid_surfaces.glsl)
flat in vec3 v_low, v_high, v_inverse_edges;
flat in vec4 v_bottom, v_top;

#ifdef WINDOW
layout(binding = 10) uniform samplerBuffer windows;  // of the pixels: what is kept of their rays, by the ray's parameter
uniform float window_width;                          // pixels in a row
#endif

// What is kept of a part of the ray.
vec2 kept_of(vec2 part) {
#ifdef WINDOW
    vec2 window = texelFetch(windows, int(gl_FragCoord.x) + int(window_width) * int(gl_FragCoord.y)).xy;
    return vec2(max(part.x, window.x), min(part.y, window.y));
#else
    return part;
#endif
}

layout(location = 0) out vec4 light;  // associated colour, opacity

#define scalars float

// Scalars 0..1, length >= 0, all in scene units.
vec4 light_of_segment(float s_front, float s_back, float segment);

#ifdef ON_CELLS
float scalar_at(vec3 place) { return v_bottom.x; }
#else
float scalar_at(vec3 place) {
    vec3 u = clamp((place - v_low) * v_inverse_edges, 0.0, 1.0);
    vec4 slice = mix(v_bottom, v_top, u.z);
    vec2 row = mix(slice.xy, slice.zw, u.y);
    return mix(row.x, row.y, u.x);
}
#endif

vec3 place_in_cell(Ray ray, float t) {
    precise vec3 u = (ray.origin + t * ray.direction - v_low) * v_inverse_edges;
    return clamp(u, 0.0, 1.0);
}

#ifdef LIT
flat in vec3 v_cell;  // its place in the grid

vec3 gradient_in_cell(vec3 u) {
#ifdef SMOOTH
    return texture(gradients, (v_cell + u + 0.5) / vec3(textureSize(gradients, 0))).rgb;
#else
    vec4 slice = mix(v_bottom, v_top, u.z), rise = v_top - v_bottom;
    vec2 row = mix(slice.xy, slice.zw, u.y), climb = slice.zw - slice.xy, ascent = mix(rise.xy, rise.zw, u.y);
    return vec3(row.y - row.x, mix(climb.x, climb.y, u.x), mix(ascent.x, ascent.y, u.x)) * v_inverse_edges;
#endif
}
#endif

// What of its light the medium sends to the eye, from where the ray enters to where it leaves.
void find_shares(Ray ray, vec2 inside) {
#ifdef LIT_MEDIUM
    vec3 to_eye = -ray.direction / ray.stretch;
    share_in_front = lit_share(per_weak_gradient * gradient_in_cell(place_in_cell(ray, inside.x)), to_eye);
    share_behind = lit_share(per_weak_gradient * gradient_in_cell(place_in_cell(ray, inside.y)), to_eye);
#endif
}

#ifdef SURFACES
const int root_steps = 14;

// The trilinear scalar at u. On a face it is one number for both cells: the shares of what lies across are exactly 0.
float scalar_in_cell(vec3 u) {
    precise vec4 slice = (1.0 - u.z) * v_bottom + u.z * v_top;
    precise vec2 row = (1.0 - u.y) * slice.xy + u.y * slice.zw;
    precise float s = (1.0 - u.x) * row.x + u.x * row.y;
    return s;
}

// Along the ray the scalar is a cubic, from its value at the front on: slope, square, cube.
float cubic_at(float start, vec3 c, float x) { return ((c.z * x + c.y) * x + c.x) * x + start; }

// Where it is v, monotonic from low to high: Newton's steps, halved where they leave what is known to hold the root.
float root_of(float start, vec3 c, float v, float low, float high, bool rising) {
    float x = 0.5 * (low + high);
    for (int i = 0; i < root_steps; ++i) {
        float s = cubic_at(start, c, x), slope = (3.0 * c.z * x + 2.0 * c.y) * x + c.x;
        if ((s < v) == rising) low = x;
        else high = x;
        float newton = x + (v - s) / slope;
        x = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    }
    return x;
}

// The places where it turns back inside, ascending; 1 for none.
vec2 turns_of(vec3 c) {
    float a = 3.0 * c.z, discriminant = c.y * c.y - a * c.x;
    if (!(discriminant >= 0.0)) return vec2(1.0);
    float q = -(c.y + (c.y < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    float r0 = a != 0.0 ? q / a : 1.0, r1 = q != 0.0 ? c.x / q : 1.0;
    r0 = r0 > 0.0 && r0 < 1.0 ? r0 : 1.0;
    r1 = r1 > 0.0 && r1 < 1.0 ? r1 : 1.0;
    return vec2(min(r0, r1), max(r0, r1));
}

vec4 light_of_cut_cell(Ray ray, vec2 inside, float s_front, float s_back) {
    float step = (inside.y - inside.x) / 3.0, segment = (inside.y - inside.x) * ray.stretch;
    float s1 = scalar_in_cell(place_in_cell(ray, inside.x + step)), s2 = scalar_in_cell(place_in_cell(ray, inside.y - step));
    // Newton's differences through the four places.
    float d1 = s1 - s_front, d2 = s2 - 2.0 * s1 + s_front, d3 = s_back - 3.0 * s2 + 3.0 * s1 - s_front;
    vec3 c = vec3(3.0 * d1 - 1.5 * d2 + d3, 4.5 * (d2 - d3), 4.5 * d3);
    vec2 turns = turns_of(c);

    vec4 sum = vec4(0.0);
    float at = 0.0, s_at = s_front, begin = 0.0;  // the last crossing, and where the monotonic part begins
    int k = rank(s_front);
    for (int part = 0; part < 3; ++part) {
        float end = part == 0 ? turns.x : part == 1 ? turns.y : 1.0;
        int last = rank(end < 1.0 ? clamp(cubic_at(s_front, c, end), 0.0, 1.0) : s_back);
        while (k != last) {
            bool rising = k < last;
            int surface = surface_behind(k, rising);
            vec4 about = texelFetch(surfaces, surface);
            float x = root_of(s_front, c, about.y, max(at, begin), end, rising);
#ifdef MEDIUM
            sum += (1.0 - sum.a) * lit(light_of_segment(s_at, about.y, (x - at) * segment), at, x);
#endif
            vec4 layer = layer_of(surface, rising);
#ifdef LIT
            layer.rgb *= reflected(gradient_in_cell(place_in_cell(ray, inside.x + x * (inside.y - inside.x))), -ray.direction / ray.stretch);
#endif
            sum += (1.0 - sum.a) * layer;
            at = x;
            s_at = about.y;
            k += rising ? 1 : -1;
        }
        begin = end;
    }
#ifdef MEDIUM
    sum += (1.0 - sum.a) * lit(light_of_segment(s_at, s_back, (1.0 - at) * segment), at, 1.0);
#endif
    return sum;
}

void main() {
    Ray ray = ray_of_pixel();
    Crossings crossings = crossings_of(ray, v_low, v_high);
    vec2 inside = kept_of(part_between(crossings));
    if (!(inside.x < inside.y)) discard;
    vec3 nearer = min(crossings.low, crossings.high), farther = max(crossings.low, crossings.high);
    bvec3 up = lessThan(crossings.low, crossings.high);
    vec3 u_front = mix(place_in_cell(ray, inside.x), 1.0 - vec3(up), equal(nearer, vec3(inside.x)));
    vec3 u_back = mix(place_in_cell(ray, inside.y), vec3(up), equal(farther, vec3(inside.y)));
    find_shares(ray, inside);
    light = light_of_cut_cell(ray, inside, scalar_in_cell(u_front), scalar_in_cell(u_back));
}
#else
void main() {
    Ray ray = ray_of_pixel();
    vec2 inside = kept_of(part_between(ray, v_low, v_high));
    if (!(inside.x < inside.y)) discard;
    float s_front = scalar_at(ray.origin + inside.x * ray.direction), s_back = scalar_at(ray.origin + inside.y * ray.direction);
    find_shares(ray, inside);
    light = lit(light_of_segment(s_front, s_back, (inside.y - inside.x) * ray.stretch), 0.0, 1.0);
#ifdef HALF_OPACITY  // three passes in one: classify/half_opacity.hpp
    light *= vec4(vec3(1.0 - 0.5 * light.a), 1.0 - 0.25 * light.a);
#endif
}
#endif
