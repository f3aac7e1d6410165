// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_gl_renderer.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "classify/segment_method.hpp"
#include "mesh/error.hpp"
#include "render/gl/grid_traversal.hpp"
#include "render/gl/shaders.hpp"
#include "render/scene_view.hpp"

namespace cellproj::gl {

namespace {

constexpr std::size_t cells_per_chunk = 16384;

// In scene units: no segment is longer than the diagonal of the box.
constexpr double longest_segment = 2.0;

// Components of the viewing direction that are nothing but the rounding of the camera's frame.
constexpr double stillness = 1e-12;

constexpr unsigned int values_unit = 8, planes_unit = 9;

OsmesaContext current(OsmesaContext context) {
    context.make_current();
    return context;
}

// What every shader of a grid knows of the camera; places are about `reference` [mesh units].
struct GridView {
    ScreenTransform transform;  // about the eye, scene units
    glm::dvec3 reference;
    glm::dvec2 center;  // where it is on the screen [pixels]; the principal point in perspective
};

GridView view_of(const Grid& grid, const Camera& camera, ImageSize size, double length) {
    const ScreenTransform transform = relative_transform(camera, size, length);
    if (transform.perspective()) return {transform, camera.eye, transform.principal_point()};
    const glm::dvec3 middle = grid.bounds().center();
    return {transform, middle, transform.to_screen(transform.to_eye((middle - camera.eye) / length))};
}

void set_rays(const Program& program, const GridView& view) {
    // The rows of the rotation, seen through what it makes of the axes.
    const ScreenTransform& t = view.transform;
    const glm::dvec3 x = t.to_eye({1, 0, 0}), y = t.to_eye({0, 1, 0}), z = t.to_eye({0, 0, 1});
    program.set("ray_center", static_cast<float>(view.center.x), static_cast<float>(view.center.y));
    program.set("pixels_per_unit", static_cast<float>(t.pixels_per_unit()));
    program.set("axis_right", glm::vec3(x.x, y.x, z.x));
    program.set("axis_down", glm::vec3(x.y, y.y, z.y));
    const glm::dvec3 forward(x.z, y.z, z.z);
    program.set("axis_forward", glm::vec3(forward));
    if (t.perspective()) return;
    const auto still = glm::lessThan(glm::abs(forward), glm::dvec3(stillness));
    program.set("inverse_forward", glm::vec3(glm::mix(1.0 / forward, glm::dvec3(1e20), still)));
    program.set("nudge", glm::vec3(glm::mix(glm::dvec3(0.0), glm::dvec3(1e-10), still)));
}

void set_grid(const Program& program, const Grid& grid, ImageSize size) {
    program.set("grid_cells", glm::vec3(grid.axes[0].cells(), grid.axes[1].cells(), grid.axes[2].cells()));
    program.set("picture", static_cast<float>(size.width), static_cast<float>(size.height));
}

double largest_point() {
    std::array<GLfloat, 2> range{};
    glGetFloatv(GL_POINT_SIZE_RANGE, range.data());
    return range[1];
}

// Which cells a point covers well: no larger than the driver's largest one, and as wide as high, more or less.
class CellSizes {
public:
    CellSizes(const Grid& grid, const GridView& view, double length, double limit) : cells_{}, view_(view), limit_(limit) {
        const ScreenTransform& t = view.transform;
        const glm::dvec3 x = t.to_eye({1, 0, 0}), y = t.to_eye({0, 1, 0}), z = t.to_eye({0, 0, 1});
        glm::dvec2 extent(0.0);  // of the mean cell
        double squared = 0.0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::vector<double>& planes = grid.axes[a].coordinates;
            const glm::dvec3 axis = a == 0 ? x : a == 1 ? y : z;
            cells_[a] = grid.axes[a].cells();
            double longest = 0.0;
            for (std::size_t i = 0; i < cells_[a]; ++i) {
                longest = std::max(longest, planes[i + 1] - planes[i]);
                depths_[a].push_back(((planes[i] + planes[i + 1]) / 2 - view.reference[static_cast<int>(a)]) / length * axis.z);
            }
            extent += glm::dvec2(glm::abs(axis)) * ((planes.back() - planes.front()) / static_cast<double>(cells_[a]));
            squared += longest * longest / (length * length);
        }
        diameter_ = std::sqrt(squared);
        square_ = std::max(extent.x, extent.y) < most_oblong * std::min(extent.x, extent.y);
        const glm::dvec2 corner = glm::dvec2(t.size().width, t.size().height) / 2.0;
        widest_ = 1.0 + std::max(corner.x, corner.y) / t.pixels_per_unit();
    }

