// SPDX-License-Identifier: BSD-3-Clause
//
// The way of a ray segment through the transfer function, and the integral of EKE01 Eq. 5 along it. Private to
// classify/: the exact integral and the pre-integration table differ only in the quadrature rule they hand in.
//
// A segment is cut at the breakpoints into stretches, on which colour c and extinction τ are linear in t = 0..1. So a
// stretch of length λ contributes A·c(0) + B·c(1), with weights that depend on τ alone:
//
//   B = λ ∫₀¹ t f(t) e^(−D(t)) dt,   A + B = λ ∫₀¹ f(t) e^(−D(t)) dt,   f = τ (density) or 1 (emitter),   D(t) = λ ∫₀ᵗ
//   τ
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>

#include "classify/transfer_function.hpp"

namespace cellproj {

// A part of a segment inside one piece of the transfer function, from front to back.
struct Stretch {
    double share;  // of the segment's length, > 0
    glm::dvec3 color_front, color_back;
    double extinction_front, extinction_back;

    double mean_extinction() const { return 0.5 * (extinction_front + extinction_back); }

    // Upper bound of the emission q, over all channels.
    double max_emission(OpticalModel model) const {
        const glm::dvec3 c = glm::max(color_front, color_back);
        const double color = std::max({c.x, c.y, c.z});
        return model == OpticalModel::density ? color * std::max(extinction_front, extinction_back) : color;
    }
};

// Calls visit(stretch) for each stretch from s_f to s_b, front to back. s_f ≠ s_b. O(log nodes + stretches).
template <class Visit>
void for_each_stretch(const TransferFunction& transfer, double s_f, double s_b, Visit visit) {
    const double low = std::min(s_f, s_b), high = std::max(s_f, s_b);
    const auto& cuts = transfer.breakpoints();
    const auto first = std::upper_bound(cuts.begin(), cuts.end(), low) - cuts.begin();
    const auto last = std::lower_bound(cuts.begin(), cuts.end(), high) - cuts.begin();
    const bool rising = s_f < s_b;
    const std::ptrdiff_t step = rising ? 1 : -1;
    for (std::ptrdiff_t i = rising ? first : last; i >= first && i <= last; i += step) {
        const LinearPiece& piece = transfer.pieces()[static_cast<std::size_t>(i)];
        const double begin = std::max(piece.begin, low), end = std::min(piece.end, high);
        const double front = rising ? begin : end, back = rising ? end : begin;
        visit(Stretch{(end - begin) / (high - low), piece.color(front), piece.color(back), piece.extinction(front),
                      piece.extinction(back)});
    }
}

// A Gauss–Legendre rule on 0..1 (Abramowitz and Stegun, Table 25.4), and the optical depth that it is trusted with at
// once.
template <std::size_t N>
struct DepthRule {
    double max_depth;
    std::array<double, N> position, weight;
};

// Errors found by computing ∫ τ e^(−D) dx for all linear τ of depth max_depth, where 1 − e^(−D) is known: 4e-16.
inline constexpr DepthRule<8> precise_rule{
    0.5,
    {0.01985507175123188, 0.10166676129318664, 0.23723379504183550, 0.40828267875217511, 0.59171732124782490,
     0.76276620495816450, 0.89833323870681336, 0.98014492824876812},
    {0.05061426814518813, 0.11119051722668724, 0.15685332293894364, 0.18134189168918099, 0.18134189168918099,
     0.15685332293894364, 0.11119051722668724, 0.05061426814518813}};
// Likewise: 3e-7 each, of the order of float32. Most stretches of a table are shallow.
inline constexpr DepthRule<4> shallow_table_rule{
    0.5,
    {0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629},
    {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693}};
inline constexpr DepthRule<6> table_rule{2.0,
                                         {0.03376524289842399, 0.16939530676686774, 0.38069040695840155,
                                          0.61930959304159845, 0.83060469323313226, 0.96623475710157601},
                                         {0.08566224618958517, 0.18038078652406930, 0.23395696728634552,
                                          0.23395696728634552, 0.18038078652406930, 0.08566224618958517}};

struct EndWeights {
    double front = 0.0, back = 0.0;
};

// The weights A, B of a stretch of length λ = `length` behind optical depth `depth_before`. The stretch is walked in
// steps of equal optical depth down to `deepest`: so an optical depth of 1e8 costs no more than `deepest`.
template <std::size_t N>
EndWeights end_weights(const Stretch& stretch, OpticalModel model, double length, double depth_before, double deepest,
                       const DepthRule<N>& rule) {
    const double mean = stretch.mean_extinction();
    const double depth = mean * length;
    // D(t) = depth·(slope_front·t + bend·t²), slope_front = τ(0)/τ̄, bend = (τ(1) − τ(0))/2τ̄; relative to τ̄ nothing
    // overflows.
    const double slope_front = mean > 0.0 ? stretch.extinction_front / mean : 1.0;
    const double bend = mean > 0.0 ? (stretch.extinction_back - stretch.extinction_front) / (2.0 * mean) : 0.0;
    const double steps = std::max(1.0, std::ceil(depth / rule.max_depth));

    EndWeights weights;
    double begin = 0.0;
    for (double step = 0.0; step < steps && begin < 1.0; ++step) {
        const double depth_at_begin = depth_before + depth * (step / steps);
        if (depth_at_begin >= deepest) break;
        // The smaller root of slope_front·t + bend·t² = r, in the form that does not cancel.
        const double r = (step + 1.0) / steps;
        const double root = std::sqrt(std::max(0.0, slope_front * slope_front + 4.0 * bend * r));
        const double end = step + 1.0 >= steps ? 1.0 : std::min(1.0, 2.0 * r / (slope_front + root));
        const double width = end - begin;
        const double slope = std::max(0.0, slope_front + 2.0 * bend * begin);
        for (std::size_t k = 0; k < N; ++k) {
            const double h = width * rule.position[k];
            const double t = begin + h;
            const double tau = stretch.extinction_front * (1.0 - t) + stretch.extinction_back * t;
            const double f = model == OpticalModel::density ? tau : 1.0;
            const double local_depth = std::max(0.0, depth * h * (slope + bend * h));
            const double light = std::exp(-(depth_at_begin + local_depth)) * f * (length * width * rule.weight[k]);
            weights.front += light * (1.0 - t);
            weights.back += light * t;
        }
        begin = end;
    }
    return weights;
}

}  // namespace cellproj
