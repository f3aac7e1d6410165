// SPDX-License-Identifier: BSD-3-Clause
//
// What is measured, everywhere the same: a field in the unit cube, two transfer functions and the views. A smooth ramp is what samplers
// are best at; of six narrow peaks most cells that hold light hold a node.
#pragma once

#include <cmath>
#include <vector>

#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"
#include "project/camera.hpp"

namespace cellproj::scenes {

// 0..1 over the unit cube; curved, so that its isosurfaces cross cells in all directions.
inline double waves(const glm::dvec3& p) { return 0.5 + 0.25 * std::sin(9 * p.x) * std::cos(7 * p.y) + 0.25 * std::sin(5 * p.z); }

// Optical depth 0.4 .. 4 through `size` mesh units, for scalars low..high, low < high.
inline TransferFunction ramp(double low = 0, double high = 1, double size = 1) {
    return {OpticalModel::density, {{low, {0.1, 0.2, 0.9}}, {high, {1.0, 0.6, 0.0}}}, {{low, 0.4 / size}, {high, 4.0 / size}}};
}

// Six coloured tents of half width 0.01 of low..high, their tops of optical depth 20 through `size` mesh units; nothing between.
inline TransferFunction peaks(double low = 0, double high = 1, double size = 1) {
    const auto at = [&](double share) { return low + share * (high - low); };
    std::vector<ColorNode> colors;
    std::vector<ExtinctionNode> extinctions{{low, 0}};
    for (int i = 0; i < 6; ++i) {
        const double center = 0.12 + 0.15 * i;
        colors.push_back({at(center), {i % 3 == 0 ? 1.0 : 0.2, i % 3 == 1 ? 1.0 : 0.2, i % 3 == 2 ? 1.0 : 0.2}});
        extinctions.insert(extinctions.end(), {{at(center - 0.01), 0}, {at(center), 20 / size}, {at(center + 0.01), 0}});
    }
    extinctions.push_back({high, 0});
    return {OpticalModel::density, colors, extinctions};
}

// Six tents likewise over 0..1, in other places and colours: what the tables of the methods are judged by, in classify/README.md.
inline TransferFunction table_peaks() {
    std::vector<ColorNode> colors;
    std::vector<ExtinctionNode> extinctions{{0, 0}};
    for (int i = 0; i < 6; ++i) {
        const double center = 0.1 + 0.16 * i;
        colors.push_back({center, {i % 2 == 0 ? 1.0 : 0.2, 0.15 * i, i % 3 == 0 ? 1.0 : 0.1}});
        extinctions.insert(extinctions.end(), {{center - 0.01, 0}, {center, 20}, {center + 0.01, 0}});
    }
    return {OpticalModel::density, colors, extinctions};
}

// The i-th view, i ≥ 0: turned by 0.37 rad against the one before and tilted, so that no two are alike and none looks along an
// axis. The box fills the square picture.
inline Camera measured_view(int i, const Bounds& box = {glm::dvec3(0), glm::dvec3(1)},
                            Camera::Projection projection = Camera::Projection::perspective) {
    const double angle = 0.7 + 0.37 * i;
    return frame_bounds(box, projection, {std::cos(angle), std::sin(angle), 0.4 + 0.3 * std::sin(1.7 * angle)}, {0, 0, 1}, 1.0);
}

}  // namespace cellproj::scenes
