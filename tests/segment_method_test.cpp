// SPDX-License-Identifier: BSD-3-Clause
//
// Every method that samples or looks up, against closed forms and against the integral to convergence.
#include "classify/segment_method.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "classify/segment_integral.hpp"
#include "classify/table_encoding.hpp"
#include "tests/support/differences.hpp"

namespace cellproj {
namespace segment_method_test {

using testing_support::distance;

constexpr double longest = 2.0, usual = 0.15;  // lengths that tables are made for
constexpr double float_half_ulp = 0x1p-24;

std::unique_ptr<SegmentMethod> make(const std::string& name, const TransferFunction& transfer) {
    return make_segment_method(parse_method(name), transfer, longest, usual);
}

TransferFunction ramp(double densest, glm::dvec3 low = {0.1, 0.2, 0.9}, glm::dvec3 high = {1.0, 0.6, 0.0}) {
    return {OpticalModel::density, {{0, low}, {1, high}}, {{0, 0.1 * densest}, {1, densest}}};
}

struct Segment {
    double s_f, s_b, length;
};

std::vector<Segment> random_segments(int count, double widest, double longest_segment) {
    std::mt19937_64 random(7);  // fixed: the same segments in every run
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Segment> segments;
    for (int i = 0; i < count; ++i) {
        const double s_f = unit(random), s_b = std::clamp(s_f + widest * (2 * unit(random) - 1), 0.0, 1.0);
        segments.push_back({s_f, s_b, longest_segment * unit(random)});
    }
    return segments;
}

double largest_error(const std::string& name, const TransferFunction& transfer, const std::vector<Segment>& segments) {
    const auto method = make(name, transfer);
    double largest = 0.0;
    for (const auto& [s_f, s_b, l] : segments)
        largest = std::max(largest, distance(method->light(s_f, s_b, l), integrate_segment(transfer, s_f, s_b, l)));
    return largest;
}

void expect_light(const Light& light, const glm::dvec3& color, double opacity, double tolerance,
                  const std::string& what) {
    EXPECT_NEAR(light.opacity, opacity, tolerance) << what;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(light.color[c], color[c], tolerance) << what;
}

// ---- closed forms ----

// Whatever is between homogeneous ends is homogeneous: 1 − e^(−τl), to the rounding of q and τ to float32. An 8-bit
// texel holds the only value of the table exactly. D·e^(−D) ≤ .37.
TEST(SegmentMethod, AConstantMediumIsExactWhereOpacityIsExponential) {
    const glm::dvec3 kappa(0.3, 0.7, 1.0);
    const TransferFunction medium(OpticalModel::density, {{0.5, kappa}}, {{0.5, 4.0}});
    for (const std::string name :
         {"homogeneous", "stein", "linear:1", "linear:7", "preint2d-exp:16", "preint2d-exp:16:uint8",
          "preint2d-exp:16:float16", "preint3d:16", "preint3d:16:uint8", "preint3d:16:float16"}) {
        const auto method = make(name, medium);
        for (const double l : {0.0, 1e-9, 1e-3, 0.1, usual, 1.0, longest}) {
            const double alpha = -std::expm1(-4.0 * l);
            expect_light(method->light(0.21, 0.83, l), kappa * alpha, alpha, 2 * float_half_ulp, name);
        }
    }
}

TEST(SegmentMethod, TheAverageGrowsWithLengthUntilItIsOpaque) {
    const TransferFunction light(OpticalModel::emitter, {{0, {1, 0, 3}}, {1, {3, 0, 5}}}, {{0, 2}, {1, 6}});
    const auto method = make("average", light);
    expect_light(method->light(0, 1, 0.1), {0.2, 0, 0.4}, 0.4, 1e-15, "means 2, 4 and 4");  // all values are float32
    expect_light(method->light(1, 0, 0.25), {0.5, 0, 1}, 1, 1e-15, "just opaque");
    expect_light(method->light(1, 0, 2), {0.5, 0, 1}, 1, 1e-15, "cut off");
}

// WVG91 Table 1: intensity and opacity of one homogeneous cell (emission 127.5, optical depth ln 2 in all) cut into n
// parts. C·D depends on the number of parts, exponential integration does not. As printed: two and three decimals.
TEST(SegmentMethod, SubdivisionIsAsInTheTableOfWilhelmsAndVanGelder) {
    struct Row {
        int parts;
        double color, opacity;
    };
    const TransferFunction cell(OpticalModel::emitter, {{0, {127.5, 127.5, 127.5}}}, {{0, std::log(2.0)}});
    const auto composited = [](const SegmentMethod& method, int parts) {
        Light sum;
        for (int part = 0; part < parts; ++part)
            sum = composite(sum, method.light(0.5, 0.5, 1.0 / parts));
        return sum;
    };
    const auto average = make("average", cell), homogeneous = make("homogeneous", cell);
    for (const Row& row : std::vector<Row>{{1, 127.50, 0.693},
                                           {2, 105.41, 0.573},
                                           {5, 96.72, 0.526},
                                           {10, 94.26, 0.512},
                                           {50, 92.42, 0.502},
                                           {100, 92.19, 0.501},
                                           {10000, 91.97, 0.500}}) {
        const Light linear = composited(*average, row.parts), exponential = composited(*homogeneous, row.parts);
        EXPECT_NEAR(linear.color.r, row.color, 0.00501) << row.parts;
        EXPECT_NEAR(linear.opacity, row.opacity, 0.000501) << row.parts;
        EXPECT_NEAR(exponential.color.r, 91.97, 0.00501) << row.parts;
        EXPECT_NEAR(exponential.opacity, 0.5, 1e-6) << row.parts;
    }
}

// With q ∝ τ linear in s: exact opacity is 1 − e^(−D), and D − D²/2 ≤ 1 − e^(−D) ≤ D.
TEST(SegmentMethod, TheAverageErrsByHalfTheSquareOfTheDepth) {
    const TransferFunction f = ramp(3, {1, 1, 1}, {1, 1, 1});
    const auto method = make("average", f);
    for (const auto& [s_f, s_b, l] : random_segments(2000, 1.0, 0.3)) {
        const double depth = mean_extinction(f, s_f, s_b) * l;
        const double error = method->light(s_f, s_b, l).opacity - integrate_segment(f, s_f, s_b, l).opacity;
        EXPECT_GE(error, -2 * float_half_ulp);
        EXPECT_LE(error, depth * depth / 2 + 2 * float_half_ulp);
    }
}

// Extinction linear in s and one colour: the mean of both ends, of the steps' middles and of the table are all the true
// mean, and the colour is κα. 4e-7: roundings of samples and texels to float32, D·e^(−D)·2⁻²⁴ each, and for preint3d
// the table's quadrature, 3e-7 (segment_path.hpp).
TEST(SegmentMethod, OneColorUnderARampIsExact) {
    const TransferFunction f = ramp(20, {0.2, 1, 0.5}, {0.2, 1, 0.5});
    for (const std::string name : {"homogeneous", "stein", "linear:1", "linear:8", "preint2d-exp:32", "preint3d:16"})
        EXPECT_LE(largest_error(name, f, random_segments(3000, 1.0, longest)), 4e-7) << name;
}

// One extinction, colour linear: every method has the right opacity, and none can be off by more than half the
// difference of the ends' colours.
TEST(SegmentMethod, ColorsStayBetweenThoseOfTheEnds) {
    const TransferFunction f(OpticalModel::density, {{0, {0, 1, 0}}, {1, {1, 0, 0}}}, {{0, 3}});
    for (const std::string name : {"homogeneous", "stein", "linear:4", "preint2d-exp:32", "preint3d:32"}) {
        const auto method = make(name, f);
        for (const auto& [s_f, s_b, l] : random_segments(1000, 1.0, longest)) {
            const Light light = method->light(s_f, s_b, l), exact = integrate_segment(f, s_f, s_b, l);
            EXPECT_NEAR(light.opacity, exact.opacity, 2 * float_half_ulp) << name;
            EXPECT_LE(std::abs(light.color.r - exact.color.r), 0.5 * std::abs(s_f - s_b) * exact.opacity + 1e-6)
                << name;
        }
    }
}

// RKE00 §4 on a constant medium: α(l̄)·l/l̄, cut off at 1, and the colour with it.
TEST(SegmentMethod, TheMeanLengthTableIsProportionalToLength) {
    const glm::dvec3 kappa(0.3, 0.7, 1.0);
    for (const double tau : {0.01, 3.0, 100.0}) {
        const TransferFunction medium(OpticalModel::density, {{0, kappa}}, {{0, tau}});
        for (const std::string name : {"preint2d:8", "preint2d:8:uint8", "preint2d:8:float16"}) {
            const auto method = make(name, medium);
            for (const double l : {0.0, 0.3 * usual, usual, 1.7 * usual, longest}) {
                const double alpha = std::min(1.0, -std::expm1(-tau * usual) * l / usual);
                // float32, and a factor up to longest / usual.
                expect_light(method->light(0.4, 0.9, l), kappa * alpha, alpha, 1e-6, name);
            }
        }
    }
}

// At the mean length it is the integral: only the bilinear interpolation is left, whose error falls with the square of
// the size.
TEST(SegmentMethod, TheMeanLengthTableIsRightAtTheMeanLength) {
    auto segments = random_segments(3000, 1.0, 1.0);
    for (Segment& segment : segments)
        segment.length = usual;
    const double coarse = largest_error("preint2d:16", ramp(10), segments);
    const double fine = largest_error("preint2d:64", ramp(10), segments);
    EXPECT_LE(fine, 1e-4);          // measured 4e-5
    EXPECT_GT(coarse, 8.0 * fine);  // 63/15 squared is 18; room for where the segments fall
}

// On the linear scale the opacity is a polygon in l: at most h²·τ²/8 below the curve, h = longest / 31.
TEST(SegmentMethod, TheLinearScaleInterpolatesOpacity) {
    const TransferFunction medium(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 5}});
    const auto method = make("preint3d:32:linear", medium);
    const double bound = std::pow(5 * longest / 31, 2) / 8;
    double largest = 0;
    for (const auto& [s_f, s_b, l] : random_segments(3000, 1.0, longest)) {
        const double below = -std::expm1(-5 * l) - method->light(s_f, s_b, l).opacity;
        EXPECT_GE(below, -2 * float_half_ulp);
        largest = std::max(largest, below);
    }
    EXPECT_LE(largest, bound);
    EXPECT_GT(largest, 0.5 * bound);  // the polygon is at work
}

