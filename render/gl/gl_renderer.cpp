// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/gl_renderer.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <glm/common.hpp>
#include <set>
#include <utility>

#include "classify/segment_method.hpp"
#include "render/depth_window.hpp"
#include "render/gl/shaders.hpp"
#include "render/order_check.hpp"

namespace cellproj::gl {

namespace {

// Large enough that the driver's work per flush (loading and storing the target) is small beside the drawing, small
// enough that projection and drawing overlap.
constexpr std::size_t cells_per_chunk = 16384;

// In scene units, where half the diagonal of the mesh's box is 1: no segment is longer than the diagonal.
constexpr double longest_segment = 2.0;

// The nearest surface alone: what is nearer has a larger depth (shaders/surfaces.frag), and nothing has 0.
void set_depth_test() {
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
}

// Segments that are taken back (project/silhouette.hpp) leave what is below nothing by their rounding.
void keep_physical(Image& image) {
    for (glm::vec4& pixel : image.pixels) {
        pixel = glm::max(pixel, glm::vec4(0.0F));
        pixel.a = std::min(pixel.a, 1.0F);
    }
}

// What shaders/cell.frag knows of a perspective camera.
void set_camera(const Program& program, const CellStream& cells) {
    const glm::dvec2 center = cells.transform().principal_point();
    program.set("principal_point", static_cast<float>(center.x), static_cast<float>(center.y));
    program.set("inverse_near", static_cast<float>(1.0 / cells.near_depth()));
    program.set("pixels_per_unit", static_cast<float>(cells.transform().pixels_per_unit()));
}

// Projects chunks of the order into batches, each of which is drawn while the next one is projected.
template <class Vertex, class Project>
void draw(TriangleStream& stream, const ViewOrder& order, Statistics& statistics, Project project) {
    Triangles<Vertex> batch;
    std::set<CellId> split_cells;
    for (std::size_t begin = 0; begin < order.items.size(); begin += cells_per_chunk) {
        const Stopwatch projecting;
        batch.clear();
        const std::size_t count = std::min(cells_per_chunk, order.items.size() - begin);
        project(ViewOrder{order.items.subspan(begin, count), order.pieces}, batch);
        statistics.ms.project += projecting.ms();

        const Stopwatch drawing;
        stream.draw(batch);
        statistics.ms.draw += drawing.ms();
        statistics.counts.drawn += batch.drawn_cells;
        statistics.counts.triangles += batch.indices.size() / 3;
        split_cells.insert(batch.drawn_split_cells.begin(), batch.drawn_split_cells.end());
    }
    statistics.counts.drawn += split_cells.size();
    const Stopwatch finish;
    glFinish();
    statistics.ms.draw += finish.ms();
}

}  // namespace

GlRenderer::GlRenderer(std::unique_ptr<Context> context, const PlanRules& rules)
    : context_(current(std::move(context))),
      segments_(make_triangle_stream<StreamVertex>()),
      two_field_segments_(make_triangle_stream<TwoFieldVertex>()),
      lit_(make_triangle_stream<LitVertex>()),
      surface_segments_(make_triangle_stream<SurfaceVertex>()),
      rules_(rules) {
    context_->release();
}

// The OpenGL objects below are deleted in their own context, which goes last.
GlRenderer::~GlRenderer() { context_->make_current(); }

void GlRenderer::prepare(const Scene& scene, const Quality& quality) {
    const CurrentContext current(*context_);
    prepare_here(scene, quality);
}

// Brings what depends on the scene and the quality up to date; usually there is nothing to do.
void GlRenderer::prepare_here(const Scene& scene, const Quality& quality) {
    require_drawn(Backend::gl_osmesa, quality, fields_read(scene));
    SurfacePass::require_drawn(scene, quality);
    require_drawn(quality.method, ray_cuts(scene));
    const bool same_cells = prepared_ && prepared_->scene().mesh == scene.mesh && prepared_->scene().field == scene.field &&
                            prepared_->scene().opacity_field == scene.opacity_field;
    const bool same_transfer = same_cells && prepared_->scene().transfer == scene.transfer;
    if (!same_cells) {
        surfaces_.reset();
        prepared_.emplace(scene, SurfacePass::sides_for(quality.surfaces), rules_);
    } else if (!same_transfer) {
        prepared_->set_transfer(scene.transfer);
    }
    prepare_surfaces(scene, quality);
    plan_ = plan_scene(prepared_->facts(), quality, Backend::gl_osmesa, rules_);
    if (plan_.sorts()) prepared_->sorter();
    if (!same_transfer || !(shader_ || lighting_) || method_ != plan_.method) prepare_light(scene, plan_.method, same_cells);
}

// The method's tables; without any where that fails, so that the next call makes them.
void GlRenderer::prepare_light(const Scene& scene, const Method& method, bool same_cells) {
    const SceneUnits& units = prepared_->units();
    const ScalarSpan span{units.scalar_low, units.scalar_high};
    const ScalarSpan opacity_span = scene.opacity_field ? ScalarSpan{units.opacity_low, units.opacity_high} : span;
    const TransferFunction transfer = in_scene_units(*scene.transfer, span, opacity_span, units.length);
    // A walk over all cells, which one method alone wants to know of.
    const double mean_length = method.kind == MethodKind::preint2d ? prepared_->mean_chord() : longest_segment;
    lighting_.reset();
    auto shader = std::exchange(shader_, nullptr);  // no stale table behind a failure
    const bool keeps = shader && same_cells && method_ == method;
    if (light_at_vertices(method)) {
        shader.reset();
        lighting_ = make_vertex_lighting(method, transfer, longest_segment, mean_length);
    } else if (!keeps || !shader->update(transfer)) {
        shader.reset();  // its memory first
        shader = make_segment_shader(method, transfer, fields_read(scene), longest_segment, mean_length);
    }
    shader_ = std::move(shader);
    method_ = method;
}

void GlRenderer::prepare_surfaces(const Scene& scene, const Quality& quality) {
    const SurfaceSides sides = SurfacePass::sides_for(quality.surfaces);
    const PreparedSurfaces* before = prepared_->surfaces();
    if (prepared_->scene().surfaces != scene.surfaces || (before && before->sides() != sides)) {
        prepared_->set_surfaces(scene.surfaces, sides);
        surfaces_.reset();
    }
    if (!has_surface_scene(scene) || (surfaces_ && surfaces_->method() == quality.surfaces)) return;
    surfaces_.reset();  // none behind a failure
    surfaces_ = std::make_unique<SurfacePass>(*prepared_, quality.surfaces);
}

Image GlRenderer::render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality,
                         Statistics* out) {
    Statistics statistics;
    const Stopwatch total;
    validate(camera, "camera");
    validate(size, "size");
    const CurrentContext current(*context_);
    prepare_here(scene, quality);
    const Plan plan = plan_view(plan_, prepared_->facts(), camera, size, ray_cuts(scene), rules_);
    statistics.ms.plan = total.ms();
    if (plan.drawing == Plan::Drawing::nothing) {
        Image image(size.width, size.height);
        if (ray_cuts(scene).any()) DepthWindow(scene, camera, size, prepared_->units().length).add_opaque(image);
        statistics.ms.total = total.ms();
        describe(statistics, quality, plan);
        if (out) *out = std::move(statistics);
        return image;
    }
    const bool nearest = plan.drawing == Plan::Drawing::nearest_surfaces;
    if (!target_.is(size, quality.target, nearest)) target_ = Target(size, quality.target, nearest);

    const Stopwatch sort;
    OrderReport order_report;
    const ViewOrder order = find_order(plan, camera, size, quality, order_report);
    statistics.ms.sort = sort.ms();

    const Stopwatch transform;
    const CellStream cells(*prepared_, camera, size);
    std::optional<DepthWindow> window;
    windows_.reset();
    if (ray_cuts(scene).any()) {
        window.emplace(scene, camera, size, prepared_->units().length);
        windows_.emplace(*window, surfaces_ ? cells.nearness_frame() : cells.segment_frame(), size.width);
    }
    statistics.ms.project = transform.ms();
    target_.clear_and_bind();
    nearest ? set_depth_test() : blend_back_to_front();
    if (surfaces_) {
        draw_surfaces(cells, order, nearest, statistics);
    } else {
        lighting_ ? draw_lit(cells, order, statistics) : draw_segments(cells, order, statistics);
    }

    const Stopwatch read_back;
    Image image = target_.read();
    check_errors("drawing");
    keep_physical(image);
    if (window) window->add_opaque(image);
    statistics.ms.read_back = read_back.ms();
    statistics.ms.total = total.ms();

    describe(statistics, quality, plan);
    if (out) {  // the proof of the order is no part of the frame
        if (plan.sorts()) {
            prepared_->judge(order, order_report, camera, size, quality, statistics);
            tell_order(statistics.plan, statistics.order, statistics.order_exact);
        }
        *out = std::move(statistics);
    }
    return image;
}

