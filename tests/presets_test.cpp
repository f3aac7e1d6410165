// SPDX-License-Identifier: BSD-3-Clause
#include "classify/presets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mesh/error.hpp"

namespace cellproj {
namespace presets_test {

constexpr double half_step = 0.5 / 255;  // what presets.hpp promises against the published tables

// The preset over 0..1.
TransferFunction preset(const std::string& name) {
    return {OpticalModel::density, preset_colors(name, 0, 1), {{0, 1}}};
}

double largest_difference(const glm::dvec3& a, const glm::dvec3& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

struct Published {
    std::string name;
    int index;  // of 256
    glm::dvec3 color;
};

// Rows of the tables as matplotlib 3.6 prints them, spread over each.
TEST(Presets, AreWithinHalfAStepOfPublishedRows) {
    const std::vector<Published> rows{
        {"viridis", 85, {0.190631, 0.407061, 0.556089}},  {"viridis", 128, {0.127568, 0.566949, 0.550556}},
        {"viridis", 170, {0.20803, 0.718701, 0.472873}},  {"magma", 85, {0.445163, 0.122724, 0.506901}},
        {"magma", 128, {0.716387, 0.214982, 0.47529}},    {"magma", 170, {0.944006, 0.377643, 0.365136}},
        {"inferno", 85, {0.472328, 0.110547, 0.428334}},  {"inferno", 128, {0.735683, 0.215906, 0.330245}},
        {"inferno", 170, {0.929644, 0.411479, 0.145367}}, {"plasma", 85, {0.610667, 0.090204, 0.619951}},
        {"plasma", 128, {0.798216, 0.280197, 0.469538}},  {"plasma", 170, {0.928329, 0.472975, 0.326067}},
        {"cividis", 85, {0.342246, 0.364939, 0.428559}},  {"cividis", 128, {0.488697, 0.485318, 0.471008}},
        {"cividis", 170, {0.648222, 0.610553, 0.454801}}, {"turbo", 85, {0.10342, 0.896, 0.715}},
        {"turbo", 128, {0.64362, 0.98999, 0.23356}},      {"turbo", 170, {0.98, 0.73, 0.22161}},
        {"turbo", 200, {0.95801, 0.39958, 0.08831}}};
    for (const auto& [name, index, color] : rows)
        EXPECT_LE(largest_difference(preset(name).color(index / 255.0), color), half_step) << name << " " << index;
}

TEST(Presets, EndAtThePublishedColors) {
    const std::vector<std::pair<std::string, std::pair<glm::dvec3, glm::dvec3>>> ends{
        {"viridis", {{0.267004, 0.004874, 0.329415}, {0.993248, 0.906157, 0.143936}}},
        {"magma", {{0.001462, 0.000466, 0.013866}, {0.987053, 0.991438, 0.749504}}},
        {"inferno", {{0.001462, 0.000466, 0.013866}, {0.988362, 0.998364, 0.644924}}},
        {"plasma", {{0.050383, 0.029803, 0.527975}, {0.940015, 0.975158, 0.131326}}},
        {"cividis", {{0.0, 0.135112, 0.304751}, {0.995737, 0.909344, 0.217772}}},
        {"turbo", {{0.18995, 0.07176, 0.23217}, {0.4796, 0.01583, 0.01055}}},
        {"gray", {{0, 0, 0}, {1, 1, 1}}}};
    for (const auto& [name, colors] : ends) {
        EXPECT_EQ(preset(name).color(0), colors.first) << name;
        EXPECT_EQ(preset(name).color(1), colors.second) << name;
    }
}

// Every fourth row of Moreland's CoolWarmFloat33.csv. 2e-3: his table and our matrices between the colour spaces are rounded.
TEST(Presets, CoolWarmFollowsMorelandsTable) {
    const std::vector<glm::dvec3> rows{{0.2298057, 0.298717966, 0.753683153},   {0.38301334, 0.50941904, 0.917387822},
                                       {0.552953156, 0.688929332, 0.995375608}, {0.722193294, 0.813952739, 0.976574709},
                                       {0.865395197, 0.86541021, 0.865395561},  {0.958852946, 0.769767752, 0.678007945},
                                       {0.958003065, 0.602842431, 0.481775914}, {0.869186849, 0.378313092, 0.300267182},
                                       {0.705673158, 0.01555616, 0.150232812}};
    for (std::size_t k = 0; k < rows.size(); ++k)
        EXPECT_LE(largest_difference(preset("cool-warm").color(k / 8.0), rows[k]), 2e-3) << k;
}

double luminance(const glm::dvec3& srgb) {
    const auto linear = [](double c) { return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92; };
    return 0.2126 * linear(srgb.r) + 0.7152 * linear(srgb.g) + 0.0722 * linear(srgb.b);
}

// What "perceptual" promises: luminance rises all the way; up and down again for turbo (Mikhailov) and cool-warm (Moreland).
// Half a step of 8 bits is worth 2.4 times as much luminance at most (the gamma's slope): less is no turn.
TEST(Presets, LuminanceRisesOrHasOnePeak) {
    for (const std::string& name : preset_names()) {
        int turns = 0;
        double extreme = 0.0, direction = 1.0;
        for (int k = 0; k <= 1000; ++k) {
            const double now = luminance(preset(name).color(k / 1000.0));
            if ((now - extreme) * direction >= 0.0) {
                extreme = now;
            } else if ((extreme - now) * direction > 2.4 * half_step) {
                extreme = now;
                direction = -direction;
                ++turns;
            }
        }
        EXPECT_EQ(turns, name == "turbo" || name == "cool-warm" ? 1 : 0) << name;
    }
}

TEST(Presets, EveryNameWorksInEveryRange) {
    const double next = std::nextafter(5.0, 6.0);
    for (const std::string& name : preset_names())
        for (const auto& [low, high] : {std::pair(5.0, 5.0), {5.0, next}, {1e-30, 1e30}, {1e-300, 1e150}})
            for (const ScalarAxis axis : {ScalarAxis::linear, ScalarAxis::log}) {
                const auto nodes = preset_colors(name, low, high, axis);
                EXPECT_EQ(nodes.back().scalar, high);
                EXPECT_EQ(nodes.back().color, preset(name).color(1));
                if (high > next) {
                    EXPECT_EQ(nodes.front().scalar, low);
                }
            }
}

// A third of the way in ln s is a third of the way through the colours.
TEST(Presets, SpreadOverALogarithmicAxis) {
    const TransferFunction f{OpticalModel::density, preset_colors("turbo", 1e-3, 1e3, ScalarAxis::log), {{1, 1}}};
    for (const double share : {0.1, 1.0 / 3, 0.5, 0.9})
        EXPECT_LE(largest_difference(f.color(std::pow(10.0, -3 + 6 * share)), preset("turbo").color(share)), 1e-3) << share;
}

TEST(Presets, UnknownNamesGetTheNearest) {
    try {
        preset_colors("virdis", 0, 1, ScalarAxis::linear, "--colors");
        FAIL() << "no Error was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::option);
        for (const char* word : {"--colors", "\"virdis\"", "\"viridis\"?", "cool-warm"})
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
}

TEST(DefaultTransferFunction, HasDepthEightAndViridisEnds) {
    const TransferFunction f = default_transfer_function(-2, 6, 4);
    EXPECT_EQ(f.extinction(-2), 0.0);
    EXPECT_EQ(f.extinction(6) * 4, 8.0);
    EXPECT_EQ(f.color(-2), glm::dvec3(0.267004, 0.004874, 0.329415));
    EXPECT_EQ(f.color(6), glm::dvec3(0.993248, 0.906157, 0.143936));
}

// The mean of the ends in ln s has half the extinction.
TEST(DefaultTransferFunction, RisesAlongALogarithmicAxis) {
    const TransferFunction f = default_transfer_function(1e-2, 1e4, 2, "cividis", ScalarAxis::log);
    EXPECT_EQ(f.extinction(1e-2), 0.0);
    EXPECT_NEAR(f.extinction(10), 2.0, 4e-3);  // 1e-3 of the change
    EXPECT_EQ(f.extinction(1e4), 4.0);
}

TEST(DefaultTransferFunction, WorksForEmptyAndExtremeRanges) {
    const double next = std::nextafter(5.0, 6.0);
    for (const auto& [low, high] : {std::pair(5.0, 5.0), {5.0, next}, {0.0, 1e30}, {-1e-30, 1e-30}})
        for (const double size : {0.0, 1e-12, 1e12}) {
            const TransferFunction f = default_transfer_function(low, high, size);
            EXPECT_DOUBLE_EQ(f.extinction(high), 8.0 / (size > 0 ? size : 1.0));
            EXPECT_EQ(f.color(high), glm::dvec3(0.993248, 0.906157, 0.143936));
        }
}

}  // namespace
}  // namespace cellproj
