// SPDX-License-Identifier: BSD-3-Clause
//
// Cell projection through OpenGL: RKE00 §2–3. Projected triangles stream through a ring of mapped
// buffers in chunks, so that the projection of one chunk overlaps the drawing of those before it.
#pragma once

#include <memory>
#include <optional>

#include "classify/vertex_light.hpp"
#include "render/cell_stream.hpp"
#include "render/gl/context.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/surface_pass.hpp"
#include "render/gl/triangle_stream.hpp"
#include "render/gl/window_texture.hpp"
#include "render/plan.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"

namespace cellproj::gl {

class GlRenderer : public Renderer {
public:
    explicit GlRenderer(std::unique_ptr<Context> context, const PlanRules& rules = {});
    ~GlRenderer() override;

    void prepare(const Scene& scene, const Quality& quality) override;
    Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality,
                 Statistics* statistics) override;

private:
    void prepare_here(const Scene& scene, const Quality& quality);
    void prepare_light(const Scene& scene, const Method& method, bool same_cells);
    void prepare_surfaces(const Scene& scene, const Quality& quality);
    ViewOrder find_order(const Plan& plan, const Camera& camera, ImageSize size, const Quality& quality, OrderReport& report);
    void describe(Statistics& statistics, const Quality& quality, const Plan& plan) const;
    void draw_segments(const CellStream& cells, const ViewOrder& order, Statistics& statistics);
    void draw_lit(const CellStream& cells, const ViewOrder& order, Statistics& statistics);
    void draw_surfaces(const CellStream& cells, const ViewOrder& order, bool nearest, Statistics& statistics);

    std::unique_ptr<Context> context_;  // current during calls only
    Programs programs_;
    TriangleStream segments_, two_field_segments_, lit_, surface_segments_;
    Target target_;
    PlanRules rules_;
    std::optional<PreparedScene> prepared_;
    Plan plan_;  // of all views
    Method method_;
    // Of method_, for the prepared scene: either light for each pixel or light at the vertices.
    std::unique_ptr<SegmentShader> shader_;
    std::unique_ptr<VertexLighting> lighting_;
    std::unique_ptr<SurfacePass> surfaces_;  // where the scene has some
    std::optional<WindowTexture> windows_;   // of the picture at hand, where rays are cut
};

}  // namespace cellproj::gl
