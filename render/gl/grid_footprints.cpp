// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_footprints.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "render/gl/shaders.hpp"

namespace cellproj::gl {

namespace {

// Where a square is half empty, a rectangle is cheaper, in spite of its four vertices.
constexpr double most_oblong = 2.0;

double largest_point() {
    std::array<GLfloat, 2> range{};
    glGetFloatv(GL_POINT_SIZE_RANGE, range.data());
    return range[1];
}

const Program& make_ready(const GridView& view, const GridLight& light, Programs& programs, const std::string& defines,
                          const WindowTexture* window) {
    const Program& program = programs.of(shaders::grid_place_vert + shaders::grid_cell_vert + light.vertex_source(),
                                         shaders::grid_rays_frag + light.fragment_source(shaders::grid_cell_frag),
                                         view.defines() + light.defines() + defines + (window ? "#define WINDOW\n" : ""));
    view.set_place(program);
    view.set_rays(program);
    if (window) window->bind(program);
    light.bind(program);
    return program;
}

bool about_square(const GridView& view) {
    glm::dvec2 extent(0.0);  // of the mean cell
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t cells = view.grid().axes[axis].cells();
        extent += glm::dvec2(glm::abs(view.axes()[axis])) * ((view.plane(axis, cells) - view.plane(axis, 0)) / static_cast<double>(cells));
    }
    return std::max(extent.x, extent.y) < most_oblong * std::min(extent.x, extent.y);
}

}  // namespace

GridFootprints::GridFootprints(const GridView& view, const GridLight& light, Programs& programs,
                               const std::string& defines, const WindowTexture* window, TriangleStream& stream)
    : view_(view),
      stream_(stream),
      points_(make_ready(view, light, programs, defines + "#define POINTS\n", window)),
      rectangles_(make_ready(view, light, programs, defines, window)),
      largest_point_(largest_point()),
      square_(about_square(view)) {
    double squared = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double longest = 0.0;
        for (std::size_t i = 0; i < view.grid().axes[axis].cells(); ++i) {
            const double low = view.plane(axis, i), high = view.plane(axis, i + 1);
            longest = std::max(longest, high - low);
            depths_[axis].push_back(0.5 * (low + high) * view.axes()[axis].z);
        }
        squared += longest * longest;
    }
    diameter_ = std::sqrt(squared);
    glEnable(GL_PROGRAM_POINT_SIZE);
}

// How far a point of a cell is at most from another one in the picture [pixels], along each axis of it; in perspective times the cell's least depth: of two
// points p, q of a cell, p_x / p_z − q_x / q_z = (p_x − q_x) / p_z − (p_z − q_z) / p_z · q_x / q_z, and one in the picture serves as q.
double GridFootprints::reach() const {
    const double size = diameter_ * view_.transform().pixels_per_unit();
    if (!view_.perspective()) return size;
    const glm::dvec2 corner = view_.transform().principal_point() / view_.transform().pixels_per_unit();
    return size * (1.0 + std::max(corner.x, corner.y));
}

bool GridFootprints::all_smaller_than_a_pixel() const {
    if (!view_.perspective()) return reach() < 1.0;
    double nearest = -0.5 * diameter_;
    for (const std::vector<double>& depths : depths_) nearest += *std::min_element(depths.begin(), depths.end());
    return reach() < nearest;
}

bool GridFootprints::points_fit(std::span<const std::uint32_t> cells) const {
    if (!square_) return false;
    if (!view_.perspective()) return 2 * reach() < largest_point_;  // twice, where it is cut by the border of the picture
    // The square is up to four times as large, where it is cut.
    const double nearest = 0.5 * diameter_ + 4 * reach() / largest_point_;
    return std::all_of(cells.begin(), cells.end(), [&](std::uint32_t id) {
        const std::size_t row = id / depths_[0].size(), slice = row / depths_[1].size();
        return depths_[0][id - row * depths_[0].size()] + depths_[1][row - slice * depths_[1].size()] + depths_[2][slice] > nearest;
    });
}

std::size_t GridFootprints::draw(std::span<const std::uint32_t> cells) {
    using Primitive = TriangleStream::Primitive;
    if (points_fit(cells)) {
        points_.use();
        stream_.draw_indices(cells, Primitive::points);
        return 2 * cells.size();
    }
    indices_.clear();
    for (const std::uint32_t id : cells)
        indices_.insert(indices_.end(), {4 * id, 4 * id + 1, 4 * id + 2, 4 * id + 2, 4 * id + 1, 4 * id + 3});
    rectangles_.use();
    stream_.draw_indices(indices_, Primitive::triangles);
    return 2 * cells.size();
}

}  // namespace cellproj::gl