// What is known without the order of cells.
void GlRenderer::describe(Statistics& statistics, const Quality& quality, const Plan& plan) const {
    statistics.counts.cells = prepared_->facts().cells;
    statistics.counts.culled = statistics.counts.cells - statistics.counts.drawn;
    statistics.method = to_string(quality.method);
    statistics.target = to_string(quality.target);
    statistics.table_bytes = (shader_ ? shader_->table_bytes() : 0) + (surfaces_ ? surfaces_->table_bytes() : 0);
    statistics.backend = context_->name();
    statistics.backend_version = driver_version();
    statistics.plan = plan.decisions;
    statistics.order = "none";  // needed, that is
    statistics.order_exact = true;
}

ViewOrder GlRenderer::find_order(const Plan& plan, const Camera& camera, ImageSize size, const Quality& quality, OrderReport& report) {
    if (plan.drawing == Plan::Drawing::nearest_surfaces) return {prepared_->surfaces()->crossed(), {}};
    if (plan.drawing == Plan::Drawing::sum) return prepared_->any_order();
    return prepared_->order(camera, size, quality.order, &report);
}

void GlRenderer::draw_segments(const CellStream& cells, const ViewOrder& order, Statistics& statistics) {
    const bool perspective = cells.transform().perspective();
    const bool two_fields = fields_read(prepared_->scene()) == FieldsRead::two;
    const Program& segments =
        programs_.of(shaders::cell_vert + shader_->vertex_source(), shaders::cell_frag + shaders::light_glsl + shader_->source(),
                std::string(perspective ? "#define PERSPECTIVE\n" : "") + (two_fields ? "#define TWO_FIELDS\n" : "") +
                    (windows_ ? "#define WINDOW\n" : "") + blending_define(method_));
    if (perspective) set_camera(segments, cells);
    if (windows_) windows_->bind(segments);
    shader_->bind(segments);
    segments.use();
    if (two_fields) {
        draw<TwoFieldVertex>(two_field_segments_, order, statistics,
                             [&](const ViewOrder& chunk, TwoFieldBatch& batch) { cells.project(chunk, batch); });
        return;
    }
    draw<StreamVertex>(segments_, order, statistics,
                       [&](const ViewOrder& chunk, TriangleBatch& batch) { cells.project(chunk, batch); });
}

