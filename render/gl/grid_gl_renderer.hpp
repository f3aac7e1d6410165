// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids through OpenGL, after Wilhelms and Van Gelder, "A Coherent Projection Approach for Direct Volume Rendering", 1991.
#pragma once

#include <memory>
#include <optional>

#include "project/camera.hpp"
#include "render/depth_window.hpp"
#include "render/gl/context.hpp"
#include "render/gl/grid_closed_tiles.hpp"
#include "render/gl/grid_surface_pass.hpp"
#include "render/gl/grid_view.hpp"
#include "render/gl/grid_volume.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/triangle_stream.hpp"
#include "render/grid_renderer.hpp"

namespace cellproj::gl {

// Throws Error (option) for what this backend does not draw of grids.
void require_grid_drawn(const GridQuality& quality, const GridShading& shading);
// Likewise for a grid that cannot be sliced so: a texture interpolates values on points, evenly spaced, all of them there.
void require_sliced(const Grid& grid, const GridSampling& sampling);

class GlGridRenderer : public GridRenderer {
public:
    explicit GlGridRenderer(std::unique_ptr<Context> context, const PlanRules& rules = {});
    ~GlGridRenderer() override;

    void prepare(const GridScene& scene, const GridQuality& quality) override;
    Image render(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality,
                 Statistics* statistics) override;

private:
    void prepare_here(const GridScene& scene, const GridQuality& quality);
    void prepare_light(const GridQuality& quality, bool same_grid);
    TransferFunction transfer_in_units() const;  // of scene_
    struct Lengths {
        double mean, longest;  // of segments [scene units]
    };
    Lengths segment_lengths(const GridSampling& sampling) const;
    GridLight light();
    // Front to back, if what is drawn may become opaque, until all of it is.
    bool front_to_back() const { return opaque_.has_value(); }
    // Returns whether no cell reaches from one pixel to the next.
    bool draw_cells(const GridView& view, const Camera& camera, const DepthWindow* window, ClosedTiles* closed, Statistics& statistics);
    void draw_slabs(const GridView& view, ClosedTiles* closed, Statistics& statistics);

    std::unique_ptr<Context> context_;  // current during calls only
    PlanRules rules_;
    Programs programs_;
    TriangleStream indices_, pairs_, slabs_, outlines_;
    Target target_;
    GridScene scene_;
    std::optional<GridVolume> volume_;
    GridQuality quality_;
    // Of quality_, for the prepared scene.
    std::unique_ptr<SegmentShader> shader_;
    Texture classified_;  // where points are classified
    std::optional<GridSurfacePass> surfaces_;  // of scene_
    bool medium_ = true;                       // whether there is light between them
    std::optional<float> opaque_;              // hiding_opacity of scene_, for quality_
};

}  // namespace cellproj::gl
