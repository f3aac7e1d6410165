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
#include "project/silhouette.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj {

// A vertex as the rasterizer gets it: a silhouette's (project/silhouette.hpp). Positions are in clip space (−1 .. 1 over the
// picture, row 0 at y = −1, w = 1), lengths in SceneUnits::length, scalars normalized. The last four are equal at all vertices of
// a cell; slivers extrapolate at pixel centres just outside, so the fragment clamps to the cell's range.
struct StreamVertex {
    float x, y;
    float base_depth, base_scalar;
    float ridges[3];
    float scalar_slope;
    float scalar_low, scalar_high;
    float depth_range;  // largest minus smallest depth; negative when the base is the back
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
    // Perspective: depth of the near plane [SceneUnits::length], a thousandth of the distance to what the camera looks at or of
    // the mesh. Cells are cut there, and what a ray meets before it is drawn as if it were the cell at the plane. A nearer plane would cost
    // accuracy: float32 carries 1/depth to 6e-8 of the largest one.
    double near_depth() const { return near_depth_; }

private:
    using Corners = std::array<ScreenVertex, 4>;

    glm::dvec2 snapped_position(const glm::dvec3& eye_point) const;
    ScreenVertex on_screen(const glm::dvec3& eye_point, double scalar) const;
    bool load(CellId cell, Corners& corners) const;
    bool project_clipped(CellId cell, TriangleBatch& batch) const;
    bool project_corners(const Corners& corners, TriangleBatch& batch) const;
    bool covers_pixel(const glm::dvec2& low, const glm::dvec2& high) const;
    StreamVertex cell_constants(const Corners& corners, const Silhouette& silhouette) const;
    StreamVertex stream_vertex(const SilhouetteVertex& v, const StreamVertex& constants) const;

    struct ScreenPoint {
        glm::dvec2 position;  // pixels
        double depth;         // depth term; 0: behind the near plane
    };

    const PreparedScene& prepared_;
    glm::dvec3 eye_;
    ScreenTransform transform_;         // in the units of the scene, about the eye
    double near_depth_;
    Rectangle guard_;                   // triangles that reach beyond are clipped
    std::vector<ScreenPoint> points_;   // #P
    std::vector<double> scalars_;       // #P or #T, normalized
};

}  // namespace cellproj
