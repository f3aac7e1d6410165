// SPDX-License-Identifier: BSD-3-Clause
//
// What the format of the framebuffer does to many thin layers, against the arithmetic of each format.
#include "render/target_format.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "mesh/error.hpp"
#include "render/renderer.hpp"
#include "tests/support/layers.hpp"

namespace cellproj {
namespace target_format_test {

using testing_support::through_stacked_cells;

constexpr TargetFormat formats[] = {TargetFormat::rgba8, TargetFormat::rgba16, TargetFormat::rgba16f, TargetFormat::rgba32f};

Renderer& renderer() {
    static const auto shared = make_renderer(Backend::gl_osmesa);
    return *shared;
}

TransferFunction medium(double extinction, const glm::dvec3& color = {1, 0.5, 0.25}) {
    return {OpticalModel::density, {{0, color}}, {{0, extinction}}};
}

float opacity_of_layers(int count, double opacity_each, TargetFormat format) {
    const double extinction = -std::log1p(-opacity_each) * count;
    return through_stacked_cells(renderer(), count, medium(extinction), {.target = format}).w;
}

TEST(TargetFormat, NamesAndFormatsAreInverse) {
    for (const TargetFormat format : formats) EXPECT_EQ(parse_target_format(to_string(format)), format);
    try {
        parse_target_format("rgba64", "--target");
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::option);
        EXPECT_NE(std::string(error.what()).find("--target"), std::string::npos);
    }
}

// One cell: a rounding of the format, once. rgba16f has 11 digits, a unit of which is 2⁻¹¹ of a value below 1.
TEST(TargetFormat, OneCellIsRightToTheFormatsStep) {
    const double opacity = 1 - std::exp(-0.7);
    const double steps[] = {1.0 / 255, 1.0 / 65535, 1.0 / 2048, 1e-6};
    for (int i = 0; i < 4; ++i) {
        const glm::vec4 light = through_stacked_cells(renderer(), 1, medium(0.7), {.target = formats[i]});
        EXPECT_NEAR(light.w, opacity, steps[i]) << to_string(formats[i]);
        EXPECT_NEAR(light.x, opacity, steps[i]);
        EXPECT_NEAR(light.y, opacity / 2, steps[i]);
        EXPECT_NEAR(light.z, opacity / 4, steps[i]);
    }
}

// ---- Many thin layers. Measured on the way: 1000 layers of .001 give 0, .6349, .5122 and .6323 where .6323 is right.

double exact_opacity(int count, double opacity_each) { return 1 - std::pow(1 - opacity_each, count); }

// .001 is a quarter of a step of 8 bits: every layer rounds to nothing.
TEST(TargetFormat, EightBitsLoseThinLayersAltogether) {
    EXPECT_EQ(opacity_of_layers(400, 0.001, TargetFormat::rgba8), 0.0F);
    EXPECT_EQ(opacity_of_layers(4000, 0.001, TargetFormat::rgba8), 0.0F);
}

// A layer of α adds α·(1 − d) to d and is lost where that is less than half a step: from d = 1 − 1/(2·255·α) on, with α
// = .01 itself (2.55 steps) or rounded to 3 steps, as the driver likes.
TEST(TargetFormat, EightBitsStopBeforeTheyAreOpaque) {
    const double stop_exact = 1 - 0.5 / 2.55, stop_rounded = 1 - 0.5 / 3;
    const float opacity = opacity_of_layers(2000, 0.01, TargetFormat::rgba8);
    EXPECT_GT(opacity, stop_exact - 1.0 / 255);
    EXPECT_LT(opacity, stop_rounded + 1.0 / 255);
    EXPECT_GT(exact_opacity(2000, 0.01), 0.9999);
}

// A layer is wrong by at most half a step when it is stored as a source and half a step after the blending; what is behind
// a layer fades by 1 − α, so that the errors add up to less than one step / α.
TEST(TargetFormat, SixteenBitsErrByLessThanAStepOverTheOpacity) {
    for (const double opacity : {0.001, 0.0015, 0.01}) {
        for (const int count : {400, 1000}) {
            EXPECT_NEAR(opacity_of_layers(count, opacity, TargetFormat::rgba16), exact_opacity(count, opacity), 1 / opacity / 65535)
                << count << " layers of " << opacity;
        }
    }
}

// Numbers in ½..1 are 2⁻¹¹ apart. A driver that rounds down loses a layer where α·(1 − d) < 2⁻¹¹, one that rounds to
// nearest where it is less than half of that.
TEST(TargetFormat, HalfFloatsStopBeforeTheyAreOpaque) {
    const double step = 1.0 / 2048, opacity = 0.001;
    const float stopped = opacity_of_layers(4000, opacity, TargetFormat::rgba16f);
    EXPECT_GT(stopped, 1 - step / opacity - step);
    EXPECT_LT(stopped, 1 - step / 2 / opacity + step);
    EXPECT_GT(exact_opacity(4000, opacity), 0.98);
}

// The default loses nothing: half a unit of the 24th digit per layer, and 1e-6 of the layer itself in float32.
TEST(TargetFormat, FloatsKeepEveryLayer) {
    for (const int count : {400, 1000, 2000, 4000}) {
        EXPECT_NEAR(opacity_of_layers(count, 0.001, TargetFormat::rgba32f), exact_opacity(count, 0.001),
                    count * std::ldexp(1.0, -25) + 1e-6);
    }
}

// Fixed point holds colours to 1 and cuts what is brighter; floats add it up.
TEST(TargetFormat, FixedPointCutsWhatIsBrighterThanOne) {
    const TransferFunction glow(OpticalModel::emitter, {{0, {3, 0.5, 0}}}, {{0, 0}});
    for (const TargetFormat format : formats) {
        const bool fixed = format == TargetFormat::rgba8 || format == TargetFormat::rgba16;
        const glm::vec4 light = through_stacked_cells(renderer(), 2, glow, {.target = format});
        EXPECT_NEAR(light.x, fixed ? 1 : 3, 2e-3) << to_string(format);
        EXPECT_NEAR(light.y, 0.5, 1.0 / 255) << to_string(format);  // two of .25, each rounded to half a step of 8 bits
    }
}

TEST(TargetFormat, IsToldAndLeavesNothingBehind) {
    const auto opacity = [](TargetFormat format) { return opacity_of_layers(3, 0.2, format); };
    const float before = opacity(TargetFormat::rgba32f);
    EXPECT_NE(opacity(TargetFormat::rgba8), before);
    EXPECT_EQ(opacity(TargetFormat::rgba32f), before);

    const auto mesh = std::make_shared<TetMesh>(testing_support::stacked_cells(1));
    const auto field = std::make_shared<ScalarField>(ScalarField{"s", FieldLocation::points, {0, 0, 0, 0}});
    Statistics statistics;
    renderer().render({mesh, field, std::make_shared<TransferFunction>(medium(1))}, testing_support::view_along_z(), {8, 8},
                      {.target = TargetFormat::rgba16f}, &statistics);
    EXPECT_EQ(statistics.target, "rgba16f");
}

}  // namespace
}  // namespace cellproj
