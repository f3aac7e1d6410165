// SPDX-License-Identifier: BSD-3-Clause
//
// Where the parts of a colour bar go.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/annotation/color_bar.hpp"

namespace cellproj {

namespace {

// Of surfaces alone, their values.
Ticks ticks_of(const ColorBar& content, int most) {
    if (content.medium) return (content.axis == ScalarAxis::log ? log_ticks : nice_ticks)(content.low, content.high, most);
    Ticks ticks{{}, {content.low, number_text(content.low)}, {content.high, number_text(content.high)}, {}};
    for (const IsoSurface& surface : content.surfaces) ticks.ticks.push_back({surface.value, number_text(surface.value)});
    return ticks;
}

// Lays out one bar: first the bar itself, then its texts.
class Planner {
public:
    Planner(ColorBarPlan& plan, const PixelBox& within, const Font& font)
        : plan_(plan), style_(plan.style), within_(within), font_(font), pad_(style_.ems(0.6)), thick_(style_.ems(1.1)),
          strip_(plan.content.path ? style_.ems(1.3) + plan.style.line : 0), tick_(style_.ems(0.35)), gap_(style_.ems(0.3)),
          cap_(font.cap_height(style_.em)), line_(font.line_height(style_.em)), small_line_(font.line_height(style_.small)) {
        plan_.arrow = plan_.content.below != Beyond::nothing || plan_.content.above != Beyond::nothing ? style_.ems(0.8) : 0;
        if (plan_.content.path) opacity_ = {"opacity over", "a path of " + number_text(*plan_.content.path)};
        if (!plan_.content.opacity_name.empty()) opacity_ = {"opacity:", plan_.content.opacity_name};
    }

    void vertical() {
        const int header = plan_.ticks.common.empty() ? 0 : rows(line_), footer = rows(static_cast<double>(opacity_.size()) * small_line_);
        const int room = within_.height() - header - footer - 2 * (beyond() + pad_);
        const int length = std::clamp(room, 1, style_.ems(26));
        const int top = within_.y0 + pad_ + beyond() + header + std::max(room - length, 0) / 2;
        set_ticks(length, 2.2 * style_.em);

        const int labels = width_of_labels();
        // Numbers are never cut; long names of an opacity field are.
        double beneath = font_.advance(plan_.ticks.common, style_.em);
        for (const std::string& text : opacity_) beneath = std::max(beneath, std::min(font_.advance(text, style_.small), 9 * style_.em));
        const int beside_bar = strip_ + thick_ + tick_ + gap_ + labels + gap_ + rows(line_);
        const int column = pad_ + std::max(beside_bar, rows(beneath)) + pad_;
        plan_.area = right() ? PixelBox{within_.x1 - column, within_.y0, within_.x1, within_.y1} : PixelBox{within_.x0, within_.y0, within_.x0 + column, within_.y1};
        const int bar = right() ? plan_.area.x0 + pad_ + strip_ : plan_.area.x1 - pad_ - strip_ - thick_;
        plan_.bar = {bar, top, bar + thick_, top + length};
        plan_.strip = right() ? PixelBox{bar - strip_, top, bar - style_.line, top + length}
                            : PixelBox{bar + thick_ + style_.line, top, bar + thick_ + strip_, top + length};

        label_side();
        name_side();
        caption_side();
    }

    void horizontal() {
        const int caption = opacity_.empty() ? 0 : rows(small_line_), row = pad_ + caption + strip_ + thick_ + tick_ + gap_ + 2 * rows(line_) + pad_;
        plan_.area = {within_.x0, within_.y1 - row, within_.x1, within_.y1};
        const int room = within_.width() - 2 * (std::max(plan_.arrow, style_.ems(2.5)) + pad_);
        const int length = std::clamp(room, 1, style_.ems(40));
        set_ticks(length, 4.5 * style_.em);
        const int left = within_.x0 + (within_.width() - length) / 2, top = plan_.area.y0 + pad_ + caption + strip_;
        plan_.bar = {left, top, left + length, top + thick_};
        plan_.strip = {left, top - strip_, left + length, top - style_.line};
        std::string opacity;
        for (const std::string& part : opacity_) opacity += (opacity.empty() ? "" : " ") + part;
        put(opacity, style_.small, left, top - strip_ - rows(0.35 * style_.small), length);

        label_below();
        name_below(plan_.bar.y1 + tick_ + gap_ + rows(cap_) + rows(line_));
    }

private:
    struct Label {
        double at;  // distance of its middle from the low end
        TextMask mask;
    };

    bool right() const { return plan_.side == BarSide::right; }
    // How far marks, and the halves of labels at the ends, reach beyond the ends of a vertical bar.
    int beyond() const { return std::max(plan_.arrow, rows(cap_ / 2) + gap_); }

    // Labels stand right of the ticks, or end left of them.
    void label_side() {
        const int beside = right() ? plan_.bar.x1 + tick_ + gap_ : plan_.bar.x0 - tick_ - gap_;
        for (const auto& [at, mask] : chosen_labels(1.25 * cap_)) {
            const int x = right() ? beside : beside - static_cast<int>(std::lround(mask.advance));
            plan_.texts.push_back({mask, x, static_cast<int>(std::lround(plan_.bar.y1 - at + cap_ / 2))});
        }
    }

