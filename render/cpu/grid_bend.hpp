// SPDX-License-Identifier: BSD-3-Clause
//
// How finely the CPU renderer cuts the cubics of regular grids into lines (grid_kernels.hpp).
#pragma once

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj::cpu {

// How far a cell's scalar may stay away from straight lines, `transfer` in scene units: by the tolerance of `exact`; as far as it likes
// by other methods, which take one line from face to face.
float bend_of(const Method& method, const TransferFunction& transfer);

}  // namespace cellproj::cpu
