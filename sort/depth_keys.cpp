// SPDX-License-Identifier: BSD-3-Clause
#include "sort/depth_keys.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// The low digit is as good as random: each of its values is a place in memory that is written to, and more of them than this are slow. The
// high one changes little from cell to cell, and may have many.
constexpr int low_bits = 9, high_bits = key_bits - low_bits;
constexpr std::uint32_t low_digits = 1U << low_bits, high_digits = 1U << high_bits;

// Between the passes an element is its high digit and its number within a part.
constexpr int number_bits = 32 - high_bits;
constexpr std::size_t largest_part = std::size_t{1} << number_bits;

constexpr std::size_t smallest_part = 8192;  // about the time that its counts take
constexpr std::size_t parts_per_thread = 4;  // so that all threads end together
constexpr std::size_t keys_per_block = 1024;  // found, and counted from the first cache

std::size_t count_parts(std::size_t elements) {
    const auto threads = static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency());
    return std::max(std::min(parts_per_thread * threads, elements / smallest_part + 1), elements / largest_part + 1);
}

template <class Body>
void for_each_part(std::size_t parts, Body body) {
    oneapi::tbb::parallel_for(std::size_t{0}, parts, body);
}

}  // namespace

std::size_t DigitCounts::find_places() {
    sums_.assign(digits_, 0);
    for (std::size_t i = 0; i < counts_.size(); i += digits_) {
        std::uint32_t* const counts = counts_.data() + i;
        for (std::size_t digit = 0; digit < digits_; ++digit) {
            const std::uint32_t here = counts[digit];
            counts[digit] = sums_[digit];
            sums_[digit] += here;
        }
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& digit : sums_) sum += std::exchange(digit, sum);
    for (std::size_t i = 0; i < counts_.size(); i += digits_) {
        std::uint32_t* const counts = counts_.data() + i;
        for (std::size_t digit = 0; digit < digits_; ++digit) counts[digit] += sums_[digit];
    }
    return sum;
}

std::span<std::uint32_t> KeySort::sort(std::size_t count, const FindKeys& find_keys) {
    keys_.resize(count);
    const std::size_t parts = count_parts(count);
    const auto first_of = [&](std::size_t part) { return count * part / parts; };

    DigitCounts &low = low_, &high = high_;
    low.reset(parts, low_digits);
    for_each_part(parts, [&](std::size_t part) {
        const std::span<std::uint32_t> counts = low.of(part);
        for (std::size_t begin = first_of(part), end = first_of(part + 1); begin < end; begin += keys_per_block) {
            const auto block = std::span(keys_).subspan(begin, std::min(keys_per_block, end - begin));
            find_keys(begin, block);
            for (const std::uint32_t key : block) {
                if (key != no_key) ++counts[key % low_digits];
            }
        }
    });
    sorted_ = low.find_places();
    entries_.resize(count);
    std::uint32_t* const entries = entries_.data();
    for_each_part(parts, [&](std::size_t part) {
        std::uint32_t* const place = low.of(part).data();
        const std::uint32_t* const keys = keys_.data() + first_of(part);
        const auto size = static_cast<std::uint32_t>(first_of(part + 1) - first_of(part));
        for (std::uint32_t i = 0; i < size; ++i) {
            if (keys[i] != no_key) entries[place[keys[i] % low_digits]++] = (keys[i] / low_digits) << number_bits | i;
        }
    });

    // The first pass has left in its counts where what each part has of each digit ends. The parts of the second one are runs of low digits.
    const auto end_of_digit = [&](std::size_t digit) { return low.of(parts - 1)[digit]; };
    std::vector<std::size_t> first_digit(parts + 1);
    for (std::size_t digit = 0, part = 0; part <= parts; ++part) {
        while (digit < low_digits && end_of_digit(digit) <= sorted_ * part / parts) ++digit;
        first_digit[part] = part == parts ? low_digits : digit;
    }
    const auto begin_of = [&](std::size_t part) {
        return first_digit[part] == 0 ? std::size_t{0} : std::size_t{end_of_digit(first_digit[part] - 1)};
    };
    high.reset(parts, high_digits);
    for_each_part(parts, [&](std::size_t part) {
        std::uint32_t* const counts = high.of(part).data();
        for (std::size_t i = begin_of(part), end = begin_of(part + 1); i < end; ++i) ++counts[entries[i] >> number_bits];
    });
    high.find_places();
    std::uint32_t* const sorted = keys_.data();
    for_each_part(parts, [&](std::size_t part) {
        std::uint32_t* const place = high.of(part).data();
        std::size_t i = begin_of(part);
        for (std::size_t digit = first_digit[part]; digit < first_digit[part + 1]; ++digit) {
            for (std::size_t from = 0; from < parts; ++from) {
                const auto first = static_cast<std::uint32_t>(first_of(from));
                for (const std::size_t end = low.of(from)[digit]; i < end; ++i) {
                    sorted[place[entries[i] >> number_bits]++] = first + entries[i] % largest_part;
                }
            }
        }
    });
    return this->sorted();
}

