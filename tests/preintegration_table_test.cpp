// SPDX-License-Identifier: BSD-3-Clause
#include "classify/preintegration_table.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "classify/segment_integral.hpp"

namespace cellproj {
namespace preintegration_table_test {

constexpr double float_ulp = 0x1p-23;

TransferFunction linear_ramp(double densest = 10.0) {
    return {OpticalModel::density, {{0, {0, 0, 1}}, {1, {1, 0.5, 0}}}, {{0, 0}, {1, densest}}};
}

struct Errors {
    double color = 0.0, opacity = 0.0;
};

// Largest error of the lookup against the exact integral, over random scalars of the domain and lengths evenly spread
// in ln l.
Errors largest_errors(const TransferFunction& transfer, const PreintegrationTable& table, double shortest,
                      double longest) {
    std::mt19937_64 random(20);  // fixed: the same segments in every run
    std::uniform_real_distribution<double> scalar(table.domain().scalar_low, table.domain().scalar_high);
    std::uniform_real_distribution<double> exponent(std::log(shortest), std::log(longest));
    Errors largest;
    for (int trial = 0; trial < 20000; ++trial) {
        const double s_f = scalar(random), s_b = scalar(random), l = std::exp(exponent(random));
        const Light looked_up = table.lookup(s_f, s_b, l), exact = integrate_segment(transfer, s_f, s_b, l);
        for (int c = 0; c < 3; ++c)
            largest.color = std::max(largest.color, std::abs(looked_up.color[c] - exact.color[c]));
        largest.opacity = std::max(largest.opacity, std::abs(looked_up.opacity - exact.opacity));
    }
    return largest;
}

bool all_finite(const PreintegrationTable& table) {
    return std::all_of(table.texels().begin(), table.texels().end(),
                       [](float x) { return std::isfinite(x) && x >= 0; });
}

TEST(PreintegrationTable, AConstantMediumIsExactToFloat32) {
    for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
        const TransferFunction medium{model, {{0, {0.3, 0.7, 1}}, {1, {0.3, 0.7, 1}}}, {{0, 4}, {1, 4}}};
        const PreintegrationTable table(medium, {0, 1, 1e3}, 16);
        // Two float32 roundings (g and τ̄), and the quadrature, better than that for e^(−D).
        for (const double l : {1e-9, 1e-3, 0.1, 1.0, 30.0, 1e3}) {
            const Light looked_up = table.lookup(0.21, 0.83, l), exact = integrate_segment(medium, 0.21, 0.83, l);
            EXPECT_NEAR(looked_up.opacity, exact.opacity, float_ulp * exact.opacity);
            EXPECT_NEAR(looked_up.color.g, exact.color.g, 2.0 * float_ulp * exact.color.g) << l;
        }
    }
}

TEST(PreintegrationTable, ALinearRampStaysWithinOneThousandth) {
    const PreintegrationTable table(linear_ramp(), {0, 1, 1.0}, 64);
    const Errors errors = largest_errors(linear_ramp(), table, 1e-4, 1.0);
    EXPECT_LE(errors.color, 1e-3);    // measured 3e-4
    EXPECT_LE(errors.opacity, 1e-7);  // τ̄ is bilinear: float32 rounding only
    EXPECT_GT(errors.color, 1e-9);    // the interpolation is at work
}

TEST(PreintegrationTable, TheErrorFallsWithTheSquareOfTheSize) {
    const PreintegrationTable coarse(linear_ramp(), {0, 1, 1.0}, 16), fine(linear_ramp(), {0, 1, 1.0}, 64);
    const double ratio =
        largest_errors(linear_ramp(), coarse, 1e-4, 1.0).color / largest_errors(linear_ramp(), fine, 1e-4, 1.0).color;
    // 63/15 squared is 18 for linear interpolation; 8 leaves room for where the random segments fall.
    EXPECT_GT(ratio, 8.0);
}

TEST(PreintegrationTable, ALengthRangeOfOneMillionCostsNoAccuracy) {
    const PreintegrationTable table(linear_ramp(), {0, 1, 1e6}, 64);
    const Errors errors = largest_errors(linear_ramp(), table, 1e-4, 1.0);
    EXPECT_LE(errors.color, 1e-3);  // measured 7e-4
    EXPECT_LE(errors.opacity, 1e-7);
}

TEST(PreintegrationTable, TheDefaultTransferFunctionStaysWithinTwoThousandths) {
    const TransferFunction transfer = default_transfer_function(0, 1, 1);
    const Errors errors = largest_errors(transfer, PreintegrationTable(transfer, {0, 1, 1}, 64), 1e-4, 1.0);
    EXPECT_LE(errors.color, 2e-3);  // measured 1.2e-3, where viridis bends between two texels
    EXPECT_LE(errors.opacity, 1e-7);
}

TEST(PreintegrationTable, AnEmitterWithGapsStaysWithinOneThousandth) {
    const TransferFunction glow{OpticalModel::emitter, {{0, {0, 0, 1}}, {1, {1, 0.5, 0}}}, {{0, 0}, {1, 10}}};
    EXPECT_LE(largest_errors(glow, PreintegrationTable(glow, {0, 1, 1}, 64), 1e-4, 1.0).color, 1e-3);
}

TEST(PreintegrationTable, TexelsAreTheIntegral) {
    const TransferFunction f{OpticalModel::density,
                             {{0, {1, 0, 0}}, {0.31, {0, 1, 0}}, {0.31, {0, 0, 1}}, {1, {1, 1, 1}}},
                             {{0, 1}, {0.55, 9}, {0.55, 0}, {0.77, 0}, {1, 3}}};
    const TableDomain domain{-0.2, 1.2, 50.0};
    const int n = 9;
    const PreintegrationTable table(f, domain, n);
    for (int k = 0; k < n; ++k) {
        const double l =
            table.length_scale() * std::expm1(k / (n - 1.0) * std::log1p(domain.max_length / table.length_scale()));
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double s_f = std::lerp(-0.2, 1.2, i / (n - 1.0)), s_b = std::lerp(-0.2, 1.2, j / (n - 1.0));
                const Light exact = integrate_segment(f, s_f, s_b, l), looked_up = table.lookup(s_f, s_b, l);
                // At a texel nothing is interpolated: the table's quadrature promises 3e-7 of each part.
                EXPECT_NEAR(looked_up.opacity, exact.opacity, 1e-6);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(looked_up.color[c], exact.color[c], 1e-6) << i << j << k;
            }
    }
}

