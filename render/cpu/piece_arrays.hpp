// SPDX-License-Identifier: BSD-3-Clause
//
// A piece table (classify/piece_table.hpp) as one array per quantity, which is how SIMD lanes read it.
#pragma once

#include <cstdint>
#include <vector>

#include "classify/piece_table.hpp"

namespace cellproj::cpu {

struct PieceArrays {
    PieceArrays(const Method& method, const PieceTable& table, const WalkLimits& limits);

    bool density;
    std::int32_t count;  // pieces
    WalkLimits limits;
    float three_point_depth;  // up to which optical depth three points of a Gauss rule serve a part
    bool mean_place;          // shallow parts may take the colour at their mean place (segment_light-inl.hpp)
    float bin_count;
    // Of each piece (classify/piece_table.hpp): scalar at its begin and its end, 1/width, τ and colour at both. These lists and those below
    // are filled up to whole vectors: `begin` with 1e30, others with 0.
    std::vector<float> begin, end, inverse_width;
    std::vector<float> extinction[2], color[2][3];
    // ∫ q ds and ∫ τ ds up to its begin: rounded, and what rounding lost.
    std::vector<float> running[4], lost[4];
    // First and last piece of each of bin_count + 1 bins of the scalars.
    std::vector<std::int32_t> first, last;
};

}  // namespace cellproj::cpu
