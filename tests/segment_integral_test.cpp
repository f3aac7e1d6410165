// SPDX-License-Identifier: BSD-3-Clause
#include "classify/segment_integral.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "classify/optics.hpp"

namespace cellproj {
namespace segment_integral_test {

// The quadrature's own bound is 1e-15 of the value; some hundred parts add their rounding.
constexpr double relative = 1e-13;

TransferFunction density(std::vector<ColorNode> color, std::vector<ExtinctionNode> extinction,
                         Outside outside = Outside::clamp) {
    return {OpticalModel::density, std::move(color), std::move(extinction), outside};
}

TransferFunction emitter(std::vector<ColorNode> color, std::vector<ExtinctionNode> extinction) {
    return {OpticalModel::emitter, std::move(color), std::move(extinction)};
}

// ∫₀ˡ exp(−(b x + a x²/2)) dx for a > 0: extinction b at the front, b + a l at the back.
double transmittance_integral(double b, double a, double l) {
    const double scale = std::sqrt(2.0 * a);
    return std::sqrt(std::numbers::pi / (2.0 * a)) * std::exp(b * b / (2.0 * a)) *
           (std::erf((a * l + b) / scale) - std::erf(b / scale));
}

// A function with steps, a spike of one ulp, transparent gaps and unrelated colour nodes.
TransferFunction rugged() {
    const double spike = std::nextafter(0.6, 1.0);
    return density(
        {{0.0, {1, 0, 0}}, {0.3, {0, 1, 0}}, {0.3, {0, 0, 1}}, {0.8, {1, 1, 0}}, {1.0, {0.2, 0.4, 0.6}}},
        {{0.1, 0.0}, {0.2, 3.0}, {0.2, 0.5}, {0.6, 2.0}, {spike, 40.0}, {std::nextafter(spike, 1.0), 0.0}, {0.9, 7.0}});
}

void expect_physical(const Light& light, double brightest) {
    EXPECT_GE(light.opacity, 0.0);
    EXPECT_LE(light.opacity, 1.0);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GE(light.color[c], 0.0);
        EXPECT_LE(light.color[c], brightest * light.opacity * (1.0 + relative));  // also false for NaN
    }
}

TEST(SegmentIntegral, ConstantMediumIsBeersLaw) {
    const double kappa = 0.7;
    for (const double tau : {0.0, 1e-30, 1e-8, 1.0, 1e8, 1e30}) {
        const TransferFunction medium = density({{0, {kappa, 1, 0}}, {1, {kappa, 1, 0}}}, {{0, tau}, {1, tau}});
        for (const double l : {1e-12, 1.0, 1e12}) {
            const double opacity = -std::expm1(-tau * l);
            for (const auto& [s_f, s_b] : {std::pair(0.2, 0.2), {0.1, 0.9}, {0.9, 0.1}, {-5.0, 5.0}}) {
                const Light light = integrate_segment(medium, s_f, s_b, l, 1e-16);
                EXPECT_NEAR(light.opacity, opacity, 1e-15 * opacity) << tau << " " << l;
                EXPECT_NEAR(light.color.r, kappa * opacity, relative * kappa * opacity + 1e-16) << tau << " " << l;
            }
        }
    }
}

TEST(SegmentIntegral, ConstantChromaticityOverARampIsChromaticityTimesOpacity) {
    const TransferFunction ramp = density({{0, {0.3, 0.6, 0.9}}}, {{0, 0}, {1, 1}});
    for (const double l : {1e-6, 1e-3, 0.5, 3.0, 50.0, 1e4, 1e8, 1e20}) {
        for (const auto& [s_f, s_b] : {std::pair(0.0, 1.0), {1.0, 0.0}, {0.3, 0.3000001}, {0.9, 0.0}}) {
            const double opacity = -std::expm1(-0.5 * (s_f + s_b) * l);
            const Light light = integrate_segment(ramp, s_f, s_b, l, 1e-17);
            EXPECT_NEAR(light.opacity, opacity, 4e-16 * opacity);
            EXPECT_NEAR(light.color.b, 0.9 * opacity, relative * opacity) << l << " " << s_f << " " << s_b;
        }
    }
}

TEST(SegmentIntegral, EmitterOfConstantExtinction) {
    const double q = 3.0, tau = 2.0;
    const TransferFunction glow = emitter({{0, {q, 0, 0}}}, {{0, tau}});
    for (const double l : {1e-9, 0.1, 10.0, 1e9}) {
        const double color = q * -std::expm1(-tau * l) / tau;
        EXPECT_NEAR(integrate_segment(glow, 0.0, 1.0, l).color.r, color, relative * color + 1e-10);
        EXPECT_NEAR(integrate_segment(glow, 0.4, 0.4, l).color.r, color, relative * color);
    }
}

TEST(SegmentIntegral, EmitterOfLinearExtinctionIsADifferenceOfErrorFunctions) {
    const double q = 2.0, tau_0 = 0.5, tau_1 = 4.0;
    const TransferFunction glow = emitter({{0, {q, 0, 0}}}, {{0, tau_0}, {1, tau_1}});
    for (const double l : {0.1, 1.0, 10.0}) {  // at 10, the closed form itself cancels to about 1e-13
        const double color = q * transmittance_integral(tau_0, (tau_1 - tau_0) / l, l);
        EXPECT_NEAR(integrate_segment(glow, 0.0, 1.0, l, 0.0).color.r, color, 1e-12 * color) << l;
    }
    // From τ = 0 the closed form is free of cancellation at any depth, and the integrand as narrow as 1e-4 of the
    // segment.
    const TransferFunction from_nothing = emitter({{0, {q, 0, 0}}}, {{0, 0}, {1, tau_1}});
    for (const double l : {1e-3, 1.0, 1e3, 1e8}) {
        const double color = q * transmittance_integral(0.0, tau_1 / l, l);
        EXPECT_NEAR(integrate_segment(from_nothing, 0.0, 1.0, l, 0.0).color.r, color, relative * color) << l;
    }
}

TEST(SegmentIntegral, LinearChromaticityOverARampByPartialIntegration) {
    // ∫ κ τ e^(−D) dx = κ(0) − κ(l) e^(−D(l)) + ∫ κ' e^(−D) dx.
    const TransferFunction ramp = density({{0, {0.2, 0, 0}}, {1, {1, 0, 0}}}, {{0, 0}, {1, 1}});
    for (const double l : {1.0, 10.0, 1e3, 1e8}) {
        const double color = 0.2 - std::exp(-0.5 * l) + 0.8 / l * transmittance_integral(0.0, 1.0 / l, l);
        EXPECT_NEAR(integrate_segment(ramp, 0.0, 1.0, l, 0.0).color.r, color, 1e-14) << l;
    }
}

TEST(SegmentIntegral, FallingExtinctionAgreesWithSimpson) {
    // Falling τ has no error-function form; the second way is Simpson's rule with 1e-16-sized steps of h⁴.
    const TransferFunction f = density({{0, {1, 0, 0}}, {1, {0.3, 0, 0}}}, {{0, 0}, {1, 8}});
    const int n = 20000;
    const double l = 3.0, h = l / n;
    double sum = 0.0;
    for (int k = 0; k <= n; ++k) {
        const double x = k * h, s = 1.0 - x / l;
        const double integrand = (1.0 - 0.7 * s) * 8.0 * s * std::exp(-8.0 * (x - x * x / (2.0 * l)));
        sum += integrand * (k == 0 || k == n ? 1.0 : k % 2 == 1 ? 4.0 : 2.0);
    }
    EXPECT_NEAR(integrate_segment(f, 1.0, 0.0, l, 0.0).color.r, sum * h / 3.0, 1e-12);
}

TEST(SegmentIntegral, WithoutExtinctionEmissionAddsUp) {
    const TransferFunction glow = emitter({{0, {0, 1, 0}}, {1, {4, 1, 0}}}, {{0, 0}});
    for (const double l : {1e-12, 1.0, 1e12}) {
        const Light light = integrate_segment(glow, 0.0, 1.0, l);
        EXPECT_EQ(light.opacity, 0.0);
        EXPECT_NEAR(light.color.r, 2.0 * l, 1e-15 * 2.0 * l);
        EXPECT_NEAR(light.color.g, l, 1e-15 * l);
    }
}

TEST(SegmentIntegral, NoLengthGivesNothing) {
    for (const auto& [s_f, s_b] : {std::pair(0.0, 1.0), {0.5, 0.5}}) {
        const Light light = integrate_segment(rugged(), s_f, s_b, 0.0);
        EXPECT_EQ(light.opacity, 0.0);
        EXPECT_EQ(light.color, glm::dvec3(0.0));
    }
}

TEST(SegmentIntegral, MeanExtinctionOverASpikeOfOneUlp) {
    const double s = 0.6, next = std::nextafter(s, 1.0), after = std::nextafter(next, 1.0);
    const TransferFunction spike = density({{0, {1, 1, 1}}}, {{s, 0}, {next, 8}, {after, 0}});
    EXPECT_EQ(mean_extinction(spike, s, next), 4.0);
    EXPECT_EQ(mean_extinction(spike, after, s), 4.0);
    EXPECT_EQ(mean_extinction(spike, next, next), 8.0);
    EXPECT_DOUBLE_EQ(mean_extinction(spike, 0.0, 1.0), 8.0 * (next - s));
    const double least = std::numeric_limits<double>::denorm_min();
    EXPECT_NEAR(mean_extinction(density({{0, {1, 1, 1}}}, {{-1, 0.3}, {1, 0.3}}), 0.0, least), 0.3, 1e-15);
}

TEST(SegmentIntegral, NearlyEqualEndsGoToEqualEnds) {
    const TransferFunction f = rugged();
    for (const double s : {0.15, 0.45, 0.7, 1e-300}) {
        const double next = std::nextafter(s, 1.0);
        for (const double l : {1e-3, 1.0, 1e3}) {
            const Light equal = integrate_segment(f, s, s, l), near = integrate_segment(f, s, next, l);
            EXPECT_NEAR(near.opacity, equal.opacity,
                        1e-13);  // one ulp in s, times the slope of 30, times l of 1e3, at D e^(−D) ≤ 1
            EXPECT_NEAR(near.color.r, equal.color.r, 1e-10);  // the default tolerance
        }
    }
}

TEST(SegmentIntegral, HugeAndTinyScalars) {
    for (const double scale : {1e-30, 1e30}) {
        const TransferFunction f = density({{0, {0, 0, 1}}, {scale, {1, 0, 0}}}, {{0, 0}, {scale, 5}});
        const TransferFunction unit = density({{0, {0, 0, 1}}, {1, {1, 0, 0}}}, {{0, 0}, {1, 5}});
        const Light scaled = integrate_segment(f, 0.1 * scale, 0.9 * scale, 1.0);
        const Light same = integrate_segment(unit, 0.1, 0.9, 1.0);
        EXPECT_NEAR(scaled.opacity, same.opacity, 1e-14);
        EXPECT_NEAR(scaled.color.r, same.color.r, 1e-14);
    }
}

TEST(SegmentIntegral, TransparentOutsideCountsTheInsideOnly) {
    const TransferFunction f = density({{0, {1, 0, 0}}}, {{0, 2}, {1, 2}}, Outside::transparent);
    // The colour has one node: outside it, black. The extinction holds for half of the segment.
    const Light light = integrate_segment(f, -1.0, 1.0, 3.0);
    EXPECT_NEAR(light.opacity, -std::expm1(-2.0 * 1.5), 1e-15);
    EXPECT_EQ(light.color, glm::dvec3(0.0));
    EXPECT_EQ(integrate_segment(f, 2.0, 3.0, 10.0).opacity, 0.0);
}

TEST(SegmentIntegral, TenThousandSpikesHaveTheirMeanAndOrder) {
    std::vector<ExtinctionNode> nodes;
    for (int i = 0; i < 10000; ++i)
        nodes.push_back({i / 9999.0, i % 2 == 0 ? 0.0 : 6.0});
    const TransferFunction f = density({{0, {0.5, 1, 0}}}, nodes);
    EXPECT_NEAR(mean_extinction(f, 0.0, 1.0), 3.0, 1e-12);  // 1e4 pieces, each rounded once
    const Light light = integrate_segment(f, 1.0, 0.0, 0.7);
    EXPECT_NEAR(light.color.r, 0.5 * -std::expm1(-2.1), 1e-10);
}

TEST(SegmentIntegral, AbsurdOpticalDepthsStayFinite) {
    const TransferFunction f = density({{0, {1, 1, 1}}, {1, {1, 1, 1}}}, {{0, 0}, {1, 1e60}});
    for (const auto& [s_f, s_b] : {std::pair(0.0, 1.0), {1.0, 0.0}, {0.5, 0.5}})
        for (const double l : {1e-150, 1.0, 1e150})
            expect_physical(integrate_segment(f, s_f, s_b, l), 1.0);
}

TEST(SegmentIntegral, TheToleranceIsKept) {
    const TransferFunction f = rugged();
    for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
        const Light rough = integrate_segment(f, 1.0, 0.0, 20.0, tolerance),
                    exact = integrate_segment(f, 1.0, 0.0, 20.0, 0.0);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(rough.color[c], exact.color[c], tolerance);
    }
}

