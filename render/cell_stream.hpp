// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of a mesh, one after the other, to triangles on the screen: the work between the order and the drawing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "classify/vertex_light.hpp"
#include "project/camera.hpp"
#include "project/clip.hpp"
#include "project/silhouette.hpp"
#include "render/prepared_scene.hpp"
#include "render/surface_cells.hpp"
#include "render/surface_vertex.hpp"

namespace cellproj {

// A vertex as the rasterizer gets it: a silhouette's (project/silhouette.hpp). Positions are in clip space (−1 .. 1 over the
// picture, row 0 at y = −1, w = 1), lengths in SceneUnits::length, scalars normalized. Behind the ridges, all is of the triangle whose
// last vertex it is: planes are the value at the origin and what it changes by per pixel to the right and down.
struct StreamVertex {
    float x, y;
    float ridges[3];
    float base_depth[3], origin_x;  // as CellStream::segment_frame
    float base_scalar[3], origin_y;  // pixels; a pixel centre
    float thickness[3][3];
    float scalar_slope;
    float scalar_low, scalar_high;  // slivers extrapolate at pixel centres just outside, so the fragment clamps to the cell's range
    float depth_range;              // largest minus smallest depth; negative when the base is the back
};

// The same with a second field for the opacity: its scalar on the base, as a plane, and what else StreamVertex says of the first.
struct TwoFieldVertex : StreamVertex {
    float base_opacity[3], opacity_slope;
    float opacity_low, opacity_high;
};

// A vertex of the classical split with its light (classify/vertex_light.hpp). The last three are equal at all vertices of a cell.
struct LitVertex {
    float x, y;
    float share;  // of the thick vertex: 1 there, 0 on the silhouette
    float color[3];
    float weight, opacity;  // at the thick vertex
    float brightest;        // largest colour channel of the cell's vertices
};

// Triangles of consecutive cells, three indices each.
template <class Vertex>
struct Triangles {
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
    std::size_t drawn_cells = 0;             // whole ones
    std::vector<CellId> drawn_split_cells;  // of those that come as pieces, one entry per piece drawn

    void clear() {
        vertices.clear();
        indices.clear();
        drawn_cells = 0;
        drawn_split_cells.clear();
    }
};
using TriangleBatch = Triangles<StreamVertex>;
using TwoFieldBatch = Triangles<TwoFieldVertex>;
using LitBatch = Triangles<LitVertex>;
using SurfaceBatch = Triangles<SurfaceVertex>;

// The mesh as one camera sees it. Every point is transformed once.
class CellStream {
public:
    // `drawn`: #T, 0 for cells to leave out, must outlive this; empty: those that `prepared` says are visible.
    CellStream(const PreparedScene& prepared, const Camera& camera, ImageSize size, std::span<const std::uint8_t> drawn = {});

    // Appends the triangles of cells and pieces of cells, in their order. Those that cannot be seen, lie outside the view, or fall
    // between pixel centres add nothing.
    void project(const ViewOrder& order, TriangleBatch& batch) const;
    // The same for a scene with an opacity field.
    void project(const ViewOrder& order, TwoFieldBatch& batch) const;
    // The same as the classical split, with light at its vertices.
    void project(const ViewOrder& order, const VertexLighting& lighting, LitBatch& batch) const;
    // The same with what cuts segments at isosurfaces; `frame` is nearness_frame().
    void project(const ViewOrder& order, const SurfaceCells& surfaces, const NearnessFrame& frame, SurfaceBatch& batch) const;

    // From all points before the near plane.
    NearnessFrame nearness_frame() const;
    // What depths of fragments of the medium are relative to, in parallel views a point's, so that far eyes cost no digits; `nearest` is not
    // told.
    NearnessFrame segment_frame() const;
    const ScreenTransform& transform() const { return transform_; }
    // Perspective: depth of the near plane [SceneUnits::length], a thousandth of the distance to what the camera looks at or of
    // the mesh. Cells are cut there, and what a ray meets before it is drawn as if it were the cell at the plane. A nearer plane would cost
    // accuracy: float32 carries 1/depth to 6e-8 of the largest one.
    double near_depth() const { return near_depth_; }

private:
    struct Corners {
        std::array<ScreenVertex, 4> vertices;  // on the rasterizer's grid
        std::array<glm::dvec2, 4> moved;       // how far to get there [pixels]
        std::array<double, 4> opacity_scalars; // scalar terms of the opacity field, where there is one
        bool whole = false;                    // those of a cell, in its order, not of a piece of it

        std::array<ScreenVertex, 4> with_opacity_scalars() const;
    };
    // Corners of a cell before they are seen on the screen.
    struct EyeCorners {
        std::array<EyeVertex, 4> vertices;
        std::array<double, 4> opacity_scalars;
    };

    struct Pieces {
        std::size_t count;
        std::array<Corners, 3> corners;
    };

    template <class Vertex, class Draw>
    void for_each_piece(const ViewOrder& order, Triangles<Vertex>& batch, Draw draw) const;
    struct ScreenPoint {
        glm::dvec2 position;  // pixels, on the rasterizer's grid
        glm::vec2 moved;      // how far to get there [pixels]
        double depth;         // depth term; 0: behind the near plane
    };

    ScreenPoint on_screen(const glm::dvec3& eye_point) const;
    void set_corner(Corners& corners, std::size_t i, const ScreenPoint& point, double scalar, double opacity_scalar) const;
    double opacity_scalar(CellId cell, VertexId vertex) const;
    bool load(CellId cell, Corners& corners) const;
    EyeCorners eye_corners(CellId cell) const;
    EyeCorners eye_corners(const CellPiece& piece) const;
    Pieces clipped(const EyeCorners& corners) const;
    template <class Vertex>
    class VertexMaker;
    template <class Vertex>
    bool project_corners(const Corners& corners, Triangles<Vertex>& batch) const;
    class SurfaceMaker;
    bool project_surfaces(CellId cell, const Corners& corners, const SurfaceCells& surfaces, const NearnessFrame& frame,
                          SurfaceBatch& batch) const;
    template <class Maker, class Vertex>
    bool append_silhouette(Maker& make, const Rectangle& box, Triangles<Vertex>& batch) const;
    // Of a cell, in lengths and normalized scalars.
    struct CellSpan {
        double near, far, low, high;
    };
    CellSpan span_of(const std::array<ScreenVertex, 4>& corners) const;
    bool light_corners(const Corners& corners, const VertexLighting& lighting, LitBatch& batch) const;
    VertexLight light_at(const ProjectedVertex& thick, const VertexLighting& lighting) const;
    bool covers_pixel(const Rectangle& box) const;
    glm::vec2 clip_space(const glm::dvec2& position) const;
    void set_cell_constants(const std::array<ScreenVertex, 4>& corners, const Silhouette& silhouette, StreamVertex& constants) const;
    glm::dvec2 origin_for(const Rectangle& box) const;
    template <class Vertex>
    void set_place(const SilhouetteVertex& v, Vertex& vertex) const;

    const PreparedScene& prepared_;
    std::span<const std::uint8_t> drawn_;
    glm::dvec3 eye_;
    ScreenTransform transform_;         // in the units of the scene, about the eye
    double near_depth_;
    Rectangle guard_;                   // triangles that reach beyond are clipped
    std::vector<ScreenPoint> points_;   // #P
    std::vector<double> scalars_;       // #P or #T, normalized
    std::vector<double> opacity_scalars_;  // likewise of the opacity field; empty without one
};

}  // namespace cellproj
