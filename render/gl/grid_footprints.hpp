// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of a grid with light for each pixel: what a cell covers, and some pixels around it, whose rays the fragments cut by the cell's
// planes (shaders/grid_cell.frag). That is the template of the cell evaluated in the pixel: the entry is the farthest of up to three planes in
// front, the exit the nearest of those behind, and which they are tells the polygon. Nothing is interpolated over the screen, so cells
// close to the eye or around it need no cutting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/gl/grid_surface_pass.hpp"
#include "render/gl/grid_view.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/triangle_stream.hpp"
#include "render/gl/window_texture.hpp"

namespace cellproj::gl {

class GridFootprints {
public:
    // All must outlive this. `defines`: besides those of the view. `window`: what cuts the rays; null: nothing.
    GridFootprints(const GridView& view, const GridLight& light, Programs& programs, const std::string& defines,
                   const WindowTexture* window, TriangleStream& stream);

    // In their order. Returns the number of triangles, two for a square or rectangle.
    std::size_t draw(std::span<const std::uint32_t> cells);
    // Whether no cell in the picture reaches from one pixel to the next.
    bool all_smaller_than_a_pixel() const;

private:
    double reach() const;
    bool points_fit(std::span<const std::uint32_t> cells) const;

    const GridView& view_;
    TriangleStream& stream_;
    const Program& points_;
    const Program& rectangles_;
    std::array<std::vector<double>, 3> depths_;  // of the middles of cells along each axis: their sum is that of a cell
    double diameter_ = 0.0;                      // no cell has a larger one [scene units]
    double largest_point_;                       // of the driver [pixels]
    bool square_;                                // most cells are about as wide as high on the screen
    std::vector<std::uint32_t> indices_;
};

}  // namespace cellproj::gl
