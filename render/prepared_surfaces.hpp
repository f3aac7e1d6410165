// SPDX-License-Identifier: BSD-3-Clause
//
// What backends need of isosurfaces, and of a medium that is lit, and no view changes: on which side of which surfaces every cell lies, and the gradients that
// shading takes for normals.
//
// This is the one place that says which cells an isovalue crosses. Sides are told by the scalars that are drawn, normalized to the
// field's range and rounded to float32, against the *threshold* of each isovalue, rounded in the same way: a point whose scalar is the
// isovalue stays on it (classify/isosurface.hpp: not below). Where the thresholds stand, the backend says (SurfaceSides). No bins and no
// span space: one search of the list for each point and one look at each cell, whatever the number of surfaces, cost less than the
// gradients do (render/README.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"
#include "render/surface_scene.hpp"

namespace cellproj {

struct Scene;
struct SceneUnits;

// For backends whose scalars on a face are float32: more than their rounding. So places whose scalar is the isovalue (points, edges
// and cells that hold it, as those of regular grids often do) are all on one side, whichever face tells. [field ranges]
inline constexpr double float32_margin = 0x1p-21;

// Where the threshold of an isovalue stands: at the isovalue or, where a table of so many texels an axis tells the surfaces
// (IsoSurfaceTable), where the nearest texel changes that is below the isovalue to one that is not; less the margin.
struct SurfaceSides {
    double margin = 0.0;  // [field ranges]
    int table_size = 0;   // 0: no table

    // The texel of a scalar s is ⌊s·texel_scale() + texel_shift()⌋.
    double texel_scale() const { return table_size - 1; }
    double texel_shift() const { return 0.5 + margin * texel_scale(); }
    bool operator==(const SurfaceSides&) const = default;
};

// The level of a scalar: how many thresholds it is not below, 0 .. #values. A segment crosses the surfaces between the levels of its
// ends; a cell whose scalars have one level is crossed by none, whatever rounding does to scalars inside.
class PreparedSurfaces {
public:
    static constexpr std::int32_t crossed_cell = -1, no_scalar = -2;

    // Of a scene that has_surface_scene; the scene's field must outlive it. `before`: of the same mesh and field, whose gradients serve again;
    // or null.
    PreparedSurfaces(const Scene& scene, const SceneUnits& units, const SurfaceSides& sides = {}, const PreparedSurfaces* before = nullptr);

    const SurfaceScene& scene() const { return *scene_; }
    const SurfaceSides& sides() const { return sides_; }
    // Normalized, ascending; equal where float32 cannot tell two isovalues apart.
    std::span<const float> values() const { return values_; }
    // Of their sides; where the field does not reach the isovalue, well outside of 0..1. Ascending.
    std::span<const float> thresholds() const { return thresholds_; }

    // #T: the level of all scalars of the cell, crossed_cell where its points have several, no_scalar where one is not finite.
    std::span<const std::int32_t> levels() const { return levels_; }
    std::span<const CellId> crossed() const { return crossed_; }  // ascending
    std::span<const VertexId> crossed_points() const { return crossed_points_; }  // theirs, ascending

    // Rays pass a flat cell with no length. Where its scalars lie in no one plane, they jump there from one neighbour to the other, and
    // surfaces lie in the jump. If there are such cells: all that are not crossed and touch a flat cell, so that it can be seen.
    std::span<const CellId> beside_jumps() const { return beside_jumps_; }
    bool jump() const { return jump_; }

    // In the axes of the mesh, over classify's weak_gradient, shortened to 1e15: #T (flat), #P (smooth) or none (unlit). 0 where there is none.
    std::span<const glm::vec3> gradients() const { return of_field_->gradients; }

private:
    // What isovalues do not change.
    struct OfField {
        Shading shading;
        std::vector<glm::vec3> gradients;
        std::vector<CellId> flat_cells;
    };

    static std::shared_ptr<const OfField> find_gradients(const Scene& scene, const SceneUnits& units);
    void find_jumps(const Scene& scene, const SceneUnits& units);

    const SurfaceScene* scene_;
    SurfaceSides sides_;
    std::vector<float> values_, thresholds_;
    std::vector<std::int32_t> levels_;
    std::vector<CellId> crossed_;
    std::vector<VertexId> crossed_points_;
    std::vector<CellId> beside_jumps_;
    bool jump_ = false;
    std::shared_ptr<const OfField> of_field_;
};

// How many of `values`, ascending, s is not below.
inline std::int32_t level_of(std::span<const float> values, float s) {
    const float* first = values.data();
    for (std::size_t count = values.size(); count > 0;) {
        const std::size_t half = count / 2;
        const bool above = !(s < first[half]);
        first = above ? first + half + 1 : first;
        count = above ? count - half - 1 : half;
    }
    return static_cast<std::int32_t>(first - values.data());
}

}  // namespace cellproj
