// SPDX-License-Identifier: BSD-3-Clause
//
// Where two transfer functions differ, so that a table is computed anew only there (EKE01 §3.5).
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "classify/transfer_function.hpp"

namespace cellproj {

// low ≤ s ≤ high.
struct ScalarInterval {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();

    // Whether it and the scalars between a and b (in any order) have one in common.
    bool meets(double a, double b) const { return std::min(a, b) <= high && std::max(a, b) >= low; }
};

// The smallest interval between nodes outside of which both functions have the same nodes, so that they and every
// integral of theirs are the same to the last bit; all scalars when the optical model or what holds outside differs;
// none when the functions are equal. O(nodes).
std::optional<ScalarInterval> changed_scalars(const TransferFunction& before, const TransferFunction& after);

}  // namespace cellproj
