// SPDX-License-Identifier: BSD-3-Clause
#include "classify/transfer_function.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "classify/presets.hpp"
#include "mesh/error.hpp"

namespace cellproj {

namespace {

constexpr double largest_scalar = 1e150;
constexpr double largest_value = 1e60;

double value_of(const ExtinctionNode& node) {
    return node.extinction;
}
glm::dvec3 value_of(const ColorNode& node) {
    return node.color;
}

template <class Value>
Value interpolate(const Value& at_0, const Value& at_1, double t) {
    return at_0 * (1.0 - t) + at_1 * t;  // exact at both ends and never negative between non-negative values
}

// Index of the first node behind s.
template <class Node>
std::size_t first_behind(const std::vector<Node>& nodes, double s) {
    const auto behind = std::upper_bound(nodes.begin(), nodes.end(), s,
                                         [](double scalar, const Node& node) { return scalar < node.scalar; });
    return static_cast<std::size_t>(behind - nodes.begin());
}

template <class Node>
auto value_between(const Node& left, const Node& right, double s) {
    return interpolate(value_of(left), value_of(right), (s - left.scalar) / (right.scalar - left.scalar));
}

template <class Node>
auto value_at(const std::vector<Node>& nodes, double s, Outside outside) -> decltype(value_of(nodes[0])) {
    const bool is_outside = s < nodes.front().scalar || s > nodes.back().scalar;
    if (is_outside && outside == Outside::transparent) return {};
    const std::size_t i = first_behind(nodes, s);
    if (i == 0) return value_of(nodes.front());
    if (i == nodes.size()) return value_of(nodes.back());
    return value_between(nodes[i - 1], nodes[i], s);
}

// Limits from inside at both ends of begin..end, which has no node strictly inside.
template <class Node>
auto limits_between(const std::vector<Node>& nodes, double begin, double end, Outside outside) {
    using Value = decltype(value_of(nodes[0]));
    const std::size_t i = first_behind(nodes, begin);
    if (i > 0 && i < nodes.size())
        return std::pair(value_between(nodes[i - 1], nodes[i], begin), value_between(nodes[i - 1], nodes[i], end));
    const Value constant = outside == Outside::transparent ? Value{} : value_of(i == 0 ? nodes.front() : nodes.back());
    return std::pair(constant, constant);
}

// Largest component over [a, b]. A step at b counts with both sides, a step at a with its right side only.
template <class Node, class Component>
double max_over(const std::vector<Node>& nodes, double a, double b, Outside outside, Component component) {
    double largest = std::max(component(value_at(nodes, a, outside)), component(value_at(nodes, b, outside)));
    for (std::size_t i = first_behind(nodes, a); i < nodes.size() && nodes[i].scalar <= b; ++i)
        largest = std::max(largest, component(value_of(nodes[i])));
    return largest;
}

double identity(double value) {
    return value;
}
double largest_component(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

std::string text(double number) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return {digits.data(), end};
}

[[noreturn]] void fail(const std::string& place, std::string expected, std::string found, std::string advice) {
    throw Error({ErrorKind::data, place, std::move(expected), std::move(found), std::move(advice)});
}

void require_value(double value, double largest, const std::string& what, const std::string& place) {
    if (value >= 0.0 && value <= largest) return;  // false for NaN
    fail(place, what + " in 0 .. " + text(largest), text(value), "correct this node");
}

// The lists by their names in the JSON, so that "color[3]" leads to the same node in a file and in a program.
std::string list_of(const std::vector<ColorNode>&, const std::string& place) {
    return place + ": color";
}
std::string list_of(const std::vector<ExtinctionNode>&, const std::string& place) {
    return place + ": extinction";
}
std::string list_of(const std::vector<OpacityNode>&, const std::string& place) {
    return place + ": opacity";
}
template <class Node>
std::string node_of(const std::vector<Node>& nodes, std::size_t i, const std::string& place) {
    return list_of(nodes, place) + "[" + std::to_string(i) + "]";
}

template <class Node>
void require_ascending(const std::vector<Node>& nodes, const std::string& place) {
    if (nodes.empty()) fail(list_of(nodes, place), "at least one node", "none", "give at least one node");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::string here = node_of(nodes, i, place);
        const double s = nodes[i].scalar;
        if (!(std::abs(s) <= largest_scalar))
            fail(here, "a finite scalar of magnitude up to 1e150", text(s), "correct this node");
        if (i >= 1 && s < nodes[i - 1].scalar)
            fail(here, "scalars in ascending order", text(s) + " after " + text(nodes[i - 1].scalar), "sort the nodes");
        if (i >= 2 && s == nodes[i - 2].scalar)
            fail(here, "at most two nodes (a step) at one scalar", "a third node at " + text(s), "remove one of them");
    }
}

void require_valid(const std::vector<ColorNode>& nodes, const std::string& place) {
    require_ascending(nodes, place);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            require_value(nodes[i].color[channel], largest_value, "color components", node_of(nodes, i, place));
}

void require_valid(const std::vector<ExtinctionNode>& nodes, const std::string& place) {
    require_ascending(nodes, place);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        require_value(nodes[i].extinction, largest_value, "an extinction", node_of(nodes, i, place));
}

void require_valid(const std::vector<OpacityNode>& nodes, const std::string& place) {
    require_ascending(nodes, place);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        require_value(nodes[i].opacity, 1.0, "an opacity", node_of(nodes, i, place));
}

template <class Node>
void require_positive(const std::vector<Node>& nodes, const std::string& place) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (!(nodes[i].scalar > 0.0))
            fail(node_of(nodes, i, place), "a scalar > 0 on a logarithmic axis",
                 text(nodes[i].scalar), "give scalars > 0, or take the linear axis");
}

