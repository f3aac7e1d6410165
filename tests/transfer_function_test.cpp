// SPDX-License-Identifier: BSD-3-Clause
#include "classify/transfer_function.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "mesh/error.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/transfer_errors.hpp"

namespace cellproj {
namespace transfer_function_test {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TransferFunction of_extinction(std::vector<ExtinctionNode> nodes, Outside outside = Outside::clamp) {
    return {OpticalModel::density, {{0.0, {1, 1, 1}}}, std::move(nodes), outside};
}

// Evaluation

TEST(TransferFunction, InterpolatesAndTakesTheRightSideOfAStep) {
    const TransferFunction f = of_extinction({{0, 1}, {1, 3}, {1, 5}, {2, 5}});
    EXPECT_EQ(f.extinction(0.5), 2.0);
    EXPECT_EQ(f.extinction(1.0), 5.0);
    EXPECT_NEAR(f.extinction(std::nextafter(1.0, 0.0)), 3.0, 1e-15);
    EXPECT_EQ(f.extinction(-7.0), 1.0);
    EXPECT_EQ(f.extinction(7.0), 5.0);
}

TEST(TransferFunction, TransparentOutsideKeepsBothEndNodes) {
    const TransferFunction f = of_extinction({{0, 1}, {1, 3}}, Outside::transparent);
    EXPECT_EQ(f.extinction(-1e-300), 0.0);
    EXPECT_EQ(f.extinction(0.0), 1.0);
    EXPECT_EQ(f.extinction(1.0), 3.0);
    EXPECT_EQ(f.extinction(std::nextafter(1.0, 2.0)), 0.0);
}

TEST(TransferFunction, EmissionFollowsTheModel) {
    const std::vector<ColorNode> color{{0, {0, 1, 0.5}}, {2, {2, 1, 0.5}}};
    const std::vector<ExtinctionNode> extinction{{0, 0}, {1, 4}};
    EXPECT_EQ(TransferFunction(OpticalModel::density, color, extinction).emission(0.5), glm::dvec3(1, 2, 1));
    EXPECT_EQ(TransferFunction(OpticalModel::emitter, color, extinction).emission(0.5), glm::dvec3(0.5, 1, 0.5));
}

TEST(TransferFunction, OneNodeIsAConstant) {
    const TransferFunction f = of_extinction({{3, 2}});
    EXPECT_EQ(f.extinction(-1e30), 2.0);
    EXPECT_EQ(f.extinction(1e30), 2.0);
    EXPECT_EQ(f.extinction_integral(-10, 10), 40.0);
}

TEST(TransferFunction, BreakpointsAndPiecesCoverBothListsOnce) {
    const TransferFunction f{
        OpticalModel::density, {{0, {0, 0, 0}}, {1, {1, 1, 1}}}, {{0.5, 1}, {1, 2}, {1, 7}, {3, 4}}};
    EXPECT_EQ(f.breakpoints(), (std::vector<double>{0, 0.5, 1, 3}));
    ASSERT_EQ(f.pieces().size(), 5u);
    const LinearPiece& before_step = f.pieces()[2];
    EXPECT_EQ(before_step.extinction_end, 2.0);  // the limit from the left
    EXPECT_EQ(f.pieces()[3].extinction_begin, 7.0);
    EXPECT_EQ(before_step.color(0.75), glm::dvec3(0.75));
    EXPECT_EQ(f.pieces()[0].extinction(-1e100), 1.0);
    EXPECT_EQ(f.pieces()[4].color(1e100), glm::dvec3(1));
}

TEST(TransferFunction, IntegralOfStepsGapsAndOutside) {
    const std::vector<ExtinctionNode> nodes{{0, 1}, {1, 3}, {1, 0}, {2, 0}, {2, 6}, {3, 0}};
    const TransferFunction clamped = of_extinction(nodes), open = of_extinction(nodes, Outside::transparent);
    EXPECT_EQ(clamped.extinction_integral(0, 1), 2.0);
    EXPECT_EQ(clamped.extinction_integral(0.5, 0.5), 0.0);
    EXPECT_EQ(clamped.extinction_integral(1, 2), 0.0);
    EXPECT_EQ(clamped.extinction_integral(0, 3), 5.0);
    EXPECT_EQ(clamped.extinction_integral(-2, 2.5), 2.0 + 2.0 + 2.25);
    EXPECT_EQ(open.extinction_integral(-2, 2.5), 2.0 + 2.25);
    EXPECT_EQ(open.extinction_integral(-2, -1), 0.0);
    EXPECT_EQ(open.extinction_integral(4, 5), 0.0);
}

TEST(TransferFunction, AWeakPartBehindAStrongOneKeepsItsDigits) {
    const TransferFunction f = of_extinction({{0, 1e20}, {1, 1e20}, {1, 0.125}, {2, 0.125}, {3, 0.5}, {4, 0.5}});
    // A plain difference of running integrals would be a multiple of 16384 here.
    EXPECT_DOUBLE_EQ(f.extinction_integral(1, 4), 0.125 + 0.3125 + 0.5);
    EXPECT_DOUBLE_EQ(f.extinction_integral(1.5, 3.5), 0.0625 + 0.3125 + 0.25);
}

RC_GTEST_PROP(TransferFunction, IntegralsAddUpAndStayBetweenTheirBounds,
              (std::vector<std::uint16_t> heights, double x, double y)) {
    RC_PRE(!heights.empty());
    std::vector<ExtinctionNode> nodes;
    for (std::size_t i = 0; i < heights.size(); ++i)
        nodes.push_back({static_cast<double>(i / 2 * 2 + (i % 3 != 0 ? i % 2 : 0)), static_cast<double>(heights[i])});
    const TransferFunction f = of_extinction(nodes);
    const double range = static_cast<double>(heights.size()) + 2.0;
    const double a = std::fmod(std::abs(x), range) - 1.0, b = std::fmod(std::abs(y), range) - 1.0;
    const double low = std::min(a, b), high = std::max(a, b), middle = 0.5 * (low + high);
    const double whole = f.extinction_integral(low, high);
    // Each piece is rounded a few times: relative 1e-14 for up to some hundred of them.
    RC_ASSERT(std::abs(f.extinction_integral(low, middle) + f.extinction_integral(middle, high) - whole) <=
              1e-14 * whole);
    RC_ASSERT(whole >= 0.0);
    RC_ASSERT(whole <= f.max_extinction(low, high) * (high - low) * (1.0 + 1e-14));
}

TEST(TransferFunction, MaximumSeesSpikesAndStepsOnlyInRange) {
    const double s = 0.4, next = std::nextafter(s, 1.0), after = std::nextafter(next, 1.0);
    const TransferFunction f = of_extinction({{s, 0}, {next, 9}, {after, 0}, {0.8, 0}, {0.8, 5}, {1, 5}});
    EXPECT_EQ(f.max_extinction(0, 0.5), 9.0);
    EXPECT_EQ(f.max_extinction(0.41, 0.79), 0.0);
    EXPECT_EQ(f.max_extinction(0.41, 0.8), 5.0);
    EXPECT_EQ(f.max_extinction(next, next), 9.0);
    EXPECT_EQ(of_extinction({{0, 5}, {1, 0}}).max_extinction(0.5, 2), 2.5);
}

TEST(TransferFunction, VisibleKnowsGlowWithoutExtinction) {
    EXPECT_FALSE(of_extinction({{0, 0}, {1, 0}, {2, 1}}).visible(-1, 1));
    EXPECT_TRUE(of_extinction({{0, 0}, {1, 0}, {2, 1}}).visible(-1, 1.001));
    const TransferFunction glow{OpticalModel::emitter, {{0, {0, 0, 0}}, {1, {0, 0, 0}}, {2, {0, 0, 3}}}, {{0, 0}}};
    EXPECT_FALSE(glow.visible(0, 1));
    EXPECT_TRUE(glow.visible(0.9, 1.1));
}

// Construction

TEST(TransferFunctionErrors, NameTheNodeAndTheValues) {
    const auto of_nodes = [](std::vector<ExtinctionNode> nodes) {
        return error_of([&] {
            TransferFunction(OpticalModel::density, {{0, {1, 1, 1}}}, nodes, Outside::clamp, "here");
        });
    };
    expect_words(of_nodes({}), ErrorKind::data, {"here: extinction", "at least one node"});
    expect_words(of_nodes({{0, 1}, {0.7, 1}, {0.5, 1}}), ErrorKind::data,
                 {"here: extinction[2]", "0.5 after 0.7", "sort"});
    expect_words(of_nodes({{0, 1}, {0, 2}, {0, 3}}), ErrorKind::data, {"extinction[2]", "third node at 0"});
    expect_words(of_nodes({{0, 1}, {nan, 1}}), ErrorKind::data, {"extinction[1]", "nan"});
    expect_words(of_nodes({{0, 1}, {infinity, 1}}), ErrorKind::data, {"extinction[1]", "inf"});
    expect_words(of_nodes({{0, 1}, {1, -0.25}}), ErrorKind::data, {"extinction[1]", "-0.25"});
    expect_words(of_nodes({{0, nan}}), ErrorKind::data, {"extinction[0]", "nan"});
    expect_words(of_nodes({{0, 1e61}}), ErrorKind::data, {"extinction[0]", "1e+61"});
    expect_words(error_of([] {
                     TransferFunction(OpticalModel::density, {{0, {1, -1, 1}}}, {{0, 1}});
                 }),
                 ErrorKind::data, {"transfer function: color[0]", "-1"});
}

// Opacity

TEST(ExtinctionFromOpacity, StaysWithinOneThousandthEverywhere) {
    const double u = 0.25;
    const std::vector<OpacityNode> opacity{{-3, 0}, {-1, 0.9}, {0, 1}, {0.5, 1}, {0.5, 0.2}, {2, 0.2}, {7, 0.9999}};
    const TransferFunction f = of_extinction(extinction_from_opacity(opacity, u, OpacityConvention::exponential));
    double worst = 0.0;
    for (std::size_t i = 1; i < opacity.size(); ++i) {
        const OpacityNode &left = opacity[i - 1], &right = opacity[i];
        const double alpha_left = std::min(left.opacity, 1 - 0x1p-24),
                     alpha_right = std::min(right.opacity, 1 - 0x1p-24);
        for (int k = 0; k < 20000; ++k) {
            const double t = (k + 0.5) / 20000;
            const double s = left.scalar + (right.scalar - left.scalar) * t;
            const double depth = -std::log1p(-(alpha_left + (alpha_right - alpha_left) * t));
            if (right.scalar > left.scalar) worst = std::max(worst, std::abs(f.extinction(s) * u - depth));
        }
    }
    EXPECT_LE(worst, 1e-3);
    EXPECT_GT(worst, 5e-4);                        // no more nodes than needed
    EXPECT_LT(f.extinction_nodes().size(), 600u);  // a full range 0..1 takes 187; there are three of about that
}

TEST(ExtinctionFromOpacity, NodesAreExact) {
    const auto nodes = extinction_from_opacity({{0, 0}, {1, 0.5}, {1, 1}}, 2.0, OpacityConvention::exponential);
    EXPECT_EQ(nodes.front().extinction, 0.0);
    EXPECT_DOUBLE_EQ(nodes[nodes.size() - 2].extinction, std::log(2.0) / 2.0);
    EXPECT_DOUBLE_EQ(nodes.back().extinction, 24 * std::log(2.0) / 2.0);
    const auto linear = extinction_from_opacity({{0, 0}, {1, 1}}, 2.0, OpacityConvention::linear);
    ASSERT_EQ(linear.size(), 2u);
    EXPECT_EQ(linear[1].extinction, 0.5);
}

TEST(ExtinctionFromOpacity, OneUlpHasNoRoomForMoreNodes) {
    const double s = 1e6, next = std::nextafter(s, 2e6);
    const auto nodes = extinction_from_opacity({{s, 0}, {next, 1}}, 1.0, OpacityConvention::exponential);
    ASSERT_EQ(nodes.size(), 2u);
    const auto few = extinction_from_opacity({{s, 0}, {s + 8 * (next - s), 1}}, 1.0, OpacityConvention::exponential);
    EXPECT_LE(few.size(), 9u);
    EXPECT_NO_THROW(of_extinction(few));
}

TEST(ExtinctionFromOpacity, RefusesWhatIsNoOpacity) {
    const auto of = [](double alpha, double u) {
        return error_of([&] { extinction_from_opacity({{0, 0}, {1, alpha}}, u, OpacityConvention::linear); });
    };
    expect_words(of(1.5, 1), ErrorKind::data, {"opacity[1]", "1.5", "0 .. 1"});
    expect_words(of(-0.5, 1), ErrorKind::data, {"opacity[1]", "-0.5"});
    expect_words(of(nan, 1), ErrorKind::data, {"opacity[1]", "nan"});
    expect_words(of(0.5, 0), ErrorKind::option, {"unit_distance", "> 0"});
    expect_words(of(0.5, nan), ErrorKind::option, {"unit_distance"});
}

// JSON

TEST(TransferFunctionJson, ReadsEveryKey) {
    const TransferFunction f = parse_transfer_function(
        R"({"model": "emitter", "color": [[0, 1, 2, 3], [1, 4, 5, 6]], "extinction": [[0.5, 7]], "outside": "transparent"})",
        "");
    EXPECT_EQ(f.model(), OpticalModel::emitter);
    EXPECT_EQ(f.outside(), Outside::transparent);
    EXPECT_EQ(f.color(1), glm::dvec3(4, 5, 6));
    EXPECT_EQ(f.extinction(0.5), 7.0);

    const TransferFunction g = parse_transfer_function(
        R"({"color": [[0, 1, 1, 1]], "opacity": [[0, 0.5]], "unit_distance": 2, "opacity_convention": "linear"})", "");
    EXPECT_EQ(g.model(), OpticalModel::density);
    EXPECT_EQ(g.outside(), Outside::clamp);
    EXPECT_EQ(g.extinction(0), 0.25);

    const TransferFunction h =
        parse_transfer_function(R"({"color": [[0, 1, 1, 1]], "opacity": [[0, 0.5]], "unit_distance": 2})", "");
    EXPECT_DOUBLE_EQ(h.extinction(0), std::log(2.0) / 2.0);
}

TEST(TransferFunctionJson, MalformedTextIsFoundByLineAndColumn) {
    expect_words(parse_error("{\"color\": [[0, 1, 1, 1]],\n  \"extinction\": [[0, 1],]}"), ErrorKind::format,
                 {"tf.json:2:25", "JSON"});
    expect_words(parse_error(""), ErrorKind::format, {"tf.json:1:1"});
    expect_words(parse_error("{\"color\": NaN}"), ErrorKind::format, {"tf.json:1:11", "NaN"});
    expect_words(parse_error(R"({"color": [[1e999, 1, 1, 1]], "extinction": [[0, 1]]})"), ErrorKind::format, {"1e999"});
    expect_words(parse_error("[1, 2]"), ErrorKind::format, {"tf.json", "an object"});
    expect_words(parse_error("{\"color\": \"\xff\"}"), ErrorKind::format, {"tf.json:1:"});
}

TEST(TransferFunctionJson, KeysAreStrict) {
    expect_words(parse_error(R"({"colour": [], "extinction": []})"), ErrorKind::option,
                 {"tf.json", "\"colour\"", "\"color\""});
    expect_words(parse_error(R"({"color": [[0,1,1,1]], "extinction": [[0,1]], "color": [[0,0,0,0]]})"),
                 ErrorKind::format, {"\"color\" twice"});
    expect_words(parse_error(R"({"extinction": [[0,1]]})"), ErrorKind::format, {"the key \"color\""});
    expect_words(parse_error(R"({"color": [[0,1,1,1]]})"), ErrorKind::format,
                 {"\"extinction\" or \"opacity\"", "neither"});
    expect_words(
        parse_error(R"({"color": [[0,1,1,1]], "extinction": [[0,1]], "opacity": [[0,1]], "unit_distance": 1})"),
        ErrorKind::format, {"both"});
    expect_words(parse_error(R"({"color": [[0,1,1,1]], "opacity": [[0,1]]})"), ErrorKind::format, {"unit_distance"});
    expect_words(parse_error(R"({"color": [[0,1,1,1]], "extinction": [[0,1]], "unit_distance": 1})"), ErrorKind::format,
                 {"unit_distance", "opacity"});
    expect_words(parse_error(R"({"color": [[0,1,1,1]], "extinction": [[0,1]], "opacity_convention": "linear"})"),
                 ErrorKind::format, {"opacity_convention"});
}

TEST(TransferFunctionJson, ValuesAreStrict) {
    const auto with = [](const std::string& rest) { return parse_error(R"({"color": [[0,1,1,1]], )" + rest + "}"); };
    expect_words(with(R"("extinction": [[0,1]], "model": "densty")"), ErrorKind::option,
                 {"model", "\"densty\"", "\"density\"?"});
    expect_words(with(R"("extinction": [[0,1]], "outside": 3)"), ErrorKind::format, {"outside", "3"});
    expect_words(with(R"("extinction": 4)"), ErrorKind::format, {"extinction", "[s, tau]", "4"});
    expect_words(with(R"("extinction": [])"), ErrorKind::data, {"extinction", "at least one"});
    expect_words(with(R"("extinction": [[0,1],[1,2,3]])"), ErrorKind::format, {"extinction[1]", "[1,2,3]"});
    expect_words(with(R"("extinction": [[0,1],[1,"x"]])"), ErrorKind::format,
                 {"extinction[1][1]", "a number", "\"x\""});
    expect_words(with(R"("extinction": [[1,1],[0,2]])"), ErrorKind::data, {"tf.json: extinction[1]", "0 after 1"});
    expect_words(with(R"("extinction": [[1,-1]])"), ErrorKind::data, {"extinction[0]", "-1"});
    expect_words(with(R"("opacity": [[0,0],[1,1.25]], "unit_distance": 1)"), ErrorKind::data, {"opacity[1]", "1.25"});
    expect_words(with(R"("opacity": [[0,0]], "unit_distance": -1)"), ErrorKind::option, {"unit_distance", "-1"});
    expect_words(with(R"("opacity": [[0,0]], "unit_distance": "1")"), ErrorKind::format, {"unit_distance", "a number"});
    expect_words(with(R"("extinction": [[0,1]], "axis": "logarithmic")"), ErrorKind::option, {"axis", "\"log\"?"});
    expect_words(with(R"("extinction": [[0,1]], "axis": "log")"), ErrorKind::data, {"tf.json: color[0]", "> 0", "linear"});
    expect_words(with(R"("extinction": [[0,1]], "range": [0, 1])"), ErrorKind::format, {"range", "preset"});
    expect_words(with(R"("extinction": [[0,1]], "preset": "turbo", "range": [0, 1])"), ErrorKind::format, {"both"});
}

TEST(TransferFunctionJson, PresetsAndAxesAreRead) {
    const TransferFunction f = parse_transfer_function(
        R"({"preset": "gray", "range": [1, 100], "axis": "log", "extinction": [[1, 0], [100, 4]]})", "");
    for (const double share : {0.0, 0.25, 0.5, 1.0}) {
        EXPECT_NEAR(f.color(std::pow(100, share)).r, share, 1e-3);
        EXPECT_NEAR(f.extinction(std::pow(100, share)), 4 * share, 4e-3);
    }
    const auto preset = [](const std::string& rest) { return parse_error(R"({"extinction": [[1,1]], )" + rest + "}"); };
    expect_words(preset(R"("preset": "grey", "range": [0, 1])"), ErrorKind::option, {"preset", "\"grey\"", "\"gray\"?"});
    expect_words(preset(R"("preset": 3, "range": [0, 1])"), ErrorKind::format, {"preset", "3"});
    expect_words(preset(R"("preset": "gray")"), ErrorKind::format, {"\"range\"", "[low, high]"});
    expect_words(preset(R"("preset": "gray", "range": [0])"), ErrorKind::format, {"range", "[0]"});
    expect_words(preset(R"("preset": "gray", "range": [2, 1])"), ErrorKind::data, {"range", "[2,1]", "swap"});
    expect_words(preset(R"("preset": "gray", "range": [0, 1], "axis": "log")"), ErrorKind::data, {"preset", "> 0"});
}

TEST(TransferFunctionJson, FilesAreReadAndNamed) {
    const auto folder = testing_support::scratch_folder();
    const auto file = folder / "tf.json";
    std::ofstream(file) << R"({"color": [[0,1,1,1]], "extinction": [[0,2]]})";
    EXPECT_EQ(read_transfer_function(file).extinction(0), 2.0);
    std::ofstream(file) << "{";
    expect_words(error_of([&] { read_transfer_function(file); }), ErrorKind::format, {file.string() + ":1:"});
    expect_words(error_of([&] { read_transfer_function(folder / "none.json"); }), ErrorKind::file,
                 {"none.json", "No such file"});
    expect_words(error_of([&] { read_transfer_function(folder); }), ErrorKind::file, {"a folder"});
}

}  // namespace
}  // namespace cellproj
