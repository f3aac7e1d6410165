// SPDX-License-Identifier: BSD-3-Clause
#include "classify/preintegration_table.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <limits>

#include "classify/optics.hpp"
#include "classify/segment_integral.hpp"
#include "classify/segment_path.hpp"

namespace cellproj {

namespace {

// Light behind this optical depth is left out of a texel: e^(−20) = 2e-9 is far below float32 beside what lies in
// front.
constexpr double deepest = 20.0;

// More stretches than this within one pair (s_f, s_b) are merged: finer than the texels, they could not be told apart.
constexpr std::size_t most_stretches = 128;

double largest_extinction(const TransferFunction& transfer, const TableDomain& domain) {
    return transfer.max_extinction(domain.scalar_low, domain.scalar_high);
}

// l₀: the texels are spaced evenly in l below l₀ and in ln l above. With l₀ = 1/τ_max nothing happens below it (D < 1),
// and every pair with a smaller τ̄ has its own D = 0.1 .. 30 somewhere on the logarithmic part.
double choose_length_scale(const TransferFunction& transfer, const TableDomain& domain) {
    return std::min(domain.max_length, 1.0 / largest_extinction(transfer, domain));
}

double length_of_texel(int k, int size, double length_scale, double max_length) {
    if (k == size - 1) return max_length;
    const double u = static_cast<double>(k) / (size - 1);
    return length_scale * std::expm1(u * std::log1p(max_length / length_scale));
}

double scalar_of_texel(int i, int size, const TableDomain& domain) {
    return std::lerp(domain.scalar_low, domain.scalar_high, static_cast<double>(i) / (size - 1));
}

// ∫ q over the stretch, per length of the stretch.
glm::dvec3 mean_emission(const Stretch& s, OpticalModel model) {
    if (model == OpticalModel::emitter) return 0.5 * (s.color_front + s.color_back);
    const double front = (2.0 * s.extinction_front + s.extinction_back) / 6.0;
    const double back = (s.extinction_front + 2.0 * s.extinction_back) / 6.0;
    return s.color_front * front + s.color_back * back;
}

// A homogeneous stretch with the mean extinction and mean emission of a run of stretches.
class Merged {
public:
    void add(const Stretch& stretch, OpticalModel model) {
        share_ += stretch.share;
        extinction_ += stretch.share * stretch.mean_extinction();
        emission_ += stretch.share * mean_emission(stretch, model);
    }
    double share() const { return share_; }
    Stretch stretch(OpticalModel model) const {
        const double tau = extinction_ / share_;
        glm::dvec3 color = emission_ / share_;
        if (model == OpticalModel::density) color = tau > 0.0 ? color / tau : glm::dvec3(0.0);
        return {share_, color, color, tau, tau};
    }

private:
    double share_ = 0.0;
    double extinction_ = 0.0;
    glm::dvec3 emission_{0.0};
};

void merge_stretches(std::vector<Stretch>& stretches, OpticalModel model) {
    std::vector<Stretch> merged;
    Merged run;
    for (const Stretch& stretch : stretches) {
        run.add(stretch, model);
        if (run.share() * most_stretches < 1.0) continue;
        merged.push_back(run.stretch(model));
        run = Merged();
    }
    if (run.share() > 0.0) merged.push_back(run.stretch(model));
    stretches.swap(merged);
}

// The path through the transfer function that all lengths of one pair (s_f, s_b) share.
struct Path {
    double extinction;               // τ̄
    glm::dvec3 diagonal;             // q(s), when s_f = s_b
    std::vector<Stretch> stretches;  // empty when s_f = s_b
};

void trace(const TransferFunction& transfer, double s_f, double s_b, Path& path) {
    path.extinction = mean_extinction(transfer, s_f, s_b);
    path.stretches.clear();
    if (s_f == s_b) {
        path.diagonal = transfer.emission(s_f);
        return;
    }
    for_each_stretch(transfer, s_f, s_b, [&](const Stretch& stretch) {
        if (stretch.share > 0.0) path.stretches.push_back(stretch);
    });
    if (path.stretches.size() > most_stretches) merge_stretches(path.stretches, transfer.model());
}

// g of the header: the colour divided by l·φ(τ̄ l).
glm::dvec3 effective_emission(const Path& path, OpticalModel model, double length) {
    if (path.stretches.empty()) return path.diagonal;
    glm::dvec3 color_per_length(0.0);
    double depth = 0.0;
    for (const Stretch& stretch : path.stretches) {
        if (length == 0.0) {
            color_per_length += stretch.share * mean_emission(stretch, model);
            continue;
        }
        if (depth >= deepest) break;
        const double stretch_length = length * stretch.share;
        const double stretch_depth = stretch.mean_extinction() * stretch_length;
        const EndWeights weights = stretch_depth <= shallow_table_rule.max_depth
                                       ? end_weights(stretch, model, stretch_length, depth, deepest, shallow_table_rule)
                                       : end_weights(stretch, model, stretch_length, depth, deepest, table_rule);
        color_per_length += (stretch.color_front * weights.front + stretch.color_back * weights.back) / length;
        depth += stretch_depth;
    }
    return color_per_length / mean_transmittance(path.extinction * length);
}

// Never infinite, so that no interpolation can make a NaN of it.
float stored(double value) {
    return static_cast<float>(std::min(value, static_cast<double>(std::numeric_limits<float>::max())));
}

// Position on an axis of `size` texels: the texel at or before it, and how far it is to the next one.
struct AxisPosition {
    int texel;
    double rest;
};

AxisPosition axis_position(double fraction, int size) {
    const double position = std::clamp(fraction, 0.0, 1.0) * (size - 1);
    const int texel = std::min(static_cast<int>(position), size - 2);
    return {texel, position - texel};
}

}  // namespace

PreintegrationTable::PreintegrationTable(const TransferFunction& transfer, const TableDomain& domain, int size)
    : size_(size), domain_(domain), length_scale_(choose_length_scale(transfer, domain)) {
    assert(size >= 2 && size <= 512);
    assert(domain.scalar_low <= domain.scalar_high && domain.max_length > 0.0 && std::isfinite(domain.max_length));
    const auto n = static_cast<std::size_t>(size);
    texels_.resize(4 * n * n * n);

    const auto fill_pair = [&](int i, int j, Path& path) {
        trace(transfer, scalar_of_texel(i, size_, domain_), scalar_of_texel(j, size_, domain_), path);
        for (int k = 0; k < size_; ++k) {
            const double length = length_of_texel(k, size_, length_scale_, domain_.max_length);
            const glm::dvec3 g = effective_emission(path, transfer.model(), length);
            float* texel = &texels_[4 * (static_cast<std::size_t>(i) +
                                         n * (static_cast<std::size_t>(j) + n * static_cast<std::size_t>(k)))];
            for (int channel = 0; channel < 3; ++channel)
                texel[channel] = stored(g[channel]);
            texel[3] = stored(path.extinction);
        }
    };
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, size_), [&](const auto& rows) {
        Path path;
        for (int j = rows.begin(); j < rows.end(); ++j)
            for (int i = 0; i < size_; ++i)
                fill_pair(i, j, path);
    });
}