// Lines of equal length h in ln s. Over one of them ln s is above its chord by at most h/8 of the line's change, which is
// 1/lines of the change from node to node: (ln high/low)/lines²/8 in all.
int lines_between(double low, double high) {
    constexpr double largest_error = 1e-3;
    const double logarithm = std::log(high) - std::log(low);  // the ratio itself may overflow
    return std::max(1, static_cast<int>(std::ceil(std::sqrt(logarithm / (8.0 * largest_error)))));
}

template <class Node>
std::vector<Node> along_logarithm(const std::vector<Node>& nodes, const std::string& place) {
    require_positive(nodes, place);
    std::vector<Node> lines;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const int count = i == 0 ? 1 : lines_between(nodes[i - 1].scalar, nodes[i].scalar);
        for (int k = 1; k < count; ++k) {
            const double share = static_cast<double>(k) / count;
            const double s = scalar_between(nodes[i - 1].scalar, nodes[i].scalar, share, ScalarAxis::log);
            if (s > lines.back().scalar && s < nodes[i].scalar)
                lines.push_back({s, interpolate(value_of(nodes[i - 1]), value_of(nodes[i]), share)});
        }
        lines.push_back(nodes[i]);
    }
    return lines;
}

std::vector<double> scalars_of(const std::vector<ColorNode>& color, const std::vector<ExtinctionNode>& extinction) {
    std::vector<double> scalars;
    scalars.reserve(color.size() + extinction.size());
    for (const ColorNode& node : color)
        scalars.push_back(node.scalar);
    for (const ExtinctionNode& node : extinction)
        scalars.push_back(node.scalar);
    std::sort(scalars.begin(), scalars.end());
    scalars.erase(std::unique(scalars.begin(), scalars.end()), scalars.end());
    return scalars;
}

// ∫ τ over a..b inside one piece: the trapezoid is exact.
double integral_in(const LinearPiece& piece, double a, double b) {
    return (b - a) * 0.5 * (piece.extinction(a) + piece.extinction(b));
}

}  // namespace

