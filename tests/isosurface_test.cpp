// SPDX-License-Identifier: BSD-3-Clause
//
// Which isosurfaces a segment crosses: the rule of sides, chains of segments, the list's order, its errors, and the table.
#include "classify/isosurface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "classify/segment_integral.hpp"
#include "mesh/error.hpp"

namespace cellproj {
namespace isosurface_test {

IsoSurfaces surfaces_at(const std::vector<double>& values, double opacity = 0.5) {
    std::vector<IsoSurface> surfaces;
    for (const double v : values)
        surfaces.push_back({v, {0.25, 0.5, 1}, opacity, {}});
    return IsoSurfaces(surfaces);
}

// How often a chain of segments through these scalars crosses each surface, counted upwards and downwards.
struct Count {
    int up = 0, down = 0;
    bool operator==(const Count&) const = default;
};

std::vector<Count> crossings_of_chain(const IsoSurfaces& surfaces, const std::vector<double>& scalars) {
    std::vector<Count> counts(surfaces.surfaces().size());
    for (std::size_t i = 0; i + 1 < scalars.size(); ++i) {
        const IsoCrossings crossings = surfaces.crossings(scalars[i], scalars[i + 1]);
        for (std::size_t k = 0; k < crossings.size(); ++k)
            ++(crossings[k].rising ? counts[crossings[k].surface].up : counts[crossings[k].surface].down);
    }
    return counts;
}

TEST(IsoSurface, IsCrossedInTheOrderOfTheRay) {
    const IsoSurfaces surfaces = surfaces_at({0.75, 0.25, 0.5, 2.0});
    const IsoCrossings up = surfaces.crossings(0, 1), down = surfaces.crossings(1, 0);
    ASSERT_EQ(up.size(), 3U);
    ASSERT_EQ(down.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(up[i].surface, i);
        EXPECT_EQ(up[i].t, 0.25 * static_cast<double>(i + 1));
        EXPECT_TRUE(up[i].rising);
        EXPECT_EQ(down[i].surface, 2 - i);
        EXPECT_EQ(down[i].t, 0.25 * static_cast<double>(i + 1));
        EXPECT_FALSE(down[i].rising);
    }
    EXPECT_TRUE(surfaces.crossings(0.3, 0.4).empty());
    EXPECT_TRUE(surfaces.crossings(-1, 0.2).empty());
    EXPECT_TRUE(surfaces.crossings(3, 5).empty());
}

TEST(IsoSurface, AtAScalarBetweenTwoSegmentsIsHitOnceWhereTheRayPasses) {
    const IsoSurfaces surfaces = surfaces_at({0.5});
    const std::vector<std::pair<std::vector<double>, Count>> chains{
        {{0, 0.5, 1}, {1, 0}},
        {{1, 0.5, 0}, {0, 1}},
        {{0, 0.5, 0}, {1, 1}},  // touches from below: through and back
        {{1, 0.5, 1}, {0, 0}},  // touches from above: never below
        {{0, 0.5, 0.5, 0.5, 1}, {1, 0}},  // whole cells at the isovalue
        {{1, 0.5, 0.5, 0}, {0, 1}},
        {{0.5, 0.5}, {0, 0}},
        {{0.5, 1}, {0, 0}},
        {{0.5, 0}, {0, 1}},
        {{1, 0.5}, {0, 0}},
    };
    for (const auto& [scalars, count] : chains)
        EXPECT_EQ(crossings_of_chain(surfaces, scalars).front(), count) << testing::PrintToString(scalars);
    // Both crossings of a touch are at the place of the touch.
    EXPECT_EQ(surfaces.crossings(0, 0.5)[0].t, 1);
    EXPECT_EQ(surfaces.crossings(0.5, 0)[0].t, 0);
}

// Scalars and isovalues of few values meet all the time: upwards and downwards alternate, and their difference is the change of sides.
TEST(IsoSurface, ChainsChangeSidesAndNothingElse) {
    std::mt19937_64 random(7);
    std::uniform_int_distribution<int> any(0, 9);
    for (int trial = 0; trial < 5000; ++trial) {
        std::vector<double> values, scalars(12);
        for (int v = 0; v < 10; ++v) {
            if (any(random) < 5) values.push_back(v / 9.0);
        }
        for (double& s : scalars)
            s = any(random) / 9.0;
        const IsoSurfaces surfaces = surfaces_at(values);
        const std::vector<Count> counts = crossings_of_chain(surfaces, scalars);
        for (std::size_t k = 0; k < values.size(); ++k) {
            const int change = static_cast<int>(scalars.front() < values[k]) - static_cast<int>(scalars.back() < values[k]);
            ASSERT_EQ(counts[k].up - counts[k].down, change);
        }
    }
}

// The binary search against the definition, and places that rise from front to back.
TEST(IsoSurface, AgreesWithItsDefinition) {
    std::mt19937_64 random(21);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<double> values(1 + random() % 40);
        for (double& v : values)
            v = any(random);
        std::sort(values.begin(), values.end());
        const double scale = std::pow(10.0, 150 * any(random));
        for (double& v : values)
            v *= scale;
        const IsoSurfaces surfaces = surfaces_at(values);
        const double s_f = scale * any(random), s_b = scale * any(random);
        std::vector<std::size_t> expected;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if ((s_f < values[i]) != (s_b < values[i])) expected.push_back(i);
        }
        if (s_b < s_f) std::reverse(expected.begin(), expected.end());
        const IsoCrossings crossings = surfaces.crossings(s_f, s_b);
        ASSERT_EQ(crossings.size(), expected.size());
        double before = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(crossings[i].surface, expected[i]);
            EXPECT_EQ(crossings[i].rising, s_f < s_b);
            const double t = crossings[i].t;
            EXPECT_TRUE(t >= before && t <= 1);
            EXPECT_NEAR((s_f + t * (s_b - s_f)) / scale, values[expected[i]] / scale, 1e-15);
            before = t;
        }
    }
}