    // Along the outer side, in the middle of the bar as far as the length of the name allows.
    void name_side() {
        TextMask name = turned_left(font_.draw(shortened(font_, plan_.content.name, style_.em, within_.height() - 2 * pad_), style_.em));
        const double middle = plan_.bar.y0 + plan_.length() / 2.0;
        const int low = within_.y1 - pad_, high = within_.y0 + pad_ + rows(name.advance);
        const int y = std::max(high, std::min(low, static_cast<int>(std::lround(middle + name.advance / 2))));
        const int x = right() ? plan_.area.x1 - pad_ - rows(0.25 * style_.em) : plan_.area.x0 + pad_ + rows(cap_);
        plan_.texts.push_back({std::move(name), x, y});
    }

    // Above and below the bar, flush with the side that the volume is on.
    void caption_side() {
        const int width = plan_.area.width() - 2 * pad_;
        const auto put_flush = [&](const std::string& text, double size, double y) {
            const int taken = std::min(rows(font_.advance(text, size)), width);
            put(text, size, right() ? plan_.area.x0 + pad_ : plan_.area.x1 - pad_ - taken, static_cast<int>(std::lround(y)), width);
        };
        put_flush(plan_.ticks.common, style_.em, plan_.bar.y0 - beyond() - rows(line_ - cap_));
        double y = plan_.bar.y1 + beyond();
        for (const std::string& text : opacity_) put_flush(text, style_.small, y += small_line_);
    }

    void label_below() {
        for (const auto& [at, mask] : chosen_labels(0.8 * style_.em)) {
            const int width = static_cast<int>(std::lround(mask.advance));
            const int x = static_cast<int>(std::lround(plan_.bar.x0 + at - mask.advance / 2));
            plan_.texts.push_back({mask, std::clamp(x, within_.x0 + 1, std::max(within_.x0 + 1, within_.x1 - width - 1)), plan_.bar.y1 + tick_ + gap_ + rows(cap_)});
        }
    }

    // The name in the middle of its line, what labels leave out at the line's end.
    void name_below(int y) {
        const double common = font_.advance(plan_.ticks.common, style_.em), beside = common > 0 ? common + pad_ : 0;
        const std::string name = shortened(font_, plan_.content.name, style_.em, within_.width() - 2 * (beside + pad_));
        const double middle = plan_.bar.x0 + plan_.length() / 2.0;
        put(name, style_.em, static_cast<int>(std::lround(middle - font_.advance(name, style_.em) / 2)), y, within_.width());
        put(plan_.ticks.common, style_.em, within_.x1 - pad_ - rows(common), y, within_.width() - 2 * pad_);
    }

    static int rows(double pixels) { return static_cast<int>(std::ceil(pixels)); }

    void put(const std::string& text, double size, int x, int y, double width) {
        if (!text.empty()) plan_.texts.push_back({font_.draw(shortened(font_, text, size, width), size), x, y});
    }

    void set_ticks(int length, double apart) {
        plan_.ticks = ticks_of(plan_.content, std::max(1, static_cast<int>(length / apart)));
    }

    // The ends say that they stand for more.
    std::string low_label() const { return (plan_.content.below == Beyond::clamped ? "≤ " : "") + plan_.ticks.low.label; }
    std::string high_label() const { return (plan_.content.above == Beyond::clamped ? "≥ " : "") + plan_.ticks.high.label; }

    int width_of_labels() const {
        double widest = std::max(font_.advance(low_label(), style_.em), font_.advance(high_label(), style_.em));
        for (const Tick& tick : plan_.ticks.ticks) widest = std::max(widest, font_.advance(tick.label, style_.em));
        return rows(widest);
    }

    // Those that leave `apart` pixels to each other: the ends before ticks, values of surfaces before the ends.
    std::vector<Label> chosen_labels(double apart) const {
        const ColorBar& content = plan_.content;
        if (content.low == content.high) return {{plan_.distance(content.low), font_.draw(plan_.ticks.low.label, style_.em)}};
        std::vector<Tick> candidates = plan_.ticks.ticks;
        const std::array<Tick, 2> ends{Tick{content.low, low_label()}, {content.high, high_label()}};
        candidates.insert(content.medium ? candidates.begin() : candidates.end(), ends.begin(), ends.end());

        std::vector<Label> kept;
        const auto half = [&](const Label& l) { return plan_.vertical() ? cap_ / 2 : l.mask.advance / 2; };
        for (const Tick& tick : candidates) {
            Label label{plan_.distance(tick.value), font_.draw(tick.label, style_.em)};
            const auto clear = [&](const Label& other) { return std::abs(label.at - other.at) >= half(label) + half(other) + apart; };
            if (std::all_of(kept.begin(), kept.end(), clear)) kept.push_back(std::move(label));
        }
        return kept;
    }

    ColorBarPlan& plan_;
    const AnnotationStyle& style_;
    PixelBox within_;
    const Font& font_;
    int pad_, thick_, strip_, tick_, gap_;
    double cap_, line_, small_line_;
    std::vector<std::string> opacity_;  // what the curve is, in words
};

}  // namespace

ColorBarPlan plan_color_bar(ColorBar content, BarSide side, const PixelBox& within, const Font& font, const AnnotationStyle& style) {
    ColorBarPlan plan{.content = std::move(content), .side = side, .area = {}, .bar = {}, .strip = {}, .arrow = 0, .ticks = {}, .texts = {}, .style = style};
    // Whether labels leave something out, which takes a line, hardly depends on how many there are.
    plan.ticks = ticks_of(plan.content, 5);
    Planner planner(plan, within, font);
    plan.vertical() ? planner.vertical() : planner.horizontal();
    return plan;
}

}  // namespace cellproj
