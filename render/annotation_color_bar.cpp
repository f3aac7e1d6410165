// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation_color_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include <glm/common.hpp>

#include "classify/optics.hpp"

namespace cellproj {

namespace {

struct Shares {
    double below, above;  // of the finite values, 0..1
};

Shares shares_beyond(const std::vector<double>& values, double low, double high) {
    std::size_t below = 0, above = 0, finite = 0;
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        ++finite;
        below += value < low;
        above += value > high;
    }
    const double all = static_cast<double>(std::max<std::size_t>(finite, 1));
    return {static_cast<double>(below) / all, static_cast<double>(above) / all};
}

std::string percent(double share) {
    if (share < 1e-4) return "less than 0.01 %";
    if (share > 0.99 && share < 1) return "more than 99 %";
    char text[16];
    std::snprintf(text, sizeof text, share < 0.1 ? "%.2g" : "%.0f", 100 * share);
    return std::string(text) + " %";
}

// What is said of values beyond an end, for example "are drawn as 4.9".
std::string note_of(const ScalarField& field, double low, double high, const std::string& fate_below, const std::string& fate_above) {
    const auto [below, above] = shares_beyond(field.values, low, high);
    if (below == 0 && above == 0) return {};
    std::string note = field.name + ": ";
    if (below > 0) note += percent(below) + " of the values lie below " + number_text(low) + " and " + fate_below;
    if (below > 0 && above > 0) note += "; ";
    if (above > 0) note += percent(above) + (below > 0 ? "" : " of the values") + " lie above " + number_text(high) + " and " + fate_above;
    return note + ".";
}

bool dark(const glm::dvec3& color) { return color == glm::dvec3(0.0); }

// The outermost pieces are constant and say what holds beyond the nodes, whatever `outside` is.
bool hides(const TransferFunction& transfer, const LinearPiece& outermost) {
    return outermost.extinction_begin == 0 && (transfer.model() == OpticalModel::density || dark(outermost.color_begin));
}

Beyond beyond(double share, bool hidden) { return share == 0 ? Beyond::nothing : hidden ? Beyond::hidden : Beyond::clamped; }

std::string fate(bool hidden, double end) { return hidden ? "are not drawn" : "are drawn as " + number_text(end); }

// The largest 1, 2 or 5 · 10^e with an optical depth of at most 2.
double path_of(double densest) {
    const double most = 2 / densest;
    const double power = std::pow(10.0, std::floor(std::log10(most)));
    return power * (5 * power <= most ? 5 : 2 * power <= most ? 2 : 1);
}

// What counts as 1 in the bar.
double brightest_of(const TransferFunction& transfer) {
    if (transfer.model() == OpticalModel::density) return 1;
    double brightest = 0;
    for (const ColorNode& node : transfer.color_nodes()) brightest = std::max({brightest, node.color.x, node.color.y, node.color.z});
    return brightest > 0 ? brightest : 1;
}

void describe_one_field(const Scene& scene, ColorBar& bar) {
    const TransferFunction& transfer = *scene.transfer;
    bar.low = transfer.breakpoints().front();
    bar.high = transfer.breakpoints().back();
    const bool hidden_below = hides(transfer, transfer.pieces().front()), hidden_above = hides(transfer, transfer.pieces().back());
    const auto [below, above] = shares_beyond(scene.field->values, bar.low, bar.high);
    bar.below = beyond(below, hidden_below);
    bar.above = beyond(above, hidden_above);
    bar.note = note_of(*scene.field, bar.low, bar.high, fate(hidden_below, bar.low), fate(hidden_above, bar.high));
    const double densest = transfer.max_extinction(bar.low, bar.high);
    if (densest > 0) bar.path = path_of(densest);
}

void describe_two_fields(const Scene& scene, ColorBar& bar) {
    const TransferFunction& transfer = *scene.transfer;
    const bool transparent = transfer.outside() == Outside::transparent;
    bar.low = transfer.color_nodes().front().scalar;
    bar.high = transfer.color_nodes().back().scalar;
    const auto [below, above] = shares_beyond(scene.field->values, bar.low, bar.high);
    bar.below = beyond(below, transparent);
    bar.above = beyond(above, transparent);
    const auto fate_of_color = [&](double end) { return transparent ? "give no light" : fate(false, end); };
    bar.note = note_of(*scene.field, bar.low, bar.high, fate_of_color(bar.low), fate_of_color(bar.high));
    bar.opacity_name = scene.opacity_field->name;

    const ExtinctionNode &first = transfer.extinction_nodes().front(), &last = transfer.extinction_nodes().back();
    const auto fate_of_opacity = [&](const ExtinctionNode& end) {
        return transparent || end.extinction == 0 ? "are transparent" : "are as opaque as " + number_text(end.scalar);
    };
    const std::string note = note_of(*scene.opacity_field, first.scalar, last.scalar, fate_of_opacity(first), fate_of_opacity(last));
    if (!note.empty()) bar.note += (bar.note.empty() ? "" : " ") + note;
}

Ticks ticks_of(const ColorBar& content, int most) { return (content.axis == ScalarAxis::log ? log_ticks : nice_ticks)(content.low, content.high, most); }

// Lays out one bar. "Across" is from the bar towards its labels: outwards, away from the volume.
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
        const int beyond = std::max(plan_.arrow, rows(cap_ / 2) + gap_);  // marks, and the halves of the labels at the ends
        const int room = within_.height() - header - footer - 2 * (beyond + pad_);
        const int length = std::clamp(room, 1, style_.ems(26));
        const int top = within_.y0 + pad_ + beyond + header + std::max(room - length, 0) / 2;
        set_ticks(length, 2.2 * style_.em);

