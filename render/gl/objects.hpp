// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL objects as values: move-only, made in the constructor (4.5 direct state access), deleted once. A context must be
// current. Names of type GLuint appear here as unsigned int, so that no OpenGL header is needed.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "project/camera.hpp"
#include "render/image.hpp"
#include "render/target_format.hpp"

namespace cellproj::gl {

// A GL name with the function that deletes it.
template <void (*Delete)(unsigned int)>
class Object {
public:
    Object() = default;
    explicit Object(unsigned int name) : name_(name) {}
    ~Object() {
        if (name_ != 0) Delete(name_);
    }
    Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0U)) {}
    Object& operator=(Object&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }

    unsigned int name() const { return name_; }

private:
    unsigned int name_ = 0;
};

void delete_buffer(unsigned int name);
void delete_texture(unsigned int name);
void delete_framebuffer(unsigned int name);
void delete_program(unsigned int name);
void delete_vertex_array(unsigned int name);

// A buffer of fixed size that stays mapped for writing (persistent, coherent).
class MappedBuffer {
public:
    explicit MappedBuffer(std::size_t bytes);

    unsigned int name() const { return buffer_.name(); }
    std::span<std::byte> memory() const { return memory_; }

private:
    Object<delete_buffer> buffer_;
    std::span<std::byte> memory_;
};

// A colour buffer of the size of a picture, with one for depths where it is asked for.
class Target {
public:
    Target() = default;
    // Throws Error (option) when the driver cannot draw that large.
    Target(ImageSize size, TargetFormat format, bool with_depth);

    bool is(ImageSize size, TargetFormat format, bool with_depth) const {
        return size_.width == size.width && size_.height == size.height && format_ == format && (depth_.name() != 0) == with_depth;
    }
    void clear_and_bind() const;  // transparent black, depth 0; viewport set
    Image read() const;           // waits for the drawing to end
    // With depths, between drawings: what has been drawn so far as a texture for drawings that write no colour; the depths anew; and as they
    // are, row by row, when the drawing has ended.
    void bind_color(unsigned int unit) const;
    void clear_depths(float depth) const;
    std::vector<float> read_depths() const;

private:
    ImageSize size_{0, 0};
    TargetFormat format_ = TargetFormat::rgba32f;
    Object<delete_texture> color_, depth_;
    Object<delete_framebuffer> framebuffer_;
};

// Vertex and fragment shader, linked. `defines` are lines put behind the #version line. Throws Error (environment) with the
// driver's log when it refuses them.
class Program {
public:
    Program() = default;
    Program(const std::string& vertex, const std::string& fragment, const std::string& defines);

    void use() const;
    void set(const char* uniform, float value) const;  // asserts that the uniform exists
    void set(const char* uniform, float x, float y) const;
    void set(const char* uniform, const glm::vec3& value) const;
    void set(const char* uniform, const glm::vec4& value) const;

private:
    int location(const char* uniform) const;
    Object<delete_program> program_;
};

// The blending of associated colours, without a depth test.
void blend_back_to_front();
void blend_front_to_back();

// Throws Error (environment) when an OpenGL call since the last check failed; `where` says what was being done.
void check_errors(const char* where);

// What the driver says of itself: renderer and version.
std::string driver_version();

}  // namespace cellproj::gl
