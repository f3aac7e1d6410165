// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes that are hard to order: with holes, in pieces, with visibility cycles. All positively oriented, without overlaps, and
// from their seed alone.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mesh/tet_mesh.hpp"

namespace cellproj::testing_support {

// The cells of a mesh whose centroid is kept.
TetMesh carved(const TetMesh& mesh, const std::function<bool(const glm::dvec3&)>& keep);

// A ring around the z axis, of radius .35 about (.5, .5, .5), with a square section of side .2, of `segments` by 4 by 4 boxes.
TetMesh torus_mesh(int segments);

// The unit cube on a jittered grid of n³ boxes, less the cells in `cavities` balls at random.
TetMesh cavity_mesh(int n, int cavities, std::uint64_t seed = 1);

// Two coils of three turns, each in the gaps of the other, of `segments` segments each.
TetMesh springs_mesh(int segments);

// `pieces` small jittered cubes, turned at random, none touching another.
TetMesh pieces_mesh(int pieces, int n, std::uint64_t seed = 1);

// Three long cells, each over the next one as seen along z: the smallest cycle.
TetMesh overlapping_sticks();

// A closed stair of `steps` long cells about the z axis, each of which rises over the lower end of the next: one cycle of all
// of them as seen along z.
TetMesh spiral_stair(int steps);

// A jittered grid of n³ boxes whose points near each of `whirls` vertical axes are turned by an angle that grows with height; its
// cells stay positive. About one cell in twenty is in a cycle as seen along z.
TetMesh twisted_mesh(int n, int whirls, std::uint64_t seed = 1);

// A grid of n³ boxes whose points in the cube's inner ball are turned about the vertical axis likewise: it fills a convex body, and has cycles.
TetMesh twisted_cube(int n);

// grid_mesh(n, .2) and `each` flat cells of both kinds (between two cells, on the side of the cube), needles, lines and points among its
// cells, and as many of its cells with their vertices in the wrong order. Cells are shuffled.
TetMesh damaged_mesh(int n, int each, std::uint64_t seed = 1);

// Each point times `scale` plus `offset`.
TetMesh moved(TetMesh mesh, double scale, double offset);

}  // namespace cellproj::testing_support
