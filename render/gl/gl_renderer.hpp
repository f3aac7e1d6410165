// SPDX-License-Identifier: BSD-3-Clause
//
// Cell projection through OpenGL: RKE00 §2–3 on a float32 target. Projected triangles stream through a ring of mapped
// buffers in chunks, so that the projection of one chunk overlaps the drawing of those before it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "render/cell_stream.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/osmesa_context.hpp"
#include "render/gl/segment_shader.hpp"
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
    const Program& program_for(bool perspective);
    void set_uniforms(const Program& program, const CellStream& cells) const;
    void draw(const CellStream& cells, std::span<const CellId> order, Statistics& statistics);

    OsmesaContext context_;
    std::map<std::pair<const std::string*, bool>, Program> programs_;  // by the method's source and whether in perspective
    TriangleStream stream_;
    FloatTarget target_;
    std::optional<PreparedScene> prepared_;
    Method method_;
    std::unique_ptr<SegmentShader> shader_;  // of method_, for the prepared scene
};

}  // namespace cellproj::gl
