// SPDX-License-Identifier: BSD-3-Clause
//
// The light of one ray through cells of a regular grid, segment by segment from front to back, in float64 (cubic.hpp). As
// ray_light.hpp, it uses only the nodes of the transfer function and shares no code with the integrals and tables that
// it judges.
#pragma once

#include "classify/transfer_function.hpp"
#include "render/judge/cubic.hpp"
#include "render/judge/ray_light.hpp"

namespace cellproj {

// RKE00 Eq. 1 along the ray. A segment is cut where the scalar turns back and where it meets a breakpoint of the
// transfer function. On such a stretch q and τ are polynomials in t, of degree at most 6 and 3 (7 where the medium is lit, by
// a share that is linear); it is halved until its optical depth is at most 1/16, where an eight-point Gauss–Legendre rule is
// exact to 1e-15; the depth itself is exact (two points). Behind a depth of 40 a stretch is left out when it cannot add 1e-16 to a channel. Accuracy: 1e-12
// absolute for colours within 0..1, besides what it changes to move the scalars by some units in their last place
// (tests/grid_reference_test.cpp).
class CubicLight {
public:
    // The transfer function must outlive this.
    explicit CubicLight(const TransferFunction& transfer) : transfer_(&transfer) {}

    // The next segment, farther from the eye than all before: `length` ≥ 0 [mesh units], control points finite, |s| ≤
    // 1e150. `shares`: of a medium that is lit.
    void add(const Cubic& scalar, double length, const ShareEnds& shares = whole_share);

    // A surface without thickness, farther than all before: associated, opacity 0..1.
    void add(const Light& surface);

    // Nothing farther can be seen: the transmittance is 0 in float64.
    bool opaque() const { return depth_ > 746.0; }
    Light light() const;  // associated

private:
    // A part of a segment, with a parameter of its own from 0 to 1, on which the scalar is monotonic and stays in one
    // piece of the transfer function.
    struct Stretch {
        Cubic scalar;
        const LinearPiece* piece;
        double length;
        ShareEnds shares;

        double extinction(double t) const;
        glm::dvec3 color(double t) const;
        double depth(double t) const;  // from 0 to t
    };

    void add_constant(double scalar, double length, const ShareEnds& shares);
    void integrate(const Stretch& stretch);

    const TransferFunction* transfer_;
    glm::dvec3 color_{0.0};
    double depth_ = 0.0;
};

}  // namespace cellproj