TEST(IsoSurface, AtTheEndsOfFloat64) {
    const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
    const IsoSurfaces surfaces = surfaces_at({-huge, 0, tiny, 0.5 * huge});
    const IsoCrossings all = surfaces.crossings(-huge, huge);
    ASSERT_EQ(all.size(), 3U);  // −huge itself is not below −huge
    EXPECT_EQ(all[0].t, 0.5);
    EXPECT_EQ(all[1].t, 0.5);
    EXPECT_EQ(all[2].t, 0.75);
    ASSERT_EQ(surfaces.crossings(0, tiny).size(), 1U);
    const double t = surfaces.crossings(0, tiny)[0].t;
    EXPECT_TRUE(t >= 0 && t <= 1);
    const double next = std::nextafter(0.5, 1.0);
    EXPECT_EQ(surfaces_at({next}).crossings(0.5, next)[0].t, 1);
    EXPECT_TRUE(surfaces_at({next}).crossings(next, 1).empty());
}

TEST(IsoSurface, HasTwoSides) {
    const IsoSurface plain{0, {1, 0, 0}, 1, {}}, two{0, {1, 0, 0}, 1, glm::dvec3(0, 0, 1)};
    EXPECT_EQ(seen_color(plain, true), glm::dvec3(1, 0, 0));
    EXPECT_EQ(seen_color(plain, false), glm::dvec3(1, 0, 0));
    EXPECT_EQ(seen_color(two, true), glm::dvec3(1, 0, 0));
    EXPECT_EQ(seen_color(two, false), glm::dvec3(0, 0, 1));
    EXPECT_EQ(layer({1, 0.5, 0}, 0.5).color, glm::dvec3(0.5, 0.25, 0));
    EXPECT_TRUE(IsoSurfaces({plain, {1}}).opaque());
    EXPECT_FALSE(surfaces_at({0, 1}).opaque());
    EXPECT_TRUE(IsoSurfaces({}).opaque());
    EXPECT_TRUE(IsoSurfaces({}).crossings(0, 1).empty());
}