namespace {

// How near points are to the eye, as a number that grows from far to near within known limits. All points lie within ±1.
class Nearness {
public:
    Nearness(const CellGraph& graph, const Eye& eye) : eye_(graph.scaled(eye)) {
        const glm::dvec3 e = graph.scaled(eye);
        const double length = glm::length(e);
        // Distances from an eye far away differ by little of themselves. Their squares, less the eye's, tell the same without
        // cancellation: −|p − e|² + |e|² = 2 p·e − |p|², here divided by 2|e|. It ends in parallel views, 1/|e| = 0.
        if (eye.at_infinity || length > 4.0) {
            far_away_ = true;
            eye_ = glm::vec3(e / length);
            curvature_ = eye.at_infinity ? 0.0F : static_cast<float>(0.5 / length);
            low_ = -radius - 3.0F * curvature_;
            high_ = radius;
        } else {
            low_ = -(static_cast<float>(length) + radius);
            high_ = 0.0F;
        }
        scale_ = static_cast<float>(largest_key) / (high_ - low_);
    }

    void find_keys(std::span<const glm::vec4> points, std::uint32_t* keys) const {
        // A loop for each: one with a choice in it is not turned into vectors.
        if (far_away_) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                const glm::vec3 p(points[i]);
                keys[i] = key(glm::dot(p, eye_) - curvature_ * glm::dot(p, p));
            }
        } else {
            for (std::size_t i = 0; i < points.size(); ++i) keys[i] = key(-glm::distance(glm::vec3(points[i]), eye_));
        }
    }

private:
    std::uint32_t key(float nearness) const {
        const float value = (nearness - low_) * scale_;
        const float above = value > 0.0F ? value : 0.0F;
        constexpr auto most = static_cast<float>(largest_key);
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(above < most ? above : most));
    }

    static constexpr float radius = 1.7321F;  // of the box
    glm::vec3 eye_;
    bool far_away_ = false;
    float curvature_ = 0.0F, low_, high_, scale_;
};

}  // namespace

void leave_out(const CellGraph& graph, std::span<const std::uint8_t> visible, std::size_t first, std::span<std::uint32_t> keys) {
    if (visible.empty()) return;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        if (visible[graph.cell(static_cast<CellId>(first + k))] == 0) keys[k] = no_key;
    }
}

FindKeys centroid_keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible) {
    return [&graph, nearness = Nearness(graph, eye), visible](std::size_t first, std::span<std::uint32_t> keys) {
        constexpr std::size_t block = 64;  // whose centroids fit into the first cache
        std::array<glm::vec4, block> centroids;
        for (std::size_t begin = 0; begin < keys.size(); begin += block) {
            const auto some = std::span(centroids).first(std::min(block, keys.size() - begin));
            graph.find_centroids(static_cast<CellId>(first + begin), some);
            nearness.find_keys(some, keys.data() + begin);
        }
        leave_out(graph, visible, first, keys);
    };
}

}  // namespace cellproj