RC_GTEST_PROP(SegmentIntegral, PiecesOfASegmentCompositeToTheWhole, (unsigned seed)) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const TransferFunction f = rugged();
    const double s_f = unit(random), s_b = unit(random), cut = unit(random);
    const double l = std::pow(10.0, 6.0 * unit(random) - 3.0), s = s_f + (s_b - s_f) * cut;
    const Light whole = integrate_segment(f, s_f, s_b, l);
    const Light parts = composite(integrate_segment(f, s_f, s, cut * l), integrate_segment(f, s, s_b, (1.0 - cut) * l));
    // 1e-9: three tolerances of 1e-10, and s rounded to an ulp, which at l = 1e3 moves a spike of height 40 by 1e-12.
    RC_ASSERT(std::abs(parts.opacity - whole.opacity) < 1e-9);
    for (int c = 0; c < 3; ++c)
        RC_ASSERT(std::abs(parts.color[c] - whole.color[c]) < 1e-9);
}

RC_GTEST_PROP(SegmentIntegral, IsPhysicalAndItsOpacitySymmetric, (unsigned seed)) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> wide(-0.5, 1.5);
    const double s_f = wide(random), s_b = wide(random), l = std::pow(10.0, 10.0 * wide(random) - 4.0);
    const TransferFunction f = rugged();
    const Light there = integrate_segment(f, s_f, s_b, l), back = integrate_segment(f, s_b, s_f, l);
    expect_physical(there, 1.0);
    RC_ASSERT(there.opacity == back.opacity);
    RC_ASSERT(integrate_segment(f, s_f, s_b, 1.1 * l).opacity >= there.opacity);
}

TEST(Optics, MeanTransmittanceHasNoCancellation) {
    EXPECT_EQ(mean_transmittance(0.0), 1.0);
    EXPECT_EQ(mean_transmittance(1e-320), 1.0);
    EXPECT_NEAR(mean_transmittance(1e-9), 1.0 - 0.5e-9, 1e-16);  // series
    EXPECT_EQ(mean_transmittance(1e300), 1e-300);
}

}  // namespace
}  // namespace cellproj
