// SPDX-License-Identifier: BSD-3-Clause
//
// A mesh as one camera sees it, in float32: every point once per view, and parts of cells as extra tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "project/camera.hpp"
#include "project/clip.hpp"
#include "render/cpu/kernels.hpp"
#include "render/cpu/screen_surfaces.hpp"
#include "render/prepared_scene.hpp"
#include "sort/view_order.hpp"

namespace cellproj::cpu {

// All decisions of a view that need float64: places relative to the eye, nearness relative to the far side of the mesh, cells
// cut at the near plane (a thousandth of the distance to what the camera looks at, or of the mesh). What is then rounded to
// float32 is the same for all cells at a point: the picture is that of a mesh whose points have moved by 1e-7 of its size.
//
// Memory is kept from view to view.
class ScreenMesh {
public:
    // The scene's scalars; forgets the view. `prepared` must outlive the views.
    void set_scene(const PreparedScene& prepared);
    // Which cells can be seen at all (PreparedScene::visible) may have changed.
    void set_visible();
    // Isosurfaces (PreparedScene::surfaces), or whether there is a medium around them, may have changed.
    void set_surfaces();

    // All points as a camera sees them, or only these, where cells with others are not drawn. set_scene came before.
    void set_view(const Camera& camera, ImageSize size, std::span<const VertexId> points = {});
    // These cells nearly back to front: by the depth of one corner each, in a thousand steps. Valid until the next call. set_view came before.
    std::span<const std::uint32_t> nearly_sorted(std::span<const CellId> cells);

    // The order with split cells as extra tetrahedra and cells cut at the near plane. The span stays valid until the next call,
    // and no longer than `order` does. set_view came before.
    std::span<const std::uint32_t> cut(const ViewOrder& order);

    // Of a depth along the viewing axis [SceneUnits::length], as of ScreenPoint; of infinite ones and the eye's own unbounded. set_view came
    // before.
    float nearness(double depth) const;

    // For the last order that was cut.
    const ScreenCells& cells() const { return cells_; }
    // The cells that the extra tetrahedra are parts of.
    std::span<const CellId> extra_cells() const { return extra_cells_; }

private:
    using Corners = std::array<EyeVertex, 4>;

    ScreenPoint on_screen(const EyeVertex& vertex) const;
    glm::dvec3 precisely_on_screen(const glm::dvec3& position) const;
    ScreenPoint rounded(const glm::dvec3& place, float scalar) const;
    bool has_place(const glm::dvec3& position) const;
    void add_surfaces_of_extra(const Corners& corners, CellId cell);
    Corners eye_corners(CellId cell) const;
    Corners eye_corners(const CellPiece& piece) const;
    bool is_cut(CellId cell) const;
    void add_extra(const Corners& corners, CellId cell);
    std::size_t add_front_part(const Corners& corners, CellId cell);

    const PreparedScene* prepared_ = nullptr;
    glm::dvec3 eye_{0.0}, middle_{0.0};  // of the mesh's box
    ScreenTransform transform_{Camera{}, ImageSize{}};
    double near_depth_ = 0, base_ = 0;   // scene units; 1/depth or depth of nearness 0
    bool near_points_ = false;           // some point lies behind the near plane
    std::vector<ScreenPoint> points_;    // #P + 4 per extra tetrahedron
    std::vector<float> cell_scalars_;    // #T + #extra for fields on cells, or none
    std::vector<std::array<VertexId, 4>> extra_;
    std::vector<CellId> extra_cells_;
    std::vector<std::uint32_t> items_;   // the order, where it is not the sorter's own
    std::vector<std::uint32_t> sorted_;  // nearly
    std::vector<float> keys_;            // of them: nearness
    // For scenes with isosurfaces, as ScreenSurfaces says.
    ScreenSurfaces surfaces_;
    std::vector<glm::dvec3> precise_points_;
    std::vector<std::int32_t> levels_;
    std::vector<glm::vec3> gradients_;
    ScreenCells cells_;
};

}  // namespace cellproj::cpu
