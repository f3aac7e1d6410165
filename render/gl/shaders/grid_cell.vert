// SPDX-License-Identifier: BSD-3-Clause
// What a cell of a grid covers on the screen, and some pixels around it: the fragments find what of their rays lies inside. With POINTS a
// square (vertex = cell), else a rectangle (vertex = 4 * cell + corner). Behind grid_place.vert.
flat out vec3 v_low, v_high, v_inverse_edges;
flat out vec4 v_bottom, v_top;
#ifdef LIT
flat out vec3 v_cell;
#endif

// What the method wants to know of a cell between two scalars.
void prepare_cell(float low, float high);

// The rasterizer rounds positions to 1/256 of a pixel.
const float margin = 1.0 / 64.0;

struct Rectangle {
    vec2 low, high;
};

#ifdef PERSPECTIVE
// Closer to the eye than this [scene units], what a cell covers does not count.
const float nearest = 1e-6;

void include_point(inout Rectangle r, vec3 p) {
    vec2 place = on_screen(p);
    r.low = min(r.low, place);
    r.high = max(r.high, place);
}

Rectangle rectangle_of(Box box) {
    Rectangle r = Rectangle(vec2(1e30), vec2(-1e30));
    vec3 corners[8];
    float depths[8];
    for (int c = 0; c < 8; ++c) {
        corners[c] = mix(box.low, box.high, bvec3(c & 1, c & 2, c & 4));
        depths[c] = dot(axis_forward, corners[c]);
        if (depths[c] >= nearest) include_point(r, corners[c]);
    }
    // Where edges leave what is in front of the eye.
    for (int c = 0; c < 8; ++c) {
        for (int along = 1; along < 8; along *= 2) {
            int other = c ^ along;
            if (depths[c] >= nearest && depths[other] < nearest) {
                float t = (depths[c] - nearest) / (depths[c] - depths[other]);
                include_point(r, mix(corners[c], corners[other], t));
            }
        }
    }
    return r;
}
#else
Rectangle rectangle_of(Box box) {
    vec2 middle = on_screen(0.5 * (box.low + box.high));
    vec3 half_edges = 0.5 * (box.high - box.low);
    vec2 extent = vec2(dot(abs(axis_right), half_edges), dot(abs(axis_down), half_edges)) * pixels_per_unit;
    return Rectangle(middle - extent, middle + extent);
}
#endif

void main() {
#ifdef POINTS
    Box box = box_of(gl_VertexID);
#else
    Box box = box_of(gl_VertexID >> 2);
#endif
    v_low = box.low;
    v_high = box.high;
#ifdef LIT
    v_cell = vec3(box.cell);
#endif
    v_inverse_edges = 1.0 / (box.high - box.low);
    corner_scalars(box.cell, v_bottom, v_top);
    vec4 low = min(v_bottom, v_top), high = max(v_bottom, v_top);
    prepare_cell(min(min(low.x, low.y), min(low.z, low.w)), max(max(high.x, high.y), max(high.z, high.w)));

    Rectangle r = rectangle_of(box);
    r.low -= margin;
    r.high += margin;
#ifdef POINTS
    // A point whose middle is not in the picture is not drawn: one at the border, large enough, is. Cells beside the picture are left out.
    vec2 middle = 0.5 * (r.low + r.high), inside = clamp(middle, vec2(0.0), picture);
    bool seen = all(lessThan(r.low, picture)) && all(greaterThan(r.high, vec2(0.0)));
    vec2 extent = r.high - r.low + 2.0 * abs(inside - middle);
    gl_Position = seen ? clip_space(inside) : vec4(2.0, 2.0, 0.0, 1.0);
    gl_PointSize = max(extent.x, extent.y);
#else
    vec2 corner = mix(r.low, r.high, bvec2(gl_VertexID & 1, gl_VertexID & 2));
    // Beyond the picture float32 would lose the place of a cell that comes close to the eye.
    gl_Position = clip_space(clamp(corner, vec2(-1.0), picture + 1.0));
#endif
}