TEST(PreintegrationTable, TheDiagonalIsTheFunctionItself) {
    const TransferFunction f = linear_ramp();
    const int n = 17;
    const PreintegrationTable table(f, {0, 1, 7}, n);
    for (int k = 0; k < n; ++k)
        for (int i = 0; i < n; ++i) {
            const auto at = static_cast<std::size_t>(4 * (i + n * (i + n * k)));
            const double s = i / 16.0;
            EXPECT_EQ(table.texels()[at], static_cast<float>(f.emission(s).r));
            EXPECT_EQ(table.texels()[at + 2], static_cast<float>(f.emission(s).b));
            EXPECT_EQ(table.texels()[at + 3], static_cast<float>(f.extinction(s)));
        }
}

TEST(PreintegrationTable, ThousandThinSlabsAddUpExactly) {
    // Opacity .001 each: every slab is 1/2000 of the longest length.
    const double tau = -std::log1p(-0.001) * 2000.0;
    const TransferFunction fog{OpticalModel::density, {{0, {1, 1, 1}}}, {{0, tau}}};
    const PreintegrationTable table(fog, {0, 1, 1.0}, 64);
    Light sum, half;
    for (int slab = 0; slab < 2000; ++slab) {
        sum = composite(sum, table.lookup(0.4, 0.4, 1.0 / 2000.0));
        if (slab == 999) half = sum;
    }
    // τ̄ is rounded to float32 once; the slabs repeat that error, D·2⁻²⁴ ≤ 2·6e-8.
    EXPECT_NEAR(half.opacity, 1.0 - std::pow(0.999, 1000), 1.2e-7);
    EXPECT_NEAR(sum.opacity, 1.0 - std::pow(0.999, 2000), 1.2e-7);
    EXPECT_NEAR(sum.color.r, sum.opacity, 2.4e-7);
}

TEST(PreintegrationTable, AConstantFieldHasARangeOfZero) {
    const PreintegrationTable table(linear_ramp(), {0.5, 0.5, 2.0}, 8);
    const Light looked_up = table.lookup(0.5, 0.5, 1.3), exact = integrate_segment(linear_ramp(), 0.5, 0.5, 1.3);
    EXPECT_NEAR(looked_up.opacity, exact.opacity, float_ulp);
    EXPECT_NEAR(looked_up.color.r, exact.color.r, 2 * float_ulp);
}

TEST(PreintegrationTable, ArgumentsOutsideTheDomainAreClamped) {
    const PreintegrationTable table(linear_ramp(), {0.2, 0.8, 2.0}, 8);
    EXPECT_EQ(table.lookup(-9, 9, 99).opacity, table.lookup(0.2, 0.8, 2).opacity);
    EXPECT_EQ(table.lookup(-9, 9, -1).opacity, 0.0);
    EXPECT_EQ(table.lookup(0.3, 0.4, 0).color, glm::dvec3(0));
}

