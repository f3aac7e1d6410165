// SPDX-License-Identifier: BSD-3-Clause
//
// The light of one ray, interval by interval from front to back, in float64. Shares no code with the integrals and tables of
// classify/, which it judges: of the transfer function it uses only the nodes.
//
// Along the ray RKE00 Eq. 1 holds, C = ∫ q(x)·exp(−∫₀ˣ τ) dx and opacity = 1 − exp(−∫ τ). Where several cells lie in one place
// their media are superposed, as those of two gases would be: q and τ are the sums of theirs. The result depends neither on
// the order nor on the number of the cells that a medium is cut into.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"

namespace cellproj {

// The scalar of one cell at both ends of an interval, linear in between.
struct ScalarEnds {
    double front, back;
};

// What of its light the medium of a cell sends to the eye, by channel, at both ends of an interval, linear in between (EKE01 §5.4).
struct ShareEnds {
    glm::dvec3 front, back;  // ≥ 0

    glm::dvec3 at(double t) const { return (1.0 - t) * front + t * back; }
    ShareEnds part(double begin, double end) const { return {at(begin), at(end)}; }
};
inline constexpr ShareEnds whole_share{glm::dvec3(1.0), glm::dvec3(1.0)};  // all of it

// An interval is cut where the scalar of any medium meets a breakpoint of the transfer function. On such a stretch τ is linear
// and q cubic; they are kept as Bézier control points, none of them negative, so that halving a stretch cancels nothing.
// It is halved until its optical depth is at most 1/2, where an eight-point Gauss–Legendre rule is exact to 1e-15; the depth
// itself is a closed form. Behind a depth of 40 a stretch is left out when it cannot add 1e-16 to a channel. Colour and
// opacity are right to 1e-12 absolute for colours within 0..1, in tests/ray_light_test.cpp. One ray, one thread.
class RayLight {
public:
    // The transfer function must outlive this.
    explicit RayLight(const TransferFunction& transfer) : transfer_(&transfer) {}

    // The next interval of the ray, farther from the eye than all before: `length` ≥ 0 [mesh units], one pair of finite
    // scalars, |s| ≤ 1e150, for each cell there. No cell: empty space.
    void add(std::span<const ScalarEnds> media, double length) { add(media, {}, length); }
    // The same where colour is a function of one scalar and extinction of another: as many `opacity` as `media`, in their order, or
    // none where both are functions of one. `shares`: likewise, of media that are lit; none: they send all of their light.
    void add(std::span<const ScalarEnds> media, std::span<const ScalarEnds> opacity, double length, std::span<const ShareEnds> shares = {});

    // A surface without thickness, farther than all before: associated, opacity 0..1.
    void add(const Light& surface);

    // Nothing farther can be seen: the transmittance is 0 in float64.
    bool opaque() const { return depth_ > 746.0; }
    double depth() const { return depth_; }  // optical depth so far; infinite behind an opaque surface
    Light light() const;                     // associated

private:
    struct Stretch {
        double length;
        double extinction[2];    // at the ends
        glm::dvec3 emission[4];  // Bézier control points

        double depth() const { return 0.5 * (extinction[0] + extinction[1]) * length; }
    };

    // One scalar's way through the pieces of the transfer function.
    class Walk {
    public:
        Walk(const TransferFunction& transfer, const ScalarEnds& ends);

        bool done() const { return done_; }
        // Where it leaves its piece, as a share of the interval.
        double next_cut() const;
        // Goes from where it is up to `share` of the interval.
        struct Step {
            double walked;  // share of the interval
            double extinction[2];
            glm::dvec3 color[2];
        };
        Step advance(double share);

    private:
        double exit_scalar() const;

        const TransferFunction* transfer_;
        ScalarEnds ends_;
        double scalar_;             // where it is
        std::size_t piece_, last_;  // of transfer_->pieces()
        bool done_ = false;
    };

    void superpose(const glm::dvec3 (&color)[2], const double (&extinction)[2], const ShareEnds& shares, Stretch& sum) const;
    void integrate(const Stretch& stretch);

    const TransferFunction* transfer_;
    glm::dvec3 color_{0.0};
    double depth_ = 0.0;
    std::vector<Walk> walks_, opacity_walks_;  // of the interval in hand; kept for their memory
};

}  // namespace cellproj
