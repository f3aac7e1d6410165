// SPDX-License-Identifier: BSD-3-Clause
//
// Batches of triangles to the driver through a ring of mapped buffers; or of indices alone, from which the vertex shader finds
// everything itself (gl_VertexID).
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"

namespace cellproj::gl {

// An attribute of a vertex: floats at an offset [bytes] to a location of the shader.
struct VertexAttribute {
    unsigned int location;
    int components;
    std::size_t offset;
};

// How a vertex type lies in memory and which locations it goes to: of shaders/cell.vert, lit.vert and surfaces.vert.
std::span<const VertexAttribute> vertex_attributes(const StreamVertex*);
std::span<const VertexAttribute> vertex_attributes(const TwoFieldVertex*);
std::span<const VertexAttribute> vertex_attributes(const LitVertex*);
std::span<const VertexAttribute> vertex_attributes(const SurfaceVertex*);

class TriangleStream {
public:
    // No bytes and no attributes: for draw_indices alone.
    TriangleStream(std::size_t vertex_bytes, std::span<const VertexAttribute> attributes);
    ~TriangleStream();
    TriangleStream(const TriangleStream&) = delete;
    TriangleStream& operator=(const TriangleStream&) = delete;

    // Draws the batch with the current program, blending and target, in its order. Returns before the drawing is done; waits
    // only if the ring's next slot is still in use. Batches larger than a slot grow the ring.
    template <class Vertex>
    void draw(const Triangles<Vertex>& batch) {
        assert(sizeof(Vertex) == vertex_bytes_);
        draw(std::as_bytes(std::span(batch.vertices)), batch.indices);
    }
    enum class Primitive { triangles, points };
    void draw_indices(std::span<const std::uint32_t> indices, Primitive primitive) {
        assert(vertex_bytes_ == 0);
        draw({}, indices, primitive);
    }

private:
    void draw(std::span<const std::byte> vertices, std::span<const std::uint32_t> indices,
              Primitive primitive = Primitive::triangles);
    void grow(std::size_t vertices, std::size_t indices);
    void wait(std::size_t slot);

    static constexpr std::size_t slots = 4;
    std::size_t vertex_bytes_;
    Object<delete_vertex_array> layout_;
    std::unique_ptr<MappedBuffer> vertices_, indices_;
    std::size_t slot_vertices_ = 0, slot_indices_ = 0;
    std::array<void*, slots> in_use_{};  // GLsync: signalled when the slot's drawing is done
    std::size_t next_ = 0;
};

template <class Vertex>
TriangleStream make_triangle_stream() {
    return {sizeof(Vertex), vertex_attributes(static_cast<const Vertex*>(nullptr))};
}

}  // namespace cellproj::gl