TEST(SegmentMethod, StepsConvergeWithTheSquareOfTheirNumber) {
    const auto segments = random_segments(2000, 1.0, 1.0);
    const double coarse = largest_error("linear:4", ramp(4), segments),
                 fine = largest_error("linear:16", ramp(4), segments);
    EXPECT_GT(coarse, 12.0 * fine);  // 16 in the limit
    EXPECT_LT(coarse, 20.0 * fine);
}

// ---- the errors that classify/README.md states ----

struct Stated {
    const char* name;
    double small, large;  // largest error of a colour channel or the opacity
};

// Ramp of extinction .4 to 4 and two colours. Small: |Δs| ≤ .02, l ≤ .03; large: |Δs| ≤ .2, l ≤ .3. The bounds are up
// to twice what was measured here; the README's table has more functions and sizes.
TEST(SegmentMethod, ErrorsOnARampAreAsStated) {
    const auto small = random_segments(4000, 0.02, 0.03), large = random_segments(4000, 0.2, 0.3);
    for (const Stated& stated : std::vector<Stated>{
             {"average", 1e-2, 4e-1},
             {"homogeneous", 3e-5, 2e-2},
             {"linear:8", 5e-7, 3e-4},
             {"stein", 3e-5, 2e-2},
             {"preint2d:256", 3e-2, 3e-1},
             {"preint2d-exp:256", 3e-5, 2e-2},
             {"preint3d:64", 6e-6, 6e-5},
             {"preint3d:64:linear", 3e-3, 3e-3},
             {"preint3d:64:uint8", 3e-4, 3e-3},
             {"preint3d:64:float16", 4e-5, 3e-4},
         }) {
        const double at_small = largest_error(stated.name, ramp(4), small),
                     at_large = largest_error(stated.name, ramp(4), large);
        EXPECT_LE(at_small, stated.small) << stated.name;
        EXPECT_LE(at_large, stated.large) << stated.name;
    }
}

