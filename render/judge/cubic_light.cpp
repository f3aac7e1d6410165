// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/cubic_light.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/common.hpp>

#include "render/judge/ray_quadrature.hpp"

namespace cellproj {

namespace {

constexpr double two_points_offset = 0.28867513459481288;  // 1/√12: exact for cubics

// e^(−D)·q with D of degree 4 and q of degree 7: the rule integrates the powers D⁰, D¹, D² exactly (degree 15). D³/3!
// is left, 4e-5 of the light, of degree at most 19: its remainder is below 1e-9 of that (that of t¹⁶ is 4e-10).
constexpr double largest_depth = 1.0 / 16;

// The places that cut 0..1 into stretches, both ends included, ascending.
std::vector<double> cuts(const Cubic& s, const std::vector<double>& breakpoints) {
    std::vector<double> places{0.0}, turns = turning_points(s);
    turns.push_back(1.0);
    for (const double end : turns) {
        const double begin = places.back();
        const double low = std::min(s.at(begin), s.at(end)), high = std::max(s.at(begin), s.at(end));
        for (auto b = std::upper_bound(breakpoints.begin(), breakpoints.end(), low);
             b != breakpoints.end() && *b < high; ++b)
            places.push_back(place_of(s, *b, begin, end));
        places.push_back(end);
    }
    std::sort(places.begin(), places.end());
    return places;
}

double largest(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

// Where on the way through a homogeneous segment of that optical depth its light comes from in the mean, 0..1/2.
double mean_place(double depth) {
    if (depth > 0.5) return 1.0 / depth - 1.0 / std::expm1(depth);
    const double d2 = depth * depth;  // B₂ₖ/(2k)!: what is left out of the difference above, which cancels here, is below 3e-13
    return 0.5 - depth / 12.0 * (1.0 - d2 / 60.0 * (1.0 - d2 / 42.0 * (1.0 - d2 / 40.0 * (1.0 - d2 / 39.6))));
}

}  // namespace

double CubicLight::Stretch::extinction(double t) const {
    return piece->extinction(std::clamp(scalar.at(t), piece->begin, piece->end));
}

glm::dvec3 CubicLight::Stretch::color(double t) const {
    return piece->color(std::clamp(scalar.at(t), piece->begin, piece->end));
}

double CubicLight::Stretch::depth(double t) const {
    return 0.5 * t * length * (extinction(t * (0.5 - two_points_offset)) + extinction(t * (0.5 + two_points_offset)));
}

void CubicLight::add(const Cubic& scalar, double length, const ShareEnds& shares) {
    assert(length >= 0 && std::isfinite(length));
    assert(std::all_of(scalar.control.begin(), scalar.control.end(), [](double s) { return std::isfinite(s); }));
    if (length == 0 || opaque()) return;
    const auto& c = scalar.control;
    if (c[0] == c[1] && c[1] == c[2] && c[2] == c[3]) return add_constant(c[0], length, shares);
    const std::vector<double>& breakpoints = transfer_->breakpoints();
    const std::vector<double> places = cuts(scalar, breakpoints);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
        if (places[i] == places[i + 1]) continue;
        const double inside = scalar.at(0.5 * (places[i] + places[i + 1]));
        const auto piece = std::upper_bound(breakpoints.begin(), breakpoints.end(), inside) - breakpoints.begin();
        integrate({scalar.part(places[i], places[i + 1]), &transfer_->pieces()[static_cast<std::size_t>(piece)],
                   length * (places[i + 1] - places[i]), shares.part(places[i], places[i + 1])});
    }
}

// On a breakpoint the function's own value counts, as everywhere.
void CubicLight::add_constant(double scalar, double length, const ShareEnds& shares) {
    const double depth = transfer_->extinction(scalar) * length;
    const double mean = depth > 0 ? -std::expm1(-depth) / depth : 1.0;  // transmittance along the segment
    color_ += shares.at(mean_place(depth)) * transfer_->emission(scalar) * (length * mean * std::exp(-depth_));
    depth_ += depth;
}

void CubicLight::integrate(const Stretch& stretch) {
    if (opaque()) return;
    const double depth = stretch.depth(1.0), length = stretch.length;
    const double transmittance = std::exp(-depth_);
    const bool density = transfer_->model() == OpticalModel::density;
    // Colour and extinction are monotonic on the stretch: their largest values are at its ends.
    const double brightest = largest(glm::max(stretch.color(0.0), stretch.color(1.0)) * glm::max(stretch.shares.front, stretch.shares.back)) *
                             (density ? std::max(stretch.extinction(0.0), stretch.extinction(1.0)) : 1.0);
    const bool dark = brightest == 0 || (depth_ > dark_depth && transmittance * brightest * length < negligible);
    if (!dark && depth > largest_depth) {  // ends: the depth is finite and the length halves
        integrate({stretch.scalar.part(0.0, 0.5), stretch.piece, 0.5 * length, stretch.shares.part(0.0, 0.5)});
        integrate({stretch.scalar.part(0.5, 1.0), stretch.piece, 0.5 * length, stretch.shares.part(0.5, 1.0)});
        return;
    }
    if (!dark) {
        for (const GaussPair& pair : eight_points) {
            for (const double t : {0.5 - pair.offset, 0.5 + pair.offset}) {
                const double rate = density ? stretch.extinction(t) : 1.0;
                color_ +=
                    stretch.shares.at(t) * stretch.color(t) * (rate * pair.weight * length * transmittance * std::exp(-stretch.depth(t)));
            }
        }
    }
    depth_ += depth;
}

void CubicLight::add(const Light& surface) {
    assert(surface.opacity >= 0 && surface.opacity <= 1);
    if (opaque()) return;
    color_ += surface.color * std::exp(-depth_);
    depth_ -= std::log1p(-surface.opacity);
}

Light CubicLight::light() const {
    return {color_, -std::expm1(-depth_)};
}

}  // namespace cellproj
