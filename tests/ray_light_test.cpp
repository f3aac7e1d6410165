// SPDX-License-Identifier: BSD-3-Clause
//
// The judge's integral against closed forms, a plain Riemann sum, and the integral of classify/, with which it shares no code.
#include "render/judge/ray_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "classify/segment_integral.hpp"

namespace cellproj {
namespace ray_light_test {

// The bound that the header states.
constexpr double stated = 1e-12;

Light light_of(const TransferFunction& transfer, const std::vector<ScalarEnds>& media, double length) {
    RayLight light(transfer);
    light.add(media, length);
    return light.light();
}

void expect_near(const Light& a, const Light& b, double tolerance, const std::string& what = "") {
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(a.color[k], b.color[k], tolerance) << what;
    EXPECT_NEAR(a.opacity, b.opacity, tolerance) << what;
}

// A function with steps, a spike of one ulp, transparent gaps and unrelated colour nodes.
TransferFunction rugged() {
    const double spike = std::nextafter(0.6, 1.0);
    return {OpticalModel::density,
            {{0.0, {1, 0, 0}}, {0.3, {0, 1, 0}}, {0.3, {0, 0, 1}}, {0.8, {1, 1, 0}}, {1.0, {0.2, 0.4, 0.6}}},
            {{0.1, 0.0}, {0.2, 3.0}, {0.2, 0.5}, {0.6, 2.0}, {spike, 40.0}, {std::nextafter(spike, 1.0), 0.0}, {0.9, 7.0}}};
}

// ∫₀ˡ exp(−(a x + b x²/2)) dx, b > 0: extinction a at the front, a + b l at the back.
double transmittance_integral(double a, double b, double l) {
    const double scale = std::sqrt(2 * b);
    return std::sqrt(std::numbers::pi / (2 * b)) * std::exp(a * a / (2 * b)) *
           (std::erf((b * l + a) / scale) - std::erf(a / scale));
}

TEST(RayLight, AConstantMediumIsBeersLaw) {
    for (const double tau : {0.0, 1e-30, 1e-8, 1.0, 1e3, 1e8, 1e30}) {
        const TransferFunction medium(OpticalModel::density, {{0, {0.7, 1, 0}}}, {{0, tau}});
        for (const auto& [front, back] : {std::pair(0.2, 0.2), {-1.0, 1.0}, {5.0, 0.0}}) {
            const double opacity = -std::expm1(-tau * 1.5);
            expect_near(light_of(medium, {{front, back}}, 1.5), {{0.7 * opacity, opacity, 0}, opacity}, stated);
        }
    }
}

// κ and τ both linear: C = κ₀ − κ₁ e^(−D) + (κ₁ − κ₀)/l · ∫T, by parts.
TEST(RayLight, ALinearRampIsAnErrorFunction) {
    for (const double steepness : {0.5, 3.0, 40.0}) {
        const double l = 2, a = 0.25, b = steepness;  // τ from a to a + b·l
        const TransferFunction ramp(OpticalModel::density, {{0, {0.1, 0.9, 0.5}}, {1, {1.0, 0.2, 0.5}}},
                                    {{0, a}, {1, a + b * l}});
        const double transmittance = std::exp(-(a * l + b * l * l / 2)), integral = transmittance_integral(a, b, l);
        const glm::dvec3 front(0.1, 0.9, 0.5), back(1.0, 0.2, 0.5);
        expect_near(light_of(ramp, {{0, 1}}, l),
                    {front - transmittance * back + integral / l * (back - front), 1 - transmittance}, stated);

        const TransferFunction glow(OpticalModel::emitter, {{0, {0.3, 0.2, 0.1}}}, {{0, a}, {1, a + b * l}});
        expect_near(light_of(glow, {{0, 1}}, l), {integral * glm::dvec3(0.3, 0.2, 0.1), 1 - transmittance}, stated);
    }
}

TEST(RayLight, TheIntegralOfClassifyAgrees) {
    std::mt19937_64 random(411);
    std::uniform_real_distribution<double> scalar(-0.2, 1.2), exponent(-12, 9);
    const TransferFunction transfer = rugged();
    for (int i = 0; i < 3000; ++i) {
        const double front = scalar(random), l = std::pow(10.0, exponent(random));
        const double back = i % 3 ? scalar(random) : front + std::pow(10.0, -2 * (i % 9)) * (scalar(random) - 0.5);
        // The other integral may leave out as much as its tolerance.
        expect_near(light_of(transfer, {{front, back}}, l), integrate_segment(transfer, front, back, l, 1e-15), stated,
                    std::to_string(front) + " " + std::to_string(back) + " " + std::to_string(l));
    }
}

TEST(RayLight, PiecesOfAnIntervalAreTheWhole) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    for (int i = 0; i < 200; ++i) {
        const ScalarEnds a{any(random), any(random)}, b{any(random), any(random)};
        const double length = 6 * any(random);
        std::vector<double> cuts{0, 1};
        for (int k = 0; k < 7; ++k)
            cuts.push_back(any(random));
        std::sort(cuts.begin(), cuts.end());
        const TransferFunction transfer = rugged();
        RayLight light(transfer);
        const auto at = [](const ScalarEnds& s, double t) { return s.front + t * (s.back - s.front); };
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
            const std::vector<ScalarEnds> media{{at(a, cuts[k]), at(a, cuts[k + 1])}, {at(b, cuts[k]), at(b, cuts[k + 1])}};
            light.add(media, length * (cuts[k + 1] - cuts[k]));
        }
        expect_near(light.light(), light_of(transfer, {a, b}, length), stated);
    }
}

