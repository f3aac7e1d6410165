// SPDX-License-Identifier: BSD-3-Clause
//
// What all annotations of a picture share: sizes relative to its shorter side, and paint that can be seen on its background.
#pragma once

#include "project/camera.hpp"
#include "render/annotation/canvas.hpp"

namespace cellproj {

struct AnnotationStyle {
    double em;         // size of text [pixels]
    double small;      // that of notes
    int line;          // thickness of lines [pixels]
    Paint ink, paper;  // text; the background

    int ems(double count) const { return static_cast<int>(count * em + 0.5); }
};

// A text and where its pen starts.
struct PlacedText {
    TextMask mask;
    int x, y;
};

inline void draw_text(Image& image, const PlacedText& text, const Paint& paint, const PixelBox& clip) {
    draw_text(image, text.mask, text.x, text.y, paint, clip);
}

}  // namespace cellproj
