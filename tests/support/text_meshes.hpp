// SPDX-License-Identifier: BSD-3-Clause
//
// One small mesh as a file of every format that cellproj reads by itself: a hexahedron, a pyramid on top of it, a wedge
// at its side and a tetrahedron on the wedge, with a triangle and a line to be skipped.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/dataset.hpp"

namespace cellproj::testing_support {

inline Dataset sample_mesh() {
    Dataset mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},   {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
                   {1, 1, 1}, {0, 1, 1}, {.5, .5, 2}, {2, 0, 0}, {2, 0, 1}, {1, 0, 2}};
    mesh.cells = {{CellKind::hexahedron, CellKind::pyramid, CellKind::wedge, CellKind::tetrahedron},
                  {0, 8, 13, 19, 23},
                  {0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 1, 9, 2, 5, 10, 6, 5, 10, 6, 11}};
    return mesh;
}

inline double sample_potential(const glm::dvec3& p) {
    return p.x + 10.0 * p.y + 100.0 * p.z;
}

// The ids of a cell, the first one `first`, with blanks between them.
inline std::string sample_ids(std::size_t cell, int first) {
    const CellList cells = sample_mesh().cells;
    std::string text;
    for (std::size_t i = cells.offsets[cell]; i < cells.offsets[cell + 1]; ++i) {
        text += (text.empty() ? "" : " ") + std::to_string(static_cast<int>(cells.vertices[i]) + first);
    }
    return text;
}

inline std::string sample_point(const glm::dvec3& p) {
    return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z);
}

// ---- Gmsh ----

// Numbers one after another, in ascii or as bytes.
struct GmshText {
    bool binary;
    std::string text;

    template <class T>
    GmshText& put(T value) {
        if (binary) {
            text.append(reinterpret_cast<const char*>(&value), sizeof value);
        } else {
            text += (text.empty() || text.back() == '\n' ? "" : " ") + shortest(std::to_string(value));
        }
        return *this;
    }
    GmshText& integer(int value) { return put(std::int32_t{value}); }
    GmshText& size(std::uint64_t value) { return put(value); }
    GmshText& line() {
        if (!binary) text += '\n';
        return *this;
    }
    GmshText& words(const std::string& words) {
        text += words;
        return *this;
    }
    GmshText& end(const std::string& section) { return words((binary ? "\n$End" : "$End") + section + "\n"); }

    static std::string shortest(std::string number) {  // without zeros behind the point
        if (number.find('.') == std::string::npos) return number;
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
        return number;
    }
};

struct GmshElement {
    int type, dimension, entity, physical;
    std::vector<VertexId> nodes;
};

// A triangle and a line, then the cells of the sample.
inline std::vector<GmshElement> gmsh_elements() {
    const CellList cells = sample_mesh().cells;
    std::vector<GmshElement> elements{{2, 2, 3, 0, {0, 1, 2}}, {1, 1, 4, 0, {0, 1}}};
    for (std::size_t c = 0; c < 4; ++c) {
        const auto* const first = cells.vertices.data();
        elements.push_back({std::array{5, 7, 6, 4}[c],
                            3,
                            c < 3 ? 1 : 2,
                            c < 3 ? 7 : 8,
                            {first + cells.offsets[c], first + cells.offsets[c + 1]}});
    }
    return elements;
}

// The tags of the nodes are 7, 7 + gap, 7 + 2 gap, …; those of the elements 1, 2, 3, ….
inline std::uint64_t gmsh_tag(std::size_t node, std::uint64_t gap) {
    return 7 + gap * node;
}

inline void put_gmsh_mesh_2(GmshText& out, std::uint64_t gap) {
    const std::vector<glm::dvec3> points = sample_mesh().points;
    out.words("$Nodes\n12\n");
    for (std::size_t i = 0; i < 12; ++i) {
        out.integer(static_cast<int>(gmsh_tag(i, gap))).put(points[i].x).put(points[i].y).put(points[i].z).line();
    }
    out.end("Nodes").words("$Elements\n6\n");
    int number = 0;
    for (const GmshElement& element : gmsh_elements()) {
        ++number;
        if (!out.binary) out.integer(number);
        out.integer(element.type);
        if (out.binary) out.integer(1);
        out.integer(2);
        if (out.binary) out.integer(number);
        out.integer(element.physical).integer(element.entity);
        for (const VertexId node : element.nodes)
            out.integer(static_cast<int>(gmsh_tag(node, gap)));
        out.line();
    }
    out.end("Elements");
}

inline void put_gmsh_nodes_4(GmshText& out, std::uint64_t gap) {
    const std::vector<glm::dvec3> points = sample_mesh().points;
    out.words("$Nodes\n").size(2).size(12).size(7).size(gmsh_tag(11, gap)).line();
    for (const bool parametric : {true, false}) {
        const std::size_t first = parametric ? 0 : 4, last = parametric ? 4 : 12;
        out.integer(parametric ? 2 : 3).integer(1).integer(parametric ? 1 : 0).size(last - first).line();
        for (std::size_t i = first; i < last; ++i)
            out.size(gmsh_tag(i, gap)).line();
        for (std::size_t i = first; i < last; ++i) {
            out.put(points[i].x).put(points[i].y).put(points[i].z);
            if (parametric) out.put(0.25).put(0.75);
            out.line();
        }
    }
    out.end("Nodes");
}

