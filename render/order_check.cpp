// SPDX-License-Identifier: BSD-3-Clause
#include "render/order_check.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

namespace cellproj {

namespace {

constexpr auto absent = std::numeric_limits<std::uint32_t>::max();
constexpr double shortest_part = 1e-9;  // of the longest crossing

// What stands where in an order.
struct Positions {
    std::vector<std::uint32_t> cell;                        // of whole cells
    std::vector<std::pair<CellId, std::uint32_t>> pieces;  // ascending: cell, position

    Positions(const ViewOrder& order, std::size_t cells) : cell(cells, absent) {
        for (std::uint32_t i = 0; i < order.items.size(); ++i) {
            const std::uint32_t item = order.items[i];
            if (item < cells) {
                cell[item] = i;
            } else {
                pieces.emplace_back(order.pieces[item - cells].cell, i);
            }
        }
        std::sort(pieces.begin(), pieces.end());
    }
};

struct Stretch {
    double enter, leave;
    std::uint32_t position;
};

// The part of a crossing inside a piece. Along a ray the weights over the cell's vertices are linear, and so are those over the piece's
// corners; inside, none is negative.
std::optional<Stretch> inside_piece(const Crossing& crossing, const CellPiece& piece, std::uint32_t position) {
    const glm::dmat4 corners(piece.corners[0], piece.corners[1], piece.corners[2], piece.corners[3]);
    if (glm::determinant(corners) == 0.0) return std::nullopt;
    const auto vector = [](const std::array<double, 4>& w) { return glm::dvec4(w[0], w[1], w[2], w[3]); };
    const glm::dmat4 weights = glm::inverse(corners);
    const glm::dvec4 at_enter = weights * vector(crossing.at_enter), at_leave = weights * vector(crossing.at_leave);
    double enter = 0.0, leave = 1.0;
    for (int corner = 0; corner < 4; ++corner) {
        const double a = at_enter[corner], b = at_leave[corner];
        if (a < 0 && b < 0) return std::nullopt;
        if (a < 0) enter = std::max(enter, a / (a - b));
        if (b < 0) leave = std::min(leave, a / (a - b));
    }
    if (enter >= leave) return std::nullopt;
    return Stretch{crossing.enter + enter * crossing.length(), crossing.enter + leave * crossing.length(), position};
}

std::vector<Stretch> stretches(const RayIndex& index, const ViewRay& ray, const ViewOrder& order, const Positions& positions,
                               std::size_t cells) {
    std::vector<Stretch> parts;
    double longest = 0.0;
    for (const Crossing& crossing : index.cells_along(ray)) {
        longest = std::max(longest, crossing.length());
        if (positions.cell[crossing.cell] != absent) {
            parts.push_back({crossing.enter, crossing.leave, positions.cell[crossing.cell]});
            continue;
        }
        auto piece = std::lower_bound(positions.pieces.begin(), positions.pieces.end(), std::pair{crossing.cell, std::uint32_t{0}});
        for (; piece != positions.pieces.end() && piece->first == crossing.cell; ++piece) {
            const auto part = inside_piece(crossing, order.pieces[order.items[piece->second] - cells], piece->second);
            if (part) parts.push_back(*part);
        }
    }
    std::erase_if(parts, [&](const Stretch& part) { return part.leave - part.enter < shortest_part * longest; });
    std::sort(parts.begin(), parts.end(), [](const Stretch& a, const Stretch& b) { return a.enter + a.leave < b.enter + b.leave; });
    return parts;
}

}  // namespace

PixelGrid pixel_grid(const Camera& camera, ImageSize size) {
    const ScreenTransform transform(camera, size);
    // In perspective, points at depth 1 before the eye; in parallel views the origins of the rays.
    const glm::dvec3 forward = transform.ray(transform.principal_point()).direction;
    const auto point = [&](double x, double y) {
        const ScreenTransform::Ray ray = transform.ray({x, y});
        return transform.perspective() ? ray.origin + ray.direction / glm::dot(ray.direction, forward) : ray.origin;
    };
    const glm::dvec3 corner = point(0, 0);
    return {camera.viewpoint(), corner, (point(size.width, 0) - corner) / static_cast<double>(size.width),
            (point(0, size.height) - corner) / static_cast<double>(size.height), size.width, size.height};
}

OrderCheck check_order(const RayIndex& index, std::size_t cells, const ViewOrder& order, const Camera& camera, ImageSize size,
                       std::size_t rays) {
    const Positions positions(order, cells);
    const auto pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    rays = std::min(rays, pixels);
    // Steps of the golden section of the picture spread evenly at any number; without a common divisor they meet each pixel once.
    auto step = static_cast<std::size_t>(0.618034 * static_cast<double>(pixels)) + 1;
    while (std::gcd(step, pixels) != 1) ++step;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    const auto judge = [&](const Range& range, OrderCheck check) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const std::size_t pixel = i * step % pixels;
            const glm::dvec2 center(static_cast<double>(pixel % static_cast<std::size_t>(size.width)) + 0.5,
                                    static_cast<double>(pixel / static_cast<std::size_t>(size.width)) + 0.5);
            const auto parts = stretches(index, index.ray(camera, size, center), order, positions, cells);
            std::size_t wrong = 0;
            for (std::size_t k = 1; k < parts.size(); ++k) wrong += parts[k - 1].position < parts[k].position ? 1 : 0;
            ++check.rays;
            check.wrong_pairs += wrong;
            check.wrong_rays += wrong > 0 ? 1 : 0;
        }
        return check;
    };
    return oneapi::tbb::parallel_reduce(Range(0, rays, 16), OrderCheck{}, judge, [](const OrderCheck& a, const OrderCheck& b) {
        return OrderCheck{a.rays + b.rays, a.wrong_rays + b.wrong_rays, a.wrong_pairs + b.wrong_pairs};
    });
}

}  // namespace cellproj
