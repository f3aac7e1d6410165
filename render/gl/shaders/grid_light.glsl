// SPDX-License-Identifier: BSD-3-Clause
// How light falls on what a grid shows, in front of grid_cell.frag and grid_slab.frag.
//   LIT         something is shaded, by the gradient of the trilinear scalar or
//   SMOOTH      by that of the points, trilinear in between
//   LIT_MEDIUM  the medium is: its share of light is linear in a cell or slab (lit_medium.glsl)
#ifdef LIT
layout(binding = 12) uniform sampler3D gradients;  // at points

vec3 reflected(vec3 gradient, vec3 to_eye);  // reflected.glsl
#endif

#ifdef LIT_MEDIUM
uniform float per_weak_gradient;

vec3 share_in_front, share_behind;  // what of its light the medium sends to the eye, linear between
vec3 lit_share(vec3 gradient, vec3 to_eye);
vec4 lit(vec4 light, float from, float to);
#else
vec4 lit(vec4 light, float from, float to) { return light; }
#endif
