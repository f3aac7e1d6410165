// SPDX-License-Identifier: BSD-3-Clause
//
// One cell over the screen in float64: what the planes of cell_planes-inl.hpp tell in float32, exactly enough for the sides of
// isosurfaces.
//
// Everything is computed face by face from its three corners in the order of their numbers. So at a pixel both cells of a face find
// the same nearness and the same scalar on it, bit for bit, and a surface is crossed on one side of the face or on the other. Rounding
// is 1e-16 times the cell's size over its thickness; rounded to float32, a face whose corners all have one scalar has that scalar.
#pragma once

#include <array>
#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/cpu/kernels.hpp"

namespace cellproj::cpu {

// Where in a pixel rays run in float64: beside the centre by so little that nothing is seen of it, and by more than places are rounded. Else
// rays of meshes that are in line with the pixels would run along faces and edges, where rounding tells who is met. [pixels]
inline constexpr glm::dvec2 beside_center{5e-10, 2.1e-10};

// The plane of a face over the screen: value + slope · (p − anchor).
struct ScreenPlane {
    double value, slope_x, slope_y;
};

struct PreciseCell {
    std::array<VertexId, 4> corners;      // ascending
    std::array<glm::dvec3, 4> points;     // theirs: x, y, whole nearness
    std::array<float, 4> scalars;         // theirs
    // Of the face opposite to each corner. `scalar` is that of s, in perspective of s/depth: both are affine on the screen.
    std::array<ScreenPlane, 4> nearness, scalar;
    std::array<bool, 4> towards_eye;
    std::array<float, 4> lowest, highest; // scalars
    bool thin = false;                    // places rounded to float32 do not tell the side of some face: 1e-5 of a pixel, 20 times over
};

// The corners of the face opposite to corner k of PreciseCell, the first one its anchor.
inline constexpr int face_corners[4][3]{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

PreciseCell precise_cell(const ScreenCells& cells, std::uint32_t item);

// Weights of the face's corners, ≥ 0 with sum 1, where the ray through the screen's place p meets it.
std::array<double, 3> weights_on_face(const PreciseCell& cell, int face, const glm::dvec2& p, bool perspective);

// The gradient of shading where the ray through p meets a face of the item; 0 for unlit surfaces.
glm::vec3 gradient_on_face(const ScreenSurfaces& surfaces, const PreciseCell& cell, std::uint32_t item, int face, const glm::dvec2& p,
                           bool perspective);

// The same where the ray enters or leaves the item.
glm::vec3 gradient_at_end(const ScreenCells& cells, std::uint32_t item, const glm::dvec2& p, bool enters);

}  // namespace cellproj::cpu
