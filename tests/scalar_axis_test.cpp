// SPDX-License-Identifier: BSD-3-Clause
//
// Functions that are linear in ln s, as straight lines in s.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "classify/segment_integral.hpp"
#include "classify/transfer_function.hpp"
#include "tests/support/transfer_errors.hpp"

namespace cellproj {
namespace scalar_axis_test {

TransferFunction of_extinction(const std::vector<ExtinctionNode>& nodes) {
    return {OpticalModel::density, {{1.0, {1, 1, 1}}}, on_axis(nodes, ScalarAxis::log)};
}

TEST(ScalarAxis, SharesRunFromEndToEnd) {
    EXPECT_EQ(scalar_between(1, 100, 0.5, ScalarAxis::linear), 50.5);
    EXPECT_NEAR(scalar_between(1, 100, 0.5, ScalarAxis::log), 10.0, 1e-14);
    for (const ScalarAxis axis : {ScalarAxis::linear, ScalarAxis::log})
        for (const auto& [low, high] : {std::pair(1e-300, 1e150), {3.0, 3.0}, {5.0, std::nextafter(5.0, 6.0)}}) {
            EXPECT_EQ(scalar_between(low, high, 0, axis), low);
            EXPECT_EQ(scalar_between(low, high, 1, axis), high);
            for (const double share : {1e-17, 0.3, 1 - 1e-16}) {
                EXPECT_GE(scalar_between(low, high, share, axis), low);
                EXPECT_LE(scalar_between(low, high, share, axis), high);
            }
        }
}

// Two nodes, any magnitudes and any scalar between: the line in ln s within 1e-3 of the change.
RC_GTEST_PROP(ScalarAxis, StaysWithinOneThousandthOfTheChange, ()) {
    const auto exponent = [] { return *rc::gen::inRange(-300000, 150000) / 1000.0; };
    const double a = exponent(), b = exponent(), t = *rc::gen::inRange(0, 100001) / 100000.0;
    const double low = std::pow(10, std::min(a, b)), high = std::pow(10, std::max(a, b));
    RC_PRE(low < high);
    const double at_low = *rc::gen::inRange(0, 1000), at_high = *rc::gen::inRange(0, 1000);
    const TransferFunction f = of_extinction({{low, at_low}, {high, at_high}});
    const double s = std::clamp(std::pow(10, std::lerp(std::min(a, b), std::max(a, b), t)), low, high);
    const double share = (std::log(s) - std::log(low)) / (std::log(high) - std::log(low));
    // Logarithms of 1e±300 carry 1e-13; over few ulps they cancel, and so does the share.
    const double rounding = 1e-13 / (std::log(high) - std::log(low));
    const double error = std::abs(f.extinction(s) - std::lerp(at_low, at_high, share));
    // 1e-12: the values themselves, up to 1000, are interpolated with a few roundings.
    RC_ASSERT(error <= (1e-3 + rounding) * std::abs(at_high - at_low) + 1e-12);
}

TEST(ScalarAxis, KeepsNodesAndStepsAndSpendsFewLines) {
    const std::vector<ExtinctionNode> nodes{{1, 2}, {10, 4}, {10, 7}, {100, 0}};
    const auto lines = on_axis(nodes, ScalarAxis::log);
    for (const ExtinctionNode& node : nodes)
        EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                                [&](const auto& line) { return line.scalar == node.scalar && line.extinction == node.extinction; }),
                  1);
    // √(125 ln 10) = 16.97 lines a decade.
    EXPECT_EQ(lines.size(), 17U + 1 + 17 + 1);
    EXPECT_EQ(on_axis(nodes, ScalarAxis::linear).size(), 4U);
    const double next = std::nextafter(1.0, 2.0);
    EXPECT_EQ(on_axis(std::vector<ExtinctionNode>{{1, 0}, {next, 5}}, ScalarAxis::log).size(), 2U);
    EXPECT_EQ(on_axis(std::vector<ExtinctionNode>{{7, 5}}, ScalarAxis::log).size(), 1U);
}

// s stays linear in the cell: ∫ ln s ds = s ln s − s gives the opacity of a segment.
TEST(ScalarAxis, ASegmentHasTheOpacityOfTheClosedForm) {
    const double low = 0.5, high = 2000, a = 2, b = 1500, length = 3;
    const TransferFunction f = of_extinction({{low, 0}, {high, 1}});
    const auto antiderivative = [&](double s) { return (s * std::log(s / low) - s) / std::log(high / low); };
    const double depth = length * (antiderivative(b) - antiderivative(a)) / (b - a);
    // 1e-3 of the change (1) in extinction over the length.
    EXPECT_NEAR(-std::log1p(-integrate_segment(f, a, b, length).opacity), depth, 1e-3 * length);
}

TEST(ScalarAxis, OpacityIsLinearInTheLogarithm) {
    for (const OpacityConvention convention : {OpacityConvention::exponential, OpacityConvention::linear}) {
        const TransferFunction f{OpticalModel::density, {{1.0, {1, 1, 1}}},
                                 extinction_from_opacity({{1e-3, 0.0}, {1e3, 0.99}}, 2.0, convention, "", ScalarAxis::log)};
        for (int k = 0; k <= 1000; ++k) {
            const double share = k / 1000.0, alpha = 0.99 * share;
            const double depth = convention == OpacityConvention::linear ? alpha : -std::log1p(-alpha);
            // 1e-3 for the curve of the opacity; 1e-3 of the change between two of its nodes, at most 0.99.
            EXPECT_NEAR(2.0 * f.extinction(std::pow(10, -3 + 6 * share)), depth, 2e-3) << share;
        }
    }
}

TEST(ScalarAxis, RefusesWhatHasNoLogarithm) {
    for (const double s : {0.0, -1.0})
        expect_words(error_of([&] { on_axis(std::vector<ExtinctionNode>{{s, 1}, {2, 1}}, ScalarAxis::log, "here"); }),
                     ErrorKind::data, {"here: extinction[0]", "> 0", "linear axis"});
    expect_words(error_of([&] { extinction_from_opacity({{1, 0}, {1, 1}, {-1, 1}}, 1, OpacityConvention::linear, "here", ScalarAxis::log); }),
                 ErrorKind::data, {"here: opacity[2]"});
    expect_words(error_of([&] { on_axis(std::vector<ColorNode>{{2, {1, 1, 1}}, {1, {1, 1, 1}}}, ScalarAxis::log, "here"); }),
                 ErrorKind::data, {"here: color[1]", "1 after 2"});
}

TEST(ScaledExtinction, MultipliesExtinctionAlone) {
    const TransferFunction f(OpticalModel::emitter, {{0, {1, 2, 3}}}, {{0, 1}, {1, 5}}, Outside::transparent);
    const TransferFunction g = with_scaled_extinction(f, 2.5);
    EXPECT_EQ(g.extinction(1), 12.5);
    EXPECT_EQ(g.emission(0), glm::dvec3(1, 2, 3));
    EXPECT_EQ(g.extinction(1.5), 0.0);
    EXPECT_EQ(with_scaled_extinction(f, 0).max_extinction(-1, 2), 0.0);
    expect_words(error_of([&] { with_scaled_extinction(f, 1e60); }), ErrorKind::data, {"extinction[1]"});
}

}  // namespace
}  // namespace cellproj