// ---- extremes ----

std::vector<TransferFunction> extreme_functions() {
    const double half = 0.5, next = std::nextafter(0.5, 1.0), after = std::nextafter(next, 1.0);
    std::vector<ExtinctionNode> comb;
    for (int i = 0; i < 10000; ++i)
        comb.push_back({i / 9999.0, i % 2 == 0 ? 0.0 : 6.0});
    const std::vector<ColorNode> colors{{0, {0, 0, 1}}, {1, {1, 0.5, 0}}};
    const OpticalModel density = OpticalModel::density, emitter = OpticalModel::emitter;
    return {
        {density, {{0.3, {1, 1, 1}}}, {{0.6, 2}}},
        {density, colors, {{0, 0}, {1, 5e7}}},                                    // depth up to 1e8
        {density, colors, {{0, 5e7}, {half, 5e7}, {half, 0}, {1, 0}}},            // a step
        {density, colors, {{0, 1}, {half, 1}, {next, 1000}, {1, 1000}}},          // one ulp wide
        {density, colors, {{0, 0}, {half, 0}, {next, 1e6}, {after, 0}, {1, 0}}},  // a spike
        {density, colors, {{0, 0}, {0, 1e6}, {1, 1e6}, {1, 0}}},                  // steps at the ends
        {density, colors, comb},
        {density, colors, {{0, 0}}},
        {emitter, colors, {{0, 0}}},  // nothing absorbs
        {emitter, {{0, {1e6, 0, 0}}, {1, {0, 0, 1e6}}}, {{0, 0}, {0.5, 1e-30}, {1, 1e6}}},
    };
}

