// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/pixel_truths.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include <glm/common.hpp>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

glm::dvec2 center(PixelId pixel) { return {pixel.x + 0.5, pixel.y + 0.5}; }

// Position along a Morton curve: the bits of x and y in turn.
std::uint64_t morton(PixelId pixel) {
    std::uint64_t code = 0;
    for (int bit = 0; bit < 16; ++bit) {
        code |= (static_cast<std::uint64_t>(pixel.x) >> bit & 1U) << (2 * bit) |
                (static_cast<std::uint64_t>(pixel.y) >> bit & 1U) << (2 * bit + 1);
    }
    return code;
}

// One pixel at random from each block of k by k.
std::vector<PixelId> candidates(ImageSize size, std::mt19937_64& random) {
    const double millions = static_cast<double>(size.width) * size.height / (1 << 20);
    const int k = std::max(1, static_cast<int>(std::ceil(std::sqrt(millions))));
    std::vector<PixelId> pixels;
    for (int y = 0; y < size.height; y += k) {
        for (int x = 0; x < size.width; x += k) {
            const auto offset = [&](int room) {
                return static_cast<int>(random() % static_cast<std::uint64_t>(std::min(k, room)));
            };
            const int dx = offset(size.width - x), dy = offset(size.height - y);
            pixels.push_back({x + dx, y + dy});
        }
    }
    return pixels;
}

}  // namespace

void require_in_picture(PixelId pixel, ImageSize size) {
    if (pixel.x >= 0 && pixel.x < size.width && pixel.y >= 0 && pixel.y < size.height) return;
    throw Error({ErrorKind::option, "pixel",
                 "one of a picture of " + std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels",
                 "(" + std::to_string(pixel.x) + ", " + std::to_string(pixel.y) + ")", "give column and row, from 0"});
}

std::vector<PixelTruth> truths_of(std::span<const PixelId> pixels, ImageSize size, double slack,
                                  const std::function<Light(const glm::dvec2&)>& light) {
    for (const PixelId& pixel : pixels)
        require_in_picture(pixel, size);
    std::vector<PixelTruth> truths(pixels.size());
    const auto look = [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            PixelTruth& truth = truths[i];
            truth.pixel = pixels[i];
            truth.light = light(center(pixels[i]));
            truth.low = truth.high = truth.light;
            if (!(slack > 0)) continue;
            for (const glm::dvec2& offset : {glm::dvec2(1, 1), glm::dvec2(-1, 1), glm::dvec2(1, -1), glm::dvec2(-1, -1)}) {
                const Light beside = light(center(pixels[i]) + slack * offset);
                truth.low = {glm::min(truth.low.color, beside.color), std::min(truth.low.opacity, beside.opacity)};
                truth.high = {glm::max(truth.high.color, beside.color), std::max(truth.high.opacity, beside.opacity)};
            }
        }
    };
    oneapi::tbb::parallel_for(Range(0, pixels.size(), 64), look);
    return truths;
}

std::vector<PixelId> sample_pixels(ImageSize size, std::size_t count, std::uint64_t seed,
                                   const std::function<bool(const glm::dvec2&)>& meets) {
    std::mt19937_64 random(seed);
    const std::vector<PixelId> tried = candidates(size, random);
    std::vector<std::uint8_t> met(tried.size());
    oneapi::tbb::parallel_for(Range(0, tried.size(), 64), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            met[i] = meets(center(tried[i]));
    });
    std::vector<PixelId> seen;
    for (std::size_t i = 0; i < tried.size(); ++i) {
        if (met[i]) seen.push_back(tried[i]);
    }
    std::sort(seen.begin(), seen.end(), [](PixelId a, PixelId b) { return morton(a) < morton(b); });
    count = std::min(count, seen.size());
    std::vector<PixelId> drawn;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t begin = seen.size() * i / count, end = seen.size() * (i + 1) / count;
        drawn.push_back(seen[begin + random() % (end - begin)]);
    }
    std::sort(drawn.begin(), drawn.end(), [](PixelId a, PixelId b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); });
    return drawn;
}

}  // namespace cellproj
