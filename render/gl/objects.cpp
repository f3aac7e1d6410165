// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/objects.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdio>

#include "mesh/error.hpp"

namespace cellproj::gl {

namespace {

[[noreturn]] void fail(std::string place, std::string expected, std::string found) {
    throw Error({ErrorKind::environment, std::move(place), std::move(expected), std::move(found),
                 "report it with the driver's version: " + driver_version()});
}

std::string text(GLenum name) {
    const GLubyte* value = glGetString(name);
    return value ? reinterpret_cast<const char*>(value) : "unknown";
}

GLuint compile(GLenum stage, const std::string& source, const std::string& defines) {
    const std::size_t first_line_end = source.find('\n') + 1;  // #version must stay first
    const std::string whole = source.substr(0, first_line_end) + defines + source.substr(first_line_end);
    const GLuint shader = glCreateShader(stage);
    const char* pointer = whole.c_str();
    glShaderSource(shader, 1, &pointer, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled) return shader;
    std::array<char, 1024> log{};
    glGetShaderInfoLog(shader, log.size(), nullptr, log.data());
    glDeleteShader(shader);
    fail("shader", "the driver to compile it", log.data());
}

GLenum internal_format(TargetFormat format) {
    switch (format) {
        case TargetFormat::rgba8:
            return GL_RGBA8;
        case TargetFormat::rgba16:
            return GL_RGBA16;
        case TargetFormat::rgba16f:
            return GL_RGBA16F;
        case TargetFormat::rgba32f:
            return GL_RGBA32F;
    }
    return GL_NONE;
}

void blend(GLenum of_new, GLenum of_old) {
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(of_new, of_old);
}

}  // namespace

void delete_buffer(unsigned int name) { glDeleteBuffers(1, &name); }
void delete_texture(unsigned int name) { glDeleteTextures(1, &name); }
void delete_framebuffer(unsigned int name) { glDeleteFramebuffers(1, &name); }
void delete_program(unsigned int name) { glDeleteProgram(name); }
void delete_vertex_array(unsigned int name) { glDeleteVertexArrays(1, &name); }

MappedBuffer::MappedBuffer(std::size_t bytes) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    buffer_ = Object<delete_buffer>(name);
    constexpr GLbitfield flags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes), nullptr, flags);
    void* memory = glMapNamedBufferRange(name, 0, static_cast<GLsizeiptr>(bytes), flags);
    if (!memory) fail("buffer of " + std::to_string(bytes) + " bytes", "memory that stays mapped", "none");
    memory_ = {static_cast<std::byte*>(memory), bytes};
}

Target::Target(ImageSize size, TargetFormat format, bool with_depth) : size_(size), format_(format) {
    GLint largest = 0, largest_viewport[2]{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest_viewport);
    largest = std::min({largest, largest_viewport[0], largest_viewport[1]});
    if (size.width > largest || size.height > largest) {
        throw Error({ErrorKind::option, "size", "at most " + std::to_string(largest) + " pixels a side with this driver",
                     std::to_string(size.width) + "x" + std::to_string(size.height), "choose a smaller picture"});
    }
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    color_ = Object<delete_texture>(name);
    glTextureStorage2D(name, 1, internal_format(format), size.width, size.height);
    glCreateFramebuffers(1, &name);
    framebuffer_ = Object<delete_framebuffer>(name);
    glNamedFramebufferTexture(name, GL_COLOR_ATTACHMENT0, color_.name(), 0);
    if (with_depth) {
        GLuint depth = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &depth);
        depth_ = Object<delete_texture>(depth);
        glTextureStorage2D(depth, 1, GL_DEPTH_COMPONENT32F, size.width, size.height);
        glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth, 0);
    }
    if (glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        fail("framebuffer", to_string(format) + " to be drawable", "an incomplete framebuffer");
    }
}

void Target::clear_and_bind() const {
    constexpr std::array<GLfloat, 4> nothing{0, 0, 0, 0};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, nothing.data());
    if (depth_.name() != 0) glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, nothing.data());
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.width, size_.height);
}

Image Target::read() const {
    Image image(size_.width, size_.height);
    static_assert(sizeof(glm::vec4) == 4 * sizeof(GLfloat));
    glGetTextureImage(color_.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(image.pixels.size() * sizeof(glm::vec4)),
                      image.pixels.data());
    return image;
}

void Target::bind_color(unsigned int unit) const {
    glTextureBarrier();
    glBindTextureUnit(unit, color_.name());
}

void Target::clear_depths(float depth) const { glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &depth); }

std::vector<float> Target::read_depths() const {
    std::vector<float> depths(static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height));
    glGetTextureImage(depth_.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(depths.size() * sizeof(GLfloat)), depths.data());
    return depths;
}

Program::Program(const std::string& vertex, const std::string& fragment, const std::string& defines) {
    const GLuint vertex_shader = compile(GL_VERTEX_SHADER, vertex, defines);
    const GLuint fragment_shader = compile(GL_FRAGMENT_SHADER, fragment, defines);
    const GLuint name = glCreateProgram();
    program_ = Object<delete_program>(name);
    glAttachShader(name, vertex_shader);
    glAttachShader(name, fragment_shader);
    glLinkProgram(name);
    glDeleteShader(vertex_shader);
    glDeleteShader(fragment_shader);
    GLint linked = GL_FALSE;
    glGetProgramiv(name, GL_LINK_STATUS, &linked);
    if (linked) return;
    std::array<char, 1024> log{};
    glGetProgramInfoLog(name, log.size(), nullptr, log.data());
    fail("shader program", "the driver to link it", log.data());
}

void Program::use() const { glUseProgram(program_.name()); }

int Program::location(const char* uniform) const {
    const GLint where = glGetUniformLocation(program_.name(), uniform);
    assert(where >= 0 && "no such uniform");
    return where;
}

void Program::set(const char* uniform, float value) const {
    glProgramUniform1f(program_.name(), location(uniform), value);
}

void Program::set(const char* uniform, float x, float y) const {
    glProgramUniform2f(program_.name(), location(uniform), x, y);
}

void Program::set(const char* uniform, const glm::vec3& value) const {
    glProgramUniform3f(program_.name(), location(uniform), value.x, value.y, value.z);
}

void Program::set(const char* uniform, const glm::vec4& value) const {
    glProgramUniform4f(program_.name(), location(uniform), value.x, value.y, value.z, value.w);
}

void blend_back_to_front() { blend(GL_ONE, GL_ONE_MINUS_SRC_ALPHA); }
void blend_front_to_back() { blend(GL_ONE_MINUS_DST_ALPHA, GL_ONE); }

void check_errors(const char* where) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    std::array<char, 16> code{};
    std::snprintf(code.data(), code.size(), "0x%04X", error);
    fail(std::string("OpenGL, ") + where, "no error", code.data());
}

std::string driver_version() { return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION); }

}  // namespace cellproj::gl