        const int labels = width_of_labels();
        // Numbers are never cut; long names of an opacity field are.
        double beneath = font_.advance(plan_.ticks.common, style_.em);
        for (const std::string& text : opacity_) beneath = std::max(beneath, std::min(font_.advance(text, style_.small), 9 * style_.em));
        const int beside_bar = strip_ + thick_ + tick_ + gap_ + labels + gap_ + rows(line_);
        const int column = pad_ + std::max(beside_bar, rows(beneath)) + pad_;
        const bool right = plan_.side == BarSide::right;
        plan_.area = right ? PixelBox{within_.x1 - column, within_.y0, within_.x1, within_.y1} : PixelBox{within_.x0, within_.y0, within_.x0 + column, within_.y1};
        const int bar = right ? plan_.area.x0 + pad_ + strip_ : plan_.area.x1 - pad_ - strip_ - thick_;
        plan_.bar = {bar, top, bar + thick_, top + length};
        plan_.strip = right ? PixelBox{bar - strip_, top, bar - style_.line, top + length}
                            : PixelBox{bar + thick_ + style_.line, top, bar + thick_ + strip_, top + length};

        // Labels stand right of the ticks, or end left of them.
        const int beside = right ? plan_.bar.x1 + tick_ + gap_ : plan_.bar.x0 - tick_ - gap_;
        for (const auto& [at, mask] : chosen_labels(1.25 * cap_)) {
            const int x = right ? beside : beside - static_cast<int>(std::lround(mask.advance));
            plan_.texts.push_back({mask, x, static_cast<int>(std::lround(plan_.bar.y1 - at + cap_ / 2))});
        }
        TextMask name = turned_left(font_.draw(shortened(font_, plan_.content.name, style_.em, within_.height() - 2 * pad_), style_.em));
        const double middle = plan_.bar.y0 + length / 2.0;
        const int low = within_.y1 - pad_, high = within_.y0 + pad_ + static_cast<int>(std::ceil(name.advance));
        const int pen_y = std::max(high, std::min(low, static_cast<int>(std::lround(middle + name.advance / 2))));
        const int pen_x = right ? plan_.area.x1 - pad_ - rows(0.25 * style_.em) : plan_.area.x0 + pad_ + rows(cap_);
        plan_.texts.push_back({std::move(name), pen_x, pen_y});
        // Above and below the bar, flush with the side that the volume is on.
        const auto put_flush = [&](const std::string& text, double size, int y) {
            const double width = std::min<double>(font_.advance(text, size), column - 2 * pad_);
            put(text, size, right ? plan_.area.x0 + pad_ : plan_.area.x1 - pad_ - rows(width), y, column - 2 * pad_);
        };
        if (header) put_flush(plan_.ticks.common, style_.em, top - beyond - rows(line_ - cap_));
        double y = plan_.bar.y1 + beyond + small_line_;
        for (const std::string& text : opacity_) {
            put_flush(text, style_.small, static_cast<int>(std::lround(y)));
            y += small_line_;
        }
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

