// SPDX-License-Identifier: BSD-3-Clause
//
// ParaView's exported colour maps as transfer functions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "classify/color_space.hpp"
#include "classify/transfer_function.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/transfer_errors.hpp"

namespace cellproj {
namespace paraview_color_map_test {

std::string paraview(const std::string& color_space, const std::string& more = "") {
    return R"([{"ColorSpace": ")" + color_space + R"(", "Name": "Cool to Warm", "NanColor": [1, 1, 0],
        "RGBPoints": [0, 0.231373, 0.298039, 0.752941, 0.5, 0.865003, 0.865003, 0.865003, 1, 0.705882, 0.0156863, 0.14902],
        "Points": [0, 0, 0.5, 0, 1, 0.5, 0.5, 0])" +
           more + "}]";
}

TEST(ParaViewColorMap, IsReadWithTheGivenUnitDistance) {
    const TransferFunction f = parse_transfer_function(paraview("RGB"), "", 2.0);
    EXPECT_EQ(f.color(1), glm::dvec3(0.705882, 0.0156863, 0.14902));
    EXPECT_NEAR(f.color(0.25).b, 0.5 * (0.752941 + 0.865003), 1e-15);
    EXPECT_DOUBLE_EQ(f.extinction(1), std::log(2.0) / 2.0);
    EXPECT_DOUBLE_EQ(parse_transfer_function(paraview("RGB", R"(, "unit_distance": 4)"), "").extinction(1),
                     std::log(2.0) / 4.0);
}

TEST(ParaViewColorMap, DivergingPassesThroughMorelandsPublishedColors) {
    // Moreland's 33-entry table for this map: its 9th and 25th rows (a quarter and three quarters of the way), in
    // 0..255.
    const TransferFunction f = parse_transfer_function(paraview("Diverging"), "");
    const glm::dvec3 quarter = f.color(0.25) * 255.0, three_quarters = f.color(0.75) * 255.0;
    const glm::dvec3 cool(141, 176, 254), warm(244, 154, 123);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(quarter[c], cool[c], 1.5)
            << c;  // rounding of the table, and of the matrices between the colour spaces
        EXPECT_NEAR(three_quarters[c], warm[c], 1.5) << c;
    }
}

TEST(ParaViewColorMap, DivergingAndLabMeetTheirNodes) {
    for (const char* space : {"Diverging", "Lab"}) {
        const TransferFunction f = parse_transfer_function(paraview(space), "");
        EXPECT_EQ(f.color(0.5), glm::dvec3(0.865003));
        // Beside the node, the curve must come close to it: 1e-3 for the rounded matrices between the colour spaces.
        for (const double s : {1e-4, 0.5 - 1e-4, 0.5 + 1e-4, 1 - 1e-4}) {
            const double node = std::round(2 * s) / 2;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(f.color(s)[c], f.color(node)[c], 2e-3) << space << s;
        }
    }
}

TEST(ParaViewColorMap, LabKeepsGreysGrey) {
    const TransferFunction f =
        parse_transfer_function(R"({"ColorSpace": "Lab", "RGBPoints": [0,0,0,0, 1,1,1,1], "Points": [0,0,0.5,0]})", "");
    const glm::dvec3 middle = f.color(0.5);  // L* = 50: 119/255 in sRGB
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(middle[c], 0.466, 2e-3);
}

