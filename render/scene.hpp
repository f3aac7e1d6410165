// SPDX-License-Identifier: BSD-3-Clause
//
// What is drawn: shared, immutable parts, so that a renderer can recognise what it has prepared already.
#pragma once

#include <memory>
#include <string>

#include "classify/transfer_function.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"
#include "render/surface_scene.hpp"

namespace cellproj {

// None of the first three may be null; the field must fit the mesh. Do not change them while a renderer may use them.
// Isosurfaces lie in the medium of the transfer function; without a medium, its extinction (and emission) is 0.
struct Scene {
    std::shared_ptr<const TetMesh> mesh;
    std::shared_ptr<const ScalarField> field;
    std::shared_ptr<const TransferFunction> transfer;
    std::shared_ptr<const SurfaceScene> surfaces = nullptr;  // null: none
};

// Throws Error (data) when the field does not fit the mesh or has no finite value, Error (option) for isosurfaces of a field on
// cells, which has none, and for lights out of range.
void validate(const Scene& scene);

// For renderers that draw no isosurfaces: throws Error (option), naming the backend, when the scene has some.
void refuse_surfaces(const Scene& scene, const std::string& backend);

}  // namespace cellproj