        const int base = plan_.bar.y1 + tick_ + gap_ + rows(cap_);
        for (const auto& [at, mask] : chosen_labels(0.8 * style_.em)) {
            const int width = static_cast<int>(std::lround(mask.advance));
            const int x = static_cast<int>(std::lround(left + at - mask.advance / 2));
            plan_.texts.push_back({mask, std::clamp(x, within_.x0 + 1, std::max(within_.x0 + 1, within_.x1 - width - 1)), base});
        }
        // The name in the middle of its line, what labels leave out at the line's end.
        const double common = font_.advance(plan_.ticks.common, style_.em);
        const double beside = common > 0 ? common + pad_ : 0;
        const std::string name = shortened(font_, plan_.content.name, style_.em, within_.width() - 2 * (beside + pad_));
        const int second = base + rows(line_);
        put(name, style_.em, static_cast<int>(std::lround(left + (length - font_.advance(name, style_.em)) / 2)), second, within_.width());
        put(plan_.ticks.common, style_.em, within_.x1 - pad_ - rows(common), second, within_.width() - 2 * pad_);
    }

private:
    struct Label {
        double at;  // distance of its middle from the low end
        TextMask mask;
    };

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

    // The ends, and those ticks between that leave `apart` pixels to their neighbours.
    std::vector<Label> chosen_labels(double apart) const {
        const auto label = [&](double s, const std::string& text) { return Label{plan_.distance(s), font_.draw(text, style_.em)}; };
        const auto half = [&](const Label& l) { return plan_.vertical() ? cap_ / 2 : l.mask.advance / 2; };
        const auto clear = [&](const Label& a, const Label& b) { return std::abs(a.at - b.at) >= half(a) + half(b) + apart; };
        const Label low = label(plan_.content.low, low_label()), high = label(plan_.content.high, high_label());
        if (plan_.content.low == plan_.content.high) return {label(plan_.content.low, plan_.ticks.low.label)};
        std::vector<Label> kept{low};
        for (const Tick& tick : plan_.ticks.ticks) {
            Label candidate = label(tick.value, tick.label);
            if (clear(kept.back(), candidate) && clear(candidate, high)) kept.push_back(std::move(candidate));
        }
        if (clear(low, high)) kept.push_back(high);
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

void draw_arrow(Image& image, const ColorBarPlan& plan, bool high) {
    const Beyond what = high ? plan.content.above : plan.content.below;
    if (what == Beyond::nothing) return;
    const PixelBox& bar = plan.bar;
    std::array<glm::dvec2, 3> corners;
    if (plan.vertical()) {
        const double base = high ? bar.y0 : bar.y1;
        corners = {glm::dvec2(bar.x0, base), {bar.x1, base}, {(bar.x0 + bar.x1) / 2.0, base + (high ? -plan.arrow : plan.arrow)}};
    } else {
        const double base = high ? bar.x1 : bar.x0;
        corners = {glm::dvec2(base, bar.y0), {base, bar.y1}, {base + (high ? plan.arrow : -plan.arrow), (bar.y0 + bar.y1) / 2.0}};
    }
    const double infinity = std::numeric_limits<double>::infinity();
    const double outside = high ? std::nextafter(plan.content.high, infinity) : std::nextafter(plan.content.low, -infinity);
    if (what == Beyond::clamped) fill_convex(image, corners, {plan.content.color(outside)}, plan.area);
    const std::array<Segment, 2> sides{Segment{corners[0], corners[2]}, Segment{corners[1], corners[2]}};
    draw_lines(image, sides, plan.style.line, plan.style.ink, plan.area);
}

void draw_opacity(Image& image, const ColorBarPlan& plan) {
    if (!plan.content.path) return;
    const int across = plan.vertical() ? plan.strip.width() : plan.strip.height();
    const bool from_high_side = plan.side != BarSide::left;  // the bar lies at the larger coordinate
    const Paint shade{plan.style.ink.color, 0.5}, one{plan.style.ink.color, 0.5};
    for (int i = 0; i < plan.length(); ++i) {
        const PixelBox slice = plan.slice(plan.strip, i);
        const double reach = across * plan.content.opacity(plan.scalar(i), plan.scalar(i + 1));
        for (int k = 0; k < across; ++k) {
            const int at = from_high_side ? across - 1 - k : k;
            blend(image, plan.vertical() ? slice.x0 + at : slice.x0, plan.vertical() ? slice.y0 : slice.y0 + at, shade, std::clamp(reach - k, 0.0, 1.0));
        }
    }
    PixelBox edge = plan.strip;
    if (!plan.vertical()) edge.y1 = edge.y0 + 1;
    else if (from_high_side) edge.x1 = edge.x0 + 1;
    else edge.x0 = edge.x1 - 1;
    fill(image, edge, one, plan.area);
}

void draw_ticks(Image& image, const ColorBarPlan& plan) {
    const int long_tick = plan.style.ems(0.35), width = plan.style.line;
    const auto tick = [&](double s, int length) {
        const int at = static_cast<int>(std::lround(plan.distance(s) - width / 2.0));
        const int from = std::clamp(at, 0, std::max(0, plan.length() - width));
        const PixelBox& bar = plan.bar;
        const PixelBox box = plan.side == BarSide::bottom ? PixelBox{bar.x0 + from, bar.y1, bar.x0 + from + width, bar.y1 + length}
                             : plan.side == BarSide::right ? PixelBox{bar.x1, bar.y1 - from - width, bar.x1 + length, bar.y1 - from}
                                                           : PixelBox{bar.x0 - length, bar.y1 - from - width, bar.x0, bar.y1 - from};
        fill(image, box, plan.style.ink, plan.area);
    };
    for (const Tick& t : plan.ticks.ticks) tick(t.value, long_tick);
    tick(plan.content.low, long_tick);
    if (plan.content.low < plan.content.high) tick(plan.content.high, long_tick);
}

}  // namespace