TEST(ParaViewColorMap, SaysWhatItCannotRead) {
    expect_words(parse_error(paraview("Lab/CIEDE2000")), ErrorKind::option, {"ColorSpace", "\"Lab/CIEDE2000\"", "\"HSV\"", "\"Lab\"?"});
    expect_words(parse_error(R"([{"IndexedColors": [1,0,0], "Annotations": ["1", "one"]}])"), ErrorKind::format,
                 {"\"IndexedColors\"", "Categories"});
    expect_words(parse_error(paraview("RGB", R"(, "UseLogScale": "yes")")), ErrorKind::format, {"UseLogScale", "\"yes\""});
    expect_words(parse_error(paraview("RGB", R"(, "UseLogScale": 1)")), ErrorKind::data, {"color[0]", "> 0"});
    expect_words(parse_error(R"([{"ColorSpace": "Lab", "RGBPoints": [0,0,0,0, 2,1,1,1, 1,0,0,0], "Points": [0,0,0.5,0]}])"),
                 ErrorKind::data, {"color[2]", "1 after 2"});  // the file's numbering, not that of inserted nodes
    expect_words(parse_error(R"([{"ColorSpace": "Lab", "RGBPoints": [0,0,0,0, 2,1,1,1.5], "Points": [0,0,0.5,0]}])"),
                 ErrorKind::data, {"color[1]", "0 .. 1", "1.5"});
    expect_words(parse_error(R"([{"RGBPoints": [0,0,0,0]}])"), ErrorKind::format, {"Points", "opacity"});
    expect_words(parse_error(R"([{"RGBPoints": [0,0,0], "Points": [0,0,0.5,0]}])"), ErrorKind::format,
                 {"RGBPoints", "4 numbers"});
    expect_words(parse_error(R"([{"RGBPoints": [0,0,0,0], "Points": [0,0,0.5,0.3]}])"), ErrorKind::data,
                 {"Points[0]", "sharpness"});
}

// Two colours over 0..1 in a colour space, opacity 0.
TransferFunction two_colors(const std::string& space, const std::string& from, const std::string& to,
                            const std::string& more = "") {
    return parse_transfer_function(R"({"ColorSpace": ")" + space + R"(", "RGBPoints": [0, )" + from + ", 1, " + to +
                                       R"(], "Points": [0, 0, 0.5, 0])" + more + "}",
                                   "");
}

void expect_color(const glm::dvec3& found, const glm::dvec3& expected, double tolerance, const std::string& what) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], tolerance) << what << ", channel " << c;
}

TEST(ParaViewColorMap, HsvGoesRoundTheCircleOfHues) {
    // From red over yellow, green, cyan to blue; with HSVWrap the short way over magenta.
    const TransferFunction far = two_colors("HSV", "1,0,0", "0,0,1"), wrapped = two_colors("HSV", "1,0,0", "0,0,1", R"(, "HSVWrap": 1)");
    expect_color(far.color(0.25), {1, 1, 0}, 1e-12, "yellow");
    expect_color(far.color(0.5), {0, 1, 0}, 1e-12, "green");
    expect_color(far.color(0.75), {0, 1, 1}, 1e-12, "cyan");
    expect_color(wrapped.color(0.5), {1, 0, 1}, 1e-12, "magenta");
    expect_color(wrapped.color(0.25), {1, 0, 0.5}, 1e-12, "rose");
    // Grey has no hue: ParaView's is 0, red's.
    expect_color(two_colors("HSV", "0.5,0.5,0.5", "1,0,0").color(0.5), {0.75, 0.375, 0.375}, 1e-12, "half grey");
}

TEST(ParaViewColorMap, HsvTurnsColorsBackIntoThemselves) {
    for (int k = 0; k < 6 * 6 * 6; ++k) {
        const glm::dvec3 rgb = glm::dvec3(k % 6, k / 6 % 6, k / 36) / 5.0;
        expect_color(rgb_from_hsv(hsv_from_rgb(rgb)), rgb, 1e-14, std::to_string(k));
    }
}

TEST(ParaViewColorMap, CurvesAreFollowedWithinOneThousandth) {
    struct Curve {
        const char* space;
        glm::dvec3 (*interpolate)(const glm::dvec3&, const glm::dvec3&, double);
    };
    // Besides the 1e-3 that is promised: the rounded matrices of Lab do not lead a colour back to itself exactly.
    for (const auto& [space, interpolate] : {Curve{"HSV", interpolate_hsv}, {"Lab", interpolate_lab}, {"Diverging", interpolate_diverging}})
        for (const char* to : {"0.9, 0.2, 0.1", "0.01, 0.9, 0.7", "0.97, 0.98, 0.99", "0.2, 0.31, 0.87"}) {
            const TransferFunction f = two_colors(space, "0.13, 0.27, 0.88", to);
            const glm::dvec3 from = f.color(0), end = f.color(1);
            const glm::dvec3 lost = glm::abs(interpolate(from, end, 0) - from) + glm::abs(interpolate(from, end, 1) - end);
            for (int k = 1; k < 3000; ++k) {
                const double t = k / 3000.0;
                expect_color(f.color(t), interpolate(from, end, t), 1e-3 + std::max({lost.r, lost.g, lost.b}), space + std::to_string(t));
            }
        }
}

