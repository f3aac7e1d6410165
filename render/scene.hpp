// SPDX-License-Identifier: BSD-3-Clause
//
// What is drawn: shared, immutable parts, so that a renderer can recognise what it has prepared already.
#pragma once

#include <memory>
#include <string>

#include "classify/transfer_function.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"
#include "render/body_scene.hpp"
#include "render/clip_region.hpp"
#include "render/ray_cuts.hpp"
#include "render/slice_scene.hpp"
#include "render/surface_scene.hpp"

namespace cellproj {

// None of the first three may be null; fields must fit the mesh. Do not change them while a renderer may use them.
// Isosurfaces lie in the medium of the transfer function; without a medium, its extinction (and emission) is 0.
struct Scene {
    std::shared_ptr<const TetMesh> mesh;
    std::shared_ptr<const ScalarField> field;
    std::shared_ptr<const TransferFunction> transfer;
    std::shared_ptr<const SurfaceScene> surfaces = nullptr;  // null: none, and nothing is lit
    // Where there is one, extinction is a function of this field, and only colour one of `field`: q = κ(field)·τ(opacity_field) in the
    // density model, which lifts the restriction of RKE00 Eq. 1 that κ and ρ come from one scalar. Cells where either field is not
    // finite are left out. Isosurfaces are those of `field`.
    std::shared_ptr<const ScalarField> opacity_field = nullptr;
    std::shared_ptr<const ClipRegion> clip = nullptr;    // what of mesh and isosurfaces is drawn; null: all
    std::shared_ptr<const BodyScene> bodies = nullptr;   // opaque, not clipped; null: none
    std::shared_ptr<const SliceScene> slices = nullptr;  // opaque, of what the region keeps, with their cuts of this mesh; null: none
};

// What colour and extinction are functions of.
enum class FieldsRead { one, two };
inline FieldsRead fields_read(const Scene& scene) { return scene.opacity_field ? FieldsRead::two : FieldsRead::one; }

// Throws Error (data) when a field does not fit the mesh or has no finite value, Error (option) for isosurfaces of a field on
// cells, which has none, or a medium lit by its gradient, for lights out of range and for clip regions, bodies
// and slices as their own `validate`.
void validate(const Scene& scene);

bool has_surfaces(const Scene& scene);
bool has_lit_medium(const Scene& scene);
// Either of both: what `Scene::surfaces` says counts, and gradients may be asked for.
inline bool has_surface_scene(const Scene& scene) { return has_surfaces(scene) || has_lit_medium(scene); }

RayCuts ray_cuts(const Scene& scene);

}  // namespace cellproj