glm::dvec3 ColorBar::color(double s) const {
    return glm::clamp(transfer->color(s) / brightest, 0.0, 1.0);
}

double ColorBar::opacity(double a, double b) const { return path ? opacity_of_depth(transfer->max_extinction(a, b) * *path) : 0; }

ColorBar describe_color_bar(const Scene& scene, const std::string& units, ScalarAxis axis) {
    ColorBar bar{};
    bar.transfer = scene.transfer;
    bar.brightest = brightest_of(*scene.transfer);
    bar.name = units.empty() ? scene.field->name : scene.field->name + " [" + units + "]";
    scene.opacity_field ? describe_two_fields(scene, bar) : describe_one_field(scene, bar);
    bar.axis = bar.low >= 1e-300 ? axis : ScalarAxis::linear;
    return bar;
}

double ColorBarPlan::scalar(double distance) const {
    return scalar_between(content.low, content.high, std::clamp(distance / length(), 0.0, 1.0), content.axis);
}

double ColorBarPlan::distance(double s) const {
    if (content.low == content.high) return length() / 2.0;
    const bool log = content.axis == ScalarAxis::log;
    return length() * (log ? std::log(s / content.low) / std::log(content.high / content.low) : (s - content.low) / (content.high - content.low));
}

PixelBox ColorBarPlan::slice(const PixelBox& of, int i) const {
    return vertical() ? PixelBox{of.x0, of.y1 - i - 1, of.x1, of.y1 - i} : PixelBox{of.x0 + i, of.y0, of.x0 + i + 1, of.y1};
}

ColorBarPlan plan_color_bar(ColorBar content, BarSide side, const PixelBox& within, const Font& font, const AnnotationStyle& style) {
    ColorBarPlan plan{.content = std::move(content), .side = side, .area = {}, .bar = {}, .strip = {}, .arrow = 0, .ticks = {}, .texts = {}, .style = style};
    // Whether labels leave something out, which takes a line, hardly depends on how many there are.
    plan.ticks = ticks_of(plan.content, 5);
    Planner planner(plan, within, font);
    plan.vertical() ? planner.vertical() : planner.horizontal();
    return plan;
}

void draw_color_bar(Image& image, const ColorBarPlan& plan) {
    // The bar comes over the edges of the marks: its own pixels are the function's.
    draw_arrow(image, plan, false);
    draw_arrow(image, plan, true);
    for (int i = 0; i < plan.length(); ++i) fill(image, plan.slice(plan.bar, i), {plan.content.color(plan.scalar(i + 0.5))}, plan.area);
    // Around it, so that colours like the paper's have an end.
    const int line = plan.style.line;
    frame(image, {plan.bar.x0 - line, plan.bar.y0 - line, plan.bar.x1 + line, plan.bar.y1 + line}, line, plan.style.ink, plan.area);
    draw_opacity(image, plan);
    draw_ticks(image, plan);
    for (const PlacedText& text : plan.texts) draw_text(image, text, plan.style.ink, plan.area);
}

}  // namespace cellproj
