#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// One ray segment inside a cell, cut where isosurfaces cross it (RKE00 sections 5 to 10): the medium before a crossing, then the surface.
// The surfaces are found in their sorted list, so that the work grows with those crossed; or by
//   TABLE     one lookup over the scalars of the ends (RKE00 figures 6, 9 and 13): all as if they stood at the first one, where the medium is
//             cut (figure 15), or
//   COMBINED  part of them before and part behind the whole medium (RKE00 section 10)
//   MEDIUM    there is one (TWO_FIELDS: whose extinction is told by another field); the method's file, behind this one, says what light it gives
//   LIT       surfaces are shaded by the gradient, one for the cell or
//   SMOOTH    linear in it
//   LIT_MEDIUM  so is the medium
//   NEAREST   all are opaque and there is no medium: the first crossing, for the depth test
//   WINDOW    of each ray only a part is kept
in vec3 v_ridges;
flat in vec4 v_faces[8];
flat in vec4 v_scalars;
flat in vec3 v_cell;
flat in vec4 v_map;  // gradient and scalar in the cell
flat in mat3x4 v_slopes;
#ifdef TWO_FIELDS
flat in vec4 v_opacity;  // the second field: value, slopes
#define scalars vec2     // that of the colour, that of the extinction
#else
#define scalars float
#endif

uniform float inverse_far;     // perspective: 1 / depth of the farthest point
uniform vec2 principal_point;  // pixels
uniform float pixels_per_unit; // perspective: at depth 1
uniform float inverse_near;    // perspective: 1 / depth of the near plane
uniform float inverse_nearest; // 1 / the largest nearness
layout(binding = 8) uniform samplerBuffer surfaces;  // three each: threshold, isovalue, opacity; front, back: associated colour, opacity

#ifdef WINDOW
layout(binding = 10) uniform samplerBuffer windows;  // of the pixels: what is kept of their rays, nearest and farthest nearness
uniform float window_width;                          // pixels in a row
#endif

#ifdef TABLE
layout(binding = 11) uniform sampler2D layer_table;  // texels (s_front, s_back): all surfaces between, unlit; associated colour, opacity
layout(binding = 12) uniform sampler2D first_table;  // likewise, x: the isovalue of the first one
uniform float table_scale, table_shift;              // from scalars to texels (render/prepared_surfaces.hpp: SurfaceSides)
#endif

layout(location = 0) out vec4 light;  // associated colour, opacity

#ifdef MEDIUM
// Scalars 0..1, length >= 0, all in scene units.
vec4 light_of_segment(scalars s_front, scalars s_back, float segment);
#endif

// How many surfaces each scalar is not below (render/prepared_surfaces.hpp), known to be between both.
ivec2 ranks(vec2 s, int low, int high) {
    ivec2 from = ivec2(low), to = ivec2(high);
    while (any(lessThan(from, to))) {
        ivec2 middle = (from + to) / 2;  // where a search has ended: its end, and what is behind the list is not read
        ivec2 read = 3 * min(middle, high - 1);
        vec2 thresholds = vec2(texelFetch(surfaces, read.x).x, texelFetch(surfaces, read.y).x);
        bvec2 open = lessThan(from, to), below = lessThan(s, thresholds);
        to = ivec2(open.x && below.x ? middle.x : to.x, open.y && below.y ? middle.y : to.y);
        from = ivec2(open.x && !below.x ? middle.x + 1 : from.x, open.y && !below.y ? middle.y + 1 : from.y);
    }
    return from;
}

// Nearness and scalar of the ray on a face between two scalars. Both cells of the face must get the same bits: the same arithmetic
// on the same numbers, never rearranged.
vec2 on_face(vec4 nearness_plane, vec4 scalar_plane, vec2 range) {
    vec2 place = gl_FragCoord.xy - vec2(nearness_plane.w, scalar_plane.w);
    precise float nearness = nearness_plane.x + nearness_plane.y * place.x + nearness_plane.z * place.y;
    precise float scalar = scalar_plane.x + scalar_plane.y * place.x + scalar_plane.z * place.y;
#ifdef PERSPECTIVE
    precise float inverse_depth = max(nearness + inverse_far, 1e-30);
    scalar = scalar / inverse_depth;
#endif
    return vec2(nearness, clamp(scalar, range.x, range.y));
}

