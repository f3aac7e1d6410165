#version 450 core
// SPDX-License-Identifier: BSD-3-Clause
// The ray of a pixel through a grid, and what of it lies in a box. Places are about the view's reference point, the eye in perspective, in
// scene units.
uniform vec2 ray_center;        // pixels: of the reference point (perspective: the principal point)
uniform float pixels_per_unit;  // perspective: at depth 1
uniform vec3 axis_right, axis_down, axis_forward;
#ifndef PERSPECTIVE
// 1 / axis_forward. Where that is 0, a large number, and a little to add to the ray's place there: a ray on a plane of the grid is in
// the cell above it.
uniform vec3 inverse_forward, nudge;
#endif

struct Ray {
    vec3 origin, direction, inverse;  // 1 / direction, finite
    float stretch;                    // length of the direction
};

Ray ray_of_pixel() {
    vec2 pixel = (gl_FragCoord.xy - ray_center) / pixels_per_unit;
    vec3 across = pixel.x * axis_right + pixel.y * axis_down;
#ifdef PERSPECTIVE
    vec3 direction = axis_forward + across;
    direction = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
    return Ray(vec3(0.0), direction, 1.0 / direction, length(direction));
#else
    return Ray(across, axis_forward, inverse_forward, 1.0);
#endif
}

struct Crossings {
    vec3 low, high;  // where the ray crosses the planes of a box
};

// Boxes that share a plane get the same number for it.
Crossings crossings_of(Ray ray, vec3 low, vec3 high) {
#ifdef PERSPECTIVE
    // The eye is the origin: of two boxes on whose common plane a ray runs, the one below it ends there at once.
    return Crossings(low * ray.inverse, high * ray.inverse);
#else
    return Crossings((low - ray.origin - nudge) * ray.inverse, (high - ray.origin - nudge) * ray.inverse);
#endif
}

// Where the ray enters and leaves; nothing lies between where the first is not less.
vec2 part_between(Crossings at) {
#ifdef PERSPECTIVE
    float from = 0.0;
#else
    float from = -1e30;
#endif
    vec3 nearer = min(at.low, at.high), farther = max(at.low, at.high);
    return vec2(max(max(from, nearer.x), max(nearer.y, nearer.z)), min(farther.x, min(farther.y, farther.z)));
}
vec2 part_between(Ray ray, vec3 low, vec3 high) { return part_between(crossings_of(ray, low, high)); }