TEST(IsoSurface, RefusesWhatCannotBe) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const std::vector<std::vector<IsoSurface>> bad{
        {{0}, {nan}}, {{0}, {infinity}}, {{0}, {1, {1, 1, 1}, 1.5}}, {{0}, {1, {1, 1, 1}, nan}}, {{0}, {1, {-1, 1, 1}}},
        {{0}, {1, {1, 1, 1}, 1, glm::dvec3(nan)}}};
    for (const auto& surfaces : bad) {
        try {
            IsoSurfaces made(surfaces, "--iso");
            ADD_FAILURE();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::option);
            EXPECT_EQ(error.place(), "--iso, surface 1");
        }
    }
    EXPECT_THROW(surfaces_at({0.5, 0.1, 0.5}), Error);
    EXPECT_THROW(surfaces_at({0.0, -0.0}), Error);
}

// A texel is the composite of the crossings between the two scalars of the grid that it stands for.
TEST(IsoSurfaceTable, IsTheListAtRoundedScalars) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(0, 1);
    std::vector<IsoSurface> list;
    for (int i = 0; i < 25; ++i)
        list.push_back({2 + 3 * any(random), {any(random), any(random), any(random)}, any(random), glm::dvec3(any(random))});
    list.push_back({3.5, {1, 0, 0}, 1, {}});
    const IsoSurfaces surfaces(list);
    const IsoSurfaceTable table(surfaces, 2, 5, 97);
    for (int trial = 0; trial < 20000; ++trial) {
        const double s_f = 2 + 3 * any(random), s_b = 2 + 3 * any(random);
        const double rounded_f = table.scalar(table.position(s_f)), rounded_b = table.scalar(table.position(s_b));
        EXPECT_LE(std::abs(rounded_f - s_f), table.step() / 2 * (1 + 1e-12));
        const IsoCrossings crossings = surfaces.crossings(rounded_f, rounded_b);
        Light light;
        for (std::size_t i = 0; i < crossings.size(); ++i) {
            const IsoSurface& surface = surfaces.surfaces()[crossings[i].surface];
            light = composite(light, layer(seen_color(surface, crossings[i].rising), surface.opacity));
        }
        const auto& texel = table.lookup(s_f, s_b);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(texel.color[k], light.color[k], 1e-7);  // float32
        EXPECT_NEAR(texel.opacity, light.opacity, 1e-7);
        EXPECT_NEAR(texel.t, crossings.empty() ? 0 : crossings[0].t, 1e-7);
    }
}

// The stated error: the same hits as those of surfaces whose isovalues have moved by at most half a step; off by t as told.
TEST(IsoSurfaceTable, MovesAnIsovalueByHalfAStepAtMost) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    for (const int n : {2, 16, 256}) {
        const double v = 0.1 + 0.8 * any(random);
        const IsoSurfaceTable table(surfaces_at({v}, 1), 0, 1, n);
        // Where the rounded scalar changes sides: between the grid's last scalar below v and the next one.
        int last_below = 0;
        while (table.scalar(last_below + 1) < v)
            ++last_below;
        const double moved = 0.5 * (table.scalar(last_below) + table.scalar(last_below + 1));
        EXPECT_LE(std::abs(moved - v), table.step() / 2);
        const IsoSurfaces drawn = surfaces_at({moved}, 1);
        for (int trial = 0; trial < 20000; ++trial) {
            const double s_f = any(random), s_b = any(random);
            const auto& texel = table.lookup(s_f, s_b);
            const IsoCrossings crossings = drawn.crossings(s_f, s_b);
            ASSERT_EQ(texel.opacity, crossings.empty() ? 0 : 1);
            if (!crossings.empty()) {
                EXPECT_LE(std::abs(texel.t - (v - s_f) / (s_b - s_f)), table.step() / std::abs(s_b - s_f));
            }
        }
    }
}

TEST(IsoSurfaceTable, OutsideOfItsRangeTakesItsEnds) {
    const IsoSurfaceTable table(surfaces_at({0.5}, 1), 0, 1, 64);
    EXPECT_EQ(table.lookup(-1e300, 1e300).opacity, 1);
    EXPECT_EQ(table.lookup(2, 3).opacity, 0);
    EXPECT_EQ(table.lookup(0.2, 0.2).opacity, 0);
}

}  // namespace
}  // namespace cellproj
