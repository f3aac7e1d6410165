// SPDX-License-Identifier: BSD-3-Clause
//
// A convex part of a tetrahedron, in barycentric weights over its four vertices: what planes cut off, and cutting it into
// tetrahedra. Weights are convex combinations all the way, so that every part stays inside its cell and whatever is linear
// in the cell (place, scalar) is mixed with them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec4.hpp>

namespace cellproj {

struct ConvexPart {
    std::vector<glm::dvec4> vertices;               // weights, ≥ 0 with sum 1
    std::vector<std::vector<std::uint32_t>> faces;  // the vertices of each, in turn, either way round
};

ConvexPart whole_cell();

// Heights of a cell's four vertices over a plane, in any unit.
using CornerHeights = std::array<double, 4>;

// On which sides of the plane a part has some volume. Vertices nearer to the plane than 1e-13 of the largest height are taken to
// lie in it: rounding of a cut never makes a part of its own.
struct PlaneSides {
    bool below, above;
};
PlaneSides sides(const ConvexPart& part, const CornerHeights& heights);

// The two parts of one that has some volume on both sides.
struct CutPart {
    ConvexPart below, above;
};
CutPart cut(const ConvexPart& part, const CornerHeights& heights);

// Tetrahedra that fill the part: cones from one vertex over the triangles of the faces that do not hold it. Those of less than
// 1e-15 of the cell's volume are left out.
std::vector<std::array<glm::dvec4, 4>> tetrahedra(const ConvexPart& part);

}  // namespace cellproj
