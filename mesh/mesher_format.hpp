// SPDX-License-Identifier: BSD-3-Clause
//
// What cellproj and cellproj-mesher say to each other: one request, one answer, over pipes. Both programs compile this
// file; it knows nothing of how the other side makes its cells.
//
//   message := header, body
//   header  := magic "cpmesher" (8 bytes), u32 version = 3, u32 kind (1 request, 2 answer, 3 surface request, 4 refusal),
//              u64 size of the body
//   request := f64 max_volume, f64 radius_edge_ratio, points, facets, holes (points), regions
//   answer  := points, tets (4 u32, 0-based, each), region attributes (f64; none or one per tet)
//   surface request := f64 max_volume, f64 radius_edge_ratio, u64 fill_holes (0 or 1), f64 wrap, u64 inside (0 alternating,
//              1 enclosed), points, polygons, the facet of each polygon (u32; none or one per polygon), holes (points), regions
//   refusal := what was expected, what was found, what to do: UTF-8 texts; pairs of facets (2 u32). The answer to a surface
//              that cannot be made a closed boundary.
//   points: 3 f64 each. regions: 3 f64 seed, f64 attribute, f64 max_volume each. Facets and polygons: the sizes of all
//   (u32), then the vertices of all (u32, 0-based). Every array and text stands behind its length, u64 (byte_stream.hpp).
//
// Numbers stand in the byte order of the machine, on which both programs run. Nothing follows the body.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct MeshingRequest {
    PiecewiseLinearComplex complex;
    double max_volume = 0.0;         // [mesh units³]; 0: no bound
    double radius_edge_ratio = 0.0;  // 0: no quality refinement
};

struct SurfaceRequest {
    Surface surface;                 // all but its fields
    bool fill_holes = false;
    double max_volume = 0.0;         // as above
    double radius_edge_ratio = 0.0;
    double wrap = 0.0;               // as in MesherOptions
};

// Why a surface was not filled.
struct Refusal {
    Error error;
    std::vector<std::array<std::uint32_t, 2>> intersections;  // as in SurfaceReport
};

// Throws Error (data), naming `place`: fewer than 4 points or more than the mesher can count, a point, hole or region
// that is not finite, a facet with fewer than 3 vertices, a vertex id out of range.
void validate(const PiecewiseLinearComplex& complex, const std::string& place);

std::string encode_request(const PiecewiseLinearComplex& complex, double max_volume, double radius_edge_ratio);
// Points, cells and, if there is one, the cell field "region"; every other field stays behind.
std::string encode_answer(const TetMesh& mesh);

std::string encode_request(const SurfaceRequest& request);
std::string encode_refusal(const Refusal& refusal);

// Whether a message says it is a surface request, a refusal; nothing else of it is checked.
bool is_surface_request(std::string_view message);
bool is_refusal(std::string_view message);

// The decoders check magic, version, kind, and every count against the bytes that are there; what the numbers mean
// (ids, finite points) is left to the two `validate`. Throw Error (mesher), naming `place`.
MeshingRequest decode_request(std::string_view message, const std::string& place);
SurfaceRequest decode_surface_request(std::string_view message, const std::string& place);
TetMesh decode_answer(std::string_view message, const std::string& place);
// Its Error is one (data) about `subject`.
Refusal decode_refusal(std::string_view message, const std::string& place, const std::string& subject);

// The size of the answer that starts with these bytes: empty while its header is incomplete, 0 when they cannot become
// an answer.
std::optional<std::size_t> announced_answer_size(std::string_view start);

}  // namespace cellproj
