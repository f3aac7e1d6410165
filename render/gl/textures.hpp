// SPDX-License-Identifier: BSD-3-Clause
//
// Tables as textures, read-only after they are made.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "classify/method.hpp"
#include "render/gl/objects.hpp"

namespace cellproj::gl {

class Texture {
public:
    Texture() = default;

    // Texels RGBA, the first axis fastest; linear filter, clamped to the edge. `uint8` stores 0..1.
    static Texture table_2d(int size, TableStorage storage, std::span<const float> texels);
    static Texture table_3d(int size, TableStorage storage, std::span<const float> texels);
    // One float32 a texel or RGBA, the first axis fastest; linear filter, clamped to the edge. Throws Error (option) where the driver takes
    // no texture that large.
    static Texture volume(std::array<std::size_t, 3> size, std::span<const float> texels);
    // Texels RGBA float32 to be fetched by index (samplerBuffer), nothing between them.
    static Texture list(std::span<const float> texels);
    // The same of two channels, RG.
    static Texture list_of_pairs(std::span<const float> texels);

    void bind(unsigned int unit) const;
    std::size_t bytes() const { return bytes_; }

private:
    static Texture make_list(std::span<const float> texels, unsigned int format);

    Object<delete_texture> texture_;
    Object<delete_buffer> buffer_;  // of a list
    std::size_t bytes_ = 0;
};

}  // namespace cellproj::gl
