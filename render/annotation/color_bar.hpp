// SPDX-License-Identifier: BSD-3-Clause
//
// The colour bar: what a transfer function makes of the scalars in its range, and what becomes of those beyond.
//
// Colours are those of the function, not of the picture, where they are mixed along rays. Beside them stands the opacity of a homogeneous
// path of a length that is named, α = 1 − exp(−τ·length) (RKE00 Eq. 1), as a curve from 0 (at the bar) to 1 (the thin line).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "classify/transfer_function.hpp"
#include "render/annotation/style.hpp"
#include "render/annotation/ticks.hpp"
#include "render/scene.hpp"

namespace cellproj {

enum class BarSide { left, right, bottom };

// What becomes of the values beyond an end of the bar.
enum class Beyond {
    nothing,  // there are none
    clamped,  // drawn as the end is
    hidden    // drawn as nothing: the function is transparent there
};

// What the bar shows.
struct ColorBar {
    std::shared_ptr<const TransferFunction> transfer;
    double low, high;  // of the function: its first and last node
    ScalarAxis axis;   // what the length of the bar is divided by; linear where `low` is not above 0
    std::string name;  // of the field, with its units
    Beyond below, above;
    bool medium;                       // or slices. False: isosurfaces alone; the range is then that of the field
    std::vector<IsoSurface> surfaces;  // each a band of its colour; the range takes in their values
    std::string note;  // which values lie beyond the ends and what becomes of them; empty: none
    // Of the opacity curve [mesh units], 1, 2 or 5 times a power of ten: the largest for which the function's densest scalar has an optical
    // depth of at most 2. Nothing where all is transparent, or opacity is another field's.
    std::optional<double> path;
    std::string opacity_name;  // that field's name
    double brightest;          // what emission counts as 1; 1 in the density model

    // 0..1 in each channel. Density model: the chromaticity κ(s), cut as a PNG cuts it. Emitter: emission, relative to the brightest channel of any
    // node.
    glm::dvec3 color(double s) const;
    // The largest opacity of a `path` through scalars in [a, b], a ≤ b: peaks that are narrower than a pixel are seen.
    double opacity(double a, double b) const;
};

// For a valid scene. The range is that of all nodes; of the colour nodes where opacity is another field's.
ColorBar describe_color_bar(const Scene& scene, const std::string& units = {}, ScalarAxis axis = ScalarAxis::linear);

// Where everything is, in pixels of the picture.
struct ColorBarPlan {
    ColorBar content;
    BarSide side;
    PixelBox area;   // what it takes from the picture
    PixelBox bar;    // low at its lower or left edge, high at the other
    PixelBox strip;  // of the opacity curve; empty without one
    int arrow;       // length of the marks for values beyond the ends
    Ticks ticks;
    std::vector<PlacedText> texts;
    AnnotationStyle style;

    bool vertical() const { return side != BarSide::bottom; }
    int length() const { return vertical() ? bar.height() : bar.width(); }
    // The scalar at a distance from the low end [pixels], and back; both exact at the ends. A constant stands in the middle.
    double scalar(double distance) const;
    double distance(double s) const;
    // The pixels at distance i .. i + 1 from the low end, of the bar or the strip.
    PixelBox slice(const PixelBox& of, int i) const;
};

// The bar along `side` of `within`. Names longer than the bar end in "…". The plan needs to be checked against what is left over: nothing is
// refused here.
ColorBarPlan plan_color_bar(ColorBar content, BarSide side, const PixelBox& within, const Font& font, const AnnotationStyle& style);

void draw_color_bar(Image& image, const ColorBarPlan& plan);

}  // namespace cellproj
