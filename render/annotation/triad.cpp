// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/triad.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>

#include "render/scene_view.hpp"

namespace cellproj {

namespace {

constexpr double arm = 2.0, head = 0.65, label_distance = 0.75, margin = 0.7;  // ems

// Red, green, blue, as usual; lighter on dark paper.
Paint axis_paint(std::size_t axis, const AnnotationStyle& style) {
    static const std::array<glm::dvec3, 3> colors{glm::dvec3(0.80, 0.12, 0.14), glm::dvec3(0.10, 0.52, 0.16), glm::dvec3(0.13, 0.33, 0.80)};
    const bool light_ink = style.ink.color.x > 0.5;
    return {light_ink ? 0.55 * colors[axis] + 0.45 : colors[axis]};
}

// A rim of paper sets what is drawn apart from the volume below.
constexpr double rim_opacity = 0.7;

void draw_label(Image& image, const TextMask& mask, const glm::dvec2& middle, const Paint& paint, const Paint& rim, const PixelBox& clip) {
    const int x = static_cast<int>(std::lround(middle.x - mask.left - mask.width / 2.0));
    const int y = static_cast<int>(std::lround(middle.y + mask.above - mask.height / 2.0));
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) draw_text(image, mask, x + dx, y + dy, rim, clip);
    draw_text(image, mask, x, y, paint, clip);
}

}  // namespace

std::array<glm::dvec3, 3> axes_seen(const Camera& camera) {
    const ScreenTransform frame = relative_transform(camera, {}, 1.0);
    return {frame.to_eye({1, 0, 0}), frame.to_eye({0, 1, 0}), frame.to_eye({0, 0, 1})};
}

int triad_size(const AnnotationStyle& style) { return 2 * style.ems(arm + label_distance + margin); }

void draw_triad(Image& image, const Camera& camera, const PixelBox& box, const Font& font, const AnnotationStyle& style) {
    const std::array<glm::dvec3, 3> axes = axes_seen(camera);
    const glm::dvec2 origin(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1));
    const double width = 1.6 * style.line;
    Paint rim = style.paper;
    rim.opacity = rim_opacity;

    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return axes[a].z > axes[b].z; });
    for (const std::size_t axis : order) {
        const glm::dvec2 seen(axes[axis].x, axes[axis].y);
        const double length = glm::length(seen);
        const glm::dvec2 direction = length > 0 ? seen / length : glm::dvec2(0.0);
        const glm::dvec2 tip = origin + arm * style.em * seen;
        const Paint paint = axis_paint(axis, style);
        // The head keeps its width and becomes as short as the axis does: a cone from the side.
        const glm::dvec2 base = tip - head * style.em * seen, across = 0.32 * head * style.em * glm::dvec2(-direction.y, direction.x);
        const Segment shaft{origin, base};
        draw_lines(image, {&shaft, 1}, width + 2, rim, box);
        draw_lines(image, {&shaft, 1}, width, paint, box);
        const std::array<glm::dvec2, 3> cone{tip, base + across, base - across};
        if (length * style.em > 1) fill_convex(image, cone, paint, box);
        // An axis that points at the eye leaves no direction for its label; then it goes to the upper right.
        const glm::dvec2 aside = length > 0.25 ? direction : glm::dvec2(0.7, -0.7);
        draw_label(image, font.draw(std::string(1, "xyz"[axis]), style.em), tip + label_distance * style.em * aside, paint, rim, box);
    }
}

}  // namespace cellproj
