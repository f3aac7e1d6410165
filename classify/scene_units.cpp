// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>
#include <vector>

#include "classify/segment_method.hpp"

namespace cellproj {

namespace {

constexpr double largest_value = 1e60;  // what TransferFunction takes

double scaled(double value, double factor) {
    return std::min(value * factor, largest_value);
}

// The nodes over low..high as 0..1, given their value at both ends and the limit from the left at `high`. `make` makes
// a node of a scalar and a value, `value_of` takes it out of a node.
template <class Node, class Value, class ValueOf, class Make>
std::vector<Node> restricted(const std::vector<Node>& nodes, double low, double high, Value at_low, Value before_high,
                             Value at_high, ValueOf value_of, Make make) {
    if (low == high) return {make(0.0, at_low)};
    std::vector<Node> result{make(0.0, at_low)};
    const auto add = [&](const Node& node) {
        // Of three at one place the middle one is gone.
        const std::size_t n = result.size();
        if (n >= 2 && result[n - 2].scalar == node.scalar) result.pop_back();
        result.push_back(node);
    };
    for (const Node& node : nodes) {
        if (node.scalar > low && node.scalar < high) add(make((node.scalar - low) / (high - low), value_of(node)));
    }
    add(make(1.0, before_high));
    if (before_high != at_high) add(make(1.0, at_high));
    return result;
}

// The limit at s from the left: the first node there where two make a step.
template <class Node, class Value, class ValueOf>
Value limit_from_left(const std::vector<Node>& nodes, double s, Outside outside, Value at_s, ValueOf value_of) {
    const auto node = std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.scalar == s; });
    if (node == nodes.end()) return at_s;
    if (node == nodes.begin() && outside == Outside::transparent) return Value{};
    return value_of(*node);
}

}  // namespace

TransferFunction in_scene_units(const TransferFunction& transfer, double scalar_low, double scalar_high,
                                double length) {
    assert(scalar_low <= scalar_high && std::isfinite(scalar_low) && std::isfinite(scalar_high) && length > 0.0);
    const double color_factor = transfer.model() == OpticalModel::emitter ? length : 1.0;
    const auto color_of = [](const ColorNode& node) { return node.color; };
    const auto make_color = [&](double s, const glm::dvec3& c) {
        return ColorNode{s, {scaled(c.x, color_factor), scaled(c.y, color_factor), scaled(c.z, color_factor)}};
    };
    const auto extinction_of = [](const ExtinctionNode& node) { return node.extinction; };
    const auto make_extinction = [&](double s, double tau) { return ExtinctionNode{s, scaled(tau, length)}; };

    const auto& [colors, extinctions] = std::tie(transfer.color_nodes(), transfer.extinction_nodes());
    const glm::dvec3 color_high = transfer.color(scalar_high);
    const double extinction_high = transfer.extinction(scalar_high);
    return TransferFunction(
        transfer.model(),
        restricted(colors, scalar_low, scalar_high, transfer.color(scalar_low),
                   limit_from_left(colors, scalar_high, transfer.outside(), color_high, color_of), color_high, color_of,
                   make_color),
        restricted(extinctions, scalar_low, scalar_high, transfer.extinction(scalar_low),
                   limit_from_left(extinctions, scalar_high, transfer.outside(), extinction_high, extinction_of),
                   extinction_high, extinction_of, make_extinction));
}

}  // namespace cellproj
