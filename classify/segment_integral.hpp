// SPDX-License-Identifier: BSD-3-Clause
//
// The light of one ray segment inside a cell, to convergence, in float64: the measure for every faster form.
//
// With s(x) = s_f + (s_b − s_f)·x/l for 0 ≤ x ≤ l, RKE00 Eq. 1 and EKE01 Eq. 5–7 read
//
//   opacity = 1 − exp(−∫₀ˡ τ(s(x)) dx),   colour = ∫₀ˡ q(s(x)) · exp(−∫₀ˣ τ(s(t)) dt) dx
#pragma once

#include "classify/transfer_function.hpp"

namespace cellproj {

// Mean of τ over the scalars between s_f and s_b: the extinction that a segment between them has per length. Exact:
// float64 rounding only, down to |s_f − s_b| of one ulp; τ(s_f) when they are equal. |s_f|, |s_b| ≤ 1e150.
double mean_extinction(const TransferFunction& transfer, double s_f, double s_b);

// The segment is cut at the breakpoints of the transfer function, between which q and τ are polynomials, and again into
// parts of optical depth ≤ 1/2, where an eight-point Gauss–Legendre rule is exact to 1e-15 (opacity: exact in closed
// form). It stops where the transmittance, and what the rest can contribute to a colour channel, are both below the
// absolute `tolerance` ≥ 0. tests/segment_integral_test.cpp holds it to closed forms.
// 0 ≤ l ≤ 1e150 [mesh units], |s_f|, |s_b| ≤ 1e150, equal or in any order; l = 0 gives nothing. Optical depths to 1e8
// and beyond. Cost: O(log nodes + nodes between s_f and s_b), whatever the optical depth.
Light integrate_segment(const TransferFunction& transfer, double s_f, double s_b, double length,
                        double tolerance = 1e-10);

// `front` in front of `back`.
Light composite(const Light& front, const Light& back);

}  // namespace cellproj
