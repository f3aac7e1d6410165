// SPDX-License-Identifier: BSD-3-Clause
//
// The reflected light of EKE01 §5.4 in directions where its terms are known numbers.
#include "classify/lighting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"

namespace cellproj {
namespace lighting_test {

const glm::dvec3 orange(1, 0.5, 0.25), to_eye(0, 0, 1);

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-14) {
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(a[k], b[k], tolerance);
}

glm::dvec3 tilted(double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return {std::sin(angle), 0, std::cos(angle)};
}

TEST(Lighting, AHeadlightByDefault) {
    const Lighting headlight;
    validate(headlight, "lights");
    expect_near(shade(headlight, orange, {0, 0, 1}, to_eye), orange);  // .1 + .7 + .2
    expect_near(shade(headlight, orange, {1, 0, 0}, to_eye), 0.1 * orange);
    for (const double angle : {10.0, 45.0, 80.0}) {
        const double c = std::cos(angle * std::numbers::pi / 180);
        expect_near(shade(headlight, orange, tilted(angle), to_eye), (0.1 + 0.7 * c + 0.2 * std::pow(c, 20)) * orange);
    }
}

TEST(Lighting, LengthsDoNotMatter) {
    const Lighting lights{.lights = {{.towards = glm::dvec3(1, 2, 3)}, {.towards = glm::dvec3(1e-200, -1e-200, 1e-200)}}};
    const glm::dvec3 expected = shade(lights, orange, {0.2, 0.3, 0.9}, {0.1, 0, 1});
    for (const double scale : {1e-300, 1e-12, 1e12, 1e300})
        expect_near(shade(lights, orange, scale * glm::dvec3(0.2, 0.3, 0.9), scale * glm::dvec3(0.1, 0, 1)), expected);
}

TEST(Lighting, LightsAddUpEachWithItsHighlightBetweenItAndTheEye) {
    const double a = 60;
    const DirectionalLight red{tilted(a), {1, 0, 0}, 0.5, 0.25}, blue{tilted(-a), {0, 0, 1}, 0.75, 0};
    const Lighting both{.ambient = {0.1, 0.2, 0.3}, .exponent = 3, .lights = {red, blue}};
    const double c = 0.5, h = std::pow(std::cos(30 * std::numbers::pi / 180), 3);
    expect_near(shade(both, glm::dvec3(1), {0, 0, 1}, to_eye), {0.1 + 0.5 * c + 0.25 * h, 0.2, 0.3 + 0.75 * c});
    // In the middle between light and eye: the whole highlight.
    const Lighting one{.ambient = {0, 0, 0}, .exponent = 50, .lights = {{tilted(a), glm::dvec3(1), 0, 1}}};
    expect_near(shade(one, orange, tilted(30), to_eye), orange);
    // No light: what is ambient.
    expect_near(shade({.lights = {}}, orange, {0, 0, 1}, to_eye), 0.1 * orange);
}

TEST(Lighting, TwoSidedLooksAtTheSideThatIsSeen) {
    const Lighting two;
    Lighting one;
    one.two_sided = false;
    for (const double angle : {0.0, 30.0, 75.0}) {
        expect_near(shade(two, orange, -tilted(angle), to_eye), shade(two, orange, tilted(angle), to_eye));
        expect_near(shade(one, orange, tilted(angle), to_eye), shade(two, orange, tilted(angle), to_eye));
        expect_near(shade(one, orange, -tilted(angle), to_eye), 0.1 * orange);
    }
    // A light behind the surface gives nothing to the side that is seen.
    const Lighting behind{.lights = {{.towards = glm::dvec3(0, 0, -1)}, {.towards = glm::dvec3(0.3, 0, -1)}}};
    expect_near(shade(behind, orange, {0, 0, 1}, to_eye), 0.1 * orange);
    expect_near(shade(behind, orange, {0, 0, -1}, to_eye), 0.1 * orange);
}

TEST(Lighting, WithoutADirectionThereIsTheColour) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& none : {glm::dvec3(0), glm::dvec3(nan, 0, 1), glm::dvec3(infinity, 0, 0)})
        EXPECT_EQ(shade({}, orange, none, to_eye), orange);
}

TEST(Lighting, IsFiniteAndNeverNegative) {
    std::mt19937_64 random(17);
    std::normal_distribution<double> any;
    for (int i = 0; i < 5000; ++i) {
        const auto direction = [&] { return std::pow(10.0, 50 * any(random)) * glm::dvec3(any(random), any(random), any(random)); };
        const Lighting lighting{.exponent = 1 + 1000 * std::abs(any(random)), .lights = {{.towards = direction()}, {}}};
        const glm::dvec3 light = shade(lighting, orange, direction(), direction());
        for (int k = 0; k < 3; ++k) {
            EXPECT_TRUE(light[k] >= 0.1 * orange[k] * (1 - 1e-15));
            EXPECT_TRUE(light[k] <= 1.9 * orange[k] * (1 + 1e-15));  // .1 + 2 · (.7 + .2)
        }
    }
}

// Steep gradients as a surface, none at all as it is unlit, and no jump in between; of any size from 1e-300 to 1e300.
TEST(Lighting, OfAMediumGoesFromUnlitToThatOfASurface) {
    const Lighting lighting{.lights = {{.towards = glm::dvec3(1, 2, 0.5)}, {.diffuse = 0.2}}};
    const glm::dvec3 normal(0.3, -0.4, 0.8), eye(0.2, 0.1, 1), lit = shade(lighting, glm::dvec3(1), normal, eye);
    const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-12; };
    EXPECT_EQ(lit_share(lighting, glm::dvec3(0), eye), glm::dvec3(1));
    EXPECT_EQ(lit_share(lighting, glm::dvec3(std::numeric_limits<double>::quiet_NaN()), eye), glm::dvec3(1));
    EXPECT_TRUE(near(lit_share(lighting, -glm::normalize(normal), eye), 0.5 * (glm::dvec3(1) + lit)));
    EXPECT_TRUE(near(lit_share(lighting, -10.0 * glm::normalize(normal), eye), glm::dvec3(1) + 100.0 / 101 * (lit - glm::dvec3(1))));
    for (const double size : {1e-300, 1e-160, 1e-9}) EXPECT_TRUE(near(lit_share(lighting, size * normal, eye), glm::dvec3(1))) << size;
    for (const double size : {1e9, 1e160, 1e300}) EXPECT_TRUE(near(lit_share(lighting, -size * normal, eye), lit)) << size;
}

TEST(Lighting, RefusesWhatCannotBe) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto refused = [](const Lighting& lighting, const std::string& place) {
        try {
            validate(lighting, "lights");
            ADD_FAILURE() << place;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::option);
            EXPECT_EQ(error.place(), place);
        }
    };
    refused({.ambient = {0, -1, 0}}, "lights");
    refused({.exponent = 0.5}, "lights");
    refused({.exponent = nan}, "lights");
    refused({.lights = {{}, {.towards = glm::dvec3(0)}}}, "lights, light 1");
    refused({.lights = {{.towards = glm::dvec3(nan, 0, 1)}}}, "lights, light 0");
    refused({.lights = {{.color = {nan, 0, 0}}}}, "lights, light 0");
    refused({.lights = {{.diffuse = -0.1}}}, "lights, light 0");
    refused({.lights = {{.specular = nan}}}, "lights, light 0");
}

}  // namespace
}  // namespace cellproj
