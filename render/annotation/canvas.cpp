// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <glm/geometric.hpp>

namespace cellproj {

namespace {

// The part of a segment inside of low..high (Liang and Barsky 1984): lines of any length are cut before pixels are counted.
std::optional<Segment> clipped(const Segment& segment, const glm::dvec2& low, const glm::dvec2& high) {
    const glm::dvec2 d = segment.second - segment.first;
    double begin = 0, end = 1;
    for (int axis = 0; axis < 2; ++axis) {
        const double from = low[axis] - segment.first[axis], to = high[axis] - segment.first[axis];
        if (d[axis] == 0) {
            if (from > 0 || to < 0) return std::nullopt;
            continue;
        }
        const double t_from = from / d[axis], t_to = to / d[axis];
        begin = std::max(begin, std::min(t_from, t_to));
        end = std::min(end, std::max(t_from, t_to));
    }
    if (begin > end) return std::nullopt;
    return Segment{begin > 0 ? segment.first + begin * d : segment.first, end < 1 ? segment.first + end * d : segment.second};
}

double distance_to(const Segment& segment, const glm::dvec2& p) {
    const glm::dvec2 d = segment.second - segment.first;
    const double squared = glm::dot(d, d);
    const double t = squared > 0 ? std::clamp(glm::dot(p - segment.first, d) / squared, 0.0, 1.0) : 0.0;
    return glm::distance(p, segment.first + t * d);
}

// Pixels that reach into low..high, which lies about the picture.
PixelBox pixels_of(const glm::dvec2& low, const glm::dvec2& high) {
    return {static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y)), static_cast<int>(std::ceil(high.x)),
            static_cast<int>(std::ceil(high.y))};
}

glm::dvec2 center(int x, int y) { return {x + 0.5, y + 0.5}; }

}  // namespace

PixelBox intersection(const PixelBox& a, const PixelBox& b) {
    const int x0 = std::max(a.x0, b.x0), y0 = std::max(a.y0, b.y0);
    return {x0, y0, std::max(x0, std::min(a.x1, b.x1)), std::max(y0, std::min(a.y1, b.y1))};
}

PixelBox whole(const Image& image) { return {0, 0, image.width, image.height}; }

void blend(Image& image, int x, int y, const Paint& paint, double coverage) {
    const double alpha = paint.opacity * coverage;
    if (!(alpha > 0)) return;
    glm::vec4& pixel = image.at(x, y);
    const bool finite = std::isfinite(pixel.r) && std::isfinite(pixel.g) && std::isfinite(pixel.b) && std::isfinite(pixel.a);
    const glm::dvec4 before = finite ? glm::dvec4(pixel) : glm::dvec4(0.0), painted(alpha * paint.color, alpha);
    pixel = glm::vec4(paint.under ? before + (1.0 - before.a) * painted : painted + (1.0 - alpha) * before);
}

void fill(Image& image, const PixelBox& box, const Paint& paint, const PixelBox& clip) {
    const PixelBox part = intersection(box, clip);
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) blend(image, x, y, paint);
}

void frame(Image& image, const PixelBox& box, int width, const Paint& paint, const PixelBox& clip) {
    const int w = std::min({width, box.width() / 2, box.height() / 2});
    fill(image, {box.x0, box.y0, box.x1, box.y0 + w}, paint, clip);
    fill(image, {box.x0, box.y1 - w, box.x1, box.y1}, paint, clip);
    fill(image, {box.x0, box.y0 + w, box.x0 + w, box.y1 - w}, paint, clip);
    fill(image, {box.x1 - w, box.y0 + w, box.x1, box.y1 - w}, paint, clip);
}

