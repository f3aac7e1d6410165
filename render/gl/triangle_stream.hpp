// SPDX-License-Identifier: BSD-3-Clause
//
// Batches of triangles to the driver through a ring of mapped buffers.
#pragma once

#include <array>
#include <cstddef>

#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"

namespace cellproj::gl {

class TriangleStream {
public:
    TriangleStream();
    ~TriangleStream();
    TriangleStream(const TriangleStream&) = delete;
    TriangleStream& operator=(const TriangleStream&) = delete;

    // Draws the batch with the current program, blending and target, in its order. Returns before the drawing is done; waits
    // only if the ring's next slot is still in use. Batches larger than a slot grow the ring.
    void draw(const TriangleBatch& batch);

private:
    struct Slot;
    void grow(std::size_t vertices, std::size_t indices);
    void wait(std::size_t slot);

    static constexpr std::size_t slots = 4;
    Object<delete_vertex_array> layout_;
    std::unique_ptr<MappedBuffer> vertices_, indices_;
    std::size_t slot_vertices_ = 0, slot_indices_ = 0;
    std::array<void*, slots> in_use_{};  // GLsync: signalled when the slot's drawing is done
    std::size_t next_ = 0;
};

}  // namespace cellproj::gl
