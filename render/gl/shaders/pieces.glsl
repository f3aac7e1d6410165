// SPDX-License-Identifier: BSD-3-Clause
// classify/piece_table.hpp, for both stages of integral and exact.
layout(binding = 0) uniform samplerBuffer pieces;
layout(binding = 1) uniform samplerBuffer bins;
uniform float bin_count;

const int texels_per_piece = 5;

// Gauss-Legendre on 0..1 (Abramowitz and Stegun, Table 25.4).
const vec4 gauss_position = vec4(0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629);
const vec4 gauss_weight = vec4(0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693);

// Of a part of a segment with D(t) = depth * ((1 - r) * t + r * t * t), t = 0..1: where a share of its depth has been passed.
float place_of_depth(float r, float share) {
    float root = sqrt(max(0.0, (1.0 - r) * (1.0 - r) + 4.0 * r * share));
    return min(1.0, 2.0 * share / (1.0 - r + root));
}

// The light of begin..behind at four points t, each times its weight. `part`: the length, which is what the emitter model takes.
vec4 light_of_step(bool density, float depth, float r, float part, float depth_before, float begin, float behind, out vec4 t) {
    t = begin + (behind - begin) * gauss_position;
    vec4 q = density ? depth * (1.0 - r + 2.0 * r * t) : vec4(part);
    return q * ((behind - begin) * gauss_weight) * exp(-depth_before - depth * t * (1.0 - r + r * t));
}

// The last piece that begins at or below s.
int piece_in(samplerBuffer pieces, samplerBuffer bins, float bin_count, float s) {
    vec4 bin = texelFetch(bins, int(s * bin_count));
    int first = int(bin.x), last = int(bin.y);
    float cut = bin.z;
    while (first < last) {
        int middle = (first + last + 1) / 2;
        if (s < cut) last = middle - 1; else first = middle;
        if (first < last) cut = texelFetch(pieces, texels_per_piece * ((first + last + 1) / 2)).x;
    }
    return first;
}

int piece_of(float s) { return piece_in(pieces, bins, bin_count, s); }
