// SPDX-License-Identifier: BSD-3-Clause
// classify/piece_table.hpp, for both stages of integral and exact.
layout(binding = 0) uniform samplerBuffer pieces;
layout(binding = 1) uniform samplerBuffer bins;
uniform float bin_count;

const int texels_per_piece = 5;

// Gauss-Legendre on 0..1 (Abramowitz and Stegun, Table 25.4).
const vec4 gauss_position = vec4(0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629);
const vec4 gauss_weight = vec4(0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693);

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
