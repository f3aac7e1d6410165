// SPDX-License-Identifier: BSD-3-Clause
// The isosurfaces of a grid, behind grid_light.glsl, in front of grid_cell.frag and grid_slab.frag.
//   MEDIUM  there is light between them
// The rank of a scalar is how many isovalues it is not below: what two places differ by lies between them. A scalar that is the isovalue is on
// one side of it, so that neither two segments that follow each other show the same crossing (the double hit of EKE01 section 5.2) nor
// one falls between them.
layout(binding = 11) uniform samplerBuffer surfaces;  // three each: threshold, isovalue, opacity; front; back: associated colour, opacity
uniform float surface_count;

int rank(float s) {
    int from = 0, to = int(surface_count);
    while (from < to) {
        int middle = (from + to) / 2;
        if (s < texelFetch(surfaces, 3 * middle).x) to = middle;
        else from = middle + 1;
    }
    return from;
}

// The surface that is met next from a rank on, upwards or downwards: where its texels begin.
int surface_behind(int k, bool rising) { return 3 * max(rising ? k : k - 1, 0); }

// As it is seen, unlit.
vec4 layer_of(int surface, bool rising) { return texelFetch(surfaces, surface + (rising ? 1 : 2)); }