// Two media of one τ each: q and τ add.
TEST(RayLight, SuperposedMediaAddUp) {
    const TransferFunction two(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 0}}}, {{0, 1.0}, {1, 3.0}});
    const double opacity = -std::expm1(-4 * 0.7);
    expect_near(light_of(two, {{0, 0}, {1, 1}}, 0.7), {{opacity / 4, opacity * 3 / 4, 0}, opacity}, stated);
    const Light same = light_of(two, {{1, 1}, {0, 0}}, 0.7);
    expect_near(same, {{opacity / 4, opacity * 3 / 4, 0}, opacity}, stated);

    // One ramp up, one ramp down: τ is constant, q is not. With τ = 1 and κ = 1, ∫x e^(−x) over 0..1 is 1 − 2/e.
    const TransferFunction ramp(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0.0}, {1, 1.0}});
    const TransferFunction red(OpticalModel::density, {{0, {0, 0, 0}}, {1, {1, 0, 0}}}, {{0, 0.0}, {1, 1.0}});
    expect_near(light_of(ramp, {{0, 1}, {1, 0}}, 1), {glm::dvec3(1 - std::exp(-1)), 1 - std::exp(-1)}, stated);
    // κτ = x² + (1 − x)² = 1 − 2x + 2x², weighted by e^(−x): (1 − 1/e) − 2(1 − 2/e) + 2(2 − 5/e) = 3 − 7/e.
    expect_near(light_of(red, {{0, 1}, {1, 0}}, 1), {{3 - 7 / std::numbers::e, 0, 0}, 1 - 1 / std::numbers::e}, stated);
}

// A sum over 2²⁰ midpoints: h² times the curvature, and h² from each kink of a continuous function: below 1e-10.
TEST(RayLight, SuperposedMediaAreARiemannSum) {
    const TransferFunction transfer(OpticalModel::density, {{0.1, {1, 0, 0.3}}, {0.4, {0, 1, 0.2}}, {0.9, {0.5, 0.5, 1}}},
                                    {{0.0, 0.1}, {0.3, 5.0}, {0.35, 0.0}, {0.5, 0.0}, {0.8, 3.0}});
    const std::vector<ScalarEnds> media{{0.05, 0.95}, {0.7, 0.1}, {0.33, 0.33}};
    const double length = 1.3;
    constexpr int n = 1 << 20;
    glm::dvec3 color(0);
    double depth = 0;
    for (int i = 0; i < n; ++i) {
        const double t = (i + 0.5) / n;
        glm::dvec3 q(0);
        double tau = 0;
        for (const ScalarEnds& s : media) {
            const double at = s.front + t * (s.back - s.front);
            q += transfer.emission(at);
            tau += transfer.extinction(at);
        }
        color += q * std::exp(-depth - 0.5 * tau * length / n) * (length / n);
        depth += tau * length / n;
    }
    expect_near(light_of(transfer, media, length), {color, -std::expm1(-depth)}, 1e-10);
}

