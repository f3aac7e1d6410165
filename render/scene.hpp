// SPDX-License-Identifier: BSD-3-Clause
//
// What is drawn: shared, immutable parts, so that a renderer can recognise what it has prepared already.
#pragma once

#include <memory>

#include "classify/transfer_function.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// None of the three may be null; the field must fit the mesh. Do not change them while a renderer may use them.
struct Scene {
    std::shared_ptr<const TetMesh> mesh;
    std::shared_ptr<const ScalarField> field;
    std::shared_ptr<const TransferFunction> transfer;
};

// Throws Error (data) when the field does not fit the mesh or has no finite value.
void validate(const Scene& scene);

}  // namespace cellproj
