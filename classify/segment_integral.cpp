// SPDX-License-Identifier: BSD-3-Clause
#include "classify/segment_integral.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "classify/optics.hpp"
#include "classify/segment_path.hpp"

namespace cellproj {

namespace {

constexpr double last_depth = 746.0;  // e^(−D) is 0 in float64 from here on

glm::dvec3 integrate_color(const TransferFunction& transfer, double s_f, double s_b, double length, double tolerance) {
    glm::dvec3 color(0.0);
    double depth = 0.0;
    for_each_stretch(transfer, s_f, s_b, [&](const Stretch& stretch) {
        const double stretch_length = length * stretch.share;
        const double brightest = stretch.max_emission(transfer.model());
        if (brightest > 0.0) {
            // What is left out of a stretch is below T·q_max·λ, so below the tolerance's share of it: all stretches
            // together leave out less than the tolerance. A thin segment, dark as a whole, is never left out: T must
            // have fallen, too.
            const double negligible = std::min(tolerance, tolerance / (brightest * length));
            const double deepest = std::min(-std::log(negligible), last_depth);
            const EndWeights weights =
                end_weights(stretch, transfer.model(), stretch_length, depth, deepest, precise_rule);
            color += stretch.color_front * weights.front + stretch.color_back * weights.back;
        }
        depth += stretch.mean_extinction() * stretch_length;
    });
    return color;
}

}  // namespace

double mean_extinction(const TransferFunction& transfer, double s_f, double s_b) {
    if (s_f == s_b) return transfer.extinction(s_f);
    const double low = std::min(s_f, s_b), high = std::max(s_f, s_b);
    // Nearer to each other than this, next to s = 0, the product of width and extinction would underflow.
    if (high - low < 1e-290) return 0.5 * (transfer.extinction(low) + transfer.extinction(high));
    return transfer.extinction_integral(low, high) / (high - low);
}

Light integrate_segment(const TransferFunction& transfer, double s_f, double s_b, double length, double tolerance) {
    assert(std::isfinite(s_f) && std::isfinite(s_b) && std::isfinite(length) && length >= 0.0 && tolerance >= 0.0);
    if (length == 0.0) return {};
    const double depth = mean_extinction(transfer, s_f, s_b) * length;
    if (s_f == s_b) return {transfer.emission(s_f) * (length * mean_transmittance(depth)), opacity_of_depth(depth)};
    return {integrate_color(transfer, s_f, s_b, length, tolerance), opacity_of_depth(depth)};
}

Light composite(const Light& front, const Light& back) {
    const double transmittance = 1.0 - front.opacity;
    return {front.color + transmittance * back.color, front.opacity + transmittance * back.opacity};
}

}  // namespace cellproj