double LinearPiece::fraction(double s) const {
    const double width = end - begin;
    return std::isfinite(width) ? std::clamp((s - begin) / width, 0.0, 1.0) : 0.0;
}

glm::dvec3 LinearPiece::color(double s) const {
    return interpolate(color_begin, color_end, fraction(s));
}
double LinearPiece::extinction(double s) const {
    return interpolate(extinction_begin, extinction_end, fraction(s));
}

TransferFunction::TransferFunction(OpticalModel model, std::vector<ColorNode> color,
                                   std::vector<ExtinctionNode> extinction, Outside outside, const std::string& place)
    : model_(model), color_(std::move(color)), extinction_(std::move(extinction)), outside_(outside) {
    require_valid(color_, place);
    require_valid(extinction_, place);
    breakpoints_ = scalars_of(color_, extinction_);

    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i <= breakpoints_.size(); ++i) {
        const double begin = i == 0 ? -infinity : breakpoints_[i - 1];
        const double end = i == breakpoints_.size() ? infinity : breakpoints_[i];
        const auto [color_begin, color_end] = limits_between(color_, begin, end, outside_);
        const auto [extinction_begin, extinction_end] = limits_between(extinction_, begin, end, outside_);
        pieces_.push_back({begin, end, color_begin, color_end, extinction_begin, extinction_end});
    }

    cumulative_extinction_.push_back({0.0, 0.0});
    for (std::size_t i = 1; i < breakpoints_.size(); ++i) {
        const RunningIntegral before = cumulative_extinction_.back();
        const double piece = integral_in(pieces_[i], breakpoints_[i - 1], breakpoints_[i]);
        // Knuth's two-sum: sum + lost is exactly before.sum + piece.
        const double sum = before.sum + piece;
        const double added = sum - before.sum;
        const double lost = (before.sum - (sum - added)) + (piece - added);
        cumulative_extinction_.push_back({sum, before.rest + lost});
    }
}

glm::dvec3 TransferFunction::color(double s) const {
    return value_at(color_, s, outside_);
}
double TransferFunction::extinction(double s) const {
    return value_at(extinction_, s, outside_);
}

glm::dvec3 TransferFunction::emission(double s) const {
    return model_ == OpticalModel::density ? color(s) * extinction(s) : color(s);
}

// Rest of the first piece, difference of running integrals, start of the last piece; the trapezoid when one piece holds
// both ends.
double TransferFunction::extinction_integral(double a, double b) const {
    assert(a <= b);
    if (a == b) return 0.0;
    const auto first = std::upper_bound(breakpoints_.begin(), breakpoints_.end(), a) - breakpoints_.begin();
    const auto last = std::lower_bound(breakpoints_.begin(), breakpoints_.end(), b) - breakpoints_.begin();
    const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(last);
    if (i == j) return integral_in(pieces_[i], a, b);
    const RunningIntegral &from = cumulative_extinction_[i], &to = cumulative_extinction_[j - 1];
    const double between = std::max(0.0, (to.sum - from.sum) + (to.rest - from.rest));
    return integral_in(pieces_[i], a, breakpoints_[i]) + between + integral_in(pieces_[j], breakpoints_[j - 1], b);
}

double TransferFunction::max_extinction(double a, double b) const {
    assert(a <= b);
    return max_over(extinction_, a, b, outside_, identity);
}

bool TransferFunction::visible(double a, double b) const {
    if (max_extinction(a, b) > 0.0) return true;
    return model_ == OpticalModel::emitter && max_over(color_, a, b, outside_, largest_component) > 0.0;
}

double scalar_between(double low, double high, double share, ScalarAxis axis) {
    const double s = axis == ScalarAxis::linear ? std::lerp(low, high, share)
                                                : std::exp(std::lerp(std::log(low), std::log(high), share));
    return share <= 0.0 ? low : share >= 1.0 ? high : std::clamp(s, low, high);
}

