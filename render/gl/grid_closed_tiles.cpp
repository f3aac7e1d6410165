// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_closed_tiles.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "render/gl/grid_slab_outline.hpp"
#include "render/gl/shaders.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int color_unit = 14;  // shaders/grid_open.frag

// Of pixels. What is drawn has 1/2, and passes where that is more: where the depth is 0, as in a cleared target, or by shaders/grid_open.vert.
constexpr float closed_depth = 1.0F;

constexpr std::array<VertexAttribute, 1> outline_attributes{{{0, 2, offsetof(OutlineVertex, x)}}};

std::size_t tiles(int pixels) { return static_cast<std::size_t>((pixels + ClosedTiles::side - 1) / ClosedTiles::side); }

// 1 for tiles with a pixel that is open, row by row.
std::vector<std::size_t> open_tiles(std::span<const float> depths, ImageSize size) {
    const auto width = static_cast<std::size_t>(size.width);
    const std::size_t columns = tiles(size.width);
    std::vector<std::size_t> open(columns * tiles(size.height), 0);
    for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
        const std::span<const float> row = depths.subspan(y * width, width);
        std::size_t* tile = &open[y / ClosedTiles::side * columns];
        for (std::size_t x = 0; x < width; x += ClosedTiles::side) {
            const auto pixels = row.subspan(x, std::min<std::size_t>(ClosedTiles::side, width - x));
            if (*std::min_element(pixels.begin(), pixels.end()) < closed_depth) tile[x / ClosedTiles::side] = 1;
        }
    }
    return open;
}

}  // namespace

std::span<const VertexAttribute> vertex_attributes(const OutlineVertex*) { return outline_attributes; }

ClosedTiles::ClosedTiles(const GridView& view, const Target& picture, Programs& programs, TriangleStream& outlines, float opaque)
    : view_(view),
      picture_(picture),
      program_(programs.of(shaders::grid_open_vert, shaders::grid_open_frag, "")),
      outlines_(outlines),
      columns_(tiles(view.transform().size().width)),
      rows_(tiles(view.transform().size().height)) {
    program_.set("opaque", opaque);
    sum_up(std::vector<std::size_t>(columns_ * rows_, 1));
    blend_front_to_back();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
}

ClosedTiles::~ClosedTiles() {
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
}

bool ClosedTiles::look(std::span<const glm::dvec3> rest) {
    Triangles<OutlineVertex> outline;
    for (const glm::dvec2& pixel : outline_on_screen(view_, rest)) {
        const glm::vec2 place = clip_space(view_, pixel);
        outline.vertices.push_back({place.x, place.y});
    }
    for (std::uint32_t i = 2; i < outline.vertices.size(); ++i) outline.indices.insert(outline.indices.end(), {0, i - 1, i});

    picture_.bind_color(color_unit);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_ALWAYS);
    picture_.clear_depths(closed_depth);
    program_.use();
    outlines_.draw(outline);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);

    const std::size_t open = open_;
    sum_up(open_tiles(picture_.read_depths(), view_.transform().size()));
    return open_ < open;
}

void ClosedTiles::sum_up(std::span<const std::size_t> open) {
    const std::size_t stride = columns_ + 1;
    before_.assign(stride * (rows_ + 1), 0);
    for (std::size_t i = 0; i < open.size(); ++i) {
        const std::size_t at = i / columns_ * stride + i % columns_;
        before_[at + stride + 1] = before_[at + 1] + before_[at + stride] - before_[at] + open[i];
    }
    open_ = before_.back();
}

bool ClosedTiles::hide(std::span<const glm::dvec3> corners) const {
    constexpr double infinite = 1e300;
    glm::dvec2 low(infinite), high(-infinite);
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 p = view_.to_eye(corner);
        if (view_.perspective() && p.z < near_depth) return false;
        const glm::dvec2 place = view_.transform().to_screen(p);
        low = glm::min(low, place - outline_margin);
        high = glm::max(high, place + outline_margin);
    }
    const auto tile = [](double pixel, std::size_t count) { return static_cast<std::size_t>(std::clamp(std::floor(pixel / side), 0.0, static_cast<double>(count))); };
    const std::size_t left = tile(low.x, columns_), right = tile(high.x + side, columns_), top = tile(low.y, rows_), bottom = tile(high.y + side, rows_);
    if (!(left < right && top < bottom)) return true;
    const std::size_t stride = columns_ + 1;
    return before_[bottom * stride + right] + before_[top * stride + left] == before_[bottom * stride + left] + before_[top * stride + right];
}

}  // namespace cellproj::gl
