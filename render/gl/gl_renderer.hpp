// SPDX-License-Identifier: BSD-3-Clause
//
// Cell projection through OpenGL: RKE00 §2–3 on a float32 target. Projected triangles stream through a ring of mapped
// buffers in chunks, so that the projection of one chunk overlaps the drawing of those before it.
#pragma once

#include <memory>
#include <optional>

#include "classify/preintegration_table.hpp"
#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/osmesa_context.hpp"
#include "render/gl/triangle_stream.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"

namespace cellproj::gl {

class GlRenderer : public Renderer {
public:
    explicit GlRenderer(OsmesaContext context);
    ~GlRenderer() override;

    void prepare(const Scene& scene, const Quality& quality) override;
    Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality,
                 Statistics* statistics) override;

private:
    void set_uniforms(const Program& program, const CellStream& cells) const;
    void draw(const CellStream& cells, std::span<const CellId> order, Statistics& statistics);

    OsmesaContext context_;
    Program parallel_, perspective_;
    TriangleStream stream_;
    FloatTarget target_;
    std::optional<PreparedScene> prepared_;
    std::optional<PreintegrationTable> table_;
    Texture3d table_texture_;
};

}  // namespace cellproj::gl
