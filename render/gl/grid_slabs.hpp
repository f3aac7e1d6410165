// SPDX-License-Identifier: BSD-3-Clause
//
// A grid as slabs between slices (render/grid_sampling.hpp): polygons in the order of the view, each of which draws one slab or some that follow
// each other. Slices of EKE01 and RS00 are textures in 2D, for each axis, or cut through one in 3D; here one in 3D serves both, and a slice
// between two that the volume has is interpolated by the texture unit as RS00 does from the two.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "render/gl/grid_closed_tiles.hpp"
#include "render/gl/grid_surface_pass.hpp"
#include "render/gl/grid_view.hpp"
#include "render/gl/programs.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/triangle_stream.hpp"
#include "render/grid_sampling.hpp"

namespace cellproj::gl {

// A corner of what some slabs cover.
struct SlabVertex {
    float x, y;              // clip space
    float first, direction;  // shaders/grid_slab.vert
};
std::span<const VertexAttribute> vertex_attributes(const SlabVertex*);

// The thickness of a slab [scene units]. `axis`: of Cut::object.
double slab_thickness(const Grid& grid, const GridUnits& units, const GridSampling& sampling, std::size_t axis);

// The axis that the view is closest to.
std::size_t nearest_axis(const GridView& view);

// Draws all from back to front or, with `closed`, from front to back what its tiles do not hide. Returns the number of triangles.
// `classified`: GridSampling::Light::pre, at the points; else null.
std::size_t draw_slabs(const GridView& view, const GridUnits& units, const GridSampling& sampling, const GridLight& light, const Texture* classified,
                       Programs& programs, const std::string& defines, TriangleStream& stream, ClosedTiles* closed);

}  // namespace cellproj::gl
