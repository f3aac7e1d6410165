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
ImageError judge(const Image& image, const std::vector<PixelTruth>& even, const std::vector<PixelTruth>& suspects) {
    ImageError error = compare(image, even);
    const ImageError worst = compare(image, suspects);
    error.pixels += worst.pixels;
    error.color.maximum = std::max(error.color.maximum, worst.color.maximum);
    error.opacity.maximum = std::max(error.opacity.maximum, worst.opacity.maximum);
    return error;
}

// Times those that keep the bound, and chooses.
void choose(QualityChoice& choice, Renderer& renderer, const Scene& scene, const Camera& camera, ImageSize size,
            double max_error, int rounds) {
    std::vector<std::size_t> within;
    std::vector<Quality> qualities;
    for (std::size_t i = 0; i < choice.candidates.size(); ++i) {
        if (largest(choice.candidates[i].error) > max_error) continue;
        within.push_back(i);
        qualities.push_back(choice.candidates[i].quality);
    }
    choice.met = !within.empty();
    choice.chosen = choice.candidates.size() - 1;
    if (!choice.met) return;
    const std::vector<FrameTimes> times = time_frames(renderer, scene, camera, size, qualities, rounds);
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
    assert(max_error > 0);
    const Reference reference(scene);
    const std::vector<PixelTruth> even =
        reference.pixels(camera, size, reference.sample(camera, size, options.sample), rasterizer_slack);

    QualityChoice choice;
    choice.sample = choice.judged = even.size();
    for (const Method& method : choice_methods(max_error)) {
        Quality quality = options.base;
        quality.method = method;
        if (!options.draws || options.draws(quality)) choice.candidates.push_back({quality, {}, 0});
    }
    assert(!choice.candidates.empty() && choice.candidates.back().quality.method.kind == MethodKind::exact);
    const Image best = renderer.render(scene, camera, size, choice.candidates.back().quality);
    const auto others = std::span(choice.candidates).first(choice.candidates.size() - 1);
    std::vector<PixelId> suspects;
    for (const Candidate& candidate : others) {
        const auto found =
            widest_differences(renderer.render(scene, camera, size, candidate.quality), best, options.suspects);
        suspects.insert(suspects.end(), found.begin(), found.end());
    }
    const auto by_row = [](PixelId a, PixelId b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); };
    std::sort(suspects.begin(), suspects.end(), by_row);
    suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
    const std::vector<PixelTruth> suspected = reference.pixels(camera, size, suspects, rasterizer_slack);
    choice.judged += suspected.size();
    // All are judged by the suspects of each: where two differ, either may be wrong. Drawn once more, as one picture for each of
    // them at once is much memory where pictures are large.
    for (Candidate& candidate : others)
        candidate.error = judge(renderer.render(scene, camera, size, candidate.quality), even, suspected);
    choice.candidates.back().error = judge(best, even, suspected);
    choose(choice, renderer, scene, camera, size, max_error, options.rounds);
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
