// SPDX-License-Identifier: BSD-3-Clause
//
// Gradients of a scalar field: what shading takes for the normals of isosurfaces (RKE00 §8). A field on points is linear in
// each cell, so that its gradient there is one constant vector; a field on cells has the gradient 0 in each of them.
//
// Both forms are the gradient itself, up to rounding, where the field is linear in space: also at the boundary, for meshes of
// any scale and place. Rounding: about 1e-15 times the cell's largest difference of scalars, over its height where it is flattest.
#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct Gradients {
    std::vector<glm::dvec3> values;  // [scalar / mesh unit], all finite
    std::size_t undefined = 0;       // elements that have none, and 0 instead: named below
};

// Whether a cell has no volume, also within the rounding of it: 4e-15 of the product of three edges.
bool is_flat(const TetMesh& mesh, CellId cell);

// One for each cell. Undefined: cells that are flat; that touch a scalar which is not finite; whose gradient float64 cannot hold. The field must fit the
// mesh. Parallel over cells, the same for any number of threads.
Gradients cell_gradients(const TetMesh& mesh, const ScalarField& field);

// One for each point: the mean of the gradients of the cells around it, weighted by their volumes; cells without a gradient
// do not count. Undefined: points around which no cell has one.
Gradients vertex_gradients(const TetMesh& mesh, const ScalarField& field);

}  // namespace cellproj
