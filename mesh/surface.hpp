// SPDX-License-Identifier: BSD-3-Clause
//
// Surfaces as files hold them: polygons, nothing promised. They may be open, turned at random, intersect themselves or
// repeat their points (STL always does); `tetrahedralize` (mesher.hpp) sorts that out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

// A region is the part of space around `seed` that facets enclose.
struct Region {
    glm::dvec3 seed;
    double attribute = 0.0;   // becomes the cell field "region"
    double max_volume = 0.0;  // largest cell in this region [mesh units³]; 0: no bound
};

// What counts as inside.
enum class Inside {
    alternating,  // what an odd number of closed sheets surrounds: a sheet within another bounds a cavity
    enclosed      // all that facets enclose, but for the holes; facets may be inner walls
};

struct Surface {
    std::string name;                             // the file, for messages
    std::vector<glm::dvec3> points;               // #P [mesh units]
    std::vector<std::vector<VertexId>> polygons;  // #F, vertices in order around, 0-based into points
    std::vector<Field> point_fields;              // each with #P rows
    std::vector<std::uint32_t> facets = {};       // #F, the facet of the file that a polygon is a part of, from 0; empty:
                                                  // polygon f is facet f
    std::vector<glm::dvec3> holes = {};           // a point in each void to be left empty; for Inside::enclosed
    std::vector<Region> regions = {};             // for Inside::enclosed
    Inside inside = Inside::alternating;
};

// The facet, for messages, that polygon `polygon` is a part of.
std::uint32_t facet_of(const Surface& surface, std::size_t polygon);

// Throws Error (data), naming the surface: fewer than 4 points or none of its polygons, a point, hole or region that is not
// finite, a polygon of fewer than 3 vertices, a vertex id out of range, a field or a list of facets whose length does not
// fit, holes or regions without Inside::enclosed.
void validate(const Surface& surface);

// Its polygons as triangles, turned as they are, in their order (face_triangles.hpp): #triangles by 3, 0-based into points. Of a valid
// surface.
std::vector<std::array<VertexId, 3>> triangles_of(const Surface& surface);

// Reads STL (ascii, binary), OFF, PLY, OBJ, VTK XML polygonal data (.vtp) and TetGen's .poly and .smesh; the format is told
// by the content, that of OBJ and TetGen, which have no mark, by the suffix. Polygons keep the order of the file; VTP and
// TetGen's files bring their point fields. Throws Error (file, format, data).
Surface read_surface(const std::filesystem::path& file);

// read_off.cpp: Geomview's OFF, ascii, with or without normals and colours (which are passed over). Needs no VTK.
Surface read_off(const std::filesystem::path& file);

// read_ply.cpp: PLY, ascii and binary; coordinates and faces, every other property is passed over. Needs no VTK.
Surface read_ply(const std::filesystem::path& file);

// read_poly.cpp: TetGen's .poly and .smesh (TetGen 1.5 manual, 5.2.2 and 5.2.3), with the points in the file or in the .node
// file of the same stem beside it. Facets of several polygons and with holes come as triangles; holes, regions and point
// attributes ("attribute_1", …) are kept, markers are passed over. Inside::enclosed. Throws Error as `read_surface`; also
// (data) for facets with polygons of one or two corners, which are points and segments to be kept, and for two-dimensional
// files. Needs no VTK.
Surface read_poly(const std::filesystem::path& file);

// Gives each point of the mesh what the nearest point of the surface has: the surface's point fields, interpolated
// linearly in its triangles (polygons: fans around their first vertex). A surface without fields gives the point field
// "distance", the distance to it [mesh units]. O(#points · log #triangles), on all cores.
void carry_fields(const Surface& surface, TetMesh& mesh);

}  // namespace cellproj