TEST(ParaViewColorMap, StepTakesTheColorOfTheIntervalsEnd) {
    const TransferFunction f = parse_transfer_function(
        R"({"ColorSpace": "Step", "RGBPoints": [0,0.1,0,0, 1,0.2,0,0, 1,0.3,0,0, 2,0.4,0,0], "Points": [0,0,0.5,0]})", "");
    EXPECT_EQ(f.color(-1).r, 0.1);
    EXPECT_EQ(f.color(0.001).r, 0.2);
    EXPECT_EQ(f.color(0.999).r, 0.2);
    EXPECT_EQ(f.color(1.001).r, 0.4);
    EXPECT_EQ(f.color(3).r, 0.4);
}

TEST(ParaViewColorMap, LogScaleSpreadsColorAndOpacity) {
    for (const char* one : {"1", "true"}) {
        const TransferFunction f = parse_transfer_function(
            std::string(R"({"ColorSpace": "RGB", "UseLogScale": )") + one +
                R"(, "RGBPoints": [0.01,0,0,0, 100,1,1,1], "Points": [0.01,0,0.5,0, 100,0.8,0.5,0]})", "");
        for (const double share : {0.125, 0.5, 0.75}) {
            const double s = 0.01 * std::pow(1e4, share);
            EXPECT_NEAR(f.color(s).g, share, 1e-3);
            // 1e-3 of −ln(1 − α), and 1e-3 of the change between the nodes that it needs.
            EXPECT_NEAR(f.extinction(s), -std::log1p(-0.8 * share), 1.1e-3);
        }
    }
    EXPECT_NEAR(two_colors("RGB", "0,0,0", "1,1,1", R"(, "UseLogScale": 0)").color(0.5).g, 0.5, 1e-15);
}

TEST(ParaViewColorMap, OneOfSeveralIsChosenByName) {
    const std::string maps = R"([{"Name": "Black", "RGBPoints": [0,0,0,0], "Points": [0,0,0.5,0]},
                                 {"Name": "White", "RGBPoints": [0,1,1,1], "Points": [0,0,0.5,0]}])";
    EXPECT_EQ(parse_transfer_function(maps, "", 1, "White").color(0).r, 1.0);
    EXPECT_EQ(parse_transfer_function(maps, "", 1, "Black").color(0).r, 0.0);
    expect_words(parse_error(maps), ErrorKind::option, {"2 colour maps", "tf.json#Black"});
    expect_words(error_of([&] { parse_transfer_function(maps, "tf.json", 1, "Wite"); }), ErrorKind::option,
                 {"\"Wite\"", "tf.json#White"});
    expect_words(error_of([&] { parse_transfer_function(R"({"color": []})", "tf.json", 1, "White"); }), ErrorKind::option,
                 {"#White"});

    const auto folder = testing_support::scratch_folder();
    std::ofstream(folder / "maps.json") << maps;
    EXPECT_EQ(read_transfer_function(folder / "maps.json#White").color(0).r, 1.0);
    expect_words(error_of([&] { read_transfer_function(folder / "none.json#White"); }), ErrorKind::file, {"none.json"});
    std::ofstream(folder / "maps.json#White") << R"({"color": [[0,0.5,0.5,0.5]], "extinction": [[0,1]]})";
    EXPECT_EQ(read_transfer_function(folder / "maps.json#White").color(0).r, 0.5);
}

}  // namespace
}  // namespace cellproj
