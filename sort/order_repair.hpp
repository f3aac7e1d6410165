// SPDX-License-Identifier: BSD-3-Clause
//
// An order that is right nearly everywhere, made right.
#pragma once

#include <cstdint>
#include <span>

#include "sort/cell_graph.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// `order`: places from back to front; position[place] is where it stands, larger than all where it does not. `wrong`: all relations
// between face neighbours that it violates. Each of them spans a window of the order, and windows that overlap are one; the cells of a
// window are sorted anew among themselves, by exact signs, the first ones first that are free. All other relations stay as they are. False, with
// the order unchanged where it failed, when a window holds a cycle or all of them more than an eighth of the order.
bool repair_order(const CellGraph& graph, const Eye& eye, std::span<const OrderArc> wrong, std::span<CellId> order,
                  std::span<std::uint32_t> position);

}  // namespace cellproj
