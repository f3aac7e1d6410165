// SPDX-License-Identifier: BSD-3-Clause
//
// The integral of EKE01 Eq. 5 for tables over pairs (s_f, s_b), with self-attenuation: all lengths of a pair share one
// path through the transfer function. Private to classify/.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "classify/preintegration_table.hpp"
#include "classify/segment_path.hpp"
#include "classify/transfer_change.hpp"

namespace cellproj {

struct PairPath {
    double extinction = 0.0;         // τ̄
    glm::dvec3 diagonal{0.0};        // q(s), when s_f = s_b
    std::vector<Stretch> stretches;  // empty when s_f = s_b
};

// g: the colour of a segment of this length, 0 ≤ length, divided by length · φ(τ̄ · length).
glm::dvec3 effective_emission(const PairPath& path, OpticalModel model, double length);

// ∫ q over the stretch, per length of the stretch.
glm::dvec3 mean_emission(const Stretch& stretch, OpticalModel model);

// The scalar of texel i of `size`.
double scalar_of_texel(int i, int size, const TableDomain& domain);

// As a texel holds it: never infinite, so that no interpolation can make a NaN of it.
float stored_value(double value);

// Calls visit(i, j, path) for every pair of texels (s_f of texel i, s_b of texel j) whose scalars meet `changed`, from
// all cores, and returns their number. What a path holds depends on the function between both scalars only, to the last
// bit.
std::size_t for_each_pair(const TransferFunction& transfer, const TableDomain& domain, int size,
                          const ScalarInterval& changed,
                          const std::function<void(int i, int j, const PairPath& path)>& visit);

}  // namespace cellproj
