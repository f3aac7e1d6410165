// SPDX-License-Identifier: BSD-3-Clause
//
// The trade of speed for accuracy, measured on a scene: every method is timed, and judged by the reference ray caster.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/reference.hpp"
#include "render/renderer.hpp"

namespace cellproj {

// What one choice of quality costs and how wrong it is.
struct TradeRow {
    Quality quality;
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

struct TradeOptions {
    int rounds = 5;  // ≥ 1; every round draws every choice once, so that what disturbs the machine disturbs all alike
    bool keep_images = true;  // in the rows: 16 bytes a pixel of memory for each
    std::function<void(std::size_t done, std::size_t of)> progress = {};  // after each frame
};

// One row per quality, in their order. `truths` are pixels of that picture (Reference::pixels). A first round, in which
// the driver compiles shaders, is not counted. Throws as Renderer::render and `compare` do.
std::vector<TradeRow> measure_trade(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size,
                                    std::span<const Quality> qualities, std::span<const PixelTruth> truths,
                                    const TradeOptions& options = {});

struct FrameTimes {
    double set_up_ms = 0, frame_ms = 0;  // as in TradeRow
};

// The times alone, in the order of `qualities`, which should all have been drawn once before. `drawn` is called after each
// frame.
std::vector<FrameTimes> time_frames(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size,
                                    std::span<const Quality> qualities, int rounds, const std::function<void()>& drawn = {});

// Sets on_front of all rows.
void mark_front(std::span<TradeRow> rows);

// How far the colours of a picture are from the truth, pixel by pixel: red as the largest error of a channel grows from
// 1e-5 to 1e-1 (logarithmic, dark blue to yellow), transparent where there is no truth.
Image error_map(const Image& image, std::span<const PixelTruth> truths);

}  // namespace cellproj
