// SPDX-License-Identifier: BSD-3-Clause
//
// What cellproj_frames draws: meshes and transfer functions by name.
#pragma once

#include <string>

#include "classify/transfer_function.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj::bench {

struct FieldMesh {
    TetMesh mesh;
    ScalarField field;         // on points
    double low = 0, high = 1;  // scalars that the transfer functions span
};

// "grid:N": N points along each edge of the unit cube (N ≥ 2), those inside moved by up to a fifth of a box, at random; six
//   tetrahedra a box, in one order of their points: 196,608 for 33, 1,572,864 for 65, 6,000,000 for 101.
// "delaunay:N": N random points in the unit cube, about 6.5 tetrahedra each; needs the mesher.
// "bluntfin": NASA's, density; needs the files beside the project.
// Throws Error: (option) for another name, (environment, file) when the mesher or the files are not there.
FieldMesh make_mesh(const std::string& name);

// "ramp" or "peaks" (apps/scenes/measured_scenes.hpp) over low..high; Error (option) otherwise.
TransferFunction make_transfer(const std::string& name, const FieldMesh& scene);

}  // namespace cellproj::bench
