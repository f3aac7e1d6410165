// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of a mesh, one after the other, to triangles on the screen: the work between the order and the drawing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "project/camera.hpp"
#include "project/clip.hpp"
#include "project/tet_projection.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj {

// A vertex as the rasterizer gets it. Positions are in clip space (−1 .. 1 over the picture, row 0 at y = −1, w = 1), lengths in
// SceneUnits::length, scalars normalized; depth and scalar terms as in project/tet_projection.hpp. The last three are the
// bounds of the cell, equal at all its vertices: slivers extrapolate, and the fragment clamps.
struct StreamVertex {
    float x, y;
    float front_depth, thickness;
    float front_scalar, back_scalar;
    float scalar_low, scalar_high;
    float depth_range;  // largest minus smallest depth
};

// Triangles of consecutive cells, three indices each.
struct TriangleBatch {
    std::vector<StreamVertex> vertices;
    std::vector<std::uint32_t> indices;
    std::size_t drawn_cells = 0;

    void clear() {
        vertices.clear();
        indices.clear();
        drawn_cells = 0;
    }
};

// The mesh as one camera sees it. Every point is transformed once.
class CellStream {
public:
    CellStream(const PreparedScene& prepared, const Camera& camera, ImageSize size);

    // Appends the triangles of the given cells, in their order. Cells that cannot be seen, lie outside the view, or fall
    // between pixel centres add nothing.
    void project(std::span<const CellId> cells, TriangleBatch& batch) const;

    const ScreenTransform& transform() const { return transform_; }

private:
    struct CellBounds {
        float scalar_low, scalar_high, depth_range;
    };
    using Corners = std::array<ScreenVertex, 4>;

    ScreenVertex on_screen(const glm::dvec3& eye_point, double scalar) const;
    bool load(CellId cell, Corners& corners) const;
    bool project_clipped(CellId cell, TriangleBatch& batch) const;
    bool project_corners(const Corners& corners, TriangleBatch& batch) const;
    bool covers_pixel(const glm::dvec2& low, const glm::dvec2& high) const;
    CellBounds cell_bounds(const Corners& corners) const;
    void append(const ProjectedTet& tet, const CellBounds& bounds, TriangleBatch& batch) const;
    void append_clipped(const ProjectedTet& tet, const CellBounds& bounds, TriangleBatch& batch) const;
    StreamVertex stream_vertex(const ProjectedVertex& v, const CellBounds& bounds) const;

    struct ScreenPoint {
        glm::dvec2 position;  // pixels
        double depth;         // depth term; 0: behind the near plane
    };

    const PreparedScene& prepared_;
    glm::dvec3 eye_;
    ScreenTransform transform_;         // in the units of the scene, about the eye
    Rectangle guard_;                   // triangles that reach beyond are clipped
    std::vector<ScreenPoint> points_;   // #P
    std::vector<double> scalars_;       // #P or #T, normalized
};

}  // namespace cellproj
