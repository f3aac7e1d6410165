// SPDX-License-Identifier: BSD-3-Clause
#include "sort/depth_keys.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

constexpr int digit_bits = key_bits / 2;
constexpr std::uint32_t digits = 1U << digit_bits;
// Enough parts for the cores of a large machine; each part's counts fill 8 KB.
constexpr std::size_t parts = 32;

using Counts = std::array<std::uint32_t, digits>;

std::size_t part_begin(std::size_t count, std::size_t part) { return count * part / parts; }

template <class Body>
void for_each_part(std::size_t count, Body body) {
    oneapi::tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        body(part, part_begin(count, part), part_begin(count, part + 1));
    });
}

// From how often each part has each digit to where it puts its first. Returns the sum.
std::size_t find_places(std::vector<Counts>& counts) {
    std::uint32_t sum = 0;
    for (std::uint32_t digit = 0; digit < digits; ++digit) {
        for (std::size_t part = 0; part < parts; ++part) {
            const std::uint32_t here = counts[part][digit];
            counts[part][digit] = sum;
            sum += here;
        }
    }
    return sum;
}

}  // namespace

std::span<std::uint32_t> KeySort::sort(std::span<const std::uint32_t> names) {
    assert(names.empty() || names.size() == keys_.size());
    std::vector<Counts> counts(parts);
    for_each_part(keys_.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        counts[part].fill(0);
        for (std::size_t i = begin; i < end; ++i) {
            if (keys_[i] != no_key) ++counts[part][keys_[i] % digits];
        }
    });
    const std::size_t count = find_places(counts);
    entries_.resize(count);
    sorted_.resize(count);
    for_each_part(keys_.size(), [&](std::size_t part, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (keys_[i] == no_key) continue;
            entries_[counts[part][keys_[i] % digits]++] = {keys_[i] / digits, names.empty() ? static_cast<std::uint32_t>(i) : names[i]};
        }
    });
    for_each_part(count, [&](std::size_t part, std::size_t begin, std::size_t end) {
        counts[part].fill(0);
        for (std::size_t i = begin; i < end; ++i) ++counts[part][entries_[i].key];
    });
    find_places(counts);
    for_each_part(count, [&](std::size_t part, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sorted_[counts[part][entries_[i].key]++] = entries_[i].element;
    });
    return sorted_;
}

namespace {

// How near a point is to the eye, as a number that grows from far to near within known limits. All points lie within ±1.
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

    std::uint32_t key(const glm::vec3& p) const {
        const float nearness = far_away_ ? glm::dot(p, eye_) - curvature_ * glm::dot(p, p) : -glm::distance(p, eye_);
        return static_cast<std::uint32_t>(std::clamp((nearness - low_) * scale_, 0.0F, static_cast<float>(largest_key)));
    }

private:
    static constexpr float radius = 1.7321F;  // of the box
    glm::vec3 eye_;
    bool far_away_ = false;
    float curvature_ = 0.0F, low_, high_, scale_;
};

}  // namespace

void find_centroid_keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible,
                        std::span<std::uint32_t> keys) {
    const Nearness nearness(graph, eye);
    oneapi::tbb::parallel_for(Range(0, graph.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto place = static_cast<CellId>(i);
            const bool wanted = visible.empty() || visible[graph.cell(place)] != 0;
            keys[i] = wanted ? nearness.key(graph.float_centroid(place)) : no_key;
        }
    });
}

}  // namespace cellproj
