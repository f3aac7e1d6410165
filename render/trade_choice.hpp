// SPDX-License-Identifier: BSD-3-Clause
//
// The fastest method that keeps a bound of the error, found by measuring a few on the scene itself: `render --max-error`.
//
// Which pixels are judged: an even sample, and besides the pixels of the whole picture where one of the methods differs most
// from `exact`, which all of them are judged by. All methods share cells, order and silhouettes, so what sets them apart is the light of segments, and where one
// errs much it differs from `exact` by as much. A layer that crosses a few pixels only is found that way, which a sample misses.
// What all methods have in common (an order that is not exact, a point moved to the rasterizer's grid) is left to the sample.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/trade.hpp"

namespace cellproj {

struct ChoiceOptions {
    Quality base = {};           // all but the method
    std::function<bool(const Quality&)> draws = {};  // whether the renderer can; all, where it is not given
    std::size_t sample = 4096;   // pixels drawn evenly; all that see the mesh where there are no more
    std::size_t suspects = 128;  // pixels judged besides: so many where a method differs from `exact`, for each
    int rounds = 3;              // frames timed of each method that keeps the bound
};

struct Candidate {
    std::string name;  // as in TradeWay, like the next two
    Quality quality;
    std::optional<GridSampling> sampling = {};
    ImageError error;     // RMS and 99 % over the even sample, the largest error over all judged pixels
    double frame_ms = 0;  // median, of those that keep the bound; otherwise 0
};

struct QualityChoice {
    std::vector<Candidate> candidates;  // the last one is the most accurate: `exact`, for grids by OpenGL `integral`
    std::size_t chosen = 0;             // the fastest of those that keep the bound; the last one where none does
    bool met = false;                   // whether the chosen one keeps the bound
    std::size_t sample = 0;             // pixels drawn evenly
    std::size_t judged = 0;             // all pixels with a truth
};

// The methods that are measured for a bound, each the best of those that cost as much on the scenes of `cellproj trade`; the
// last one is `exact` with a tolerance that follows from the bound.
std::vector<Method> choice_methods(double max_error);

// `max_error` > 0: the largest error of any channel, opacity included. Throws as Reference and Renderer::render do. A scene
// that no pixel sees has no error.
QualityChoice choose_quality(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size, double max_error,
                             const ChoiceOptions& options = {});

// The same among any ways to one picture, of which the last one is the most accurate. At least one; `base` and `draws` do not count.
QualityChoice choose_way(std::span<const TradeWay> ways, const TradeJudge& judge, double max_error, const ChoiceOptions& options = {});

// The `count` pixels where two pictures of one size differ most, widest first; only such that differ at all. A value that is not
// finite differs infinitely.
std::vector<PixelId> widest_differences(const Image& a, const Image& b, std::size_t count);

}  // namespace cellproj
