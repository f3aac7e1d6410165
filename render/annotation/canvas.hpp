// SPDX-License-Identifier: BSD-3-Clause
//
// Drawing over a picture: colours are display-referred and not associated, `opacity` 0..1 is multiplied by the coverage of the pixel, and
// the result is composited as Image is (image.hpp): no gamma comes in, as none does where the PNG writer adds the background. Nothing is
// drawn outside of `clip`, which lies in the picture.
#pragma once

#include <span>
#include <utility>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/annotation/text.hpp"
#include "render/image.hpp"

namespace cellproj {

// Pixels x0 ≤ x < x1, y0 ≤ y < y1.
struct PixelBox {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

PixelBox intersection(const PixelBox& a, const PixelBox& b);
PixelBox whole(const Image& image);

struct Paint {
    glm::dvec3 color{0.0};
    double opacity = 1;
    bool under = false;  // what is in the picture already
};

// Over (or under) one pixel of the picture; one that is not finite counts as empty, as in a PNG.
void blend(Image& image, int x, int y, const Paint& paint, double coverage = 1);

void fill(Image& image, const PixelBox& box, const Paint& paint, const PixelBox& clip);
// A rectangle's border, `width` pixels to the inside.
void frame(Image& image, const PixelBox& box, int width, const Paint& paint, const PixelBox& clip);

using Segment = std::pair<glm::dvec2, glm::dvec2>;

// Lines with round ends, `width` ≥ 1 pixels thick, anti-aliased by the distance of a pixel's centre; where several of them meet, paint
// counts once. Any finite coordinates.
void draw_lines(Image& image, std::span<const Segment> lines, double width, const Paint& paint, const PixelBox& clip);

// A convex polygon of at least 3 corners, either way round, anti-aliased by the distance to its nearest side.
void fill_convex(Image& image, std::span<const glm::dvec2> corners, const Paint& paint, const PixelBox& clip);

// Text with its pen at a pixel corner.
void draw_text(Image& image, const TextMask& mask, int pen_x, int pen_y, const Paint& paint, const PixelBox& clip);
// What of the picture's pixels it may touch.
PixelBox box_of(const TextMask& mask, int pen_x, int pen_y);

}  // namespace cellproj
