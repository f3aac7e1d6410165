// SPDX-License-Identifier: BSD-3-Clause
#include "classify/sampled_function.hpp"

#include "classify/pair_paths.hpp"
#include "classify/table_lookup.hpp"

namespace cellproj {

SampledFunction::SampledFunction(const TransferFunction& transfer, Sampled sampled) {
    texels_.reserve(4 * static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
        const double s = static_cast<double>(i) / (size - 1);
        const glm::dvec3 light = sampled == Sampled::emission ? transfer.emission(s) : transfer.color(s);
        for (int channel = 0; channel < 3; ++channel)
            texels_.push_back(stored_value(light[channel]));
        texels_.push_back(stored_value(transfer.extinction(s)));
    }
}

glm::dvec4 SampledFunction::at(double s) const {
    return interpolate<1>(texels_, size, {s}, TableEncoding(TableStorage::float32, texels_));
}

}  // namespace cellproj
