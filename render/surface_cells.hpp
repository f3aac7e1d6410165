// SPDX-License-Identifier: BSD-3-Clause
//
// The isosurfaces of a scene in the units of a renderer: what drawing them needs and no view changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/gradient.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj {

// Scalars are normalized float32 here. A scalar lies below a surface when it is less than the surface's *threshold*, which stands
// 2⁻²¹ of the field's range below the isovalue: more than the rounding of a scalar on a face, so that places whose scalar is the
// isovalue (points, edges and cells that hold it, as those of regular grids often do) are all on one side, whichever face tells.
// The place of a crossing is that of the isovalue, clamped to the segment.
class SurfaceCells {
public:
    // The scene's surfaces, which must be there; a scene that `validate` passes.
    SurfaceCells(const Scene& scene, const SceneUnits& units);

    const std::vector<float>& thresholds() const { return thresholds_; }  // by surface, ascending

    // The surfaces between two scalars, low <= high: first <= i < last.
    struct Range {
        std::size_t first, last;
    };
    Range between(float low, float high) const;

    const std::vector<std::uint8_t>& crossed() const { return crossed_; }  // #T: 1 where a surface is in the cell
    std::size_t crossed_count() const { return crossed_count_; }

    // At the corners of a cell, in the axes of the mesh [scalar / mesh unit]: its own one four times (flat), those of its points
    // (smooth), 0 (unlit, and where there is none).
    std::array<glm::dvec3, 4> gradients(CellId cell) const;

private:
    const TetMesh* mesh_;  // the scene keeps it
    Shading shading_;
    std::vector<float> thresholds_;
    std::vector<std::uint8_t> crossed_;
    std::size_t crossed_count_ = 0;
    Gradients gradients_;
};

}  // namespace cellproj
