// SPDX-License-Identifier: BSD-3-Clause
#include "sort/power_keys.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "sort/order_repair.hpp"

namespace cellproj {

namespace {

using Range = oneapi::tbb::blocked_range<std::size_t>;

constexpr std::size_t cells_per_task = 4096;
constexpr double half_ulp = 0x1p-53, half_ulp_float = 0x1p-24;
constexpr float infinity = std::numeric_limits<float>::infinity();

// Circumcentres inside the mesh have a nearness within ±4 or nearly so. Those of flat cells at the boundary may lie anywhere: beyond,
// keys grow by the logarithm, up to a factor of 2³².
constexpr float common_nearness = 4.0F;

constexpr float highest = 1.0F + 32.0F / 256.0F;
constexpr float key_scale = static_cast<float>(largest_key) / (2 * highest);
constexpr float key_width = common_nearness / key_scale;  // within ±common_nearness

std::uint32_t key_of(float nearness) {
    const float part = std::abs(nearness) / common_nearness;
    const float height = part <= 1.0F ? part : std::min(1.0F + std::log2(part) / 256.0F, highest);
    return static_cast<std::uint32_t>((std::copysign(height, nearness) + highest) * key_scale);
}

// What a cell's slack may be, to spare memory: 2⁻⁴⁰ to 2²³ in steps of a quarter of the power of two below, and infinite.
const std::array<float, 256> slacks = [] {
    std::array<float, 256> values;
    for (int i = 0; i < 255; ++i) values[static_cast<std::size_t>(i)] = std::ldexp(1.0F + 0.25F * static_cast<float>(i % 4), i / 4 - 40);
    values.back() = infinity;
    return values;
}();

std::uint8_t slack_at_least(double slack) {
    const auto above = std::partition_point(slacks.begin(), slacks.end() - 1, [&](float value) { return !(value >= slack); });
    return static_cast<std::uint8_t>(above - slacks.begin());
}

double largest_coordinate(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

// The centre is a + n/(2D) with n = |u|²(v × w) + |v|²(w × u) + |w|²(u × v) and D = [u v w], u, v, w the edges from a. Edges of at most
// L per coordinate are good to 2⁻⁵¹ (their ends lie within ±1 and are rounded twice); then n is good to 18 L³(4·2⁻⁵¹ + 20 L·2⁻⁵³) and D
// to 6 L²(3·2⁻⁵¹ + 8 L·2⁻⁵³). Nearness is 2 e·c − (|c|² − r²) over max(1, |e|): off by 6 times the centre's error and that of the power.
PowerKeys::PowerKeys(const CellGraph& graph) : spheres_(graph.size()), slack_(graph.size()) {
    oneapi::tbb::parallel_for(Range(0, graph.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto& t = graph.mesh().tets[graph.cell(static_cast<CellId>(i))];
            const auto point = [&](int corner) {
                return graph.scaled(Eye::at(graph.mesh().points[t[static_cast<std::size_t>(corner)]]));
            };
            const glm::dvec3 a = point(0), u = point(1) - a, v = point(2) - a, w = point(3) - a;
            const glm::dvec3 vw = glm::cross(v, w), wu = glm::cross(w, u), uv = glm::cross(u, v);
            const glm::dvec3 n = glm::dot(u, u) * vw + glm::dot(v, v) * wu + glm::dot(w, w) * uv;
            const double d = glm::dot(uv, w);
            const double l = std::max({largest_coordinate(u), largest_coordinate(v), largest_coordinate(w)});
            const double n_error = 18 * l * l * l * (16 + 20 * l) * half_ulp, d_error = 6 * l * l * (12 + 8 * l) * half_ulp;
            if (!(std::abs(d) > 2 * d_error)) {
                spheres_[i] = {};
                slack_[i] = slack_at_least(infinity);
                continue;
            }
            const glm::dvec3 from_a = n / (2 * d), center = a + from_a;
            const double reach = largest_coordinate(from_a);
            const double power = glm::dot(a, a) + 2 * glm::dot(a, from_a);
            const double center_error = (n_error / 2 + reach * d_error) / (std::abs(d) - d_error) + 4 * half_ulp * (reach + 1);
            const double power_error = 6 * center_error + 128 * half_ulp * (reach + 1);
            spheres_[i] = {static_cast<float>(center.x), static_cast<float>(center.y), static_cast<float>(center.z),
                           static_cast<float>(power)};
            const double rounding = half_ulp_float * (6 * largest_coordinate(center) + std::abs(power));
            slack_[i] = slack_at_least(1.001 * (6 * center_error + power_error + rounding));
        }
    });
}

// The nearness of the spheres to an eye.
class PowerKeys::View {
public:
    View(const CellGraph& graph, const Eye& eye) {
        const glm::dvec3 e = graph.scaled(eye);
        const double size = std::max(1.0, glm::length(e));
        towards_ = (eye.at_infinity ? 1.0 : 2.0) * (e / size);
        own_ = eye.at_infinity ? 0.0 : 1.0 / size;
    }

