// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of a grid with light at the vertices of their templates, interpolated over the polygons (WVG91 §3). In a parallel view of uniform
// axes one template serves all cells: the device moves it from cell to cell and takes the scalars of its pairs from the corners. Otherwise
// every cell has its own, which is found here and streamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "project/cell_template.hpp"
#include "render/gl/grid_footprints.hpp"
#include "render/gl/grid_view.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/triangle_stream.hpp"

namespace cellproj::gl {

// A pair of points of a template on the screen, as the rasterizer gets it.
struct TemplatePair {
    float x, y;                    // clip space
    float front, back, thickness;  // scalars 0..1, length [scene units]
};
std::span<const VertexAttribute> vertex_attributes(const TemplatePair*);

class GridTemplates {
public:
    // All must outlive this. `footprints`: for cells that reach behind the near plane, which have no projection; with light
    // by the same method in each pixel.
    GridTemplates(const GridView& view, const GridUnits& units, const SegmentShader& shader, Programs& programs,
                  const std::string& defines, GridFootprints& footprints, TriangleStream& indices, TriangleStream& pairs);

    // In their order. Returns the number of triangles.
    std::size_t draw(std::span<const std::uint32_t> cells);

private:
    std::size_t draw_moved(std::span<const std::uint32_t> cells);
    std::size_t draw_streamed(std::span<const std::uint32_t> cells);
    bool append(const GridCell& cell, Triangles<TemplatePair>& batch);
    const CellTemplate& template_of(const GridCell& cell, const Bounds& box);

    const GridView& view_;
    const GridUnits& units_;
    GridFootprints& footprints_;
    TriangleStream& indices_;
    TriangleStream& pairs_;
    const Program& program_;
    bool moved_;  // one template for all
    glm::dvec3 towards_eye_;
    glm::dvec3 edges_{0.0};  // of the template below, in parallel views
    CellTemplate template_;
    std::vector<std::uint32_t> triangles_;  // of the one template: three pairs each
    Texture template_pairs_;
    std::vector<std::uint32_t> vertices_;
    Triangles<TemplatePair> batch_;
};

}  // namespace cellproj::gl
