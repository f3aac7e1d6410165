// SPDX-License-Identifier: BSD-3-Clause
//
// Volumes from surfaces, through TetGen. TetGen is AGPL, keeps global state and dies of signals on some bad inputs, so it
// lives in a program of its own, `cellproj-mesher` (apps/mesher/); this header is the caller's side of the process wall.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/surface.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// A piecewise-linear complex: planar polygons that meet in common points and edges only.
struct PiecewiseLinearComplex {
    std::vector<glm::dvec3> points;                  // #P; points that no facet uses become mesh vertices, too
    std::vector<std::vector<VertexId>> facets;       // polygons of ≥ 3 points, 0-based
    std::vector<glm::dvec3> holes;                   // a point in each void to be left empty
    std::vector<Region> regions;                     // may be empty
};

struct MesherOptions {
    double max_volume = 0.0;              // largest cell anywhere [mesh units³]; 0: no bound
    double radius_edge_ratio = 0.0;       // largest circumradius / shortest edge, e.g. 1.414; 0: no quality refinement
    bool fill_holes = false;              // of a Surface: cap its open ends with triangles
    double wrap = 0.0;                    // of a Surface: fill a wrap around it instead (see below); 0: the surface itself
    double timeout_seconds = 300.0;       // the process is killed after that
    std::filesystem::path program;        // the mesher; empty: found by `find_mesher`
};

// The program next to the running one, in ../libexec/cellproj beside it, named by the environment variable
// CELLPROJ_MESHER (first), or on PATH. Throws Error (environment) when there is none.
std::filesystem::path find_mesher();

// Meshes the inside of a complex. With regions, the result has the cell field "region". Throws Error (data) for an
// unusable complex (ids out of range, NaN), Error (mesher) when the process reports a failure, dies of a signal, answers
// with garbage, produces no cells, or exceeds its time.
TetMesh tetrahedralize(const PiecewiseLinearComplex& complex, const MesherOptions& options = {});

struct SurfaceReport {
    // Pairs of facets (`facet_of`) that cross or touch each other beside their common corners and edges, ascending;
    // `new_facet` for a triangle that closes a hole.
    std::vector<std::array<std::uint32_t, 2>> intersections;
};
inline constexpr std::uint32_t new_facet = 0xffffffffU;

// Meshes the inside of a surface: coincident points are merged, facets turned to agree, open edges that coincide joined
// first. What is inside, `surface.inside` says; with regions, the result has the cell field "region", in which the parts
// that no seed marks have numbers above all others. Fields come as `carry_fields` says. Throws Error (data), naming the
// surface, for one that is flat, open, non-manifold (unless Inside::enclosed) or intersects itself, with counts and the
// first offenders by facet, and for a region outside or beside another; and as above. `report` is set even then.
//
// With `options.wrap` in (0, 1], nothing is refused but what has no extent: the result fills the wrap of the surface (CGAL,
// Portaneri et al., Alpha Wrapping with an Offset, ACM TOG 41(4), 2022), a closed surface that lies outside of it by 1/30
// of `wrap` times the diagonal of its box (fields are still those of the surface itself: "distance" is not 0 there). Gaps
// that a ball of the radius `wrap` × diagonal does not pass are closed; caves behind them and cavities are filled, inner walls
// are gone. Smaller values follow the surface more closely and cost about the inverse square in time.
TetMesh tetrahedralize(const Surface& surface, const MesherOptions& options = {}, SurfaceReport* report = nullptr);

}  // namespace cellproj