    float operator()(const Sphere& s) const {
        return static_cast<float>(towards_.x * s.x + towards_.y * s.y + towards_.z * s.z - own_ * s.power);
    }

private:
    glm::dvec3 towards_;
    double own_;
};

FindKeys PowerKeys::keys(const CellGraph& graph, const Eye& eye, std::span<const std::uint8_t> visible) const {
    return [&graph, nearness = View(graph, eye), visible, spheres = spheres_.data()](std::size_t first, std::span<std::uint32_t> keys) {
        for (std::size_t k = 0; k < keys.size(); ++k) keys[k] = key_of(nearness(spheres[first + k]));
        leave_out(graph, visible, first, keys);
    };
}

bool PowerKeys::settle(const CellGraph& graph, const Eye& eye, std::span<CellId> order, std::span<std::uint32_t> scratch) const {
    const std::span<std::uint32_t> nearness = scratch;  // as bits of float32; when these are done, positions
    const View nearness_of(graph, eye);
    oneapi::tbb::parallel_for(Range(0, graph.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) nearness[i] = std::bit_cast<std::uint32_t>(nearness_of(spheres_[i]));
    });
    const auto is_near = [&](std::size_t place) { return std::bit_cast<float>(nearness[place]); };
    // Where the powers of two cells stand in the order of their nearness. The last term is the rounding of that.
    const auto certain = [&](std::size_t a, std::size_t b) {
        return slacks[slack_[a]] + slacks[slack_[b]] + 0x1.01p-24F * (std::abs(is_near(a)) + std::abs(is_near(b)));
    };
    // Whether their keys might stand in another order than their powers.
    const auto doubtful = [&](std::size_t a, std::size_t b) {
        return !(std::abs(is_near(a) - is_near(b)) > certain(a, b)) || key_of(is_near(a)) == key_of(is_near(b));
    };
    // Nearly all cells are far from doubt. This says so at once, without a choice that depends on the data: within the common nearness a key is
    // off by less than half its width, so keys of what differs by three of them are not equal. Nobody's number is larger than all.
    const auto may_be_doubtful = [&](std::size_t place) {
        const auto last = static_cast<CellId>(graph.size() - 1);
        bool doubt = !(std::abs(is_near(place)) <= common_nearness);
        for (const CellId other : graph.neighbours(static_cast<CellId>(place))) {
            const CellId there = std::min(other, last);
            const bool is_there = other <= last, is_common = std::abs(is_near(there)) <= common_nearness;
            const bool is_settled = std::abs(is_near(place) - is_near(there)) > certain(place, there) + 3 * key_width;
            doubt |= is_there & !(is_settled & is_common);
        }
        return doubt;
    };
    struct Pair {
        CellId place;
        int face;
    };
    oneapi::tbb::enumerable_thread_specific<std::vector<Pair>> found;
    oneapi::tbb::parallel_for(Range(0, graph.size(), cells_per_task), [&](const Range& range) {
        std::vector<Pair>& pairs = found.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            if (!may_be_doubtful(i)) continue;
            for (std::size_t face = 0; face < 4; ++face) {
                const CellId other = graph.neighbours(static_cast<CellId>(i))[face];
                if (other == graph.nobody() || other < i || !doubtful(i, other)) continue;
                pairs.push_back({static_cast<CellId>(i), static_cast<int>(face)});
            }
        }
    });
    std::size_t doubts = 0;
    for (const auto& pairs : found) doubts += pairs.size();
    if (doubts == 0) return true;
    if (doubts > graph.size() / 64 + 64) return false;

    const std::span<std::uint32_t> position = scratch;
    std::fill(position.begin(), position.end(), no_key);
    oneapi::tbb::parallel_for(Range(0, order.size(), cells_per_task), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) position[order[i]] = static_cast<std::uint32_t>(i);
    });
    std::vector<OrderArc> wrong;
    for (const auto& pairs : found) {
        for (const auto& [place, face] : pairs) {
            const CellId other = graph.neighbours(place)[static_cast<std::size_t>(face)];
            if (position[place] == no_key && position[other] == no_key) continue;
            const int beyond = graph.beyond(eye, place, face);
            if (beyond == 0) continue;
            if (position[place] == no_key || position[other] == no_key) return false;
            const OrderArc arc = beyond > 0 ? OrderArc{place, other} : OrderArc{other, place};
            if (position[arc.front] < position[arc.behind]) wrong.push_back(arc);
        }
    }
    return repair_order(graph, eye, wrong, order, position);
}

}  // namespace cellproj
