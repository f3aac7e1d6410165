// SPDX-License-Identifier: BSD-3-Clause
#include "render/annotation/color_bar.hpp"

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

// The range takes in all isovalues: each has its band.
void add_surfaces(const Scene& scene, ColorBar& bar) {
    if (!scene.surfaces || scene.surfaces->isosurfaces.surfaces().empty()) return;
    bar.surfaces = scene.surfaces->isosurfaces.surfaces();
    bar.low = std::min(bar.low, bar.surfaces.front().value);
    bar.high = std::max(bar.high, bar.surfaces.back().value);
}

void describe_surfaces_alone(const Scene& scene, ColorBar& bar) {
    const ScalarRange values = range(scene.field->values);
    bar.low = values.low;
    bar.high = values.high;
    add_surfaces(scene, bar);
}

void describe_one_field(const Scene& scene, ColorBar& bar) {
    const TransferFunction& transfer = *scene.transfer;
    bar.low = transfer.breakpoints().front();
    bar.high = transfer.breakpoints().back();
    add_surfaces(scene, bar);
    // Slices are opaque, whatever the extinction is.
    const bool clamped = scene.slices && transfer.outside() == Outside::clamp;
    const bool hidden_below = !clamped && hides(transfer, transfer.pieces().front()), hidden_above = !clamped && hides(transfer, transfer.pieces().back());
    const auto [below, above] = shares_beyond(scene.field->values, bar.low, bar.high);
    bar.below = beyond(below, hidden_below);
    bar.above = beyond(above, hidden_above);
    bar.note = note_of(*scene.field, bar.low, bar.high, fate(hidden_below, bar.low), fate(hidden_above, bar.high));
    const double densest = transfer.max_extinction(bar.low, bar.high);
    if (densest > 0) bar.path = path_of(densest);
}

// Slices alone, or with isosurfaces: the function is that of their colours.
void describe_slices(const Scene& scene, ColorBar& bar) {
    const TransferFunction& colors = *bar.transfer;
    bar.low = colors.color_nodes().front().scalar;
    bar.high = colors.color_nodes().back().scalar;
    add_surfaces(scene, bar);
    const bool hidden = colors.outside() == Outside::transparent;
    const auto [below, above] = shares_beyond(scene.field->values, bar.low, bar.high);
    bar.below = beyond(below, hidden);
    bar.above = beyond(above, hidden);
    bar.note = note_of(*scene.field, bar.low, bar.high, fate(hidden, bar.low), fate(hidden, bar.high));
}

void describe_two_fields(const Scene& scene, ColorBar& bar) {
    const TransferFunction& transfer = *scene.transfer;
    const bool transparent = transfer.outside() == Outside::transparent;
    bar.low = transfer.color_nodes().front().scalar;
    bar.high = transfer.color_nodes().back().scalar;
    add_surfaces(scene, bar);
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

// A band of the surface's colour at each isovalue, set apart from the colours around it.
void draw_surfaces(Image& image, const ColorBarPlan& plan) {
    const int line = plan.style.line, half = std::max(2 * line, plan.style.ems(0.18));
    for (const IsoSurface& surface : plan.content.surfaces) {
        const int middle = static_cast<int>(std::lround(plan.distance(surface.value)));
        for (int i = std::max(0, middle - half); i < std::min(plan.length(), middle + half); ++i) {
            const bool rim = plan.content.medium && (i < middle - half + line || i >= middle + half - line);
            fill(image, plan.slice(plan.bar, i), rim ? plan.style.ink : Paint{glm::clamp(surface.color, 0.0, 1.0)}, plan.area);
        }
    }
}

void draw_opacity(Image& image, const ColorBarPlan& plan) {
    if (!plan.content.path) return;
    const int across = plan.vertical() ? plan.strip.width() : plan.strip.height();
    const bool from_high_side = plan.side != BarSide::left;  // the bar lies at the larger coordinate
    const Paint shade{plan.style.ink.color, 0.5};
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
    fill(image, edge, shade, plan.area);
}

void draw_ticks(Image& image, const ColorBarPlan& plan) {
    const int length = plan.style.ems(0.35), width = plan.style.line;
    const auto tick = [&](double s) {
        const int at = static_cast<int>(std::lround(plan.distance(s) - width / 2.0));
        const int from = std::clamp(at, 0, std::max(0, plan.length() - width));
        const PixelBox& bar = plan.bar;
        const PixelBox box = plan.side == BarSide::bottom ? PixelBox{bar.x0 + from, bar.y1, bar.x0 + from + width, bar.y1 + length}
                             : plan.side == BarSide::right ? PixelBox{bar.x1, bar.y1 - from - width, bar.x1 + length, bar.y1 - from}
                                                           : PixelBox{bar.x0 - length, bar.y1 - from - width, bar.x0, bar.y1 - from};
        fill(image, box, plan.style.ink, plan.area);
    };
    for (const Tick& t : plan.ticks.ticks) tick(t.value);
    tick(plan.content.low);
    if (plan.content.low < plan.content.high) tick(plan.content.high);
}

}  // namespace

