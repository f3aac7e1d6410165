// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/triangle_stream.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace cellproj::gl {

namespace {

constexpr GLuint vertex_binding = 0;

constexpr std::array<VertexAttribute, 8> stream_attributes{{{0, 2, offsetof(StreamVertex, x)},
                                                            {1, 3, offsetof(StreamVertex, ridges)},
                                                            {2, 4, offsetof(StreamVertex, base_depth)},
                                                            {3, 4, offsetof(StreamVertex, base_scalar)},
                                                            {4, 3, offsetof(StreamVertex, thickness[0])},
                                                            {5, 3, offsetof(StreamVertex, thickness[1])},
                                                            {6, 3, offsetof(StreamVertex, thickness[2])},
                                                            {7, 4, offsetof(StreamVertex, scalar_slope)}}};
// Behind those of the first field.
static_assert(sizeof(TwoFieldVertex) == sizeof(StreamVertex) + 6 * sizeof(float));
constexpr std::array<VertexAttribute, 10> two_field_attributes{
    {stream_attributes[0], stream_attributes[1], stream_attributes[2], stream_attributes[3], stream_attributes[4],
     stream_attributes[5], stream_attributes[6], stream_attributes[7], {8, 4, sizeof(StreamVertex)},
     {9, 2, sizeof(StreamVertex) + 4 * sizeof(float)}}};
constexpr std::array<VertexAttribute, 4> lit_attributes{{{0, 2, offsetof(LitVertex, x)},
                                                         {1, 1, offsetof(LitVertex, share)},
                                                         {2, 3, offsetof(LitVertex, color)},
                                                         {3, 3, offsetof(LitVertex, weight)}}};
// All that OpenGL grants: 16 of four floats.
static_assert(sizeof(SurfaceVertex) == 16 * 4 * sizeof(float));
constexpr std::size_t half_face = sizeof(SurfaceFace) / 2;
constexpr std::array<VertexAttribute, 16> surface_attributes{{{0, 4, offsetof(SurfaceVertex, x)},
                                                             {1, 4, offsetof(SurfaceVertex, ridges)},
                                                             {2, 4, offsetof(SurfaceVertex, faces)},
                                                             {3, 4, offsetof(SurfaceVertex, faces) + half_face},
                                                             {4, 4, offsetof(SurfaceVertex, faces[1])},
                                                             {5, 4, offsetof(SurfaceVertex, faces[1]) + half_face},
                                                             {6, 4, offsetof(SurfaceVertex, faces[2])},
                                                             {7, 4, offsetof(SurfaceVertex, faces[2]) + half_face},
                                                             {8, 4, offsetof(SurfaceVertex, faces[3])},
                                                             {9, 4, offsetof(SurfaceVertex, faces[3]) + half_face},
                                                             {10, 4, offsetof(SurfaceVertex, scalars)},
                                                             {11, 4, offsetof(SurfaceVertex, first)},
                                                             {12, 4, offsetof(SurfaceVertex, maps[0])},
                                                             {13, 4, offsetof(SurfaceVertex, maps[1])},
                                                             {14, 4, offsetof(SurfaceVertex, maps[2])},
                                                             {15, 4, offsetof(SurfaceVertex, maps[3])}}};

}  // namespace

std::span<const VertexAttribute> vertex_attributes(const StreamVertex*) { return stream_attributes; }
std::span<const VertexAttribute> vertex_attributes(const TwoFieldVertex*) { return two_field_attributes; }
std::span<const VertexAttribute> vertex_attributes(const LitVertex*) { return lit_attributes; }
std::span<const VertexAttribute> vertex_attributes(const SurfaceVertex*) { return surface_attributes; }

TriangleStream::TriangleStream(std::size_t vertex_bytes, std::span<const VertexAttribute> attributes)
    : vertex_bytes_(vertex_bytes) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    layout_ = Object<delete_vertex_array>(name);
    for (const VertexAttribute& attribute : attributes) {
        glEnableVertexArrayAttrib(name, attribute.location);
        glVertexArrayAttribFormat(name, attribute.location, attribute.components, GL_FLOAT, GL_FALSE,
                                  static_cast<GLuint>(attribute.offset));
        glVertexArrayAttribBinding(name, attribute.location, vertex_binding);
    }
}

TriangleStream::~TriangleStream() {
    for (void* fence : in_use_) glDeleteSync(static_cast<GLsync>(fence));
}

void TriangleStream::draw(std::span<const std::byte> vertices, std::span<const std::uint32_t> indices, Primitive primitive) {
    if (indices.empty()) return;
    const std::size_t vertex_count = vertices.empty() ? 0 : vertices.size() / vertex_bytes_;
    if (vertex_count > slot_vertices_ || indices.size() > slot_indices_) grow(vertex_count, indices.size());
    const std::size_t slot = next_;
    next_ = (next_ + 1) % slots;
    wait(slot);
    const std::size_t first_vertex = slot * slot_vertices_;
    const std::size_t first_index = slot * slot_indices_;
    if (!vertices.empty())
        std::memcpy(vertices_->memory().data() + first_vertex * vertex_bytes_, vertices.data(), vertices.size());
    std::memcpy(indices_->memory().data() + first_index * sizeof(std::uint32_t), indices.data(), indices.size_bytes());
    glBindVertexArray(layout_.name());
    glDrawElementsBaseVertex(primitive == Primitive::points ? GL_POINTS : GL_TRIANGLES, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT,
                             reinterpret_cast<const void*>(first_index * sizeof(std::uint32_t)),
                             static_cast<GLint>(first_vertex));
    in_use_[slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
}

void TriangleStream::grow(std::size_t vertices, std::size_t indices) {
    for (std::size_t slot = 0; slot < slots; ++slot) wait(slot);
    slot_vertices_ = std::max(slot_vertices_, vertices + vertices / 4);
    slot_indices_ = std::max(slot_indices_, indices + indices / 4);
    indices_ = std::make_unique<MappedBuffer>(slots * slot_indices_ * sizeof(std::uint32_t));
    if (slot_vertices_ > 0) {
        vertices_ = std::make_unique<MappedBuffer>(slots * slot_vertices_ * vertex_bytes_);
        glVertexArrayVertexBuffer(layout_.name(), vertex_binding, vertices_->name(), 0,
                                  static_cast<GLsizei>(vertex_bytes_));
    }
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