TEST(SegmentMethod, ExtremesStayFiniteAndPhysical) {
    const double half = 0.5, next = std::nextafter(0.5, 1.0);
    const std::vector<std::pair<double, double>> ends{{0, 0},       {1, 1},       {0, 1},     {1, 0}, {half, half},
                                                      {half, next}, {next, half}, {0.3, 0.7}, {-1, 2}};
    int index = 0;
    for (const TransferFunction& f : extreme_functions()) {
        for (const std::string name :
             {"average", "homogeneous", "linear:1", "linear:1000", "stein", "preint2d:16", "preint2d:16:uint8",
              "preint2d-exp:16", "preint2d-exp:2", "preint2d-exp:16:float16", "preint3d:8", "preint3d:2",
              "preint3d:8:linear", "preint3d:8:uint8", "preint3d:8:float16", "preint3d:8:linear:uint8"}) {
            const auto method = make(name, f);
            for (const auto& [s_f, s_b] : ends) {
                const std::string what = name + ", function " + std::to_string(index) + ", " + std::to_string(s_f);
                for (const double l : {0.0, 1e-300, 1e-12, usual, longest}) {
                    const Light light = method->light(s_f, s_b, l), swapped = method->light(s_b, s_f, l);
                    ASSERT_GE(light.opacity, 0.0) << what;
                    ASSERT_LE(light.opacity, 1.0) << what;
                    // Weights and steps are summed in another order.
                    ASSERT_NEAR(light.opacity, swapped.opacity, 1e-9) << what;
                    for (int c = 0; c < 3; ++c)
                        ASSERT_TRUE(light.color[c] >= 0.0 && std::isfinite(light.color[c])) << what;
                    const double sum = light.opacity + light.color.r + light.color.g + light.color.b;
                    ASSERT_TRUE(l > 0.0 || sum == 0.0) << what;
                }
            }
        }
        ++index;
    }
}

// A step one ulp wide is felt within one sample or texel of it only.
TEST(SegmentMethod, AStepIsRightBesideItsTexel) {
    const double half = 0.5, next = std::nextafter(0.5, 1.0);
    const TransferFunction step(OpticalModel::density, {{0, {1, 0.5, 0}}}, {{0, 1}, {half, 1}, {next, 50}, {1, 50}});
    const std::vector<std::pair<std::string, double>> methods{
        {"homogeneous", 4095}, {"stein", 4095}, {"linear:5", 4095}, {"preint2d-exp:64", 63}, {"preint3d:16", 15}};
    for (const auto& [name, intervals] : methods) {
        const auto method = make(name, step);
        for (const auto& [s_f, s_b, l] : random_segments(1000, 1.0, longest)) {
            const double low = std::min(s_f, s_b), high = std::max(s_f, s_b);
            if (high >= 0.5 - 1 / intervals && low <= 0.5 + 1 / intervals) continue;
            EXPECT_LE(distance(method->light(s_f, s_b, l), integrate_segment(step, s_f, s_b, l)), 4e-7)
                << name << " " << s_f;
        }
    }
}

