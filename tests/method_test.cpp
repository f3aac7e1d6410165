// SPDX-License-Identifier: BSD-3-Clause
#include "classify/method.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "classify/segment_integral.hpp"
#include "classify/segment_method.hpp"
#include "mesh/error.hpp"

namespace cellproj {
namespace method_test {

TEST(Method, NamesAndChoicesAreRead) {
    const Method table = parse_method("preint3d:uint8:128:linear");
    EXPECT_EQ(table.kind, MethodKind::preint3d);
    EXPECT_EQ(table.size, 128);
    EXPECT_EQ(table.scale, TableScale::linear);
    EXPECT_EQ(table.storage, TableStorage::uint8);
    EXPECT_EQ(parse_method("exact:1e-7").tolerance, 1e-7);
    EXPECT_EQ(parse_method("linear:3:vertices").interpolation, Interpolation::vertices);
    EXPECT_EQ(parse_method("preint2d").size, 256);
}

TEST(Method, TextAndMethodAreInverse) {
    for (const std::string text :
         {"shirley-tuchman", "average", "homogeneous:vertices", "linear:8", "average:half", "average:vertices:half", "stein", "preint2d:256", "preint2d-exp:64:float16",
          "preint3d:64", "preint3d:32:linear:uint8", "integral", "exact:1e-06"}) {
        EXPECT_EQ(to_string(parse_method(text)), text);
    }
}

TEST(Method, WhatItCannotUseIsRefused) {
    const auto message = [](const std::string& text) -> std::string {
        try {
            parse_method(text, "--method");
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::option);
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message("preint3e").find("did you mean \"preint3d\""), std::string::npos);
    EXPECT_NE(message("preint3d:1000").find("a size from 2 to 256"), std::string::npos);
    for (const std::string text : {"", "integral:64", "exact:0", "exact:nan", "preint3d:vertices", "preint3d:", "preint3d:64x", "linear:0", "linear:4:half", "shirley-tuchman:vertices"})
        EXPECT_NE(message(text).find("--method"), std::string::npos) << text;
}

// A segment's light does not depend on the units it is measured in.
TEST(SceneUnits, KeepTheLightOfEverySegment) {
    const TransferFunction density(OpticalModel::density, {{-3, {1, 0, 0}}, {2, {0, 1, 0.5}}, {2, {0, 0, 1}}, {9, {1, 1, 1}}},
                                   {{-1, 0}, {0.5, 2}, {1, 0.1}, {4, 5}});
    const TransferFunction emitter(OpticalModel::emitter, density.color_nodes(), density.extinction_nodes(),
                                   Outside::transparent);
    const double low = -2, high = 4, length = 0.3;
    for (const TransferFunction& transfer : {density, emitter}) {
        const TransferFunction scene = in_scene_units(transfer, low, high, length);
        for (const auto& [s_f, s_b] : std::vector<std::pair<double, double>>{{-2, 4}, {3.5, -1.5}, {1, 1}, {2, 2}, {-2, -2}, {4, 4}}) {
            const Light there = integrate_segment(transfer, s_f, s_b, 0.7);
            const Light here = integrate_segment(scene, (s_f - low) / (high - low), (s_b - low) / (high - low), 0.7 / length);
            EXPECT_NEAR(here.opacity, there.opacity, 1e-12) << s_f << " " << s_b;  // rounding of the mapped nodes
            for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(here.color[channel], there.color[channel], 1e-9);
        }
    }
}

// What is transparent outside its nodes is cut off at them, not faded out, and holds at them: fields of whole numbers hit them.
TEST(SceneUnits, TransparencyBeginsBehindTheNodes) {
    const TransferFunction band(OpticalModel::density, {{-3, {1, 0, 0}}, {9, {0, 1, 0}}}, {{1, 2}, {2, 4}}, Outside::transparent);
    const TransferFunction spike(OpticalModel::density, band.color_nodes(), {{2, 3}}, Outside::transparent);
    for (const TransferFunction& transfer : {band, spike}) {
        for (const auto& [low, high] : std::vector<std::pair<double, double>>{{0, 4}, {1, 2}, {2, 4}, {0, 2}, {0, 1}, {3, 4}}) {
            const TransferFunction scene = in_scene_units(transfer, low, high, 1);
            for (const double s : {0.0, 0.5, 0.999, 1.0, 1.5, 2.0, 2.001, 2.5, 3.0, 3.999, 4.0}) {
                if (s < low || s > high) continue;
                EXPECT_NEAR(scene.extinction((s - low) / (high - low)), transfer.extinction(s), 1e-12)
                    << s << " of " << low << ".." << high;
            }
        }
    }
}

TEST(SceneUnits, AnEmptyRangeIsOneValue) {
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 0}}}, {{0, 0}, {1, 4}});
    const TransferFunction scene = in_scene_units(transfer, 0.25, 0.25, 2);
    EXPECT_EQ(scene.extinction(0), 2.0);
    EXPECT_EQ(scene.color(0.7), transfer.color(0.25));
}

// Nodes nearer to each other than the new scale can tell apart do not break its rules, and steps stay steps.
TEST(SceneUnits, NodesThatCoincideKeepTheOutermost) {
    const double one = 1.0, next = std::nextafter(one, 2.0), after = std::nextafter(next, 2.0);
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 1, 1}}},
                                    {{0, 0}, {one, 1}, {next, 9}, {after, 3}, {2, 0}});
    const TransferFunction scene = in_scene_units(transfer, -1e30, 1e30, 1);
    EXPECT_LE(scene.extinction_nodes().size(), 4U);
    EXPECT_EQ(scene.extinction_nodes().front().scalar, 0.0);
    EXPECT_EQ(scene.extinction_nodes().back().scalar, 1.0);
}

}  // namespace
}  // namespace cellproj
