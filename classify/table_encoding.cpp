// SPDX-License-Identifier: BSD-3-Clause
#include "classify/table_encoding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/gtc/packing.hpp>

namespace cellproj {

namespace {

glm::vec4 largest_values(std::span<const float> texels) {
    glm::vec4 largest(0.0F);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        float& channel = largest[static_cast<int>(i % 4)];
        channel = std::max(channel, texels[i]);
    }
    for (int channel = 0; channel < 4; ++channel)
        if (largest[channel] == 0.0F) largest[channel] = 1.0F;
    return largest;
}

// The nearest number to 0..1 that the storage holds. Rounded here, not by the driver, so that both sides read the same.
float rounded(float fraction, TableStorage storage) {
    switch (storage) {
        case TableStorage::uint8:
            return std::round(fraction * 255.0F) / 255.0F;
        case TableStorage::float16:
            return glm::unpackHalf1x16(glm::packHalf1x16(fraction));
        case TableStorage::float32:
            break;
    }
    return fraction;
}

}  // namespace

TableEncoding::TableEncoding(TableStorage storage, std::span<const float> texels)
    : storage_(storage), range_(storage == TableStorage::float32 ? glm::vec4(1.0F) : largest_values(texels)) {
    assert(texels.size() % 4 == 0);
}

std::vector<float> TableEncoding::stored(std::span<const float> texels) const {
    std::vector<float> result(texels.begin(), texels.end());
    if (storage_ == TableStorage::float32) return result;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = rounded(result[i] / range_[static_cast<int>(i % 4)], storage_);
    return result;
}

glm::dvec4 TableEncoding::value(const float* texel) const {
    glm::dvec4 result;
    for (int channel = 0; channel < 4; ++channel) {
        const float range = range_[channel];
        result[channel] = static_cast<double>(range) * static_cast<double>(rounded(texel[channel] / range, storage_));
    }
    return result;
}

std::size_t bytes_per_texel(TableStorage storage) {
    switch (storage) {
        case TableStorage::uint8:
            return 4;
        case TableStorage::float16:
            return 8;
        case TableStorage::float32:
            break;
    }
    return 16;
}

}  // namespace cellproj
