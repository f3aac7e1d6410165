// SPDX-License-Identifier: BSD-3-Clause
//
// WVG91 §3.2: a cell of colour C (= emission · length, not attenuated by itself) and opacity α is drawn in three passes:
// attenuate what is behind by half of the opacity, add the colour, attenuate everything by the other half. On what is
// already there, I,
//
//   ((I·(1 − α/2)) + C)·(1 − α/2) = I·(1 − α/2)² + C·(1 − α/2)
//
// which is one blending with colour C·(1 − α/2) and opacity 1 − (1 − α/2)² = α·(1 − α/4).
//
// With C·D, for a homogeneous cell of optical depth D ≤ 1 and unit chromaticity: colour D·(1 − D/2), where
// 1 − e^(−D) = D·(1 − D/2 + D²/6 − …) is right. So the colour is right to second order, error −D³/6, where one pass has
// +D²/2; the opacity has D²/4, half of the error of one pass. The two do not match: an opaque stack of such cells shows
// (1 − D/2)/(1 − D/4) of its colour, where C·D shows all of it.
#pragma once

#include "classify/transfer_function.hpp"

namespace cellproj {

inline Light half_opacity(const Light& cell) {
    return {cell.color * (1.0 - cell.opacity / 2.0), cell.opacity * (1.0 - cell.opacity / 4.0)};
}

}  // namespace cellproj