// The share of the way between two scalars where a value is met.
float way_to(float value, float from, float to) { return from != to ? clamp((value - from) / (to - from), 0.0, 1.0) : 1.0; }

vec2 ends(float a, float b, float c) { return vec2(min(min(a, b), c), max(max(a, b), c)); }

#ifdef LIT
uniform vec4 axis_right, axis_down, axis_forward;  // of the camera, in those of the mesh

vec3 reflected(vec3 gradient, vec3 to_eye);  // reflected.glsl
#endif

#ifdef MEDIUM
#ifdef LIT_MEDIUM
vec3 share_in_front, share_behind;  // what of its light the medium sends to the eye, linear between
vec3 lit_share(vec3 gradient, vec3 to_eye);  // lit_medium.glsl
vec4 lit(vec4 light, float from, float to);
#else
vec4 lit(vec4 light, float from, float to) { return light; }
#endif
#endif

// In eye space, from the farthest point's depth on: where the field of the cell is told.
vec3 place_at(vec2 offset, float depth) {
#ifdef PERSPECTIVE
    return vec3(offset * (depth + 1.0 / inverse_far), depth);
#else
    return vec3(offset, depth);
#endif
}

#ifdef NEAREST
void set_depth(float depth) {  // from the farthest point's on
#ifdef PERSPECTIVE
    gl_FragDepth = -depth * inverse_far / (depth + 1.0 / inverse_far) * inverse_nearest;
#else
    gl_FragDepth = -depth * inverse_nearest;
#endif
}
#endif

