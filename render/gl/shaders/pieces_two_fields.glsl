// SPDX-License-Identifier: BSD-3-Clause
// Colour over one field, extinction over another: two walks along one segment, through pieces of colour (`pieces`) and of
// extinction. A stretch ends where either walk leaves its piece; on it both are linear along the ray, as in pieces_all.glsl.
layout(binding = 2) uniform samplerBuffer opacity_pieces;
layout(binding = 3) uniform samplerBuffer opacity_bins;
uniform float opacity_bin_count;
uniform float is_density;           // 1, or 0 for the emitter model
uniform float step_depth, deepest;  // WalkLimits

// x: the scalar of the colour, y: that of the extinction.
vec4 light_of_segment(vec2 s_front, vec2 s_back, float segment) {
    bvec2 rising = lessThanEqual(s_front, s_back);
    ivec2 direction = mix(ivec2(-1), ivec2(1), rising);
    ivec2 piece = ivec2(piece_of(s_front.x), piece_in(opacity_pieces, opacity_bins, opacity_bin_count, s_front.y));
    vec2 s = s_front;
    vec3 color = vec3(0.0);
    float from = 0.0;                                  // where this stretch begins, as a share of the segment
    float depth_before = 0.0, taken = 0.0, begin = 0.0;  // before it; steps in it; where they have come, 0..1
    for (;;) {
        vec4 color_ends = texelFetch(pieces, texels_per_piece * piece.x);
        vec4 ends = texelFetch(opacity_pieces, texels_per_piece * piece.y);
        vec3 color_begin = texelFetch(pieces, texels_per_piece * piece.x + 1).rgb;
        vec3 color_end = texelFetch(pieces, texels_per_piece * piece.x + 2).rgb;
        vec2 low = vec2(color_ends.x, ends.x), high = vec2(color_ends.y, ends.y);
        vec2 last = mix(low, high, rising);
        bvec2 goes_beyond = mix(greaterThan(low, s_back), lessThan(high, s_back), rising);
        vec2 cut = mix(vec2(1.0), (last - s_front) / (s_back - s_front), goes_beyond);
        float to = clamp(min(cut.x, cut.y), from, 1.0);
        bvec2 leaves = bvec2(goes_beyond.x && cut.x <= to, goes_beyond.y && cut.y <= to);
        // The cut of the other walk: rounding must not carry this one out of its piece.
        vec2 end = mix(clamp(mix(s_front, s_back, to), low, high), last, leaves);

        vec2 color_at = clamp((vec2(s.x, end.x) - low.x) / (high.x - low.x), 0.0, 1.0);
        vec2 at = clamp((vec2(s.y, end.y) - low.y) / (high.y - low.y), 0.0, 1.0);
        vec2 extinction = ends.z * (1.0 - at) + ends.w * at;
        float part = segment * (to - from);
        float depth = part * 0.5 * (extinction.x + extinction.y);
        float r = depth > 0.0 ? (extinction.y - extinction.x) / (extinction.y + extinction.x) : 0.0;

        // The next step of equal optical depth.
        float steps = max(1.0, ceil(depth / step_depth));
        taken += 1.0;
        bool whole = !(taken < steps);
        float share = taken / steps;
        float behind = whole ? 1.0 : place_of_depth(r, share);
        vec4 t;
        vec4 light = light_of_step(is_density > 0.0, depth, r, part, depth_before, begin, behind, t);
        t = mix(vec4(color_at.x), vec4(color_at.y), t);
        color += dot(light, 1.0 - t) * color_begin + dot(light, t) * color_end;

        bool deep = depth_before + depth * share >= deepest;
        if (whole || deep) depth_before += depth;
        if (deep || (whole && !any(goes_beyond))) break;
        begin = whole ? 0.0 : behind;
        taken = whole ? 0.0 : taken;
        from = whole ? to : from;
        s = whole ? end : s;
        piece += whole ? direction * ivec2(leaves) : ivec2(0);
    }
    return vec4(color, depth_before * attenuation_mean(depth_before));
}
