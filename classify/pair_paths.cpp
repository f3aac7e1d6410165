// SPDX-License-Identifier: BSD-3-Clause
#include "classify/pair_paths.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "classify/optics.hpp"

namespace cellproj {

namespace {

// Light behind this optical depth is left out of a texel: e^(−20) = 2e-9 is far below float32 beside what lies in
// front.
constexpr double deepest = 20.0;

// More stretches than this within one pair (s_f, s_b) are merged: finer than the texels, they could not be told apart.
constexpr std::size_t most_stretches = 128;

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

// τ̄ of the stretches, summed by ascending scalar: the same for both directions.
double mean_extinction(const std::vector<Stretch>& stretches, bool rising) {
    double sum = 0.0;
    const auto add = [&](const Stretch& stretch) { sum += stretch.share * stretch.mean_extinction(); };
    if (rising) {
        std::for_each(stretches.begin(), stretches.end(), add);
    } else {
        std::for_each(stretches.rbegin(), stretches.rend(), add);
    }
    return sum;
}

// Not by TransferFunction::extinction_integral: its running integrals carry what lies before both scalars in their last
// bits.
void trace(const TransferFunction& transfer, double s_f, double s_b, PairPath& path) {
    path.stretches.clear();
    if (s_f == s_b) {
        path.extinction = transfer.extinction(s_f);
        path.diagonal = transfer.emission(s_f);
        return;
    }
    for_each_stretch(transfer, s_f, s_b, [&](const Stretch& stretch) {
        if (stretch.share > 0.0) path.stretches.push_back(stretch);
    });
    path.extinction = mean_extinction(path.stretches, s_f < s_b);
    if (path.stretches.size() > most_stretches) merge_stretches(path.stretches, transfer.model());
}

}  // namespace

glm::dvec3 mean_emission(const Stretch& s, OpticalModel model) {
    if (model == OpticalModel::emitter) return 0.5 * (s.color_front + s.color_back);
    const double front = (2.0 * s.extinction_front + s.extinction_back) / 6.0;
    const double back = (s.extinction_front + 2.0 * s.extinction_back) / 6.0;
    return s.color_front * front + s.color_back * back;
}

glm::dvec3 effective_emission(const PairPath& path, OpticalModel model, double length) {
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

double scalar_of_texel(int i, int size, const TableDomain& domain) {
    return std::lerp(domain.scalar_low, domain.scalar_high, static_cast<double>(i) / (size - 1));
}

float stored_value(double value) {
    return static_cast<float>(std::min(value, static_cast<double>(std::numeric_limits<float>::max())));
}

std::size_t for_each_pair(const TransferFunction& transfer, const TableDomain& domain, int size,
                          const ScalarInterval& changed,
                          const std::function<void(int i, int j, const PairPath& path)>& visit) {
    using Rows = oneapi::tbb::blocked_range<int>;
    const auto visit_rows = [&](const Rows& rows, std::size_t count) {
        PairPath path;
        for (int j = rows.begin(); j < rows.end(); ++j) {
            const double s_b = scalar_of_texel(j, size, domain);
            for (int i = 0; i < size; ++i) {
                const double s_f = scalar_of_texel(i, size, domain);
                if (!changed.meets(s_f, s_b)) continue;
                trace(transfer, s_f, s_b, path);
                visit(i, j, path);
                ++count;
            }
        }
        return count;
    };
    return oneapi::tbb::parallel_reduce(Rows(0, size), std::size_t{0}, visit_rows, std::plus<>());
}

}  // namespace cellproj
