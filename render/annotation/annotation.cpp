// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/annotation.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/trigonometric.hpp>

#include "mesh/error.hpp"
#include "render/annotation/outline.hpp"
#include "render/annotation/triad.hpp"

namespace cellproj {

namespace {

constexpr int least_side = 96;           // pixels: ten lines of the smallest text
constexpr double least_em = 9;           // pixels: digits can be told apart
constexpr double em_share = 1.0 / 38;    // of the shorter side
constexpr double title_size = 1.25, note_size = 0.8, outline_opacity = 0.65;

// The contrast of WCAG 2.1: relative luminance from sRGB. Black text from a luminance of 0.18 upwards.
bool light(const glm::dvec3& srgb) {
    const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
    const double luminance = 0.2126 * linear(srgb.x) + 0.7152 * linear(srgb.y) + 0.0722 * linear(srgb.z);
    return (luminance + 0.05) * (luminance + 0.05) > 1.05 * 0.05;
}

AnnotationStyle style_of(ImageSize size, const glm::dvec3& background) {
    const double em = std::max(em_share * std::min(size.width, size.height), least_em);
    return {.em = em,
            .small = std::max(note_size * em, least_em),
            .line = std::max(1, static_cast<int>(std::lround(em / 14))),
            .ink = {light(background) ? glm::dvec3(0.06) : glm::dvec3(0.94)},
            .paper = {background}};
}

[[noreturn]] void throw_too_small(ImageSize size, const std::string& expected, const std::string& advice) {
    throw Error({.kind = ErrorKind::option,
                 .place = "--size",
                 .expected = expected,
                 .found = std::to_string(size.width) + "x" + std::to_string(size.height),
                 .advice = advice});
}

void require_half(const PixelBox& view, ImageSize size) {
    if (2 * view.width() >= size.width && 2 * view.height() >= size.height) return;
    throw_too_small(size, "a picture that leaves half of its width and height to the volume",
                    "colour bar, title and note leave " + std::to_string(std::max(view.width(), 0)) + "x" + std::to_string(std::max(view.height(), 0)) +
                        ": enlarge it, or leave some of them out");
}

}  // namespace

void require_room(const Annotations& annotations, ImageSize size) {
    if (!annotations.text() || std::min(size.width, size.height) >= least_side) return;
    const std::string side = std::to_string(least_side);
    throw_too_small(size, "at least " + side + "x" + side + " for text that can be read", "enlarge it, or leave colour bar, axes and title out");
}

Annotator::Annotator(const Annotations& annotations, const Scene& scene, ImageSize size, std::shared_ptr<const Font> font)
    : annotations_(annotations), size_(size), box_(bounds(scene.mesh->points)), font_(std::move(font)),
      style_(style_of(size, annotations.background)), view_{0, 0, size.width, size.height} {
    assert(font_ || !annotations_.text());
    require_room(annotations_, size);
    if (!annotations_.title.empty()) place_lines(annotations_.title, title_size * style_.em, view_, true);
    if (annotations_.color_bar) {
        ColorBar content = describe_color_bar(scene, annotations_.units, annotations_.bar_axis);
        note_ = content.note;
        place_lines(note_, style_.small, view_, false);
        require_half(view_, size);
        bar_ = plan_color_bar(std::move(content), *annotations_.color_bar, view_, *font_, style_);
        if (bar_->side == BarSide::left) view_.x0 = bar_->area.x1;
        if (bar_->side == BarSide::right) view_.x1 = bar_->area.x0;
        if (bar_->side == BarSide::bottom) view_.y1 = bar_->area.y0;
    }
    require_half(view_, size);
}

// Lines of text in the middle, at the upper or lower end of what is left over, which shrinks.
void Annotator::place_lines(const std::string& text, double size, PixelBox& left_over, bool above) {
    const int pad = style_.ems(0.6);
    const std::vector<std::string> lines = wrapped(*font_, text, size, left_over.width() - 2 * pad);
    if (lines.empty()) return;
    const double line = font_->line_height(size);
    const int height = static_cast<int>(std::ceil(static_cast<double>(lines.size()) * line)) + pad;
    const int top = above ? left_over.y0 + pad / 2 : left_over.y1 - height + pad / 2;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double width = font_->advance(lines[i], size);
        // Capitals in the middle of their line.
        const double base = top + (static_cast<double>(i) + 0.5) * line + font_->cap_height(size) / 2;
        lines_.push_back({font_->draw(lines[i], size), static_cast<int>(std::lround(left_over.x0 + (left_over.width() - width) / 2)),
                          static_cast<int>(std::lround(base))});
    }
    (above ? left_over.y0 : left_over.y1) += above ? height : -height;
}

Camera Annotator::view_camera(const Camera& camera) const {
    // The picture as a whole is scaled by the smaller of the two ratios; where that is the width's, the view shows more above and below.
    const double across = static_cast<double>(view_.width()) / size_.width, down = static_cast<double>(view_.height()) / size_.height;
    const double more = std::max(1.0, down / across);
    if (more == 1) return camera;
    Camera wider = camera;
    wider.height *= more;
    wider.fov_y_degrees = 2 * glm::degrees(std::atan(more * std::tan(glm::radians(camera.fov_y_degrees) / 2)));
    return wider;
}

// The view at its place in the picture.
Image Annotator::on_canvas(Image view) const {
    if (view.width == size_.width && view.height == size_.height) return view;
    Image picture(size_.width, size_.height);
    for (int y = 0; y < view.height; ++y) std::copy_n(&view.at(0, y), view.width, &picture.at(view_.x0, view_.y0 + y));
    return picture;
}

Image Annotator::compose(Image view, const Camera& camera) const {
    assert(view.width == view_.width() && view.height == view_.height());
    if (!annotations_.any()) return view;
    const Camera seen = view_camera(camera);
    if (annotations_.outline) {
        const BoxOutline outline = outline_of(box_, seen, view_size());
        Paint paint{style_.ink.color, outline_opacity, true};
        draw_lines(view, outline.behind, style_.line, paint, whole(view));
        paint.under = false;
        draw_lines(view, outline.before, style_.line, paint, whole(view));
    }
    Image picture = on_canvas(std::move(view));
    if (annotations_.axes) {
        const int side = triad_size(style_);
        draw_triad(picture, seen, intersection({view_.x0, view_.y1 - side, view_.x0 + side, view_.y1}, view_), *font_, style_);
    }
    if (bar_) draw_color_bar(picture, *bar_);
    for (const PlacedText& line : lines_) draw_text(picture, line, style_.ink, whole(picture));
    return picture;
}

}  // namespace cellproj
