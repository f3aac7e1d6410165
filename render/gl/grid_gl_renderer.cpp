// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_gl_renderer.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "classify/segment_method.hpp"
#include "mesh/error.hpp"
#include "render/gl/grid_closed_tiles.hpp"
#include "render/gl/grid_footprints.hpp"
#include "render/gl/grid_slabs.hpp"
#include "render/gl/grid_templates.hpp"
#include "render/gl/grid_traversal.hpp"
#include "render/gl/grid_view.hpp"
#include "render/gl/shaders.hpp"
#include "render/gl/window_texture.hpp"
#include "render/grid_plan.hpp"
#include "render/surface_method.hpp"

namespace cellproj::gl {

namespace {

constexpr std::size_t cells_per_chunk = 16384;

constexpr unsigned int values_unit = 8;  // behind those of the methods (segment_shader.hpp)

}  // namespace

void require_grid_drawn(const GridQuality& quality, const GridShading& shading) {
    const auto refuse = [](const char* option, const char* expected, const std::string& found, const char* advice) {
        throw Error({ErrorKind::option, option, expected, found, advice});
    };
    if (shading.isosurfaces && quality.sampling.light != GridSampling::Light::segment)
        refuse("--sampling", "slabs by their two slices for isosurfaces", to_string(quality.sampling), "leave out pre or post");
    if ((shading.isosurfaces || shading.lit_medium) && !takes_surfaces(quality.method))
        refuse("--method", "a method of light per pixel, blended once, for isosurfaces and lit media", to_string(quality.method), "leave it out");
    // Between two faces the scalar is a cubic; segments of this backend are linear.
    if (quality.method.kind == MethodKind::exact)
        refuse("--method", "one that OpenGL draws for a regular grid", to_string(quality.method),
               "use the CPU backend (--backend cpu), or integral");
    if (quality.method.kind == MethodKind::shirley_tuchman)
        refuse("--method", "one that OpenGL draws for a regular grid", to_string(quality.method),
               "use homogeneous:vertices, or draw the grid as tetrahedra (--as tets)");
    if (quality.sampling.cut != GridSampling::Cut::cells && light_at_vertices(quality.method))
        refuse("--method", "a method of light per pixel for slabs", to_string(quality.method), "use cells (--sampling cells)");
}

void require_sliced(const Grid& grid, const GridSampling& sampling) {
    const auto refuse = [&](const char* expected, const char* found) {
        throw Error({ErrorKind::option, "--sampling", std::string(expected) + " for " + to_string(sampling), found, "use cells"});
    };
    if (grid.location != FieldLocation::points) refuse("values on points", "values on cells");
    if (!grid.blanked.empty()) refuse("a grid without blanked cells", "some");
    for (const GridAxis& axis : grid.axes) {
        if (!axis.spacing) refuse("uniform axes", "a rectilinear grid");
    }
}

GlGridRenderer::GlGridRenderer(std::unique_ptr<Context> context, const PlanRules& rules)
    : context_(current(std::move(context))),
      rules_(rules),
      indices_(0, {}),
      pairs_(make_triangle_stream<TemplatePair>()),
      slabs_(make_triangle_stream<SlabVertex>()),
      outlines_(make_triangle_stream<OutlineVertex>()) {
    context_->release();
}

// The OpenGL objects below are deleted in their own context, which goes last.
GlGridRenderer::~GlGridRenderer() { context_->make_current(); }

void GlGridRenderer::prepare(const GridScene& scene, const GridQuality& quality) {
    const CurrentContext current(*context_);
    prepare_here(scene, quality);
}

void GlGridRenderer::prepare_here(const GridScene& scene, const GridQuality& quality) {
    gl::require_grid_drawn(quality, grid_shading(scene));
    require_grid_cut(quality, ray_cuts(scene));
    if (quality.sampling.cut != GridSampling::Cut::cells) require_sliced(*scene.grid, quality.sampling);
    const bool same_grid = volume_ && scene_.grid == scene.grid;
    const bool same_transfer = same_grid && scene_.transfer == scene.transfer;
    const bool same_surfaces = same_grid && scene_.surfaces == scene.surfaces;
    if (!same_grid || !same_surfaces) validate(scene);
    if (!same_grid) {
        volume_.reset();  // none of another scene behind a failure
        shader_.reset();
        volume_.emplace(scene);
    }
    if (!same_surfaces) {
        surfaces_.reset();
        scene_.surfaces.reset();
        if (has_surfaces(scene) || has_lit_medium(scene)) surfaces_.emplace(scene, volume_->units());
    }
    if (!same_surfaces || !same_transfer)
        volume_->set_light(*scene.grid, *scene.transfer, surfaces_ ? std::span(surfaces_->thresholds()) : std::span<const float>());
    scene_ = scene;
    const bool same_light = quality_.method == quality.method && quality_.sampling == quality.sampling;
    if (!same_transfer || !shader_ || !same_light) prepare_light(quality, same_grid);
    // Formats of fewer digits round differently in each order, and do not tell opaque from nearly opaque.
    const bool tells = quality.target == TargetFormat::rgba32f;
    opaque_ = rules_.front_to_back && tells ? hiding_opacity(transfer_in_units(), scene_.surfaces.get()) : std::nullopt;
}

TransferFunction GlGridRenderer::transfer_in_units() const {
    const GridUnits& units = volume_->units();
    return in_scene_units(*scene_.transfer, units.scalar_low, units.scalar_high, units.length);
}

// Slabs: what most of them are that look along their normal, and the diagonal of the box, as slices may be seen edge-on.
GlGridRenderer::Lengths GlGridRenderer::segment_lengths(const GridSampling& sampling) const {
    if (sampling.cut == GridSampling::Cut::cells) return {volume_->mean_chord(), volume_->longest_chord()};
    double thickest = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        thickest = std::max(thickest, slab_thickness(*scene_.grid, volume_->units(), sampling, axis));
    return {thickest, 2.0};
}

void GlGridRenderer::prepare_light(const GridQuality& quality, bool same_grid) {
    const TransferFunction transfer = transfer_in_units();
    medium_ = transfer.visible(0.0, 1.0);
    auto shader = std::exchange(shader_, nullptr);  // no stale table behind a failure
    classified_ = {};
    const bool keeps = shader && same_grid && quality_.method == quality.method && quality_.sampling == quality.sampling;
    if (!keeps || !shader->update(transfer)) {
        shader.reset();  // its memory first
        const Lengths lengths = segment_lengths(quality.sampling);
        shader = make_segment_shader(quality.method, transfer, FieldsRead::one, lengths.longest, lengths.mean);
    }
    if (quality.sampling.light == GridSampling::Light::pre) classified_ = volume_->classified(*scene_.grid, transfer);
    shader_ = std::move(shader);
    quality_ = quality;
}

Image GlGridRenderer::render(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality,
                             Statistics* out) {
    Statistics statistics;
    const Stopwatch total;
    cellproj::validate(camera, "camera");
    cellproj::validate(size, "size");
    const CurrentContext current(*context_);
    prepare_here(scene, quality);
    if (!target_.is(size, quality.target, front_to_back())) target_ = Target(size, quality.target, front_to_back());
    statistics.ms.plan = total.ms();

    target_.clear_and_bind();
    blend_back_to_front();
    const GridView view(*scene.grid, volume_->units(), camera, size);
    std::optional<ClosedTiles> tiles;
    if (front_to_back()) tiles.emplace(view, target_, programs_, outlines_, *opaque_);
    ClosedTiles* closed = tiles ? &*tiles : nullptr;
    volume_->values().bind(values_unit);
    const bool cells = quality.sampling.cut == GridSampling::Cut::cells;
    std::optional<DepthWindow> window;
    if (ray_cuts(scene).any()) window.emplace(scene, camera, size, volume_->units().length);
    GridFacts facts{.rays = false, .medium = medium_, .front_to_back = front_to_back()};
    if (cells) facts.smaller_than_a_pixel = draw_cells(view, camera, window ? &*window : nullptr, closed, statistics);
    else draw_slabs(view, closed, statistics);

    const Stopwatch read_back;
    Image image = target_.read();
    check_errors("drawing");
    if (window) window->add_opaque(image);
    statistics.ms.read_back = read_back.ms();
    statistics.ms.total = total.ms();
    if (!out) return image;
    statistics.counts.cells = scene.grid->cell_count();
    statistics.counts.culled = statistics.counts.cells - statistics.counts.drawn;
    statistics.drawn_as = "grid";
    statistics.method = to_string(quality.method);
    statistics.target = to_string(quality.target);
    statistics.table_bytes = shader_->table_bytes();
    statistics.backend = context_->name();
    statistics.backend_version = driver_version();
    statistics.order = cells ? "slices" : to_string(quality.sampling);
    statistics.order_exact = true;
    facts.cells = statistics.counts.cells;
    facts.drawn = statistics.counts.drawn;
    statistics.plan = plan_of(scene, quality, facts);
    *out = std::move(statistics);
    return image;
}

GridLight GlGridRenderer::light() {
    if (!surfaces_) return {.shader = shader_.get()};
    const bool lit_medium = medium_ && has_lit_medium(scene_), lit = lit_medium || surfaces_->isosurfaces();
    return {.shader = medium_ || !surfaces_->isosurfaces() ? shader_.get() : nullptr,
            .surfaces = &*surfaces_,
            .gradients = lit && surfaces_->smooth() ? &volume_->gradients(*scene_.grid) : nullptr,
            .lit_medium = lit_medium};
}

bool GlGridRenderer::draw_cells(const GridView& view, const Camera& camera, const DepthWindow* window, ClosedTiles* closed, Statistics& statistics) {
    const std::string blending = blending_define(quality_.method);
    std::optional<const WindowTexture> kept;
    if (window) kept.emplace(*window, view.perspective() ? 0.0 : view.to_eye(glm::dvec3(0.0)).z, view.transform().size().width);
    GridFootprints footprints(view, light(), programs_, blending, kept ? &*kept : nullptr, indices_);
    std::optional<GridTemplates> templates;
    // WVG91 §4: one quad where polygons would cover no pixel.
    const bool smaller_than_a_pixel = footprints.all_smaller_than_a_pixel();
    if (light_at_vertices(quality_.method) && !smaller_than_a_pixel)
        templates.emplace(view, volume_->units(), *shader_, programs_, blending, footprints, indices_, pairs_);

    GridTraversal traversal(*scene_.grid, camera.viewpoint(), volume_->drawn(), closed ? largest_slice_first(view.forward()) : GridOrder{});
    std::vector<std::uint32_t> cells;
    const auto draw_part = [&] {
        for (;;) {
            const Stopwatch ordering;
            traversal.next(cells_per_chunk, cells);
            statistics.ms.sort += ordering.ms();
            if (cells.empty()) return;
            const Stopwatch drawing;
            statistics.counts.triangles += templates ? templates->draw(cells) : footprints.draw(cells);
            statistics.counts.drawn += cells.size();
            statistics.ms.draw += drawing.ms();
        }
    };
    if (closed) {
        LookRhythm rhythm(traversal.slices_left());
        for (;;) {
            traversal.begin_part(rhythm.step(), [&](const CellRange& brick) { return closed->hide(view.corners(brick)); });
            draw_part();
            if (traversal.slices_left() == 0) break;
            const Stopwatch looking;
            rhythm.looked(closed->look(view.corners(traversal.rest())));
            statistics.ms.draw += looking.ms();
            if (closed->all()) break;
        }
    } else {
        draw_part();
    }
    const Stopwatch finish;
    glFinish();
    statistics.ms.draw += finish.ms();
    return smaller_than_a_pixel;
}

void GlGridRenderer::draw_slabs(const GridView& view, ClosedTiles* closed, Statistics& statistics) {
    const Stopwatch drawing;
    const bool pre = quality_.sampling.light == GridSampling::Light::pre;
    GridLight light = this->light();
    if (pre) light.shader = nullptr;
    statistics.counts.triangles = gl::draw_slabs(view, volume_->units(), quality_.sampling, light, pre ? &classified_ : nullptr, programs_,
                                                 blending_define(quality_.method), slabs_, closed);
    statistics.counts.drawn = scene_.grid->cell_count();
    glFinish();
    statistics.ms.draw = drawing.ms();
}

}  // namespace cellproj::gl
