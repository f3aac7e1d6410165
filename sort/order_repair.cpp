// SPDX-License-Identifier: BSD-3-Clause
#include "sort/order_repair.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace cellproj {

namespace {

struct Window {
    std::uint32_t first, last;
};

std::vector<Window> windows_of(std::span<const OrderArc> wrong, std::span<const std::uint32_t> position) {
    std::vector<Window> windows;
    windows.reserve(wrong.size());
    for (const OrderArc& arc : wrong) windows.push_back({position[arc.front], position[arc.behind]});
    std::sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.first < b.first; });
    std::vector<Window> merged;
    for (const Window& window : windows) {
        if (!merged.empty() && window.first <= merged.back().last) {
            merged.back().last = std::max(merged.back().last, window.last);
        } else {
            merged.push_back(window);
        }
    }
    return merged;
}

// Kahn's algorithm on the cells of a window, the one that stood first among the free ones first.
bool sort_window(const CellGraph& graph, const Eye& eye, Window window, std::span<CellId> order, std::span<std::uint32_t> position) {
    const std::uint32_t count = window.last - window.first + 1;
    std::vector<std::array<std::uint32_t, 4>> fronts(count);  // per cell, by number within the window; `count` for none
    std::vector<std::uint8_t> hidden(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        fronts[i].fill(count);
        const CellId place = order[window.first + i];
        for (int face = 0; face < 4; ++face) {
            const CellId other = graph.neighbours(place)[static_cast<std::size_t>(face)];
            if (other == graph.nobody() || position[other] < window.first || position[other] > window.last) continue;
            const int beyond = graph.beyond(eye, place, face);
            if (beyond > 0) fronts[i][static_cast<std::size_t>(face)] = position[other] - window.first;
            if (beyond < 0) ++hidden[i];
        }
    }
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> free;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (hidden[i] == 0) free.push(i);
    }
    std::vector<CellId> sorted;
    sorted.reserve(count);
    while (!free.empty()) {
        const std::uint32_t i = free.top();
        free.pop();
        sorted.push_back(order[window.first + i]);
        for (const std::uint32_t front : fronts[i]) {
            if (front < count && --hidden[front] == 0) free.push(front);
        }
    }
    if (sorted.size() < count) return false;
    std::copy(sorted.begin(), sorted.end(), order.begin() + window.first);
    for (std::uint32_t i = 0; i < count; ++i) position[sorted[i]] = window.first + i;
    return true;
}

}  // namespace

bool repair_order(const CellGraph& graph, const Eye& eye, std::span<const OrderArc> wrong, std::span<CellId> order,
                  std::span<std::uint32_t> position) {
    const auto windows = windows_of(wrong, position);
    std::size_t cells = 0;
    for (const Window& window : windows) cells += window.last - window.first + 1;
    if (cells > order.size() / 8 + 64) return false;
    for (const Window& window : windows) {
        if (!sort_window(graph, eye, window, order, position)) return false;
    }
    return true;
}

}  // namespace cellproj