TEST(PreintegrationTable, ScalarsAndLengthsOfAnySizeStayFinite) {
    for (const double scale : {1e-30, 1.0, 1e30})
        for (const double l : {1e-12, 1.0, 1e12}) {
            const TransferFunction f{
                OpticalModel::density, {{0, {0, 0, 1}}, {scale, {1, 0, 0}}}, {{0, 0}, {scale, 5 / l}}};
            const PreintegrationTable table(f, {0, scale, l}, 32);
            ASSERT_TRUE(all_finite(table)) << scale << " " << l;
            const Light looked_up = table.lookup(0.9 * scale, 0.1 * scale, l);
            const Light unit = integrate_segment(linear_ramp(5), 0.9, 0.1, 1.0);
            EXPECT_NEAR(looked_up.opacity, unit.opacity, 1e-6);
            EXPECT_NEAR(looked_up.color.r, unit.color.r, 2e-3);  // 32 texels: four times the error of 64
        }
}

TEST(PreintegrationTable, NothingBecomesInfiniteBeyondFloat32) {
    const TransferFunction f{OpticalModel::emitter, {{0, {1e60, 0, 1}}}, {{0, 0}, {1, 1e60}}};
    const PreintegrationTable table(f, {-1, 2, 1e12}, 8);
    EXPECT_TRUE(all_finite(table));
    const Light light = table.lookup(0, 1, 1e12);
    EXPECT_TRUE(std::isfinite(light.color.r));
    EXPECT_LE(light.opacity, 1.0);
}

TEST(PreintegrationTable, WithoutExtinctionEmissionAddsUp) {
    const TransferFunction glow{OpticalModel::emitter, {{0, {0, 1, 0}}, {1, {4, 1, 0}}}, {{0, 0}}};
    const PreintegrationTable table(glow, {0, 1, 10}, 8);
    EXPECT_EQ(table.length_scale(), 10.0);
    const Light light = table.lookup(0.25, 0.5, 8.0);
    EXPECT_EQ(light.opacity, 0.0);
    EXPECT_NEAR(light.color.r, 4 * 0.375 * 8, 12 * float_ulp);
}

TEST(PreintegrationTable, ManyNodesAreMergedIntoTheirMean) {
    std::vector<ExtinctionNode> comb;
    for (int i = 0; i < 10000; ++i)
        comb.push_back({i / 9999.0, i % 2 == 0 ? 0.0 : 6.0});
    const TransferFunction f{OpticalModel::density, {{0, {0, 0, 1}}, {1, {1, 0, 0}}}, comb};
    const TransferFunction smooth{OpticalModel::density, {{0, {0, 0, 1}}, {1, {1, 0, 0}}}, {{0, 3}}};
    // Scalars on every third texel, so that only long paths over the comb are looked up: they see it as a fog of its
    // mean.
    const PreintegrationTable table(f, {0, 1, 1}, 16);
    for (int i = 0; i <= 15; i += 3)
        for (int j = 0; j <= 15; j += 3) {
            if (i == j) continue;
            const Light looked_up = table.lookup(i / 15.0, j / 15.0, 1),
                        mean = integrate_segment(smooth, i / 15.0, j / 15.0, 1);
            // A path meets at least 2000 teeth: half a tooth more or less is 2.5e-4, times D e^(−D) ≤ .15.
            EXPECT_NEAR(looked_up.opacity, mean.opacity, 1e-4);
            EXPECT_NEAR(looked_up.color.r, mean.color.r, 1e-3);  // and 128 parts: (D/128)²/12 and the like
        }
}

RC_GTEST_PROP(PreintegrationTable, IsPhysicalMonotoneAndItsOpacitySymmetric, (unsigned seed)) {
    static const TransferFunction f{OpticalModel::density,
                                    {{0, {1, 0, 0}}, {0.3, {0, 1, 0}}, {0.3, {0, 0, 1}}, {1, {1, 1, 1}}},
                                    {{0.1, 0}, {0.5, 9}, {0.5, 0}, {0.7, 0}, {1, 3}}};
    static const PreintegrationTable table(f, {0, 1, 10}, 32);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double s_f = unit(random), s_b = unit(random), l = 10 * std::pow(unit(random), 4);
    const Light light = table.lookup(s_f, s_b, l);
    // τ̄ is symmetric; trilinear weights are summed in another order.
    RC_ASSERT(std::abs(table.lookup(s_b, s_f, l).opacity - light.opacity) < 1e-12);
    RC_ASSERT(table.lookup(s_f, s_b, 1.01 * l).opacity >= light.opacity);
    RC_ASSERT(light.opacity >= 0 && light.opacity <= 1);
    for (int c = 0; c < 3; ++c) {
        RC_ASSERT(light.color[c] >= 0);
        // No chromaticity exceeds 1: every texel has g ≤ τ̄, and so has every mean of texels, up to float32.
        RC_ASSERT(light.color[c] <= light.opacity * (1 + 4 * float_ulp));
    }
}

}  // namespace
}  // namespace cellproj
