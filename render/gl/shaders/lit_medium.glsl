// SPDX-License-Identifier: BSD-3-Clause
// The light of a medium that is lit by the gradient of its scalar (SurfaceScene::lit_medium), behind surfaces.frag and grid_light.glsl, which have
// found share_in_front and share_behind; reflected.glsl is there, too.

// classify/lighting.hpp, by a gradient over the weak one.
vec3 lit_share(vec3 gradient, vec3 to_eye) {
    float square = min(dot(gradient, gradient), 1e30);
    return mix(vec3(1.0), reflected(gradient, to_eye), square / (1.0 + square));
}

// Light that grows linearly along a homogeneous segment of optical depth D is, in the mean, what it is at 1/D - 1/(e^D - 1) of the way
// (render/cpu/medium_light-inl.hpp). `from`, `to`: of the way through the cell or slab.
vec4 lit(vec4 light, float from, float to) {
    float passed = max(1.0 - light.a, 1e-30), depth = -log(passed);
    float place = depth < 0.5 ? 0.5 - depth * (1.0 / 12.0 - depth * depth / 720.0) : 1.0 / depth - passed / light.a;
    return vec4(light.rgb * mix(share_in_front, share_behind, mix(from, to, place)), light.a);
}
