// SPDX-License-Identifier: BSD-3-Clause
#include "classify/preintegration_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "classify/optics.hpp"
#include "classify/pair_paths.hpp"
#include "classify/table_lookup.hpp"

namespace cellproj {

namespace {

// l₀: the texels are spaced evenly in l below l₀ and in ln l above. With l₀ = 1/τ_max nothing happens below it (D < 1),
// and every pair with a smaller τ̄ has its own D = 0.1 .. 30 somewhere on the logarithmic part.
double choose_length_scale(const TransferFunction& transfer, const TableDomain& domain) {
    return std::min(domain.max_length, 1.0 / transfer.max_extinction(domain.scalar_low, domain.scalar_high));
}

double length_of_texel(int k, int size, TableScale scale, double length_scale, double max_length) {
    if (k == size - 1) return max_length;
    const double u = static_cast<double>(k) / (size - 1);
    if (scale == TableScale::linear) return u * max_length;
    return length_scale * std::expm1(u * std::log1p(max_length / length_scale));
}

}  // namespace

PreintegrationTable::PreintegrationTable(const TransferFunction& transfer, const TableDomain& domain, int size,
                                         TableScale scale, TableStorage storage)
    : transfer_(transfer),
      size_(size),
      domain_(domain),
      scale_(scale),
      length_scale_(choose_length_scale(transfer, domain)),
      encoding_(storage, {}) {
    assert(size >= 2 && size <= 512);
    assert(domain.scalar_low <= domain.scalar_high && domain.max_length > 0.0 && std::isfinite(domain.max_length));
    const auto n = static_cast<std::size_t>(size);
    texels_.resize(4 * n * n * n);
    fill({});
}

std::size_t PreintegrationTable::update(const TransferFunction& transfer) {
    const auto changed = changed_scalars(transfer_, transfer);
    if (!changed) return 0;
    transfer_ = transfer;
    const double length_scale = choose_length_scale(transfer, domain_);
    const bool keeps_lengths = scale_ == TableScale::linear || length_scale == length_scale_;
    length_scale_ = length_scale;
    return fill(keeps_lengths ? *changed : ScalarInterval{});
}

std::size_t PreintegrationTable::fill(const ScalarInterval& changed) {
    const auto n = static_cast<std::size_t>(size_);
    const auto fill_pair = [&](int i, int j, const PairPath& path) {
        for (int k = 0; k < size_; ++k) {
            const double length = length_of_texel(k, size_, scale_, length_scale_, domain_.max_length);
            glm::dvec4 value(effective_emission(path, transfer_.model(), length), path.extinction);
            if (scale_ == TableScale::linear) {
                const Light light = homogeneous_light(glm::dvec3(value), path.extinction, length);
                value = glm::dvec4(light.color, light.opacity);
            }
            float* texel = &texels_[4 * (static_cast<std::size_t>(i) +
                                         n * (static_cast<std::size_t>(j) + n * static_cast<std::size_t>(k)))];
            for (int channel = 0; channel < 4; ++channel)
                texel[channel] = stored_value(value[channel]);
        }
    };
    const std::size_t computed = for_each_pair(transfer_, domain_, size_, changed, fill_pair);
    encoding_ = TableEncoding(encoding_.storage(), texels_);
    return computed;
}

Light PreintegrationTable::lookup(double s_f, double s_b, double length) const {
    assert(!std::isnan(s_f) && !std::isnan(s_b) && !std::isnan(length));
    const double range = domain_.scalar_high - domain_.scalar_low;
    const auto fraction = [&](double s) { return range > 0.0 ? (s - domain_.scalar_low) / range : 0.0; };
    const double l = std::clamp(length, 0.0, domain_.max_length);
    const double u = scale_ == TableScale::linear
                         ? l / domain_.max_length
                         : std::log1p(l / length_scale_) / std::log1p(domain_.max_length / length_scale_);
    const glm::dvec4 texel = interpolate<3>(texels_, size_, {fraction(s_f), fraction(s_b), u}, encoding_);
    if (scale_ == TableScale::linear) return {glm::dvec3(texel), std::min(texel.w, 1.0)};
    return homogeneous_light(glm::dvec3(texel), texel.w, l);
}

}  // namespace cellproj
