// SPDX-License-Identifier: BSD-3-Clause
#include "sort/view_order.hpp"

namespace cellproj {

namespace {

// In the order of the enumeration.
constexpr std::array<std::string_view, 5> method_names{"centroid", "power", "mpvo", "bsp", "sxmpvo"};

}  // namespace

std::string to_string(OrderMethod method) { return std::string(method_names[static_cast<std::size_t>(method)]); }

std::optional<OrderMethod> order_method(std::string_view name) {
    for (std::size_t i = 0; i < method_names.size(); ++i) {
        if (method_names[i] == name) return static_cast<OrderMethod>(i);
    }
    return std::nullopt;
}

}  // namespace cellproj
