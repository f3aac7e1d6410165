// SPDX-License-Identifier: BSD-3-Clause
#include "render/trade_choice.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace cellproj {

namespace {

double difference(const glm::vec4& a, const glm::vec4& b) {
    double widest = 0;
    for (int k = 0; k < 4; ++k) {
        const double d = std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k]));
        if (!std::isfinite(d)) return std::numeric_limits<double>::infinity();
        widest = std::max(widest, d);
    }
    return widest;
}

// RMS and 99 % of the even sample, as pixels chosen for their errors would spoil both; the maximum of all.
ImageError measured(const Image& image, const std::vector<PixelTruth>& even, const std::vector<PixelTruth>& suspects) {
    ImageError error = compare(image, even);
    const ImageError worst = compare(image, suspects);
    error.pixels += worst.pixels;
    error.color.maximum = std::max(error.color.maximum, worst.color.maximum);
    error.opacity.maximum = std::max(error.opacity.maximum, worst.opacity.maximum);
    return error;
}

// Times those that keep the bound, and chooses.
void choose(QualityChoice& choice, std::span<const TradeWay> ways, double max_error, int rounds) {
    std::vector<std::size_t> within;
    std::vector<TradeWay> good;
    for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
        if (largest(choice.candidates[i].error) > max_error) continue;
        within.push_back(i);
        good.push_back(ways[i]);
    }
    choice.met = !within.empty();
    choice.chosen = choice.candidates.size() - 1;
    if (!choice.met) return;
    const std::vector<FrameTimes> times = time_frames(good, rounds);
    for (std::size_t k = 0; k < within.size(); ++k) choice.candidates[within[k]].frame_ms = times[k].frame_ms;
    choice.chosen = *std::min_element(within.begin(), within.end(), [&](std::size_t a, std::size_t b) {
        return choice.candidates[a].frame_ms < choice.candidates[b].frame_ms;
    });
}

}  // namespace

std::vector<Method> choice_methods(double max_error) {
    std::vector<Method> methods;
    for (const char* name : {"homogeneous:vertices", "homogeneous", "preint2d-exp:256", "preint2d-exp:1024", "integral"})
        methods.push_back(parse_method(name));
    // The errors of a ray's segments add up, weighted by what shines through: rays of a hundred cells are usual. Single
    // precision ends at 1e-9.
    methods.push_back({.kind = MethodKind::exact, .tolerance = std::clamp(max_error / 100, 1e-9, 1e-2)});
    return methods;
}

QualityChoice choose_quality(Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size, double max_error,
                             const ChoiceOptions& options) {
    const Reference reference(scene);
    std::vector<Quality> qualities;
    for (const Method& method : choice_methods(max_error)) {
        Quality quality = options.base;
        quality.method = method;
        if (!options.draws || options.draws(quality)) qualities.push_back(quality);
    }
    assert(!qualities.empty() && qualities.back().method.kind == MethodKind::exact);
    return choose_way(ways_of(renderer, scene, camera, size, qualities), judge_by(reference, camera, size), max_error, options);
}

QualityChoice choose_way(std::span<const TradeWay> ways, const TradeJudge& judge, double max_error, const ChoiceOptions& options) {
    assert(max_error > 0 && !ways.empty());
    const std::vector<PixelTruth> even = judge.truths(judge.sample(options.sample));
    QualityChoice choice;
    choice.sample = choice.judged = even.size();
    for (const TradeWay& way : ways) choice.candidates.push_back({way.name, way.quality, way.sampling, {}, 0});
    const Image best = ways.back().render(nullptr);
    const std::size_t others = ways.size() - 1;
    std::vector<PixelId> suspects;
    for (std::size_t i = 0; i < others; ++i) {
        const auto found = widest_differences(ways[i].render(nullptr), best, options.suspects);
        suspects.insert(suspects.end(), found.begin(), found.end());
    }
    const auto by_row = [](PixelId a, PixelId b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); };
    std::sort(suspects.begin(), suspects.end(), by_row);
    suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
    const std::vector<PixelTruth> suspected = judge.truths(suspects);
    choice.judged += suspected.size();
    // All are judged by the suspects of each: where two differ, either may be wrong. Drawn once more, as one picture for each of
    // them at once is much memory where pictures are large.
    for (std::size_t i = 0; i < others; ++i)
        choice.candidates[i].error = measured(ways[i].render(nullptr), even, suspected);
    choice.candidates.back().error = measured(best, even, suspected);
    choose(choice, ways, max_error, options.rounds);
    return choice;
}

std::vector<PixelId> widest_differences(const Image& a, const Image& b, std::size_t count) {
    assert(a.width == b.width && a.height == b.height);
    std::vector<std::pair<double, std::size_t>> differing;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const double d = difference(a.pixels[i], b.pixels[i]);
        if (d > 0) differing.emplace_back(d, i);
    }
    count = std::min(count, differing.size());
    // Equal ones by their place, so that the answer is one.
    std::partial_sort(differing.begin(), differing.begin() + static_cast<std::ptrdiff_t>(count), differing.end(),
                      [](const auto& x, const auto& y) { return x.first != y.first ? x.first > y.first : x.second < y.second; });
    std::vector<PixelId> pixels;
    const auto width = static_cast<std::size_t>(a.width);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = differing[k].second;
        pixels.push_back({static_cast<int>(i % width), static_cast<int>(i / width)});
    }
    return pixels;
}

}  // namespace cellproj
