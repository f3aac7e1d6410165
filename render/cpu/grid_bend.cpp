// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/grid_bend.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/cpu/classification.hpp"

namespace cellproj::cpu {

namespace {

// The share of a ray's length that lines with a node of the transfer function inside may make up. All other lines have
// the right optical depth, as they have the cubic's mean (grid_walk-inl.hpp).
constexpr double share_at_nodes = 0.1;

// How far scalars may stay away from the true ones, in a unit of their range, so that a ray's light is within
// `tolerance`: with |τ'| and |q'| at most L, |∫ τ(s) − τ(s + δ)| ≤ L·δ·length, likewise for q. A step of the function
// has no such L: where a ray only just reaches it, the length behind it goes with √δ. There δ is a hundredth of the
// tolerance, which most often cuts a cell as finely as it can be.
double bend_within(double tolerance, const TransferFunction& transfer) {
    double steepest = 0, step = 0;
    const std::vector<LinearPiece>& pieces = transfer.pieces();
    const bool density = transfer.model() == OpticalModel::density;
    const auto most = [](const glm::dvec3& c) { return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}); };
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const LinearPiece& p = pieces[i];
        const double thickest = density ? std::max(p.extinction_begin, p.extinction_end) : 1.0;
        const double change = std::abs(p.extinction_end - p.extinction_begin);
        const double color_change = most(p.color_end - p.color_begin) * thickest +
                                    (density ? std::max(most(p.color_begin), most(p.color_end)) * change : 0.0);
        if (std::isfinite(p.begin) && std::isfinite(p.end)) steepest = std::max(steepest, std::max(change, color_change) / (p.end - p.begin));
        if (i == 0) continue;
        const LinearPiece& before = pieces[i - 1];
        step = std::max({step, std::abs(p.extinction_begin - before.extinction_end), most(p.color_begin - before.color_end)});
    }
    const double within = steepest > 0 ? tolerance / (share_at_nodes * longest_segment * steepest) : std::numeric_limits<double>::infinity();
    return step > 0 ? std::min(within, 0.01 * tolerance) : within;
}

}  // namespace

float bend_of(const Method& method, const TransferFunction& transfer) {
    constexpr double most = std::numeric_limits<float>::max();
    return static_cast<float>(method.kind == MethodKind::exact ? std::min(bend_within(method.tolerance, transfer), most) : most);
}

}  // namespace cellproj::cpu