void main() {
    float ridge = min(min(v_ridges.x, v_ridges.y), v_ridges.z);
    int other = ridge == v_ridges.x ? 1 : ridge == v_ridges.y ? 2 : 3;
    vec4 nearness_plane = other == 1 ? v_faces[2] : other == 2 ? v_faces[4] : v_faces[6];
    vec4 scalar_plane = other == 1 ? v_faces[3] : other == 2 ? v_faces[5] : v_faces[7];
    vec3 corners = other == 1 ? v_scalars.xzw : other == 2 ? v_scalars.xyw : v_scalars.xyz;  // of that face
    vec2 on_base = on_face(v_faces[0], v_faces[1], ends(v_scalars.y, v_scalars.z, v_scalars.w));
    vec2 on_other = on_face(nearness_plane, scalar_plane, ends(corners.x, corners.y, corners.z));
    bool base_is_front = v_cell.z > 0.0;
    vec2 front = base_is_front ? on_base : on_other, back = base_is_front ? on_other : on_base;

    vec2 offset = (gl_FragCoord.xy - principal_point) / pixels_per_unit;
#ifdef PERSPECTIVE
    float front_inverse = max(front.x + inverse_far, 1e-30), back_inverse = max(back.x + inverse_far, 1e-30);
    float depth_difference = max(front.x - back.x, 0.0) / (front_inverse * back_inverse);
    float ray = length(vec3(offset, 1.0));
    // Cells cut by the near plane are drawn from the eye on (render/cell_stream.hpp).
    float lead = front_inverse > 0.999 * inverse_near ? ray / front_inverse : 0.0;
    float front_depth = -front.x / (front_inverse * inverse_far);  // from the farthest point's on
#else
    float depth_difference = max(front.x - back.x, 0.0);
    float ray = 1.0, lead = 0.0;
    float front_depth = -front.x;
#endif
    depth_difference = min(depth_difference, abs(v_cell.z));
    float segment = depth_difference * ray;
    vec2 kept = vec2(0.0, 1.0);  // of the way from front to back
#ifdef WINDOW
    vec2 window = texelFetch(windows, int(gl_FragCoord.x) + int(window_width) * int(gl_FragCoord.y)).xy;
    if (window.x <= window.y || window.x <= back.x || (window.y >= front.x && lead == 0.0)) discard;
    vec2 cuts = clamp((front.x - window) / max(front.x - back.x, 1e-30), 0.0, 1.0);
#ifdef PERSPECTIVE
    cuts = clamp(cuts * back_inverse / max(window + inverse_far, 1e-30), 0.0, 1.0);
    if (window.x >= front.x && lead > 0.0)
        lead = max(1.0 / max(front_inverse, window.y + inverse_far) - (window.x < 1e30 ? 1.0 / (window.x + inverse_far) : 0.0), 0.0) * ray;
#endif
    if (window.x < front.x) {
        kept.x = cuts.x;
        lead = 0.0;
    }
    if (window.y > back.x) kept.y = window.y < front.x ? cuts.y : 0.0;
#endif
    // The field at both ends, in the cell's own range beyond which slivers extrapolate. `front` and `back` tell the sides of surfaces and, as
    // gradients are linear between the points where the rasterizer has them, also where on its way the gradient becomes a surface's: in
    // a sliver, the two scalars of one place are far apart.
    vec3 place_in_front = place_at(offset, front_depth), place_behind = place_at(offset, front_depth + depth_difference);
    vec4 at_front = v_map + v_slopes * place_in_front, at_back = v_map + v_slopes * place_behind;
    vec2 range = vec2(min(v_scalars.x, ends(v_scalars.y, v_scalars.z, v_scalars.w).x), max(v_scalars.x, ends(v_scalars.y, v_scalars.z, v_scalars.w).y));
    vec2 s = clamp(vec2(at_front.w, at_back.w), range.x, range.y);
#ifdef TWO_FIELDS
    vec2 s_opacity = v_opacity.xx + vec2(dot(v_opacity.yzw, place_in_front), dot(v_opacity.yzw, place_behind));
    s_opacity = clamp(s_opacity, 0.0, 1.0);
#endif

#ifdef LIT
#ifdef PERSPECTIVE
    vec3 to_eye = -(offset.x * axis_right.xyz + offset.y * axis_down.xyz + axis_forward.xyz) / ray;
#else
    vec3 to_eye = -axis_forward.xyz;
#endif
#endif
#ifdef LIT_MEDIUM
#ifdef SMOOTH
    share_in_front = lit_share(at_front.xyz, to_eye);
    share_behind = lit_share(at_back.xyz, to_eye);
#else
    share_in_front = share_behind = lit_share(v_map.xyz, to_eye);
#endif
#endif

#ifdef TABLE
    precise vec2 place = vec2(front.y, back.y) * table_scale + table_shift;  // both cells of a face: the same
    ivec2 texel = ivec2(floor(clamp(place, 0.0, table_scale)));
    vec4 layers = texelFetch(layer_table, texel, 0);
    float first_value = texelFetch(first_table, texel, 0).x, value = clamp(first_value, min(s.x, s.y), max(s.x, s.y));
    float share = way_to(value, s.x, s.y);
    vec2 s_kept = vec2(mix(s.x, s.y, kept.x), mix(s.x, s.y, kept.y));
    bool crossed = layers.a > 0.0;
#ifdef WINDOW
    crossed = crossed && share >= kept.x && share <= kept.y;
    if (!crossed) layers = vec4(0.0);
#endif
#ifdef NEAREST
    if (!crossed) discard;
#endif
    // The part at the front of a layer of opacity a at share t has (1 - t)a; the part at the back makes the rest of it.
    float t = clamp((share - kept.x) / max(kept.y - kept.x, 1e-30), 0.0, 1.0);
    vec4 at_face = (1.0 - t) * layers, behind = layers * (t / max(1.0 - at_face.a, 1e-30));
#if defined(SMOOTH) && defined(COMBINED)
    at_face.rgb *= reflected(at_front.xyz, to_eye);
    behind.rgb *= reflected(at_back.xyz, to_eye);
#elif defined(LIT)
#ifdef SMOOTH
    vec3 share_of_color = reflected(mix(at_front.xyz, at_back.xyz, way_to(first_value, front.y, back.y)), to_eye);
#else
    vec3 share_of_color = reflected(v_map.xyz, to_eye);
#endif
    layers.rgb *= share_of_color;
    at_face.rgb *= share_of_color;
    behind.rgb *= share_of_color;
#endif
#ifdef COMBINED
    light = at_face;
#ifdef MEDIUM
#ifdef TWO_FIELDS
    vec2 o_kept = vec2(mix(s_opacity.x, s_opacity.y, kept.x), mix(s_opacity.x, s_opacity.y, kept.y));
    vec4 medium = light_of_segment(vec2(s_kept.x, o_kept.x), vec2(s_kept.y, o_kept.y), (kept.y - kept.x) * segment + lead);
#else
    vec4 medium = light_of_segment(s_kept.x, s_kept.y, (kept.y - kept.x) * segment + lead);
#endif
    light += (1.0 - light.a) * lit(medium, kept.x, kept.y);
#endif
    light += (1.0 - light.a) * behind;
#else
    light = vec4(0.0);
#ifdef MEDIUM
    // Once, or twice where there are surfaces: a loop, as code that is written twice is run twice.
    float from = kept.x, to = crossed ? share : kept.y, s_at = s_kept.x, s_to = crossed ? value : s_kept.y;
    for (bool before = true;;) {
        float part = (to - from) * segment + lead;
#ifdef TWO_FIELDS
        vec4 medium = light_of_segment(vec2(s_at, mix(s_opacity.x, s_opacity.y, from)), vec2(s_to, mix(s_opacity.x, s_opacity.y, to)), part);
#else
        vec4 medium = light_of_segment(s_at, s_to, part);
#endif
        light += (1.0 - light.a) * lit(medium, from, to);
        if (before) light += (1.0 - light.a) * layers;
        if (!before || !crossed || light.a >= 1.0) break;
        from = to;
        to = kept.y;
        s_at = s_to;
        s_to = s_kept.y;
        lead = 0.0;
        before = false;
    }
#else
    light = layers;
#endif
#endif
#ifdef NEAREST
    set_depth(front_depth + share * depth_difference);
    light.a = 1.0;
#endif
#else
    int first = int(v_cell.x), last = int(v_cell.y);
    ivec2 both = ranks(vec2(front.y, back.y), first, last);
    int k = both.x, end = both.y;
    bool rising = k < end;
    light = vec4(0.0);
#ifdef NEAREST
    if (k == end) discard;
#endif
#if defined(LIT) && !defined(SMOOTH)
    vec3 share_of_color = reflected(v_map.xyz, to_eye);
#endif
    float at = kept.x, s_at = mix(s.x, s.y, kept.x);  // where the last crossing was, as a share of the segment, and the scalar there
    for (;;) {
        bool crossed = k != end;
#if !defined(MEDIUM) && !defined(NEAREST)
        if (!crossed) break;
#endif
        int surface = 3 * max(rising ? k : k - 1, 0);
        vec4 about = texelFetch(surfaces, surface);
        float share = crossed ? way_to(about.y, s.x, s.y) : 1.0;
#ifdef WINDOW
        if (crossed && share < kept.x) {
            k += rising ? 1 : -1;
            continue;
        }
        crossed = crossed && share <= kept.y;
        share = min(share, kept.y);
#ifdef NEAREST
        if (!crossed) discard;
#endif
#endif
        share = max(share, at);
#ifdef MEDIUM
        float s_here = crossed ? clamp(about.y, min(s.x, s.y), max(s.x, s.y)) : mix(s.x, s.y, share);
        float part = (share - at) * segment + lead;
#ifdef TWO_FIELDS
        vec2 from = vec2(s_at, mix(s_opacity.x, s_opacity.y, at)), to = vec2(s_here, mix(s_opacity.x, s_opacity.y, share));
        vec4 medium = light_of_segment(from, to, part);
#else
        vec4 medium = light_of_segment(s_at, s_here, part);
#endif
        light += (1.0 - light.a) * lit(medium, at, share);
        s_at = s_here;
        lead = 0.0;
#endif
        vec4 layer = texelFetch(surfaces, surface + (rising ? 1 : 2));
#ifdef SMOOTH
        vec3 share_of_color = reflected(mix(at_front.xyz, at_back.xyz, way_to(about.y, front.y, back.y)), to_eye);
#endif
#ifdef LIT
        layer.rgb *= share_of_color;
#endif
#ifdef NEAREST
        set_depth(front_depth + share * depth_difference);
        light = vec4(layer.rgb, 1.0);
        break;
#else
        if (crossed) light += (1.0 - light.a) * layer;
        if (!crossed || light.a >= 1.0) break;
        at = share;
        k += rising ? 1 : -1;
#endif
    }
#endif
}
