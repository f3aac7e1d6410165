// SPDX-License-Identifier: BSD-3-Clause
//
// The transfer function as a list of its own pieces, in float32, for the methods `integral` and `exact`. It has no
// resolution: opacity is exact for any function, however narrow its peaks (EKE01 Eq. 8–10 with integrals that are
// exactly quadratic between nodes, instead of tables of N samples).
//
// A segment is walked piece by piece from s_f to s_b. In a piece, c and τ are linear, so the part of the segment in it
// has optical depth D = λ(τ₀ + τ₁)/2 exactly, and its light is a Gauss rule along it. Several whole pieces in a row are
// taken at once where they are thin (`integral` with many pieces): from running integrals of τ and q over s, whose
// difference gives the depth exactly and the light with the mean colour. So a thin segment over thousands of pieces costs
// little more than one over three.
//
// Scalars are 0..1 (scene units). Nodes are rounded down to float32, as fine as the renderers' scalars are; a piece
// that vanishes by it is left out, its step stays.
#pragma once

#include <cstddef>
#include <glm/vec4.hpp>
#include <vector>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"

namespace cellproj {

// Immutable once made. Texels are RGBA float32.
struct PieceTable {
    static constexpr std::size_t texels_per_piece = 5;

    OpticalModel model = OpticalModel::density;
    // #pieces by texels_per_piece by 4. The pieces cover 0..1 in ascending order; one more, from 1 to 2, holds the value at 1
    // itself. Texels of a piece:
    //   0  scalar at its begin, at its end, τ at its begin, at its end (limits from inside)
    //   1  colour at its begin, 0
    //   2  colour at its end, 0
    //   3  ∫ q ds (RGB) and ∫ τ ds from 0 to its begin, rounded to float32
    //   4  what that rounding lost, so that differences keep their digits behind strong pieces
    std::vector<float> pieces;
    // #bins + 1 by 4, #bins a power of two. Bin b holds the scalars from b/#bins up to (b + 1)/#bins, the last one 1
    // alone: (first piece, last piece, scalar at the begin of the one half-way between, (first + last + 1)/2, 0).
    std::vector<float> bins;

    std::size_t piece_count() const { return pieces.size() / (4 * texels_per_piece); }
    std::size_t bin_count() const { return bins.size() / 4 - 1; }
    std::size_t bytes() const { return (pieces.size() + bins.size()) * sizeof(float); }

    glm::dvec4 texel(std::size_t piece, std::size_t which) const;
    // The last piece that begins at or below s, 0 ≤ s ≤ 1.
    std::size_t piece_of(float s) const;
};

// `transfer` in scene units. Extinctions and colours above 1e15 count as 1e15, so that no product of theirs overflows.
// O(pieces): 20 nodes take microseconds.
PieceTable make_piece_table(const TransferFunction& transfer);

// How closely a segment is followed.
struct WalkLimits {
    double step_depth;   // optical depth up to which one Gauss rule serves a part of a piece, > 0
    double block_depth;  // optical depth up to which several whole pieces are taken at once; 0: never
    double deepest;      // optical depth behind which nothing is seen any more

    bool takes_blocks() const { return block_depth > 0.0; }
};

// Of `integral`: fixed, for errors of about 1e-4. Of `exact`: such that each source of error stays below a share of the
// tolerance, for the brightest colour of the table and segments up to `max_length` [scene units].
WalkLimits walk_limits(const Method& method, const PieceTable& table, double max_length);

// The light of a segment: what the shaders pieces_*.glsl compute in float32, here in float64 from the same table. s_f, s_b: 0..1,
// 0 ≤ length; none may be NaN. O(pieces between s_f and s_b), O(log pieces) for thin
// segments where blocks are taken.
Light walk_segment(const PieceTable& table, const WalkLimits& limits, double s_f, double s_b, double length);

}  // namespace cellproj