void draw_lines(Image& image, std::span<const Segment> lines, double width, const Paint& paint, const PixelBox& clip) {
    const double reach = width / 2 + 0.5;  // of the coverage from the middle of the line
    const glm::dvec2 low = glm::dvec2(clip.x0, clip.y0) - reach - 1.0, high = glm::dvec2(clip.x1, clip.y1) + reach + 1.0;
    std::vector<Segment> parts;
    PixelBox reached{clip.x1, clip.y1, clip.x0, clip.y0};  // by all of them
    const auto pixels_near = [&](const Segment& part) {
        return intersection(pixels_of(glm::min(part.first, part.second) - reach, glm::max(part.first, part.second) + reach), clip);
    };
    for (const Segment& line : lines)
        if (const std::optional<Segment> part = clipped(line, low, high)) {
            const PixelBox near = pixels_near(*part);
            if (near.width() == 0 || near.height() == 0) continue;
            parts.push_back(*part);
            reached = {std::min(reached.x0, near.x0), std::min(reached.y0, near.y0), std::max(reached.x1, near.x1), std::max(reached.y1, near.y1)};
        }
    if (parts.empty()) return;

    std::vector<float> coverage(static_cast<std::size_t>(reached.width()) * static_cast<std::size_t>(reached.height()), 0.0F);
    const auto at = [&](int x, int y) -> float& {
        return coverage[static_cast<std::size_t>(y - reached.y0) * static_cast<std::size_t>(reached.width()) + static_cast<std::size_t>(x - reached.x0)];
    };
    for (const Segment& part : parts) {
        const PixelBox rows = pixels_near(part);
        const glm::dvec2 d = part.second - part.first;
        for (int y = rows.y0; y < rows.y1; ++y) {
            // Of each row only the columns that the line can reach: long slanting lines leave most of their box alone.
            PixelBox near = rows;
            if (std::abs(d.x) < 1e6 * std::abs(d.y)) {
                const double slope = d.x / d.y, around = reach * std::sqrt(1 + slope * slope) + std::abs(slope) + 1;
                const double x = part.first.x + (y + 0.5 - part.first.y) * slope;
                near.x0 = static_cast<int>(std::clamp(std::floor(x - around), double(rows.x0), double(rows.x1)));
                near.x1 = static_cast<int>(std::clamp(std::ceil(x + around), double(rows.x0), double(rows.x1)));
            }
            for (int x = near.x0; x < near.x1; ++x) {
                const double covered = std::clamp(reach - distance_to(part, center(x, y)), 0.0, 1.0);
                at(x, y) = std::max(at(x, y), static_cast<float>(covered));
            }
        }
    }
    for (int y = reached.y0; y < reached.y1; ++y)
        for (int x = reached.x0; x < reached.x1; ++x)
            if (at(x, y) > 0) blend(image, x, y, paint, at(x, y));
}

void fill_convex(Image& image, std::span<const glm::dvec2> corners, const Paint& paint, const PixelBox& clip) {
    glm::dvec2 low = corners[0], high = corners[0];
    double doubled_area = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2& a = corners[i];
        const glm::dvec2& b = corners[(i + 1) % corners.size()];
        low = glm::min(low, a);
        high = glm::max(high, a);
        doubled_area += a.x * b.y - a.y * b.x;
    }
    const PixelBox box = intersection(pixels_of(low - 0.5, high + 0.5), clip);
    const double side = doubled_area < 0 ? -1 : 1;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) {
            double inside = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < corners.size(); ++i) {
                const glm::dvec2 a = corners[i], d = corners[(i + 1) % corners.size()] - a, p = center(x, y) - a;
                const double length = glm::length(d);
                if (length > 0) inside = std::min(inside, side * (d.x * p.y - d.y * p.x) / length);
            }
            blend(image, x, y, paint, std::clamp(inside + 0.5, 0.0, 1.0));
        }
}

PixelBox box_of(const TextMask& mask, int pen_x, int pen_y) {
    const int x = pen_x + mask.left, y = pen_y - mask.above;
    return {x, y, x + mask.width, y + mask.height};
}

void draw_text(Image& image, const TextMask& mask, int pen_x, int pen_y, const Paint& paint, const PixelBox& clip) {
    const PixelBox box = box_of(mask, pen_x, pen_y), part = intersection(box, clip);
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x) blend(image, x, y, paint, mask.at(x - box.x0, y - box.y0));
}

}  // namespace cellproj
