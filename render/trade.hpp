// SPDX-License-Identifier: BSD-3-Clause
//
// The trade of speed for accuracy, measured on a scene: every method is timed, and judged by the reference ray caster. What is measured
// are ways to one picture, whatever they draw it from: a mesh (here), a regular grid (grid_trade.hpp).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/grid_sampling.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"

namespace cellproj {

// One way to the picture.
struct TradeWay {
    std::string name;                            // for people: "integral, rgba8"
    Quality quality;                             // its method, target and surfaces
    std::optional<GridSampling> sampling = {};   // of a regular grid that is drawn as it is; none: tetrahedra
    std::function<void()> prepare;               // all but drawing
    std::function<Image(Statistics*)> render;
};

// What one way costs and how wrong it is.
struct TradeRow {
    std::string name;  // as in TradeWay, like the next two
    Quality quality;
    std::optional<GridSampling> sampling = {};
    std::string backend;          // that drew it (Statistics::backend)
    double set_up_ms = 0;         // tables and shaders, for a scene that is prepared otherwise; median
    double frame_ms = 0;          // from camera to pixels in memory; median
    std::size_t table_bytes = 0;  // memory of its tables
    ImageError error;
    bool on_front = false;        // no other row is at once as fast and as accurate (RMS), and better in one of them
    Image image;                  // where it was to be kept
};

// The choices that `cellproj trade` compares unless told otherwise: every kind, tables of several sizes and storages, and
// the formats of the framebuffer.
std::vector<Quality> trade_qualities();
// The same for scenes with isosurfaces: those that draw them, and the ways to them that are not exact.
std::vector<Quality> surface_qualities();

// "integral", "integral, table:512, rgba8": the method, that of isosurfaces and the format of the framebuffer unless they are the usual ones.
std::string to_string(const Quality& quality);

// Who knows what the pixels should be: an even sample of so many of those that see something, and the truths of pixels, for pictures
// whose points were put on a rasterizer's grid.
struct TradeJudge {
    std::function<std::vector<PixelId>(std::size_t count)> sample;
    std::function<std::vector<PixelTruth>(std::span<const PixelId>)> truths;
};

// Of a Reference or a GridReference, which must live as long.
template <class AnyReference>
TradeJudge judge_by(const AnyReference& reference, const Camera& camera, ImageSize size) {
    return {[&reference, camera, size](std::size_t count) { return reference.sample(camera, size, count); },
            [&reference, camera, size](std::span<const PixelId> pixels) {
                return reference.pixels(camera, size, pixels, rasterizer_slack);
            }};
}

struct TradeOptions {
    int rounds = 5;  // ≥ 1; every round draws every choice once, so that what disturbs the machine disturbs all alike
    bool keep_images = true;  // in the rows: 16 bytes a pixel of memory for each
    std::function<void(std::size_t done, std::size_t of)> progress = {};  // after each frame
};

// The ways that these qualities are, named by them. The parts of the scene are kept, the renderer must live as long.
std::vector<TradeWay> ways_of(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size,
                              std::span<const Quality> qualities);

// One row per way, in their order. `truths` are pixels of that picture (truths_of). A first round, in which the driver compiles
// shaders, is not counted. Throws as the ways and `compare` do.
std::vector<TradeRow> measure_trade(std::span<const TradeWay> ways, std::span<const PixelTruth> truths,
                                    const TradeOptions& options = {});

struct FrameTimes {
    double set_up_ms = 0, frame_ms = 0;  // as in TradeRow
};

// The times alone, in the order of `ways`, which should all have been drawn once before. `drawn` is called after each frame.
std::vector<FrameTimes> time_frames(std::span<const TradeWay> ways, int rounds, const std::function<void()>& drawn = {});

// Sets on_front of all rows.
void mark_front(std::span<TradeRow> rows);

// How far the colours of a picture are from the truth, pixel by pixel: red as the largest error of a channel grows from
// 1e-5 to 1e-1 (logarithmic, dark blue to yellow), transparent where there is no truth.
Image error_map(const Image& image, std::span<const PixelTruth> truths);

}  // namespace cellproj
