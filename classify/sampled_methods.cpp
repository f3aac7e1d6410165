// SPDX-License-Identifier: BSD-3-Clause
//
// The methods that sample the transfer function along the segment. `at(s)` below is (q or κ, τ) there.
#include <algorithm>
#include <cmath>

#include "classify/optics.hpp"
#include "classify/sampled_function.hpp"
#include "classify/segment_methods.hpp"

namespace cellproj {

namespace {

// WVG91 Eq. 9–10, "C·D": emission and extinction times length, no attenuation inside. Their means are those of both
// ends. At length 1/τ̄ the segment is opaque: what lies behind is cut off, from the colour as well.
Light average_light(const glm::dvec4& front, const glm::dvec4& back, double length) {
    const glm::dvec4 mean = 0.5 * (front + back);
    const double depth = mean.w * length;
    const double seen = depth > 1.0 ? 1.0 / mean.w : length;
    return {glm::dvec3(mean) * seen, std::min(depth, 1.0)};
}

// WVG91, exponential homogeneous.
Light exponential_light(const glm::dvec4& front, const glm::dvec4& back, double length) {
    const glm::dvec4 mean = 0.5 * (front + back);
    return homogeneous_light(glm::dvec3(mean), mean.w, length);
}

// Stein, Becker, Max 1994, as told in RKE00 §2: the mean chromaticity of both ends, made opaque by the mean extinction.
Light stein_light(const glm::dvec4& front, const glm::dvec4& back, double length) {
    const glm::dvec4 mean = 0.5 * (front + back);
    return homogeneous_light(glm::dvec3(mean) * mean.w, mean.w, length);
}

// WVG91, exponential linear: homogeneous steps of equal length, each as the function is in its middle.
Light stepped_light(const SampledFunction& function, double s_f, double s_b, double length, int steps) {
    const double step_length = length / steps;
    Light light;
    double depth = 0.0;
    for (int step = 0; step < steps; ++step) {
        const glm::dvec4 middle = function.at(std::lerp(s_f, s_b, (step + 0.5) / steps));
        light.color += std::exp(-depth) * homogeneous_light(glm::dvec3(middle), middle.w, step_length).color;
        depth += middle.w * step_length;
    }
    light.opacity = opacity_of_depth(depth);
    return light;
}

// A chromaticity is what the density model is given by. In the emitter model there is none where nothing absorbs, and
// `stein` takes the mean emission, as `homogeneous` does.
bool by_chromaticity(const Method& method, const TransferFunction& transfer) {
    return method.kind == MethodKind::stein && transfer.model() == OpticalModel::density;
}

class SampledMethod : public SegmentMethod {
public:
    SampledMethod(const Method& method, const TransferFunction& transfer)
        : method_(method),
          by_chromaticity_(by_chromaticity(method, transfer)),
          function_(transfer, by_chromaticity_ ? Sampled::color : Sampled::emission) {}

    Light light(double s_f, double s_b, double length) const override {
        if (method_.kind == MethodKind::linear) return stepped_light(function_, s_f, s_b, length, method_.size);
        const glm::dvec4 front = function_.at(s_f), back = function_.at(s_b);
        if (method_.kind == MethodKind::average) return average_light(front, back, length);
        return by_chromaticity_ ? stein_light(front, back, length) : exponential_light(front, back, length);
    }

    std::size_t table_bytes() const override { return function_.texels().size() * sizeof(float); }

private:
    Method method_;
    bool by_chromaticity_;
    SampledFunction function_;
};

}  // namespace

std::unique_ptr<SegmentMethod> make_sampled_method(const Method& method, const TransferFunction& transfer) {
    return std::make_unique<SampledMethod>(method, transfer);
}

}  // namespace cellproj
