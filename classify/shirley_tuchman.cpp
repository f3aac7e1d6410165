// SPDX-License-Identifier: BSD-3-Clause
#include "classify/shirley_tuchman.hpp"

#include <algorithm>
#include <glm/common.hpp>

#include "classify/optics.hpp"

namespace cellproj {

VertexLight ShirleyTuchman::at(double s_f, double s_b, double length) const {
    const double front = std::clamp(s_f, 0.0, 1.0), back = std::clamp(s_b, 0.0, 1.0);
    const double depth = (transfer_.extinction(front) + transfer_.extinction(back)) / 2 * length;
    const double opacity = opacity_of_depth(depth);
    const double weight = transfer_.model() == OpticalModel::density ? opacity : length * mean_transmittance(depth);
    return {(transfer_.color(front) + transfer_.color(back)) / 2.0, weight, opacity};
}

glm::dvec3 ShirleyTuchman::color(double s) const {
    return transfer_.color(std::clamp(s, 0.0, 1.0));
}

}  // namespace cellproj