// The integral over a spike one ulp wide is 1e6 · 2⁻⁵³: nothing. At .5 it lies between samples and texels of even
// number.
TEST(SegmentMethod, ASpikeOneUlpWideIsNothing) {
    const double half = 0.5, next = std::nextafter(half, 1.0), after = std::nextafter(next, 1.0);
    const std::vector<ColorNode> color{{0, {1, 0.5, 0}}};
    const TransferFunction spike(OpticalModel::density, color, {{0, 1}, {half, 1}, {next, 1e6}, {after, 1}, {1, 1}});
    for (const std::string name : {"homogeneous", "stein", "linear:5", "preint2d-exp:64", "preint3d:16"})
        EXPECT_LE(largest_error(name, spike, random_segments(1000, 1.0, longest)), 4e-7) << name;
}

// A medium of optical depth 1e8 is opaque to every method but those that are linear in l, which may be made for longer
// segments; so is a segment that is opaque at its mean length.
TEST(SegmentMethod, DepthOfAHundredMillionIsOpaque) {
    const TransferFunction wall(OpticalModel::density, {{0, {1, 0.5, 0.25}}}, {{0, 5e7}});
    for (const std::string name : {"average", "homogeneous", "linear:8", "stein", "preint2d:8", "preint2d-exp:8",
                                   "preint3d:8", "preint3d:8:linear", "preint3d:8:uint8"})
        expect_light(make(name, wall)->light(0.2, 0.9, longest), {1, 0.5, 0.25}, 1.0, 1e-6, name);
}

// 2000 slabs of opacity .001: the true transmittance, for every method that is exact in l.
TEST(SegmentMethod, TwoThousandThinSlabsAddUp) {
    const TransferFunction fog(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, -std::log1p(-0.001) * 1000}});
    for (const std::string name :
         {"homogeneous", "linear:4", "stein", "preint2d-exp:8", "preint2d-exp:8:uint8", "preint3d:8"}) {
        const Light slab = make(name, fog)->light(0.3, 0.4, 0.001);
        Light sum;
        for (int i = 0; i < 2000; ++i)
            sum = composite(sum, slab);
        // τ is rounded to float32 once, D·2⁻²⁴ in all.
        EXPECT_NEAR(sum.opacity, 1 - std::pow(0.999, 2000), 2e-7) << name;
    }
}

// ---- storage ----

TEST(TableEncoding, StoredTexelsAreWithinTheStatedError) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> exponent(-12.0, 1.0);
    std::vector<float> texels(4000);
    for (std::size_t i = 0; i < texels.size(); ++i)
        texels[i] =
            i % 4 == 2 ? 0.0F : static_cast<float>(std::pow(10.0, exponent(random) + static_cast<double>(i % 4)));
    for (const TableStorage storage : {TableStorage::uint8, TableStorage::float16, TableStorage::float32}) {
        const TableEncoding encoding(storage, texels);
        const std::vector<float> stored = encoding.stored(texels);
        for (std::size_t i = 0; i < texels.size(); ++i) {
            const int channel = static_cast<int>(i % 4);
            const double range = encoding.range()[channel], texel = texels[i];
            const double value = encoding.value(&texels[i - i % 4])[channel];
            EXPECT_GT(range, 0.0);
            EXPECT_FLOAT_EQ(static_cast<float>(range * stored[i]), static_cast<float>(value));
            const double bound = storage == TableStorage::uint8     ? range / 510
                                 : storage == TableStorage::float16 ? std::max(texel * 0x1p-11, range * 0x1p-25)
                                                                    : 0.0;
            EXPECT_LE(std::abs(value - texel), bound * (1 + 1e-5) + texel * 2 * float_half_ulp * (bound > 0)) << i;
            if (storage == TableStorage::uint8) {
                EXPECT_EQ(stored[i] * 255.0F, std::round(stored[i] * 255.0F));
            }
        }
    }
}

TEST(SegmentMethod, TablesTakeWhatTheirStorageTakes) {
    EXPECT_EQ(make("preint3d:16", ramp(1))->table_bytes(), 16U * 16 * 16 * 16);
    EXPECT_EQ(make("preint3d:16:float16", ramp(1))->table_bytes(), 16U * 16 * 16 * 8);
    EXPECT_EQ(make("preint2d:32:uint8", ramp(1))->table_bytes(), 32U * 32 * 4);
    EXPECT_EQ(make("preint2d-exp:32", ramp(1))->table_bytes(), 32U * 32 * 16);
    EXPECT_EQ(make("stein", ramp(1))->table_bytes(), 4096U * 16);
}

}  // namespace
}  // namespace cellproj