    bool all_fit(std::span<const std::uint32_t> ids) const {
        if (!square_) return false;
        const double size = diameter_ * view_.transform.pixels_per_unit();
        if (!view_.transform.perspective()) return size < limit_ - 1;
        // Of two points p, q of a cell, p_x / p_z − q_x / q_z = (p_x − q_x) / p_z − (p_z − q_z) q_x / (q_z p_z); one in the picture
        // serves as q, so that no point is farther from it than `widest_` diameters over the least depth.
        const double nearest = 0.5 * diameter_ + 4 * widest_ * size / limit_;
        return std::all_of(ids.begin(), ids.end(), [&](std::uint32_t id) {
            const std::size_t row = id / cells_[0];
            return depths_[0][id - row * cells_[0]] + depths_[1][row % cells_[1]] + depths_[2][row / cells_[1]] > nearest;
        });
    }

private:
    // Where a square is half empty, a rectangle, at four times the vertices, is cheaper.
    static constexpr double most_oblong = 2.0;

    std::array<std::size_t, 3> cells_;
    std::array<std::vector<double>, 3> depths_;  // of the middles of cells along each axis: their sum is that of a cell
    const GridView& view_;
    double limit_, diameter_, widest_;
    bool square_;
};

}  // namespace

void require_grid_drawn(const GridQuality& quality, bool surfaces) {
    if (surfaces)
        throw Error({ErrorKind::option, "isosurfaces", "none in a grid for the OpenGL backend", "some",
                     "use the CPU backend (--backend cpu), or draw the grid as tetrahedra (--as tets)"});
    (void)quality;
}

GlGridRenderer::GlGridRenderer(OsmesaContext context) : context_(current(std::move(context))), indices_(0, {}) {}

GlGridRenderer::~GlGridRenderer() { context_.make_current(); }

void GlGridRenderer::prepare(const GridScene& scene, const GridQuality& quality) {
    gl::require_grid_drawn(quality, has_surfaces(scene));
    context_.make_current();
    const bool same_grid = volume_ && scene_.grid == scene.grid;
    const bool same_transfer = same_grid && scene_.transfer == scene.transfer;
    if (!same_grid) {
        volume_.reset();  // none of another scene behind a failure
        shader_.reset();
        validate(scene);
        volume_.emplace(scene);
    } else if (!same_transfer) {
        volume_->set_transfer(*scene.grid, *scene.transfer);
    }
    scene_ = scene;
    if (!same_transfer || !shader_ || method_ != quality.method) prepare_light(quality, same_grid);
}

void GlGridRenderer::prepare_light(const GridQuality& quality, bool same_grid) {
    const GridUnits& units = volume_->units();
    const TransferFunction transfer = in_scene_units(*scene_.transfer, units.scalar_low, units.scalar_high, units.length);
    auto shader = std::exchange(shader_, nullptr);  // no stale table behind a failure
    const bool keeps = shader && same_grid && method_ == quality.method;
    if (!keeps || !shader->update(transfer)) {
        shader.reset();  // its memory first
        shader = make_segment_shader(quality.method, transfer, FieldsRead::one, longest_segment, volume_->mean_chord());
    }
    shader_ = std::move(shader);
    method_ = quality.method;
}

