// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes for tests and benchmarks, by property. All are positively oriented; all random ones come from their seed alone.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/dataset.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj::testing_support {

// One positively oriented tetrahedron: the origin and the unit points of the axes.
TetMesh unit_tet();

// The unit cube [0, 1]³ in n³ boxes of five tetrahedra each. Convex. With `jitter` > 0 inner points move by up to that
// fraction of a box's edge, at random (0.2 keeps every cell positive).
TetMesh grid_mesh(int n, double jitter = 0.0, std::uint64_t seed = 1);

// The Delaunay tetrahedralization of the corners of the unit cube and `points` random points inside, by the mesher. Convex
// and acyclic from every eye (Edelsbrunner 1990). About 6.5 cells per point. Throws Error where there is no mesher.
TetMesh delaunay_mesh(int points, std::uint64_t seed = 1);

// The same mesh under other numbers of its points: shape, order and corners of the cells stay.
TetMesh relabelled(const TetMesh& mesh, std::mt19937_64& random);

// The same mesh with its cells and its points in another order.
TetMesh shuffled(TetMesh mesh, std::uint64_t seed);

// The corners of the unit cube in the order of a hexahedron, and a dataset of one cell.
inline const std::vector<glm::dvec3> cube_corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
Dataset single_cell(CellKind kind, std::vector<glm::dvec3> points, std::vector<VertexId> vertices);

// The sum of the signed volumes of all cells.
double total_volume(const TetMesh& mesh);

// f at every point.
ScalarField point_field(const TetMesh& mesh, const std::function<double(const glm::dvec3&)>& f);

// Sectors around the z axis whose common faces all lean the same way: seen from above, each lies partly over the next one.
TetMesh cyclic_ring(int sectors);

}  // namespace cellproj::testing_support
