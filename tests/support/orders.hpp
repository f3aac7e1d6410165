// SPDX-License-Identifier: BSD-3-Clause
//
// Eyes around the unit cube, and what every order of cells is: each of them once.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include <glm/geometric.hpp>

#include "sort/view_order.hpp"

namespace cellproj::testing_support {

inline glm::dvec3 random_direction(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

// Even ones at infinity, odd ones at a distance of .3 to 10 from the middle of the unit cube, many inside.
inline Eye random_eye(std::mt19937_64& random, int i) {
    const glm::dvec3 direction = random_direction(random);
    const double distance = 0.3 * std::pow(33.0, std::uniform_real_distribution<double>()(random));
    return i % 2 ? Eye::at(glm::dvec3(0.5) + distance * direction) : Eye::towards(direction);
}

inline void expect_each_once(std::span<const std::uint32_t> items, std::size_t cells) {
    ASSERT_EQ(items.size(), cells);
    std::vector<bool> seen(cells, false);
    for (const std::uint32_t item : items) {
        ASSERT_LT(item, cells);
        ASSERT_FALSE(seen[item]) << "cell " << item << " twice";
        seen[item] = true;
    }
}

}  // namespace cellproj::testing_support
