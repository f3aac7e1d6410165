// SPDX-License-Identifier: BSD-3-Clause
//
// Grids refined inside each other whose field is a function.
#pragma once

#include <array>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mesh/grid_hierarchy.hpp"
#include "tests/support/grids.hpp"

namespace cellproj::testing_support {

// `n` cells of size h along each axis from `origin` on.
inline Grid block(const glm::dvec3& origin, double h, const std::array<std::size_t, 3>& n, const std::function<double(const glm::dvec3&)>& f) {
    return grid_of({uniform_axis(origin.x, h, n[0] + 1), uniform_axis(origin.y, h, n[1] + 1), uniform_axis(origin.z, h, n[2] + 1)}, f);
}

inline GridHierarchy hierarchy_of(std::vector<Grid> pieces) {
    std::vector<std::string> names;
    for (std::size_t p = 0; p < pieces.size(); ++p) names.push_back(std::to_string(p));
    return make_grid_hierarchy(std::move(pieces), std::move(names), "test");
}

// The unit cube in n³ cells (n even), its corner at the origin, half along each axis, refined 2:1.
inline GridHierarchy corner_refined(std::size_t n, const std::function<double(const glm::dvec3&)>& f) {
    const double h = 1.0 / static_cast<double>(n);
    return hierarchy_of({block({0, 0, 0}, h, {n, n, n}, f), block({0, 0, 0}, h / 2, {n, n, n}, f)});
}

// A coarse block with two refined ones beside each other, by 2 or 3, and one that is refined again across their border or inside the coarse
// block alone.
inline GridHierarchy random_blocks(std::mt19937_64& random, const std::function<double(const glm::dvec3&)>& f) {
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    const std::array<std::size_t, 3> n{4 + below(3), 4 + below(3), 4 + below(3)};
    const std::size_t ratio = 2 + below(2), again = 2;
    const double fine = 1.0 / static_cast<double>(ratio);
    const glm::dvec3 corner(below(2), below(2), below(2));  // of the first refined block, 1 by 2 by 2 coarse cells; the second is behind it in x
    const std::array<std::size_t, 3> cells{ratio, 2 * ratio, 2 * ratio};
    std::vector<Grid> pieces{block({0, 0, 0}, 1, n, f), block(corner, fine, cells, f), block(corner + glm::dvec3(1, 0, 0), fine, cells, f)};
    const glm::dvec3 inner = below(2) == 0 ? corner + glm::dvec3(1 - fine, fine, fine) : glm::dvec3(n[0], n[1], n[2]) - glm::dvec3(1);
    const std::size_t across = inner.x > corner.x + 1 ? ratio * again : 2 * again;
    pieces.push_back(block(inner, fine / static_cast<double>(again), {across, across, across}, f));
    return hierarchy_of(std::move(pieces));
}

}  // namespace cellproj::testing_support