glm::dvec3 ColorBar::color(double s) const {
    return glm::clamp(transfer->color(s) / brightest, 0.0, 1.0);
}

double ColorBar::opacity(double a, double b) const { return path ? opacity_of_depth(transfer->max_extinction(a, b) * *path) : 0; }

ColorBar describe_color_bar(const Scene& scene, const std::string& units, ScalarAxis axis) {
    ColorBar bar{};
    // Without a medium the function is no more than what the interface asks for.
    const double everything = std::numeric_limits<double>::max();
    const bool medium = (!scene.surfaces && !scene.slices) || scene.transfer->visible(-everything, everything);
    bar.transfer = scene.slices && !medium ? scene.slices->colors : scene.transfer;
    bar.brightest = color_scale(*bar.transfer);
    bar.name = units.empty() ? scene.field->name : scene.field->name + " [" + units + "]";
    bar.medium = medium || scene.slices;
    !bar.medium           ? describe_surfaces_alone(scene, bar)
    : !medium             ? describe_slices(scene, bar)
    : scene.opacity_field ? describe_two_fields(scene, bar)
                          : describe_one_field(scene, bar);
    bar.axis = bar.low >= 1e-300 && bar.high <= 1e300 ? axis : ScalarAxis::linear;
    return bar;
}

double ColorBarPlan::scalar(double distance) const {
    return scalar_between(content.low, content.high, std::clamp(distance / length(), 0.0, 1.0), content.axis);
}

double ColorBarPlan::distance(double s) const {
    if (content.low == content.high) return length() / 2.0;
    const bool log = content.axis == ScalarAxis::log;
    if (log) return length() * (std::log(s / content.low) / std::log(content.high / content.low));
    return length() * ((s / 2 - content.low / 2) / (content.high / 2 - content.low / 2));  // halves: no range overflows
}

PixelBox ColorBarPlan::slice(const PixelBox& of, int i) const {
    return vertical() ? PixelBox{of.x0, of.y1 - i - 1, of.x1, of.y1 - i} : PixelBox{of.x0 + i, of.y0, of.x0 + i + 1, of.y1};
}

void draw_color_bar(Image& image, const ColorBarPlan& plan) {
    // The bar comes over the edges of the marks: its own pixels are the function's.
    draw_arrow(image, plan, false);
    draw_arrow(image, plan, true);
    for (int i = 0; plan.content.medium && i < plan.length(); ++i)
        fill(image, plan.slice(plan.bar, i), {plan.content.color(plan.scalar(i + 0.5))}, plan.area);
    draw_surfaces(image, plan);
    // Around it, so that colours like the paper's have an end.
    const int line = plan.style.line;
    frame(image, {plan.bar.x0 - line, plan.bar.y0 - line, plan.bar.x1 + line, plan.bar.y1 + line}, line, plan.style.ink, plan.area);
    draw_opacity(image, plan);
    draw_ticks(image, plan);
    for (const PlacedText& text : plan.texts) draw_text(image, text, plan.style.ink, plan.area);
}

}  // namespace cellproj
