// SPDX-License-Identifier: BSD-3-Clause
//
// What a file of bare voxels does not say about itself.
#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "mesh/dataset.hpp"
#include "mesh/number_type.hpp"

namespace cellproj {

// One number per point, x fastest; point (i, j, k) lies at origin + (i, j, k) · spacing [mesh units].
struct RawVolume {
    GridDimensions dimensions;
    NumberType type = NumberType::uint8;
    bool big_endian = false;
    glm::dvec3 spacing{1.0};         // finite, not 0
    glm::dvec3 origin{0.0};          // finite
    std::uint64_t header_bytes = 0;  // in front of the numbers
};

}  // namespace cellproj
