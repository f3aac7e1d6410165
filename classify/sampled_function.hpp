// SPDX-License-Identifier: BSD-3-Clause
//
// A transfer function as a table of 4096 samples with linear interpolation between them: the classification of single
// scalars, as all four papers do it. At the samples it is the function; between two of them, h = 1/4095 apart, it is
// off by up to h·|change of slope|/4 at a bend and by up to the whole jump at a step, and a spike that lies between is
// not seen.
#pragma once

#include <glm/vec4.hpp>
#include <vector>

#include "classify/transfer_function.hpp"

namespace cellproj {

// What the first three channels of a sample hold; the fourth one is the extinction.
enum class Sampled {
    emission,  // q(s)
    color      // as the nodes say: κ(s) in the density model, q(s) in the emitter model
};

class SampledFunction {
public:
    static constexpr int size = 4096;

    // `transfer` over scalars 0..1.
    SampledFunction(const TransferFunction& transfer, Sampled sampled);

    const std::vector<float>& texels() const { return texels_; }  // four per sample, never infinite
    // s is clamped to 0..1; not NaN.
    glm::dvec4 at(double s) const;

private:
    std::vector<float> texels_;
};

}  // namespace cellproj
