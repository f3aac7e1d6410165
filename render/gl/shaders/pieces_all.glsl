// SPDX-License-Identifier: BSD-3-Clause
// Every piece of the transfer function between the ends of a segment, one after the other: classify/piece_walk.cpp in
// float32, without its blocks.
//
// One loop takes a step of limited optical depth and, at the end of a piece, goes on to the next: llvmpipe runs all code of a
// shader at least once for every fragment, whatever the conditions, so one body is half as expensive as nested loops.
uniform float is_density;           // 1, or 0 for the emitter model
uniform float step_depth, deepest;  // WalkLimits

flat in vec2 v_pieces;  // pieces_cell.glsl

vec4 light_of_segment(float s_front, float s_back, float segment) {
    bool rising = s_front <= s_back;
    float range = abs(s_back - s_front);
    int piece = int(rising ? v_pieces.x : v_pieces.y);  // at first maybe one that the segment does not reach
    float s = s_front;
    vec3 color = vec3(0.0);
    float depth_before = 0.0, taken = 0.0, begin = 0.0;  // before this piece; steps in it; where they have come, 0..1
    for (;;) {
        vec4 ends = texelFetch(pieces, texels_per_piece * piece);
        vec3 color_begin = texelFetch(pieces, texels_per_piece * piece + 1).rgb;
        vec3 color_end = texelFetch(pieces, texels_per_piece * piece + 2).rgb;
        float end = rising ? clamp(ends.y, s, s_back) : clamp(ends.x, s_back, s);
        vec2 at = clamp((vec2(s, end) - ends.x) / (ends.y - ends.x), 0.0, 1.0);
        vec2 extinction = ends.z * (1.0 - at) + ends.w * at;
        // With one scalar all along, all of the segment lies in the piece that holds it, and nothing in those before.
        bool reached = range > 0.0 || s < ends.y || piece == int(v_pieces.y);
        float part = range > 0.0 ? segment * (abs(end - s) / range) : (reached ? segment : 0.0);
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
        t = mix(vec4(at.x), vec4(at.y), t);
        color += dot(light, 1.0 - t) * color_begin + dot(light, t) * color_end;

        bool deep = depth_before + depth * share >= deepest;
        if (whole || deep) depth_before += depth;
        if (deep || (whole && end == s_back && reached)) break;
        begin = whole ? 0.0 : behind;
        taken = whole ? 0.0 : taken;
        s = whole ? end : s;
        piece += whole ? (rising ? 1 : -1) : 0;
        if (piece < int(v_pieces.x) || piece > int(v_pieces.y)) break;
    }
    return vec4(color, depth_before * attenuation_mean(depth_before));
}