inline void put_gmsh_mesh_4(GmshText& out, std::uint64_t gap) {
    out.words("$Entities\n").size(0).size(1).size(1).size(2).line();
    for (const int entity : {4, 3, 1, 2}) {  // line, surface, two volumes
        out.integer(entity);
        for (int k = 0; k < 6; ++k)
            out.put(0.5 * k);
        const bool volume = entity < 3;
        out.size(volume ? 1 : 0);
        if (volume) out.integer(entity == 1 ? 7 : -8);
        out.size(1).integer(1).line();
    }
    out.end("Entities");
    put_gmsh_nodes_4(out, gap);
    out.words("$Elements\n").size(6).size(6).size(1).size(6).line();
    std::uint64_t number = 0;
    for (const GmshElement& element : gmsh_elements()) {
        out.integer(element.dimension).integer(element.entity).integer(element.type).size(1).line();
        out.size(++number);
        for (const VertexId node : element.nodes)
            out.size(gmsh_tag(node, gap));
        out.line();
    }
    out.end("Elements");
}

// Version 2 (2.2) or 4 (4.1), with a view of the nodes, one of two elements, and sections to be skipped.
inline std::string gmsh_file(int version, bool binary, std::uint64_t gap) {
    GmshText out{binary, ""};
    out.words("$MeshFormat\n" + std::string(version == 2 ? "2.2 " : "4.1 ") + (binary ? "1 8\n" : "0 8\n"));
    if (binary) out.integer(1);
    out.end("MeshFormat").words("$PhysicalNames\n1\n3 7 \"box\"\n$EndPhysicalNames\n");
    version == 2 ? put_gmsh_mesh_2(out, gap) : put_gmsh_mesh_4(out, gap);
    out.words("$NodeData\n1\n\"potential, V\"\n1\n0.5\n3\n0\n1\n12\n");
    std::size_t node = 0;
    for (const glm::dvec3& p : sample_mesh().points) {
        out.integer(static_cast<int>(gmsh_tag(node++, gap))).put(sample_potential(p)).line();
    }
    out.end("NodeData").words("$ElementData\n1\n\"flux\"\n1\n2.5\n3\n2\n3\n2\n");
    for (const int element : {1, 4})
        out.integer(element).put(1.5).put(-1.0).put(0.0).line();  // triangle, pyramid
    return out.end("ElementData").words("$ElementNodeData\n1\n2 3\n$EndElementNodeData\n").text;
}

// ---- Medit ----

inline std::string medit_file() {
    std::string text = "MeshVersionFormatted 2\nDimension 3 # comment\nVertices\n12\n";
    for (const glm::dvec3& p : sample_mesh().points)
        text += sample_point(p) + " 0\n";
    text += "Triangles\n1\n1 2 3 5\nEdges\n1\n1 2 5\nRequiredVertices\n2\n1\n2\nNormals\n1\n0 0 1\n";
    const char* const keywords[] = {"Hexahedra", "Pyramids", "Prisms", "Tetrahedra"};
    for (std::size_t c = 0; c < 4; ++c) {
        text += std::string(keywords[c]) + "\n1\n" + sample_ids(c, 1) + (c < 3 ? " 7\n" : " 8\n");
    }
    return text + "\nEnd\n";
}

inline std::string medit_solutions() {
    std::string text = "MeshVersionFormatted 2\nDimension\n3\nSolAtVertices\n12\n2 1 2\n";
    for (const glm::dvec3& p : sample_mesh().points)
        text += std::to_string(sample_potential(p)) + " 3 4 5\n";
    return text + "End\n";
}

// ---- SU2 ----

inline std::string su2_file() {
    std::string text = "% a comment\nNDIME= 3\nNELEM= 4\n";
    const char* const types[] = {"12 ", "14 ", "13 ", "10 "};
    for (std::size_t c = 0; c < 4; ++c)
        text += types[c] + sample_ids(c, 0) + " " + std::to_string(c) + "\n";
    text += "NPOIN=12\n";
    for (const glm::dvec3& p : sample_mesh().points)
        text += sample_point(p) + "\n";
    return text + "NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 2\n5 0 1 2 0\n3 0 1\nFFD_NBOX= 1\n";
}

// ---- TetGen: two tetrahedra on a common face ----

inline std::string tetgen_nodes(int first) {
    std::string text = "# a comment\n5 3 1 1\n";
    const char* const rows[] = {"0 0 -1 0 0", "1 0 0 1 0", "0 1 0 2 0", "-1 -1 0 3 0 # comment", "0 0 1.0e0 4 9"};
    for (int i = 0; i < 5; ++i)
        text += std::to_string(first + i) + "  " + rows[i] + "\n";
    return text;
}

inline std::string tetgen_elements(int first) {
    std::string text = "2 4 1\n";
    for (const int t : {0, 1}) {
        text += std::to_string(first + t) + " " + std::to_string(first + 4 * t);
        for (int i = 1; i < 4; ++i)
            text += " " + std::to_string(first + i);
        text += t == 0 ? " -1\n" : " 2.5\n";
    }
    return text;
}

}  // namespace cellproj::testing_support
