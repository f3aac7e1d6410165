// SPDX-License-Identifier: BSD-3-Clause
//
// Planes cut out of the field: opaque, in the colours of a transfer function as the colour bar shows them, unlit, so that values can be read
// off (RS00: arbitrary cutting planes). They hide what is behind them; of a clipped scene counts what the region keeps.
//
// A cap is the slice along a plane of the clip region: the face of what is kept. Where a field jumps in the plane itself (one on cells, whose
// faces lie in it), both show the cell on the side that the normal points to, which is the one that a clip region keeps.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "classify/transfer_function.hpp"
#include "mesh/grid.hpp"
#include "mesh/plane_cut.hpp"
#include "render/clip_region.hpp"

namespace cellproj {

struct Slice {
    HalfSpace plane;
    bool cap = false;  // faces in the plane are seen only where something is on the normal's side of it
};

struct SliceScene {
    std::vector<Slice> slices;
    std::shared_ptr<const TransferFunction> colors;  // not null: its colours, not its extinction. What it leaves transparent outside is a hole.
    // Of a mesh one for each slice (cut_slices); of a grid none, whose scalar is found at each pixel.
    std::vector<std::vector<CutTriangle>> cuts = {};
};

// Slices and the caps of a clip region (null: none).
std::vector<Slice> slices_and_caps(const std::vector<HalfSpace>& planes, const ClipRegion* capped);

// The slices of a mesh with its field, once for all views: cells are left out where the field or `other` (null: none) is not finite. Throws
// Error (option) as `validate`.
SliceScene cut_slices(const TetMesh& mesh, const ScalarField& field, const ScalarField* other, std::vector<Slice> slices,
                      std::shared_ptr<const TransferFunction> colors);

// Throws Error (option) for a plane as `validate` of regions does.
void validate(const SliceScene& scene);

// The scalar of a grid at a point of a slice's plane, trilinear; nothing outside and in blanked cells. A point between two cells has that
// of the one on the normal's side, else (but for caps) of the other one.
std::optional<double> scalar_at(const Grid& grid, const Slice& slice, const glm::dvec3& point);

// Whether a slice meets the box.
bool slice_meets(const Slice& slice, const Bounds& box);

// What counts as 1 where a function's colours are shown by themselves: an emitter's are per length, and relative to its brightest channel; 1 in
// the density model.
double color_scale(const TransferFunction& function);

// The colours of slices by scalar, 0..1; nothing where the function is transparent outside of its nodes.
class SliceColors {
public:
    explicit SliceColors(const TransferFunction& function) : function_(&function), brightest_(color_scale(function)) {}

    std::optional<glm::dvec3> at(double s) const;

private:
    const TransferFunction* function_;
    double brightest_;
};

}  // namespace cellproj
