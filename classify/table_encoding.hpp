// SPDX-License-Identifier: BSD-3-Clause
//
// What becomes of a table's float32 texels in the storage that a renderer keeps them in (TableStorage, method.hpp).
//
// uint8 and float16 hold texel / range, `range` the largest value of each of the four channels: so all of 0..1 is used
// and nothing overflows. The largest error of a texel is range/510 (uint8), or 2⁻¹¹ of itself but at least range·2⁻²⁵
// (float16). float32 keeps the texel itself; its range is 1.
#pragma once

#include <cstddef>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "classify/method.hpp"

namespace cellproj {

class TableEncoding {
public:
    // For `texels`, four non-negative finite channels each; another table needs another encoding.
    TableEncoding(TableStorage storage, std::span<const float> texels);

    TableStorage storage() const { return storage_; }
    // What a stored texel is multiplied by. Never 0: 1 for a channel that is 0 everywhere.
    const glm::vec4& range() const { return range_; }

    // The texels as they are stored: each is a number that the storage holds exactly.
    std::vector<float> stored(std::span<const float> texels) const;
    // What one texel (four floats) tells after it was stored.
    glm::dvec4 value(const float* texel) const;

private:
    TableStorage storage_;
    glm::vec4 range_;
};

// [bytes], four channels.
std::size_t bytes_per_texel(TableStorage storage);

}  // namespace cellproj
