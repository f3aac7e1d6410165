// SPDX-License-Identifier: BSD-3-Clause
//
// What clip regions, bodies and slices leave of the rays of a picture (render/depth_window.hpp), as fragments cut their segments by it: the variants
// WINDOW of shaders/cell.frag, shaders/surfaces.frag and shaders/grid_cell.frag.
#pragma once

#include "render/depth_window.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/renderer.hpp"
#include "render/surface_vertex.hpp"

namespace cellproj::gl {

class WindowTexture {
public:
    // `frame`: that of the fragments' nearness.
    WindowTexture(const DepthWindow& window, const NearnessFrame& frame, int width);
    // For cells of grids, along whose rays a parameter is the depth less that of the view's reference point.
    WindowTexture(const DepthWindow& window, double reference_depth, int width);

    void bind(const Program& program) const;

private:
    Texture texels_;
    int width_;
};

}  // namespace cellproj::gl