Light PreintegrationTable::lookup(double s_f, double s_b, double length) const {
    assert(!std::isnan(s_f) && !std::isnan(s_b) && !std::isnan(length));
    const double range = domain_.scalar_high - domain_.scalar_low;
    const auto scalar_position = [&](double s) {
        return axis_position(range > 0.0 ? (s - domain_.scalar_low) / range : 0.0, size_);
    };
    const double l = std::clamp(length, 0.0, domain_.max_length);
    const double u = std::log1p(l / length_scale_) / std::log1p(domain_.max_length / length_scale_);
    const std::array<AxisPosition, 3> at{scalar_position(s_f), scalar_position(s_b), axis_position(u, size_)};

    glm::dvec4 texel(0.0);
    for (int corner = 0; corner < 8; ++corner) {
        std::size_t index = 0;
        double weight = 1.0;
        for (int axis = 2; axis >= 0; --axis) {
            const bool next = (corner >> axis & 1) != 0;
            const AxisPosition& position = at[static_cast<std::size_t>(axis)];
            index = index * static_cast<std::size_t>(size_) + static_cast<std::size_t>(position.texel + (next ? 1 : 0));
            weight *= next ? position.rest : 1.0 - position.rest;
        }
        const float* corner_texel = &texels_[4 * index];
        texel += weight * glm::dvec4(corner_texel[0], corner_texel[1], corner_texel[2], corner_texel[3]);
    }
    const double depth = texel.w * l;
    return {glm::dvec3(texel) * (l * mean_transmittance(depth)), opacity_of_depth(depth)};
}

}  // namespace cellproj
