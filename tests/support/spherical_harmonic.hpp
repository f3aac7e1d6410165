// SPDX-License-Identifier: BSD-3-Clause
//
// The volume by which EKE01 compares classifications (Fig. 9 and 10): a spherical harmonic on few points, and a transfer function that
// changes at random many times over its range.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "render/grid_scene.hpp"
#include "tests/support/grids.hpp"

namespace cellproj::testing_support {

// Degree 3, order 2: xyz/r³, times a function of the radius that is smooth at 0. On −1 .. 1.
inline Grid spherical_harmonic(std::size_t points) {
    const GridAxis axis = uniform_axis(-1, 2.0 / static_cast<double>(points - 1), points);
    return grid_of({axis, axis, axis}, [](const glm::dvec3& p) { return p.x * p.y * p.z * std::exp(-2 * glm::dot(p, p)); });
}

// Optical depths up to `depth` per unit of length; `nodes` of them over the range of the grid.
inline GridScene with_random_transfer(Grid grid, int nodes, double depth, unsigned seed) {
    const GridUnits units = units_of(grid);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<ColorNode> colors;
    std::vector<ExtinctionNode> extinctions;
    for (int i = 0; i < nodes; ++i) {
        const double s = units.scalar_low + (units.scalar_high - units.scalar_low) * i / (nodes - 1);
        const double red = unit(random), green = unit(random), blue = unit(random);
        colors.push_back({s, {red, green, blue}});
        extinctions.push_back({s, depth * unit(random)});
    }
    return {std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(OpticalModel::density, colors, extinctions)};
}

}  // namespace cellproj::testing_support
