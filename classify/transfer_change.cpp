// SPDX-License-Identifier: BSD-3-Clause
#include "classify/transfer_change.hpp"

#include <cstddef>
#include <vector>

namespace cellproj {

namespace {

bool same(const ColorNode& a, const ColorNode& b) {
    return a.scalar == b.scalar && a.color == b.color;
}
bool same(const ExtinctionNode& a, const ExtinctionNode& b) {
    return a.scalar == b.scalar && a.extinction == b.extinction;
}

// From the last of the leading nodes that both have to the first of the trailing ones.
template <class Node>
std::optional<ScalarInterval> changed_nodes(const std::vector<Node>& before, const std::vector<Node>& after) {
    const std::size_t shorter = std::min(before.size(), after.size());
    std::size_t leading = 0, trailing = 0;
    while (leading < shorter && same(before[leading], after[leading]))
        ++leading;
    if (leading == before.size() && leading == after.size()) return std::nullopt;
    while (leading + trailing < shorter &&
           same(before[before.size() - 1 - trailing], after[after.size() - 1 - trailing]))
        ++trailing;
    ScalarInterval interval;
    if (leading > 0) interval.low = before[leading - 1].scalar;
    if (trailing > 0) interval.high = before[before.size() - trailing].scalar;
    return interval;
}

}  // namespace

std::optional<ScalarInterval> changed_scalars(const TransferFunction& before, const TransferFunction& after) {
    if (before.model() != after.model() || before.outside() != after.outside()) return ScalarInterval{};
    const auto color = changed_nodes(before.color_nodes(), after.color_nodes());
    const auto extinction = changed_nodes(before.extinction_nodes(), after.extinction_nodes());
    if (!color) return extinction;
    if (!extinction) return color;
    return ScalarInterval{std::min(color->low, extinction->low), std::max(color->high, extinction->high)};
}

}  // namespace cellproj
