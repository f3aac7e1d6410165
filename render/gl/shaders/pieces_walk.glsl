// SPDX-License-Identifier: BSD-3-Clause
// A walk through many pieces of the transfer function, several at once where they are thin together: classify/piece_walk.cpp in
// float32.
uniform float is_density;                        // 1, or 0 for the emitter model
uniform float step_depth, block_depth, deepest;  // WalkLimits

// The light so far, from the front.
vec3 color;
float depth_before;

// Colour and extinction at s and at t, both inside the piece, whose first texel is `ends`.
void light_in_piece(int piece, vec4 ends, float s, float t, out vec4 at_s, out vec4 at_t) {
    vec2 at = (vec2(s, t) - ends.x) / (ends.y - ends.x);
    vec2 extinction = ends.z * (1.0 - at) + ends.w * at;
    vec3 begin = texelFetch(pieces, texels_per_piece * piece + 1).rgb;
    vec3 end = texelFetch(pieces, texels_per_piece * piece + 2).rgb;
    at_s = vec4(mix(begin, end, at.x), extinction.x);
    at_t = vec4(mix(begin, end, at.y), extinction.y);
}

// Between two scalars of one piece, with colour and extinction there, `part` of the ray. Steps of equal optical depth,
// a Gauss rule in each.
void add_part(vec4 front, vec4 back, float part) {
    float depth = part * 0.5 * (front.a + back.a);
    float r = depth > 0.0 ? (back.a - front.a) / (back.a + front.a) : 0.0;
    float steps = max(1.0, ceil(depth / step_depth));
    vec2 weights = vec2(0.0);  // of the colours in front and at the back
    float begin = 0.0;
    for (float k = 1.0;; ++k) {
        float share = k / steps;
        float behind = k < steps ? place_of_depth(r, share) : 1.0;
        vec4 t;
        vec4 light = light_of_step(is_density > 0.0, depth, r, part, depth_before, begin, behind, t);
        weights += vec2(dot(light, 1.0 - t), dot(light, t));
        begin = behind;
        if (!(k < steps) || depth_before + depth * share >= deepest) break;
    }
    color += weights.x * front.rgb + weights.y * back.rgb;
    depth_before += depth;
}

// The whole pieces between the begins of two, at once, unless they are too thick.
bool add_block(int a, int b, float range, float segment) {
    float width = abs(texelFetch(pieces, texels_per_piece * b).x - texelFetch(pieces, texels_per_piece * a).x);
    vec4 high = texelFetch(pieces, texels_per_piece * b + 3) - texelFetch(pieces, texels_per_piece * a + 3);
    vec4 low = texelFetch(pieces, texels_per_piece * b + 4) - texelFetch(pieces, texels_per_piece * a + 4);
    vec4 block = abs(high + low) / width * (segment * (width / range));
    if (block.a > block_depth) return false;
    color += block.rgb * (attenuation_mean(block.a) * exp(-depth_before));
    depth_before += block.a;
    return true;
}

void walk(float s_front, float s_back, float segment) {
    float range = abs(s_back - s_front);
    bool rising = s_front <= s_back;
    int direction = rising ? 1 : -1;
    int piece = piece_of(s_front);
    int last = -1;  // looked up when it is needed
    float s = s_front;
    for (int parts = 1; parts < 65536; ++parts) {
        vec4 ends = texelFetch(pieces, texels_per_piece * piece);
        float end = rising ? min(ends.y, s_back) : max(ends.x, s_back);
        vec4 front, back;
        light_in_piece(piece, ends, s, end, front, back);
        add_part(front, back, range > 0.0 ? segment * (abs(end - s) / range) : segment);
        if (end == s_back || depth_before >= deepest) break;
        piece += direction;
        s = end;
        if (parts < 2) continue;  // most segments end in this piece
        if (last < 0) last = piece_of(s_back);
        // The most pieces, by halving, that are thin enough together.
        for (int count = (last - piece) * direction; count > 1; count /= 2) {
            int first = rising ? piece : piece + 1;
            if (!add_block(first, first + count * direction, range, segment)) continue;
            piece += count * direction;
            s = texelFetch(pieces, texels_per_piece * (rising ? piece : piece + 1)).x;
            break;
        }
    }
}

vec4 light_of_segment(float s_front, float s_back, float segment) {
    color = vec3(0.0);
    depth_before = 0.0;
    walk(s_front, s_back, segment);
    return vec4(color, depth_before * attenuation_mean(depth_before));
}
