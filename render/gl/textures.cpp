// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/textures.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cassert>
#include <string>

#include "classify/table_encoding.hpp"
#include "mesh/error.hpp"

namespace cellproj::gl {

namespace {

GLenum internal_format(TableStorage storage) {
    switch (storage) {
        case TableStorage::uint8: return GL_RGBA8;
        case TableStorage::float16: return GL_RGBA16F;
        case TableStorage::float32: break;
    }
    return GL_RGBA32F;
}

GLuint make_table(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
        glTextureParameteri(name, axis, GL_CLAMP_TO_EDGE);
    }
    return name;
}

}  // namespace

Texture Texture::table_2d(int size, TableStorage storage, std::span<const float> texels) {
    assert(texels.size() == 4 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    const GLuint name = make_table(GL_TEXTURE_2D);
    Texture texture;
    texture.texture_ = Object<delete_texture>(name);
    glTextureStorage2D(name, 1, internal_format(storage), size, size);
    glTextureSubImage2D(name, 0, 0, 0, size, size, GL_RGBA, GL_FLOAT, texels.data());
    texture.bytes_ = texels.size() / 4 * bytes_per_texel(storage);
    check_errors("uploading a 2D table");
    return texture;
}

Texture Texture::table_3d(int size, TableStorage storage, std::span<const float> texels) {
    assert(texels.size() == 4 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    const GLuint name = make_table(GL_TEXTURE_3D);
    Texture texture;
    texture.texture_ = Object<delete_texture>(name);
    glTextureStorage3D(name, 1, internal_format(storage), size, size, size);
    glTextureSubImage3D(name, 0, 0, 0, 0, size, size, size, GL_RGBA, GL_FLOAT, texels.data());
    texture.bytes_ = texels.size() / 4 * bytes_per_texel(storage);
    check_errors("uploading a 3D table");
    return texture;
}

Texture Texture::volume(std::array<std::size_t, 3> size, std::span<const float> texels) {
    const std::size_t components = texels.size() / (size[0] * size[1] * size[2]);
    assert(texels.size() == components * size[0] * size[1] * size[2] && (components == 1 || components == 4));
    GLint largest = 0;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    const std::size_t longest = std::max({size[0], size[1], size[2]});
    if (longest > static_cast<std::size_t>(largest)) {
        throw Error({ErrorKind::option, "grid", "at most " + std::to_string(largest) + " values along an axis with this driver",
                     std::to_string(longest), "use the CPU backend (--backend cpu)"});
    }
    const GLuint name = make_table(GL_TEXTURE_3D);
    Texture texture;
    texture.texture_ = Object<delete_texture>(name);
    const auto extent = [&](std::size_t axis) { return static_cast<GLsizei>(size[axis]); };
    glTextureStorage3D(name, 1, components == 1 ? GL_R32F : GL_RGBA32F, extent(0), extent(1), extent(2));
    glTextureSubImage3D(name, 0, 0, 0, 0, extent(0), extent(1), extent(2), components == 1 ? GL_RED : GL_RGBA, GL_FLOAT, texels.data());
    texture.bytes_ = texels.size_bytes();
    check_errors("uploading a volume");
    return texture;
}

Texture Texture::list(std::span<const float> texels) {
    assert(!texels.empty() && texels.size() % 4 == 0);
    return make_list(texels, GL_RGBA32F);
}

Texture Texture::list_of_pairs(std::span<const float> texels) {
    assert(!texels.empty() && texels.size() % 2 == 0);
    return make_list(texels, GL_RG32F);
}

Texture Texture::make_list(std::span<const float> texels, unsigned int format) {
    Texture texture;
    GLuint name = 0;
    glCreateBuffers(1, &name);
    texture.buffer_ = Object<delete_buffer>(name);
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(texels.size_bytes()), texels.data(), 0);
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
    texture.texture_ = Object<delete_texture>(name);
    glTextureBuffer(name, format, texture.buffer_.name());
    texture.bytes_ = texels.size_bytes();
    check_errors("uploading a list");
    return texture;
}

void Texture::bind(unsigned int unit) const { glBindTextureUnit(unit, texture_.name()); }

}  // namespace cellproj::gl
