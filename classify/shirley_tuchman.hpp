// SPDX-License-Identifier: BSD-3-Clause
//
// The light that Shirley and Tuchman (1990) give the thick vertex: the colour is the mean of both ends', the opacity
// 1 − exp(−τ̄·l) with τ̄ the mean of both ends' extinctions. Private to classify/.
#pragma once

#include "classify/segment_method.hpp"
#include "classify/vertex_light.hpp"

namespace cellproj {

class ShirleyTuchman : public SegmentMethod {
public:
    explicit ShirleyTuchman(TransferFunction transfer) : transfer_(std::move(transfer)) {}

    Light light(double s_f, double s_b, double length) const override { return at(s_f, s_b, length).light(); }
    std::size_t table_bytes() const override { return 0; }

    // density: colour κ, weight = opacity. emitter: colour q, weight = l·φ(τ̄l), the way that shines through, so that
    // light without extinction is kept as well.
    VertexLight at(double s_f, double s_b, double length) const;
    // κ or q of the scalar, which is clamped to 0..1.
    glm::dvec3 color(double s) const;

private:
    TransferFunction transfer_;
};

}  // namespace cellproj
