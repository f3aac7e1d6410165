// SPDX-License-Identifier: BSD-3-Clause
//
// The functions of optical depth D ≥ 0 that every form of the segment integral shares, free of cancellation. Private to
// classify/.
#pragma once

#include <cmath>

#include "classify/transfer_function.hpp"

namespace cellproj {

// 1 − e^(−D), the opacity of optical depth D: RKE00 Eq. 1, EKE01 Eq. 6.
inline double opacity_of_depth(double depth) {
    return -std::expm1(-depth);
}

// φ(D) = (1 − e^(−D))/D, the mean transmittance along a homogeneous path: 1 at D = 0, 1/D for D → ∞.
inline double mean_transmittance(double depth) {
    return depth > 0.0 ? opacity_of_depth(depth) / depth : 1.0;
}

// Light of a homogeneous segment (WVG91's exponential integration): emission · l · φ(τ l), 1 − e^(−τ l).
inline Light homogeneous_light(const glm::dvec3& emission, double extinction, double length) {
    const double depth = extinction * length;
    return {emission * (length * mean_transmittance(depth)), opacity_of_depth(depth)};
}

}  // namespace cellproj
