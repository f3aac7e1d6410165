// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/cubic.hpp"

#include <algorithm>
#include <cmath>

namespace cellproj {

namespace {

// De Casteljau's construction with a parameter for each of its three rounds.
double blossom(const Cubic& cubic, const std::array<double, 3>& t) {
    std::array<double, 4> p = cubic.control;
    for (std::size_t round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i + round < 3; ++i)
            p[i] = (1.0 - t[round]) * p[i] + t[round] * p[i + 1];
    }
    return p[0];
}

}  // namespace

double Cubic::at(double t) const {
    return blossom(*this, {t, t, t});
}

Cubic Cubic::part(double begin, double end) const {
    return {{at(begin), blossom(*this, {begin, begin, end}), blossom(*this, {begin, end, end}), at(end)}};
}

// Of the derivative, 3 times the quadratic with control points d; over the largest of them, so that no square leaves float64's range.
std::vector<double> turning_points(const Cubic& scalar) {
    const auto& c = scalar.control;
    double d0 = c[1] - c[0], d1 = c[2] - c[1], d2 = c[3] - c[2];
    const double largest = std::max({std::abs(d0), std::abs(d1), std::abs(d2)});
    std::vector<double> roots;
    if (!(largest > 0)) return roots;
    d0 /= largest;
    d1 /= largest;
    d2 /= largest;
    const double a = (d2 - d1) - (d1 - d0), half_b = d1 - d0;
    const double discriminant = half_b * half_b - a * d0;
    if (!(discriminant >= 0)) return roots;
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    for (const double root : {a != 0 ? q / a : -1.0, q != 0 ? d0 / q : -1.0}) {
        if (root > 0 && root < 1) roots.push_back(root);
    }
    std::sort(roots.begin(), roots.end());
    return roots;
}

double place_of(const Cubic& scalar, double value, double begin, double end) {
    const bool rises = scalar.at(begin) < scalar.at(end);
    for (;;) {
        const double middle = 0.5 * (begin + end);
        if (middle <= begin || middle >= end) return middle;
        ((scalar.at(middle) < value) == rises ? begin : end) = middle;
    }
}

std::vector<IsoCrossing> crossings(const IsoSurfaces& surfaces, const Cubic& scalar) {
    std::vector<IsoCrossing> found;
    const auto [low, high] = std::minmax_element(scalar.control.begin(), scalar.control.end());
    if (surfaces.crossings(*low, *high).empty()) return found;
    std::vector<double> ends = turning_points(scalar);
    ends.push_back(1.0);
    double begin = 0.0;
    for (const double end : ends) {
        const IsoCrossings inside = surfaces.crossings(scalar.at(begin), scalar.at(end));
        for (std::size_t i = 0; i < inside.size(); ++i) {
            const double t = place_of(scalar, surfaces.surfaces()[inside[i].surface].value, begin, end);
            // Where a part is flat, rounding may put the next surface before this one.
            found.push_back({inside[i].surface, found.empty() ? t : std::max(t, found.back().t), inside[i].rising});
        }
        begin = end;
    }
    return found;
}

}  // namespace cellproj
