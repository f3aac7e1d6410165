// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/ray_light.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>

#include "render/judge/ray_quadrature.hpp"

namespace cellproj {

namespace {

constexpr std::array<GaussPair, 2> four_points{
    {{0.16999052179242813, 0.32607257743127307}, {0.43056815579702629, 0.17392742256872693}}};

// e^(−D) times a cubic, relative error: D⁷/7! · 4e-10 for eight points, D³/3! · 2e-5 for four (the remainder f⁽²ⁿ⁾ of the
// first power of D that the rule does not integrate exactly; D itself is quadratic). 5e-16 and 2e-13.
constexpr double eight_points_depth = 0.5, four_points_depth = 1.0 / 256;

using Weights = std::array<double, 4>;

// ∫₀¹ Bᵢ(x) e^(−D(x)) dx for the four Bernstein polynomials of degree 3.
template <std::size_t N>
Weights bernstein_weights(double length, const double (&extinction)[2], const std::array<GaussPair, N>& rule) {
    Weights sum{};
    for (const GaussPair& pair : rule) {
        for (const double x : {0.5 - pair.offset, 0.5 + pair.offset}) {
            const double depth = length * x * (extinction[0] * (1.0 - 0.5 * x) + extinction[1] * 0.5 * x);
            const double light = pair.weight * std::exp(-depth);
            const double y = 1.0 - x;
            sum[0] += light * y * y * y;
            sum[1] += light * 3.0 * x * y * y;
            sum[2] += light * 3.0 * x * x * y;
            sum[3] += light * x * x * x;
        }
    }
    return sum;
}

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

RayLight::Walk::Walk(const TransferFunction& transfer, const ScalarEnds& ends)
    : transfer_(&transfer), ends_(ends), scalar_(ends.front) {
    assert(std::isfinite(ends.front) && std::isfinite(ends.back));
    const auto& cuts = transfer.breakpoints();
    // A scalar on a breakpoint begins in the piece that it is about to walk through, and ends in the one it came from.
    const auto behind = [&](double s) {
        return static_cast<std::size_t>(std::upper_bound(cuts.begin(), cuts.end(), s) - cuts.begin());
    };
    const auto before = [&](double s) {
        return static_cast<std::size_t>(std::lower_bound(cuts.begin(), cuts.end(), s) - cuts.begin());
    };
    const bool falling = ends.back < ends.front;
    piece_ = falling ? before(ends.front) : behind(ends.front);
    last_ = falling ? behind(ends.back) : ends.front == ends.back ? piece_ : before(ends.back);
}

double RayLight::Walk::exit_scalar() const {
    if (piece_ == last_) return ends_.back;
    const LinearPiece& piece = transfer_->pieces()[piece_];
    return piece_ < last_ ? piece.end : piece.begin;
}

double RayLight::Walk::next_cut() const {
    return piece_ == last_ ? 1.0 : (exit_scalar() - ends_.front) / (ends_.back - ends_.front);
}

RayLight::Walk::Step RayLight::Walk::advance(double share) {
    const LinearPiece& piece = transfer_->pieces()[piece_];
    const bool leaves = share >= next_cut();
    // A cut of another medium: rounding must not carry this one out of its piece.
    const double end =
        leaves ? exit_scalar() : std::clamp(ends_.front * (1.0 - share) + ends_.back * share, piece.begin, piece.end);
    const bool constant = ends_.front == ends_.back;  // on a breakpoint, the function's own value counts
    const Step step{constant ? 1.0 : (end - scalar_) / (ends_.back - ends_.front),
                    {constant ? transfer_->extinction(end) : piece.extinction(scalar_),
                     constant ? transfer_->extinction(end) : piece.extinction(end)},
                    {constant ? transfer_->color(end) : piece.color(scalar_),
                     constant ? transfer_->color(end) : piece.color(end)}};
    scalar_ = end;
    if (leaves) {
        done_ = piece_ == last_;
        if (piece_ != last_) piece_ = piece_ < last_ ? piece_ + 1 : piece_ - 1;
    }
    return step;
}

// One more medium on a stretch.
void RayLight::superpose(const glm::dvec3 (&color)[2], const double (&tau)[2], const ShareEnds& shares, Stretch& sum) const {
    for (int side : {0, 1})
        sum.extinction[side] += tau[side];
    // q as a quadratic, then times what is linear.
    const bool density = transfer_->model() == OpticalModel::density;
    const glm::dvec3 front = density ? color[0] * tau[0] : color[0], back = density ? color[1] * tau[1] : color[1];
    const glm::dvec3 middle = 0.5 * (density ? color[0] * tau[1] + color[1] * tau[0] : color[0] + color[1]);
    sum.emission[0] += shares.front * front;
    sum.emission[1] += (2.0 * shares.front * middle + shares.back * front) / 3.0;
    sum.emission[2] += (2.0 * shares.back * middle + shares.front * back) / 3.0;
    sum.emission[3] += shares.back * back;
}

void RayLight::add(std::span<const ScalarEnds> media, std::span<const ScalarEnds> opacity, double length, std::span<const ShareEnds> shares) {
    assert(length >= 0 && std::isfinite(length) && (opacity.empty() || opacity.size() == media.size()) &&
           (shares.empty() || shares.size() == media.size()));
    if (media.empty() || length == 0 || opaque()) return;
    walks_.clear();
    opacity_walks_.clear();
    for (const ScalarEnds& ends : media)
        walks_.emplace_back(*transfer_, ends);
    for (const ScalarEnds& ends : opacity)
        opacity_walks_.emplace_back(*transfer_, ends);
    const auto goes_on = [](const Walk& walk) { return !walk.done(); };
    double begin = 0;
    while (std::ranges::any_of(walks_, goes_on) || std::ranges::any_of(opacity_walks_, goes_on)) {
        double end = 1;
        for (const Walk& walk : walks_)
            end = std::min(end, walk.next_cut());
        for (const Walk& walk : opacity_walks_)
            end = std::min(end, walk.next_cut());
        Stretch stretch{};
        double walked = 0;
        for (std::size_t i = 0; i < walks_.size(); ++i) {
            const Walk::Step step = walks_[i].advance(end);
            walked = step.walked;
            ShareEnds here{glm::dvec3(1), glm::dvec3(1)};
            if (!shares.empty()) here = {glm::mix(shares[i].front, shares[i].back, begin), glm::mix(shares[i].front, shares[i].back, end)};
            if (opacity_walks_.empty()) {
                superpose(step.color, step.extinction, here, stretch);
            } else {
                superpose(step.color, opacity_walks_[i].advance(end).extinction, here, stretch);
            }
        }
        // The scalar tells the share of a single medium with all digits, even between nodes one ulp apart.
        stretch.length = length * (walks_.size() == 1 && opacity_walks_.empty() ? walked : end - begin);
        integrate(stretch);
        begin = end;
    }
}

void RayLight::add(const Light& surface) {
    assert(surface.opacity >= 0 && surface.opacity <= 1);
    if (opaque()) return;
    color_ += std::exp(-depth_) * surface.color;
    depth_ -= std::log1p(-surface.opacity);
}

void RayLight::integrate(const Stretch& stretch) {
    const double depth = stretch.depth();
    const double transmittance = std::exp(-depth_);
    const auto& q = stretch.emission;
    const double brightest = std::max({largest(q[0]), largest(q[1]), largest(q[2]), largest(q[3])});
    const bool dark =
        brightest == 0 || opaque() || (depth_ > dark_depth && transmittance * brightest * stretch.length < negligible);
    if (!dark && depth > eight_points_depth) {
        const double tau = 0.5 * (stretch.extinction[0] + stretch.extinction[1]);
        const glm::dvec3 a = 0.5 * (q[0] + q[1]), b = 0.5 * (q[1] + q[2]), c = 0.5 * (q[2] + q[3]);  // de Casteljau
        const glm::dvec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), middle = 0.5 * (ab + bc);
        integrate({0.5 * stretch.length, {stretch.extinction[0], tau}, {q[0], a, ab, middle}});
        integrate({0.5 * stretch.length, {tau, stretch.extinction[1]}, {middle, bc, c, q[3]}});
        return;
    }
    if (!dark) {
        const Weights w = depth <= four_points_depth ? bernstein_weights(stretch.length, stretch.extinction, four_points)
                                                     : bernstein_weights(stretch.length, stretch.extinction, eight_points);
        color_ += (transmittance * stretch.length) * (w[0] * q[0] + w[1] * q[1] + w[2] * q[2] + w[3] * q[3]);
    }
    depth_ += depth;
}

Light RayLight::light() const { return {color_, -std::expm1(-depth_)}; }

}  // namespace cellproj
