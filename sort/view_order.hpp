// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells for one view, and what it is worth. An order is exact when, along every ray from the eye, cells follow each
// other as the order says.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

// How an order is found; what each is worth stands in sort/README.md.
enum class OrderMethod {
    centroid,  // by the distance of the centroids: approximate
    power,     // by the power of the eye with respect to the circumspheres: exact for Delaunay meshes
    mpvo,      // by the relations of face neighbours (Williams 1992): exact for convex acyclic meshes
    bsp,       // mpvo, pairs of boundary faces one behind the other (for the BSP of Comba et al. 1999), cycles cut: exact on all rays
    sxmpvo     // mpvo, the boundary scan-converted (Cook et al. 2004), cycles cut: exact at pixel centres
};

// "centroid", "power", … and back; nothing for an unknown name.
std::string to_string(OrderMethod method);
std::optional<OrderMethod> order_method(std::string_view name);

// A part of a cell that had to be split to get out of a visibility cycle: a tetrahedron inside it. Each corner is given by its
// barycentric weights over the cell's four vertices: ≥ 0, with sum 1.
struct CellPiece {
    CellId cell;
    std::array<glm::dvec4, 4> corners;
};

struct OrderReport {
    OrderMethod method = OrderMethod::mpvo;
    bool exact = false;           // proven for this mesh and eye (sxmpvo: for the pixel centres of this picture)
    std::size_t unordered = 0;    // cells that could only be ordered by depth, against a relation
    std::size_t cycles = 0;       // visibility cycles: strongly connected components of more than one cell
    std::size_t split_cells = 0;  // cells that were split to resolve them
};

// What to draw, from back to front. An item below #T is a cell, the item #T + i is pieces[i]. A cell is there once, as a whole or
// as its pieces.
struct ViewOrder {
    std::span<const std::uint32_t> items;
    std::span<const CellPiece> pieces;
};

// `behind` must come before `front`: a relation that face neighbours do not tell.
struct OrderArc {
    CellId behind, front;

    auto operator<=>(const OrderArc&) const = default;
};

// The pixel centres of a picture, row by row. In perspective, the ray of pixel (i, j) goes from the eye through
// corner + (i + ½)·dx + (j + ½)·dy; in parallel views it starts there and goes against the eye's direction.
struct PixelGrid {
    Eye eye;
    glm::dvec3 corner, dx, dy;  // [mesh units]
    int width, height;
};

}  // namespace cellproj
