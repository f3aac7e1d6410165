// SPDX-License-Identifier: BSD-3-Clause
//
// A scalar along a segment of a ray through a regular grid, in float64: along a straight line a trilinear scalar is a cubic.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "classify/isosurface.hpp"

namespace cellproj {

// 0 ≤ t ≤ 1, by its Bézier control points: it stays between the smallest and the largest of them.
struct Cubic {
    std::array<double, 4> control;

    double at(double t) const;
    Cubic part(double begin, double end) const;  // the same curve from begin to end
};

// Where it turns back inside 0..1, ascending: at most two places, between which it is monotonic but for rounding.
std::vector<double> turning_points(const Cubic& scalar);

// Where the scalar, monotonic from `begin` to `end`, is `value`, which lies between its ends: halved to the last bit.
double place_of(const Cubic& scalar, double value, double begin, double end);

// The surfaces that it crosses from t = 0 to 1, in that order: all roots, one by one, by the rule of classify/isosurface.hpp from end to end
// of every monotonic part. So where one cubic ends with the very scalar with which the next one begins, surfaces are met exactly as often
// as the ray changes sides; where it touches an isovalue from below and turns back, twice in one place or never. `t` never falls.
std::vector<IsoCrossing> crossings(const IsoSurfaces& surfaces, const Cubic& scalar);

}  // namespace cellproj
