// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "classify/segment_method.hpp"

namespace cellproj {

namespace {

constexpr double largest_value = 1e60;  // what TransferFunction takes

double scaled(double value, double factor) {
    return std::min(value * factor, largest_value);
}

// What is transparent beyond its last node still is as before at that node itself, in float32 as well: scalars and nodes are
// rounded there, by up to 2⁻²⁴.
constexpr double behind_last = 0x1p-23;

// The limit at s from the left: the first node there where two make a step.
template <class Node, class Value, class ValueOf>
Value limit_from_left(const std::vector<Node>& nodes, double s, Outside outside, Value at_s, ValueOf value_of) {
    const auto node = std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.scalar == s; });
    if (node == nodes.end()) return at_s;
    if (node == nodes.begin() && outside == Outside::transparent) return Value{};
    return value_of(*node);
}

// The nodes over a range as 0..1, from their values at its ends. `make` makes a node of a scalar and a value, `value_of` takes it
// out of a node.
template <class Node, class Value, class ValueOf, class Make>
std::vector<Node> restricted(const std::vector<Node>& nodes, ScalarSpan range, Outside outside, Value at_low, Value at_high,
                             ValueOf value_of, Make make) {
    const auto [low, high] = range;
    if (low == high) return {make(0.0, at_low)};
    std::vector<Node> result{make(0.0, at_low)};
    const auto add = [&](double scalar, const Value& value) {
        // Of three at one place the middle one is gone.
        const std::size_t n = result.size();
        if (n >= 2 && result[n - 2].scalar == scalar) result.pop_back();
        result.push_back(make(scalar, value));
    };
    const double first = nodes.front().scalar, last = nodes.back().scalar, width = high - low;
    const bool transparent = outside == Outside::transparent;
    if (transparent && first > low && first < high) add((first - low) / width, Value{});
    for (const Node& node : nodes) {
        if (node.scalar > low && node.scalar < high) add((node.scalar - low) / width, value_of(node));
    }
    const double end = (last - low) / width + behind_last;
    if (transparent && last >= low && end < 1.0) {
        add(end, value_of(nodes.back()));
        add(end, Value{});
    }
    const Value before_high = limit_from_left(nodes, high, outside, at_high, value_of);
    add(1.0, before_high);
    if (before_high != at_high) add(1.0, at_high);
    return result;
}

}  // namespace

TransferFunction in_scene_units(const TransferFunction& transfer, double scalar_low, double scalar_high,
                                double length) {
    const ScalarSpan range{scalar_low, scalar_high};
    return in_scene_units(transfer, range, range, length);
}

TransferFunction in_scene_units(const TransferFunction& transfer, ScalarSpan color, ScalarSpan extinction, double length) {
    for ([[maybe_unused]] const ScalarSpan& span : {color, extinction})
        assert(span.low <= span.high && std::isfinite(span.low) && std::isfinite(span.high));
    assert(length > 0.0);
    const double color_factor = transfer.model() == OpticalModel::emitter ? length : 1.0;
    const auto color_of = [](const ColorNode& node) { return node.color; };
    const auto make_color = [&](double s, const glm::dvec3& c) {
        return ColorNode{s, {scaled(c.x, color_factor), scaled(c.y, color_factor), scaled(c.z, color_factor)}};
    };
    const auto extinction_of = [](const ExtinctionNode& node) { return node.extinction; };
    const auto make_extinction = [&](double s, double tau) { return ExtinctionNode{s, scaled(tau, length)}; };
    const auto colors = restricted(transfer.color_nodes(), color, transfer.outside(), transfer.color(color.low),
                                   transfer.color(color.high), color_of, make_color);
    const auto extinctions =
        restricted(transfer.extinction_nodes(), extinction, transfer.outside(), transfer.extinction(extinction.low),
                   transfer.extinction(extinction.high), extinction_of, make_extinction);
    return {transfer.model(), colors, extinctions};
}

}  // namespace cellproj
