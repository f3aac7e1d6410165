// SPDX-License-Identifier: BSD-3-Clause
//
// The curved colour interpolations of ParaView's colour maps: HSV, CIE L*a*b* (D65) and the diverging one, Moreland,
// "Diverging Color Maps for Scientific Visualization", ISVC 2009. All colours are sRGB in 0..1. Private to classify/.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace cellproj {

inline constexpr glm::dvec3 white_d65{0.9505, 1.0, 1.089};  // XYZ

// IEC 61966-2-1.
inline double linear_from_srgb(double c) {
    return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
}
inline double srgb_from_linear(double c) {
    return c > 0.0031308 ? 1.055 * std::pow(c, 1.0 / 2.4) - 0.055 : 12.92 * c;
}

inline glm::dvec3 lab_from_rgb(const glm::dvec3& rgb) {
    const double r = linear_from_srgb(rgb.r), g = linear_from_srgb(rgb.g), b = linear_from_srgb(rgb.b);
    const glm::dvec3 xyz{0.4124 * r + 0.3576 * g + 0.1805 * b, 0.2126 * r + 0.7152 * g + 0.0722 * b,
                         0.0193 * r + 0.1192 * g + 0.9505 * b};
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
    const double x = f(xyz.x / white_d65.x), y = f(xyz.y / white_d65.y), z = f(xyz.z / white_d65.z);
    return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

// Colours outside sRGB are brought in as VTK does it: too bright ones are darkened in all channels, negative ones are clamped.
inline glm::dvec3 rgb_from_lab(const glm::dvec3& lab) {
    const auto inverse_f = [](double t) { return t > 0.206893 ? t * t * t : (t - 16.0 / 116.0) / 7.787; };
    const double y = (lab.x + 16.0) / 116.0;
    const glm::dvec3 xyz =
        white_d65 * glm::dvec3(inverse_f(y + lab.y / 500.0), inverse_f(y), inverse_f(y - lab.z / 200.0));
    const glm::dvec3 rgb{srgb_from_linear(3.2406 * xyz.x - 1.5372 * xyz.y - 0.4986 * xyz.z),
                         srgb_from_linear(-0.9689 * xyz.x + 1.8758 * xyz.y + 0.0415 * xyz.z),
                         srgb_from_linear(0.0557 * xyz.x - 0.2040 * xyz.y + 1.0570 * xyz.z)};
    return glm::max(rgb / std::max({1.0, rgb.r, rgb.g, rgb.b}), 0.0);
}

inline glm::dvec3 interpolate_lab(const glm::dvec3& rgb_0, const glm::dvec3& rgb_1, double t) {
    return rgb_from_lab(glm::mix(lab_from_rgb(rgb_0), lab_from_rgb(rgb_1), t));
}

// Polar form of L*a*b*: magnitude M, saturation angle s, hue angle h.
struct Msh {
    double magnitude, saturation, hue;
};

inline Msh msh_from_rgb(const glm::dvec3& rgb) {
    const glm::dvec3 lab = lab_from_rgb(rgb);
    const double magnitude = std::sqrt(lab.x * lab.x + lab.y * lab.y + lab.z * lab.z);
    const double saturation = magnitude > 1e-3 ? std::acos(std::min(1.0, lab.x / magnitude)) : 0.0;
    return {magnitude, saturation, saturation > 1e-3 ? std::atan2(lab.z, lab.y) : 0.0};
}

inline glm::dvec3 rgb_from_msh(const Msh& c) {
    const double radius = c.magnitude * std::sin(c.saturation);
    return rgb_from_lab({c.magnitude * std::cos(c.saturation), radius * std::cos(c.hue), radius * std::sin(c.hue)});
}

// The hue that an unsaturated colour should start with on its way to `saturated`, so that the path bends away from
// purple. The bounds here and below are VTK's; Moreland writes π/3 for both angles and no 0.1. Colours between them differ.
inline double spun_hue(const Msh& saturated, double unsaturated_magnitude) {
    if (saturated.magnitude >= unsaturated_magnitude - 0.1) return saturated.hue;
    const double m = saturated.magnitude;
    const double spin = saturated.saturation * std::sqrt(unsaturated_magnitude * unsaturated_magnitude - m * m) /
                        (m * std::sin(saturated.saturation));
    return saturated.hue > -0.3 * std::numbers::pi ? saturated.hue + spin : saturated.hue - spin;
}

inline glm::dvec3 interpolate_diverging(const glm::dvec3& rgb_0, const glm::dvec3& rgb_1, double t) {
    constexpr double unsaturated = 0.05;
    Msh from = msh_from_rgb(rgb_0), to = msh_from_rgb(rgb_1);
    // Two saturated colours of different hue meet at a white between them.
    const double apart = std::abs(std::remainder(from.hue - to.hue, 2.0 * std::numbers::pi));
    if (from.saturation > unsaturated && to.saturation > unsaturated && apart > 0.33 * std::numbers::pi) {
        const Msh white{std::max({from.magnitude, to.magnitude, 88.0}), 0.0, 0.0};
        (t < 0.5 ? to : from) = white;
        t = t < 0.5 ? 2.0 * t : 2.0 * t - 1.0;
    }
    if (from.saturation < unsaturated && to.saturation > unsaturated) from.hue = spun_hue(to, from.magnitude);
    if (to.saturation < unsaturated && from.saturation > unsaturated) to.hue = spun_hue(from, to.magnitude);
    return rgb_from_msh({std::lerp(from.magnitude, to.magnitude, t), std::lerp(from.saturation, to.saturation, t),
                         std::lerp(from.hue, to.hue, t)});
}

// Hue, saturation and value, each in 0..1 (Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978). Grey has hue 0.
inline glm::dvec3 hsv_from_rgb(const glm::dvec3& rgb) {
    const double value = std::max({rgb.r, rgb.g, rgb.b}), chroma = value - std::min({rgb.r, rgb.g, rgb.b});
    if (chroma <= 0.0) return {0.0, 0.0, value};
    const double sector = value == rgb.r   ? (rgb.g - rgb.b) / chroma
                          : value == rgb.g ? 2.0 + (rgb.b - rgb.r) / chroma
                                           : 4.0 + (rgb.r - rgb.g) / chroma;
    return {(sector < 0.0 ? sector + 6.0 : sector) / 6.0, chroma / value, value};
}

// Any hue: it is periodic with 1.
inline glm::dvec3 rgb_from_hsv(const glm::dvec3& hsv) {
    const auto channel = [&](double phase) {
        const double sector = 6.0 * (hsv.x + phase - std::floor(hsv.x + phase));
        return hsv.z * (1.0 - hsv.y * std::clamp(2.0 - std::abs(sector - 3.0), 0.0, 1.0));
    };
    return {channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)};
}

// Through all hues between the two, as ParaView does.
inline glm::dvec3 interpolate_hsv(const glm::dvec3& rgb_0, const glm::dvec3& rgb_1, double t) {
    return rgb_from_hsv(glm::mix(hsv_from_rgb(rgb_0), hsv_from_rgb(rgb_1), t));
}
// The shorter way around the circle of hues: ParaView's HSVWrap.
inline glm::dvec3 interpolate_hsv_wrapped(const glm::dvec3& rgb_0, const glm::dvec3& rgb_1, double t) {
    glm::dvec3 from = hsv_from_rgb(rgb_0), to = hsv_from_rgb(rgb_1);
    if (std::abs(from.x - to.x) > 0.5) (from.x > to.x ? from : to).x -= 1.0;
    return rgb_from_hsv(glm::mix(from, to, t));
}

}  // namespace cellproj