TEST(RayLight, ScalarsOfAnySize) {
    for (const double scale : {1e-30, 1e30}) {
        const TransferFunction unit(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 0}}}, {{0.2, 0.0}, {0.7, 9.0}});
        const TransferFunction scaled(OpticalModel::density, {{0, {1, 0, 0}}, {scale, {0, 1, 0}}},
                                      {{0.2 * scale, 0.0}, {0.7 * scale, 9.0}});
        expect_near(light_of(scaled, {{0.1 * scale, 0.9 * scale}}, 1.0), light_of(unit, {{0.1, 0.9}}, 1.0), stated);
    }
}

// From one float64 to the next: the mean of both ends' media, whatever their names.
TEST(RayLight, OneUlpApart) {
    const double low = 0.3, high = std::nextafter(low, 1.0);
    const TransferFunction step(OpticalModel::density, {{0, {1, 1, 1}}}, {{low, 0.0}, {high, 2.0}});
    expect_near(light_of(step, {{low, high}}, 1.0), {glm::dvec3(-std::expm1(-1)), -std::expm1(-1)}, stated);
    expect_near(light_of(step, {{high, low}}, 1.0), {glm::dvec3(-std::expm1(-1)), -std::expm1(-1)}, stated);
    // A spike of that width inside a wide segment, as strong as it is thin: ∫τ = 3·(share of the way) / (that share).
    const double width = high - low;
    const TransferFunction spike(OpticalModel::density, {{0, {1, 1, 1}}},
                                 {{low, 0.0}, {low, 3 / width}, {high, 3 / width}, {high, 0.0}});
    expect_near(light_of(spike, {{0, 1}}, 1.0), {glm::dvec3(-std::expm1(-3)), -std::expm1(-3)}, stated);
    // On a way of 1.4 its share lies between two float64 near the cuts' own shares.
    expect_near(light_of(spike, {{-0.1, 1.3}}, 1.4), {glm::dvec3(-std::expm1(-3)), -std::expm1(-3)}, stated);
}

TEST(RayLight, IsPhysicalAtAnyExtreme) {
    std::mt19937_64 random(99);
    std::uniform_real_distribution<double> any(0, 1), exponent(-20, 20);
    for (int i = 0; i < 500; ++i) {
        std::vector<ExtinctionNode> nodes;
        for (int k = 0; k < 6; ++k)
            nodes.push_back({any(random), any(random) < 0.3 ? 0.0 : std::pow(10.0, exponent(random))});
        std::sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.scalar < b.scalar; });
        const TransferFunction transfer(OpticalModel::density, {{0, {1, 0.5, 0}}, {1, {0, 0.5, 1}}}, nodes);
        std::vector<ScalarEnds> media{{any(random), any(random)}};
        if (i % 2) media.push_back({any(random), any(random)});
        const Light light = light_of(transfer, media, std::pow(10.0, exponent(random)));
        ASSERT_TRUE(light.opacity >= 0 && light.opacity <= 1);
        // κ = (1 − s, 1/2, s): green is half the opacity, red and blue share the rest. An optical depth of 1e20 has 1e-16 of
        // rounding per step.
        EXPECT_NEAR(light.color.y, 0.5 * light.opacity, stated);
        EXPECT_NEAR(light.color.x + light.color.z, light.opacity, stated);
        ASSERT_TRUE(light.color.x >= 0 && light.color.z >= 0);
    }
}

TEST(RayLight, TwoThousandLayersLoseNothing) {
    const TransferFunction medium(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, -std::log1p(-0.001)}});
    RayLight light(medium);
    const std::vector<ScalarEnds> media{{0, 1}};
    for (int i = 0; i < 1000; ++i)
        light.add(media, 1.0);
    EXPECT_NEAR(light.light().opacity, 1 - std::pow(0.999, 1000), stated);  // .6323…
    EXPECT_NEAR(light.light().color.x, 1 - std::pow(0.999, 1000), stated);
}

}  // namespace
}  // namespace cellproj