std::vector<ColorNode> on_axis(std::vector<ColorNode> nodes, ScalarAxis axis, const std::string& place) {
    require_valid(nodes, place);
    return axis == ScalarAxis::linear ? nodes : along_logarithm(nodes, place);
}
std::vector<ExtinctionNode> on_axis(std::vector<ExtinctionNode> nodes, ScalarAxis axis, const std::string& place) {
    require_valid(nodes, place);
    return axis == ScalarAxis::linear ? nodes : along_logarithm(nodes, place);
}

std::vector<ExtinctionNode> extinction_from_opacity(const std::vector<OpacityNode>& opacity, double unit_distance,
                                                    OpacityConvention convention, const std::string& place,
                                                    ScalarAxis axis) {
    require_valid(opacity, place);
    if (axis == ScalarAxis::log) require_positive(opacity, place);
    if (!(unit_distance > 0.0 && std::isfinite(unit_distance)))
        throw Error({ErrorKind::option, place + ": unit_distance", "a length > 0 [mesh units]", text(unit_distance),
                     "give the distance that the opacities hold for"});

    std::vector<ExtinctionNode> nodes;
    if (convention == OpacityConvention::linear) {
        for (const OpacityNode& node : opacity)
            nodes.push_back({node.scalar, node.opacity / unit_distance});
        return on_axis(std::move(nodes), axis, place);
    }

    // WVG91 Eq. 2. Between two nodes 1 − α is linear in s, and the chord of −ln x over a ratio e^h of x errs by at most
    // h²/8. So nodes at equal steps h of optical depth are enough, whatever the scalars.
    constexpr double longest_step = 0.0894;  // h²/8 < 1e-3
    constexpr double opaque = 1.0 - 0x1p-24;
    const auto alpha = [&](std::size_t i) { return std::min(opacity[i].opacity, opaque); };
    const auto depth = [&](std::size_t i) { return -std::log1p(-alpha(i)); };
    for (std::size_t i = 0; i < opacity.size(); ++i) {
        const double s = opacity[i].scalar;
        const int steps = i == 0 ? 0 : static_cast<int>(std::ceil(std::abs(depth(i) - depth(i - 1)) / longest_step));
        for (int step = 1; step < steps; ++step) {
            const double d = interpolate(depth(i - 1), depth(i), static_cast<double>(step) / steps);
            const double t = (-std::expm1(-d) - alpha(i - 1)) / (alpha(i) - alpha(i - 1));
            const double inserted = scalar_between(opacity[i - 1].scalar, s, t, axis);
            if (inserted > nodes.back().scalar && inserted < s) nodes.push_back({inserted, d / unit_distance});
        }
        nodes.push_back({s, depth(i) / unit_distance});
    }
    return on_axis(std::move(nodes), axis, place);
}

TransferFunction color_alone(const TransferFunction& function) {
    return {OpticalModel::emitter, function.color_nodes(), {{0.0, 0.0}}, function.outside()};
}

TransferFunction extinction_alone(const TransferFunction& function) {
    return {OpticalModel::density, {{0.0, glm::dvec3(0.0)}}, function.extinction_nodes(), function.outside()};
}

TransferFunction with_scaled_extinction(const TransferFunction& function, double factor) {
    assert(factor >= 0.0);
    std::vector<ExtinctionNode> extinction = function.extinction_nodes();
    for (ExtinctionNode& node : extinction) node.extinction *= factor;
    return {function.model(), function.color_nodes(), std::move(extinction), function.outside()};
}

TransferFunction default_transfer_function(double low, double high, double size, std::string_view colors, ScalarAxis axis) {
    assert(low <= high && size >= 0.0);
    const double densest = 8.0 / (size > 0.0 ? size : 1.0);
    std::vector<ExtinctionNode> extinction{{low, 0.0}, {high, densest}};
    if (low == high) extinction.erase(extinction.begin());
    return {OpticalModel::density, preset_colors(colors, low, high, axis), on_axis(std::move(extinction), axis)};
}

}  // namespace cellproj
