// SPDX-License-Identifier: BSD-3-Clause
//
// Surfaces as files hold them: polygons, nothing promised. They may be open, turned at random, intersect themselves or
// repeat their points (STL always does); `tetrahedralize` (mesher.hpp) sorts that out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct Surface {
    std::string name;                             // the file, for messages
    std::vector<glm::dvec3> points;               // #P [mesh units]
    std::vector<std::vector<VertexId>> polygons;  // #F, vertices in order around, 0-based into points
    std::vector<Field> point_fields;              // each with #P rows
};

// Throws Error (data), naming the surface: fewer than 4 points or none of its polygons, a point that is not finite, a
// polygon of fewer than 3 vertices, a vertex id out of range, a field whose length does not fit.
void validate(const Surface& surface);

// Reads STL (ascii, binary), OFF, PLY, OBJ and VTK XML polygonal data (.vtp); the format is told by the content, OBJ,
// which has no mark, by its suffix. Polygons keep the order of the file; VTP brings its point fields. Throws Error
// (file, format, data).
Surface read_surface(const std::filesystem::path& file);

// read_off.cpp: Geomview's OFF, ascii, with or without normals and colours (which are passed over). Needs no VTK.
Surface read_off(const std::filesystem::path& file);

// read_ply.cpp: PLY, ascii and binary; coordinates and faces, every other property is passed over. Needs no VTK.
Surface read_ply(const std::filesystem::path& file);

// Gives each point of the mesh what the nearest point of the surface has: the surface's point fields, interpolated
// linearly in its triangles (polygons: fans around their first vertex). A surface without fields gives the point field
// "distance", the distance to it [mesh units]. O(#points · log #triangles), on all cores.
void carry_fields(const Surface& surface, TetMesh& mesh);

}  // namespace cellproj
