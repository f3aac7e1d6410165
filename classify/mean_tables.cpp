// SPDX-License-Identifier: BSD-3-Clause
#include "classify/mean_tables.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cassert>
#include <functional>

#include "classify/optics.hpp"
#include "classify/pair_paths.hpp"
#include "classify/table_lookup.hpp"

namespace cellproj {

namespace {

std::vector<float> empty_table(int size) {
    assert(size >= 2 && size <= 4096);
    return std::vector<float>(4 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
}

void store(std::vector<float>& texels, int size, int i, int j, const glm::dvec4& value) {
    const std::size_t at =
        4 * (static_cast<std::size_t>(i) + static_cast<std::size_t>(size) * static_cast<std::size_t>(j));
    for (int channel = 0; channel < 4; ++channel)
        texels[at + static_cast<std::size_t>(channel)] = stored_value(value[channel]);
}

glm::dvec4 mean_between(const TransferFunction& transfer, double low, double high) {
    glm::dvec4 mean(0.0);
    for_each_stretch(transfer, low, high, [&](const Stretch& stretch) {
        mean += stretch.share * glm::dvec4(mean_emission(stretch, transfer.model()), stretch.mean_extinction());
    });
    return mean;
}

}  // namespace

MeanLengthTable::MeanLengthTable(const TransferFunction& transfer, double mean_length, int size, TableStorage storage)
    : transfer_(transfer), mean_length_(mean_length), size_(size), texels_(empty_table(size)), encoding_(storage, {}) {
    assert(mean_length > 0.0);
    fill({});
}

std::size_t MeanLengthTable::update(const TransferFunction& transfer) {
    const auto changed = changed_scalars(transfer_, transfer);
    if (!changed) return 0;
    transfer_ = transfer;
    return fill(*changed);
}

std::size_t MeanLengthTable::fill(const ScalarInterval& changed) {
    const auto fill_pair = [&](int i, int j, const PairPath& path) {
        const glm::dvec3 emission = effective_emission(path, transfer_.model(), mean_length_);
        const Light light = homogeneous_light(emission, path.extinction, mean_length_);
        store(texels_, size_, i, j, glm::dvec4(light.color, light.opacity));
    };
    const std::size_t computed = for_each_pair(transfer_, {0.0, 1.0, mean_length_}, size_, changed, fill_pair);
    encoding_ = TableEncoding(encoding_.storage(), texels_);
    return computed;
}

Light MeanLengthTable::lookup(double s_f, double s_b, double length) const {
    const glm::dvec4 texel = interpolate<2>(texels_, size_, {s_f, s_b}, encoding_);
    double factor = std::max(length, 0.0) / mean_length_;
    if (texel.w * factor > 1.0) factor = 1.0 / texel.w;
    return {glm::dvec3(texel) * factor, std::min(texel.w * factor, 1.0)};
}

MeanValueTable::MeanValueTable(const TransferFunction& transfer, int size, TableStorage storage)
    : transfer_(transfer),
      size_(size),
      between_(static_cast<std::size_t>(size) - 1),
      texels_(empty_table(size)),
      encoding_(storage, {}) {
    fill({});
}

std::size_t MeanValueTable::update(const TransferFunction& transfer) {
    const auto changed = changed_scalars(transfer_, transfer);
    if (!changed) return 0;
    transfer_ = transfer;
    return fill(*changed);
}

// EKE01 takes differences of running integrals. We add up the integrals from texel to texel along each row instead,
// which costs the same: nothing cancels, and a pair depends on nothing outside its own scalars, not even in the last
// bit.
std::size_t MeanValueTable::fill(const ScalarInterval& changed) {
    const auto scalar = [&](int i) { return scalar_of_texel(i, size_, {0.0, 1.0, 1.0}); };
    for (int i = 0; i + 1 < size_; ++i) {
        if (!changed.meets(scalar(i), scalar(i + 1))) continue;
        between_[static_cast<std::size_t>(i)] = mean_between(transfer_, scalar(i), scalar(i + 1));
    }
    using Rows = oneapi::tbb::blocked_range<int>;
    const auto fill_rows = [&](const Rows& rows, std::size_t count) {
        for (int i = rows.begin(); i < rows.end() && scalar(i) <= changed.high; ++i) {
            if (changed.meets(scalar(i), scalar(i))) {
                store(texels_, size_, i, i, glm::dvec4(transfer_.emission(scalar(i)), transfer_.extinction(scalar(i))));
                ++count;
            }
            glm::dvec4 sum(0.0);
            for (int j = i + 1; j < size_; ++j) {
                sum += between_[static_cast<std::size_t>(j) - 1];
                if (!changed.meets(scalar(i), scalar(j))) continue;
                const glm::dvec4 mean = sum / static_cast<double>(j - i);
                store(texels_, size_, i, j, mean);
                store(texels_, size_, j, i, mean);
                count += 2;
            }
        }
        return count;
    };
    const std::size_t computed = oneapi::tbb::parallel_reduce(Rows(0, size_), std::size_t{0}, fill_rows, std::plus<>());
    encoding_ = TableEncoding(encoding_.storage(), texels_);
    return computed;
}

Light MeanValueTable::lookup(double s_f, double s_b, double length) const {
    const glm::dvec4 texel = interpolate<2>(texels_, size_, {s_f, s_b}, encoding_);
    return homogeneous_light(glm::dvec3(texel), texel.w, std::max(length, 0.0));
}

}  // namespace cellproj
