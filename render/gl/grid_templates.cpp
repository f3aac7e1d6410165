// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_templates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>

#include "render/gl/shaders.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int template_unit = 10;  // shaders/grid_lit.vert

// Cells whose nearest corner is nearer than this, in diameters of the cell, are drawn per pixel: their projection is wide, or has no end.
constexpr double least_depth = 0.5;

constexpr std::array<VertexAttribute, 2> pair_attributes{{{0, 2, offsetof(TemplatePair, x)}, {1, 3, offsetof(TemplatePair, front)}}};

bool is_uniform(const Grid& grid) {
    return std::all_of(grid.axes.begin(), grid.axes.end(), [](const GridAxis& axis) { return axis.spacing.has_value(); });
}

const Program& make_ready(const GridView& view, const SegmentShader& shader, Programs& programs,
                          const std::string& defines, bool moved) {
    // Both sources may hold what they share.
    const std::string method = shaders::light_glsl + shader.vertex_source() + shader.source();
    const Program& program = programs.of(shaders::grid_place_vert + shaders::grid_lit_vert + method, shaders::grid_lit_frag,
                                          view.defines() + defines + "#define AT_VERTICES\n" + (moved ? "" : "#define STREAMED\n"));
    if (moved) view.set_place(program);
    shader.bind(program);
    return program;
}

// Fans: three vertices of the template each.
template <class Visit>
void for_each_triangle(const CellTemplate& shape, Visit visit) {
    for (const TemplatePolygon& polygon : shape.polygons()) {
        const auto corners = polygon.corners();
        for (std::size_t i = 2; i < corners.size(); ++i) visit(corners[0], corners[i - 1], corners[i]);
    }
}

Texture upload(const CellTemplate& shape) {
    std::vector<float> texels;
    for (const TemplateVertex& v : shape.vertices()) {
        for (const glm::dvec3& u : {v.front, v.back}) {
            for (int axis = 0; axis < 3; ++axis) texels.push_back(static_cast<float>(u[axis]));
            texels.push_back(static_cast<float>(v.interior ? shape.interior_thickness : 0.0));
        }
    }
    return Texture::list(texels);
}

}  // namespace

std::span<const VertexAttribute> vertex_attributes(const TemplatePair*) { return pair_attributes; }

GridTemplates::GridTemplates(const GridView& view, const GridUnits& units, const SegmentShader& shader,
                             Programs& programs, const std::string& defines, GridFootprints& footprints,
                             TriangleStream& indices, TriangleStream& pairs)
    : view_(view),
      units_(units),
      footprints_(footprints),
      indices_(indices),
      pairs_(pairs),
      program_(make_ready(view, shader, programs, defines, !view.perspective() && is_uniform(view.grid()))),
      moved_(!view.perspective() && is_uniform(view.grid())),
      towards_eye_(-view.axes()[0].z, -view.axes()[1].z, -view.axes()[2].z) {
    if (!moved_) return;
    const CellTemplate& shape = template_of({0, 0, 0}, view.box_about_eye({0, 0, 0}));
    template_pairs_ = upload(shape);
    template_pairs_.bind(template_unit);
    for_each_triangle(shape, [&](std::uint8_t a, std::uint8_t b, std::uint8_t c) { triangles_.insert(triangles_.end(), {a, b, c}); });
}

// A row of cells has one shape where the x axis is uniform, whatever the others are.
const CellTemplate& GridTemplates::template_of(const GridCell& cell, const Bounds& box) {
    if (view_.perspective()) return template_ = perspective_template(glm::dvec3(0.0), box);
    const glm::dvec3 edges = view_.grid().cell_edges(cell) / units_.length;
    if (edges != edges_) template_ = parallel_template(towards_eye_, edges_ = edges);
    return template_;
}

std::size_t GridTemplates::draw(std::span<const std::uint32_t> cells) {
    return moved_ ? draw_moved(cells) : draw_streamed(cells);
}

std::size_t GridTemplates::draw_moved(std::span<const std::uint32_t> cells) {
    vertices_.clear();
    for (const std::uint32_t id : cells) {
        for (const std::uint32_t vertex : triangles_) vertices_.push_back(16 * id + vertex);
    }
    program_.use();
    indices_.draw_indices(vertices_, TriangleStream::Primitive::triangles);
    return vertices_.size() / 3;
}

std::size_t GridTemplates::draw_streamed(std::span<const std::uint32_t> cells) {
    const std::size_t nx = view_.grid().axes[0].cells(), ny = view_.grid().axes[1].cells();
    std::size_t triangles = 0, begin = 0;  // of the cells at the near plane
    const auto flush = [&] {
        if (batch_.indices.empty()) return;
        program_.use();
        pairs_.draw(batch_);
        triangles += batch_.indices.size() / 3;
        batch_.clear();
    };
    for (std::size_t i = 0; i <= cells.size(); ++i) {
        const bool projected =
            i == cells.size() || append({cells[i] % nx, cells[i] / nx % ny, cells[i] / (nx * ny)}, batch_);
        if (!projected) {
            flush();
            continue;
        }
        if (begin < i) triangles += footprints_.draw(cells.subspan(begin, i - begin));
        begin = i + 1;
    }
    flush();
    return triangles;
}

// False for a cell that comes too near.
bool GridTemplates::append(const GridCell& cell, Triangles<TemplatePair>& batch) {
    const Bounds box = view_.box_about_eye(cell);
    const ScreenTransform& transform = view_.transform();
    if (view_.perspective()) {
        const glm::dvec3 middle = box.center(), half = 0.5 * (box.high - box.low);
        double nearest = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double z = view_.axes()[static_cast<std::size_t>(axis)].z;
            nearest += middle[axis] * z - half[axis] * std::abs(z);
        }
        if (nearest < least_depth * box.diagonal()) return false;
    }
    std::array<double, 8> scalars = view_.grid().corner_values(cell);
    for (double& s : scalars) s = units_.normalized(s);
    const CellTemplate& shape = template_of(cell, box);
    const auto first = static_cast<std::uint32_t>(batch.vertices.size());
    for (const TemplateVertex& v : shape.vertices()) {
        ProjectedVertex p = project(v, shape, box, scalars, transform);
        if (view_.perspective()) {
            const double back = p.front_depth - p.thickness;
            const glm::dvec2 offset = (p.position - transform.principal_point()) / transform.pixels_per_unit();
            p.front_scalar /= p.front_depth;
            p.back_scalar /= back;
            p.thickness *= glm::length(glm::dvec3(offset, 1.0)) / (p.front_depth * back);
        }
        const glm::dvec2 place = 2.0 * p.position / glm::dvec2(transform.size().width, transform.size().height) - 1.0;
        batch.vertices.push_back({static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(p.front_scalar),
                                  static_cast<float>(p.back_scalar), static_cast<float>(p.thickness)});
    }
    for_each_triangle(shape, [&](std::uint8_t a, std::uint8_t b, std::uint8_t c) {
        batch.indices.insert(batch.indices.end(), {first + a, first + b, first + c});
    });
    return true;
}

}  // namespace cellproj::gl