void GlRenderer::draw_surfaces(const CellStream& cells, const ViewOrder& order, bool nearest, Statistics& statistics) {
    const NearnessFrame frame = cells.nearness_frame();
    const bool medium = prepared_->has_medium();
    const Program& surfaces = programs_.of(shaders::surfaces_vert + (medium ? shader_->vertex_source() : shaders::no_cell_glsl),
                                      shaders::surfaces_frag + shaders::reflected_glsl + (prepared_->lights_medium() ? shaders::lit_medium_glsl : "") +
                                          (medium ? shaders::light_glsl + shader_->source() : ""),
                                      surfaces_->defines(frame.perspective, nearest) + (windows_ ? "#define WINDOW\n" : ""));
    surfaces_->bind(surfaces, cells, frame, {.nearest = nearest, .windowed = windows_.has_value()});
    if (windows_) windows_->bind(surfaces);
    if (medium) shader_->bind(surfaces);
    surfaces.use();
    draw<SurfaceVertex>(surface_segments_, order, statistics, [&](const ViewOrder& chunk, SurfaceBatch& batch) {
        cells.project(chunk, frame, batch);
    });
}

void GlRenderer::draw_lit(const CellStream& cells, const ViewOrder& order, Statistics& statistics) {
    programs_.of(shaders::lit_vert, shaders::lit_frag, blending_define(method_)).use();
    draw<LitVertex>(lit_, order, statistics,
                    [&](const ViewOrder& chunk, LitBatch& batch) { cells.project(chunk, *lighting_, batch); });
}

}  // namespace cellproj::gl
