// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/triangle_stream.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace cellproj::gl {

namespace {

// The attribute locations of shaders/cell.vert.
enum Attribute : GLuint { position = 0, base = 1, ridges = 2, cell = 3 };

constexpr GLuint vertex_binding = 0;

}  // namespace

TriangleStream::TriangleStream() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    layout_ = Object<delete_vertex_array>(name);
    const auto attribute = [&](Attribute location, GLint components, std::size_t offset) {
        glEnableVertexArrayAttrib(name, location);
        glVertexArrayAttribFormat(name, location, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
        glVertexArrayAttribBinding(name, location, vertex_binding);
    };
    attribute(position, 2, offsetof(StreamVertex, x));
    attribute(base, 2, offsetof(StreamVertex, base_depth));
    attribute(ridges, 3, offsetof(StreamVertex, ridges));
    attribute(cell, 4, offsetof(StreamVertex, scalar_slope));
}

TriangleStream::~TriangleStream() {
    for (void* fence : in_use_) glDeleteSync(static_cast<GLsync>(fence));
}

void TriangleStream::draw(const TriangleBatch& batch) {
    if (batch.indices.empty()) return;
    if (batch.vertices.size() > slot_vertices_ || batch.indices.size() > slot_indices_) {
        grow(batch.vertices.size(), batch.indices.size());
    }
    const std::size_t slot = next_;
    next_ = (next_ + 1) % slots;
    wait(slot);
    const std::size_t first_vertex = slot * slot_vertices_;
    const std::size_t first_index = slot * slot_indices_;
    std::memcpy(vertices_->memory().data() + first_vertex * sizeof(StreamVertex), batch.vertices.data(),
                batch.vertices.size() * sizeof(StreamVertex));
    std::memcpy(indices_->memory().data() + first_index * sizeof(std::uint32_t), batch.indices.data(),
                batch.indices.size() * sizeof(std::uint32_t));
    glBindVertexArray(layout_.name());
    glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(batch.indices.size()), GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(first_index * sizeof(std::uint32_t)),
                             static_cast<GLint>(first_vertex));
    in_use_[slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
}

void TriangleStream::grow(std::size_t vertices, std::size_t indices) {
    for (std::size_t slot = 0; slot < slots; ++slot) wait(slot);
    slot_vertices_ = std::max(slot_vertices_, vertices + vertices / 4);
    slot_indices_ = std::max(slot_indices_, indices + indices / 4);
    vertices_ = std::make_unique<MappedBuffer>(slots * slot_vertices_ * sizeof(StreamVertex));
    indices_ = std::make_unique<MappedBuffer>(slots * slot_indices_ * sizeof(std::uint32_t));
    glVertexArrayVertexBuffer(layout_.name(), vertex_binding, vertices_->name(), 0, sizeof(StreamVertex));
    glVertexArrayElementBuffer(layout_.name(), indices_->name());
}

void TriangleStream::wait(std::size_t slot) {
    if (!in_use_[slot]) return;
    const auto fence = static_cast<GLsync>(in_use_[slot]);
    while (glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, 1'000'000'000) == GL_TIMEOUT_EXPIRED) {
    }
    glDeleteSync(fence);
    in_use_[slot] = nullptr;
}

}  // namespace cellproj::gl
