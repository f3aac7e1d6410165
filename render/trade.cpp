// SPDX-License-Identifier: BSD-3-Clause
#include "render/trade.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>

#include "render/statistics.hpp"

namespace cellproj {

namespace {

bool is_better(const TradeRow& a, const TradeRow& b) {
    const double error_a = a.error.color.rms, error_b = b.error.color.rms;
    return a.frame_ms <= b.frame_ms && error_a <= error_b && (a.frame_ms < b.frame_ms || error_a < error_b);
}

// 0..1 to colours that get lighter: dark blue, violet, red, yellow.
glm::vec3 heat(double value) {
    static constexpr std::array<glm::vec3, 4> colors{
        {{0.03F, 0.05F, 0.25F}, {0.45F, 0.05F, 0.55F}, {0.90F, 0.25F, 0.20F}, {1.0F, 0.95F, 0.35F}}};
    const double position = std::clamp(value, 0.0, 1.0) * (colors.size() - 1);
    const std::size_t i = std::min(static_cast<std::size_t>(position), colors.size() - 2);
    return glm::mix(colors[i], colors[i + 1], static_cast<float>(position - static_cast<double>(i)));
}

}  // namespace

std::vector<Quality> trade_qualities() {
    std::vector<Quality> qualities;
    for (const char* method :
         {"shirley-tuchman", "average", "average:half", "average:vertices", "homogeneous", "homogeneous:vertices", "linear:8",
          "linear:8:vertices", "linear:32", "stein", "preint2d:256", "preint2d-exp:256", "preint2d-exp:256:float16",
          "preint2d-exp:256:uint8", "preint2d-exp:1024", "preint3d:32", "preint3d:64", "preint3d:128", "preint3d:64:linear:uint8",
          "preint3d:64:linear", "preint3d:64:float16", "integral", "exact:1e-3", "exact:1e-5"}) {
        qualities.push_back({.method = parse_method(method)});
    }
    for (const TargetFormat target : {TargetFormat::rgba8, TargetFormat::rgba16, TargetFormat::rgba16f})
        qualities.push_back({.target = target});
    return qualities;
}

std::vector<Quality> surface_qualities() {
    std::vector<Quality> qualities = trade_qualities();
    std::erase_if(qualities, [](const Quality& quality) { return !takes_surfaces(quality.method); });
    for (const char* method : {"integral", "preint2d-exp:256", "preint3d:64"})
        for (const char* surfaces : {"table", "combined"})
            qualities.push_back({.method = parse_method(method), .surfaces = parse_surface_method(surfaces)});
    return qualities;
}

std::string to_string(const Quality& quality) {
    const bool usual = quality.target == Quality{}.target, exact = quality.surfaces.kind == SurfaceMethodKind::exact;
    return to_string(quality.method) + (exact ? "" : ", " + to_string(quality.surfaces)) + (usual ? "" : ", " + to_string(quality.target));
}

std::vector<TradeWay> ways_of(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size,
                              std::span<const Quality> qualities) {
    std::vector<TradeWay> ways;
    for (Quality quality : qualities) {
        quality.check_neighbours = false;  // nobody reads it
        ways.push_back({.name = to_string(quality),
                        .quality = quality,
                        .prepare = [=, &renderer] { renderer.prepare(scene, quality); },
                        .render = [=, &renderer](Statistics* out) { return renderer.render(scene, camera, size, quality, out); }});
    }
    return ways;
}

std::vector<FrameTimes> time_frames(std::span<const TradeWay> ways, int rounds, const std::function<void()>& drawn) {
    assert(rounds >= 1);
    std::vector<std::vector<double>> set_up(ways.size()), frame(ways.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const Stopwatch preparing;
            ways[i].prepare();
            set_up[i].push_back(preparing.ms());
            Statistics statistics;
            ways[i].render(&statistics);
            frame[i].push_back(statistics.ms.total);
            if (drawn) drawn();
        }
    }
    std::vector<FrameTimes> times;
    for (std::size_t i = 0; i < ways.size(); ++i)
        times.push_back({median(std::move(set_up[i])), median(std::move(frame[i]))});
    return times;
}

std::vector<TradeRow> measure_trade(std::span<const TradeWay> ways, std::span<const PixelTruth> truths, const TradeOptions& options) {
    const std::size_t frames = ways.size() * static_cast<std::size_t>(options.rounds + 1);
    std::size_t done = 0;
    const auto tell = [&] {
        if (options.progress) options.progress(++done, frames);
    };
    std::vector<TradeRow> rows;
    for (const TradeWay& way : ways) {
        Statistics statistics;
        Image image = way.render(&statistics);
        rows.push_back({.name = way.name,
                        .quality = way.quality,
                        .sampling = way.sampling,
                        .backend = statistics.backend,
                        .table_bytes = statistics.table_bytes,
                        .error = compare(image, truths),
                        .image = options.keep_images ? std::move(image) : Image{}});
        tell();
    }
    const std::vector<FrameTimes> times = time_frames(ways, options.rounds, tell);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].set_up_ms = times[i].set_up_ms;
        rows[i].frame_ms = times[i].frame_ms;
    }
    mark_front(rows);
    return rows;
}

void mark_front(std::span<TradeRow> rows) {
    for (TradeRow& row : rows) {
        row.on_front =
            std::none_of(rows.begin(), rows.end(), [&](const TradeRow& other) { return is_better(other, row); });
    }
}

Image error_map(const Image& image, std::span<const PixelTruth> truths) {
    Image map(image.width, image.height);
    for (const PixelTruth& truth : truths) {
        const glm::dvec4 channels = error_of_pixel(image, truth);
        const double error = std::max({channels.r, channels.g, channels.b, channels.a});
        const double decades = error > 0.0 ? std::log10(error) + 5.0 : 0.0;  // 0 at 1e-5, 4 at 1e-1
        map.at(truth.pixel.x, truth.pixel.y) = glm::vec4(heat(std::isfinite(error) ? decades / 4.0 : 1.0), 1.0F);
    }
    return map;
}

}  // namespace cellproj