const Program& GlGridRenderer::program(const std::string& vertex, const std::string& fragment, const std::string& defines) {
    const std::string key = defines + vertex + fragment;
    const auto known = programs_.find(key);
    if (known != programs_.end()) return known->second;
    return programs_[key] = Program(vertex, fragment, defines);
}

Image GlGridRenderer::render(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality,
                             Statistics* out) {
    Statistics statistics;
    const Stopwatch total;
    cellproj::validate(camera, "camera");
    cellproj::validate(size, "size");
    prepare(scene, quality);
    if (!target_.is(size, quality.target, false)) target_ = Target(size, quality.target, false);
    statistics.ms.plan = total.ms();

    target_.clear_and_bind();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw_cells(camera, size, statistics);

    const Stopwatch read_back;
    Image image = target_.read();
    check_errors("drawing");
    statistics.ms.read_back = read_back.ms();
    statistics.ms.total = total.ms();
    if (!out) return image;
    statistics.counts.cells = scene.grid->cell_count();
    statistics.counts.culled = statistics.counts.cells - statistics.counts.drawn;
    statistics.method = to_string(quality.method);
    statistics.target = to_string(quality.target);
    statistics.table_bytes = shader_->table_bytes();
    statistics.backend = "gl_osmesa";
    statistics.backend_version = driver_version();
    statistics.order = "slices";
    statistics.order_exact = true;
    *out = std::move(statistics);
    return image;
}

void GlGridRenderer::draw_cells(const Camera& camera, ImageSize size, Statistics& statistics) {
    const Grid& grid = *scene_.grid;
    const double length = volume_->units().length;
    const GridView view = view_of(grid, camera, size, length);
    const Texture planes = Texture::list(planes_about(grid, view.reference, length));
    volume_->values().bind(values_unit);
    planes.bind(planes_unit);
    const std::string defines = std::string(view.transform.perspective() ? "#define PERSPECTIVE\n" : "") +
                                (grid.location == FieldLocation::cells ? "#define ON_CELLS\n" : "") +
                                (method_.blending == Blending::half ? "#define HALF_OPACITY\n" : "");
    const auto make_ready = [&](const std::string& more) -> const Program& {
        const Program& cells = program(shaders::grid_place_vert + shaders::grid_cell_vert + shader_->vertex_source(),
                                       shaders::grid_cell_frag + shaders::light_glsl + shader_->source(), defines + more);
        set_rays(cells, view);
        set_grid(cells, grid, size);
        shader_->bind(cells);
        return cells;
    };
    const Program& points = make_ready("#define POINTS\n");
    const Program& rectangles = make_ready("");
    glEnable(GL_PROGRAM_POINT_SIZE);

    const CellSizes sizes(grid, view, length, largest_point());
    GridTraversal traversal(grid, camera.viewpoint(), volume_->drawn());
    std::vector<std::uint32_t> ids, indices;
    for (;;) {
        const Stopwatch ordering;
        traversal.next(cells_per_chunk, ids);
        if (ids.empty()) break;
        const bool small = sizes.all_fit(ids);
        indices.clear();
        if (!small) {
            for (const std::uint32_t id : ids)
                indices.insert(indices.end(), {4 * id, 4 * id + 1, 4 * id + 2, 4 * id + 2, 4 * id + 1, 4 * id + 3});
        }
        statistics.ms.sort += ordering.ms();
        const Stopwatch drawing;
        using Primitive = TriangleStream::Primitive;
        (small ? points : rectangles).use();
        small ? indices_.draw_indices(ids, Primitive::points) : indices_.draw_indices(indices, Primitive::triangles);
        statistics.ms.draw += drawing.ms();
        statistics.counts.drawn += ids.size();
        statistics.counts.triangles += small ? 0 : 2 * ids.size();
    }
    const Stopwatch finish;
    glFinish();
    statistics.ms.draw += finish.ms();
}

}  // namespace cellproj::gl
