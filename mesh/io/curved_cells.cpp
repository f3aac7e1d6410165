// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/io/curved_cells.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/cell_faces.hpp"
#include "mesh/error.hpp"
#include "mesh/io/text_cells.hpp"

namespace cellproj {

namespace {

using Edge = std::array<std::uint8_t, 2>;

constexpr std::array<Edge, 6> tet_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<Edge, 12> hex_edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};
constexpr std::array<Edge, 9> wedge_edges{{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
constexpr std::array<Edge, 8> pyramid_edges{{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}};

// The pieces by number: corners first, then the extra nodes in their order.
using Tet = std::array<std::uint8_t, 4>;
using Wedge = std::array<std::uint8_t, 6>;
using Pyramid = std::array<std::uint8_t, 5>;
using Hex = std::array<std::uint8_t, 8>;

// 4 to 9 are the edges' nodes. The four corners, and the octahedron left between them along each of its diagonals.
constexpr std::array<Tet, 4> tet_corners{{{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}}};
struct Octahedron {
    std::array<std::uint8_t, 2> diagonal;
    std::array<std::uint8_t, 4> around;
};
constexpr std::array<Octahedron, 3> octahedron{
    {{{4, 9}, {5, 6, 7, 8}}, {{5, 7}, {4, 8, 9, 6}}, {{6, 8}, {4, 5, 9, 7}}}};

// 8 to 19 edges, 20 to 25 faces (bottom, top, 0154, 1265, 2376, 3047), 26 the inside.
constexpr std::array<Hex, 8> hex_pieces{{{0, 8, 20, 11, 16, 22, 26, 25},
                                         {8, 1, 9, 20, 22, 17, 23, 26},
                                         {20, 9, 2, 10, 26, 23, 18, 24},
                                         {11, 20, 10, 3, 25, 26, 24, 19},
                                         {16, 22, 26, 25, 4, 12, 21, 15},
                                         {22, 17, 23, 26, 12, 5, 13, 21},
                                         {26, 23, 18, 24, 21, 13, 6, 14},
                                         {25, 26, 24, 19, 15, 21, 14, 7}}};

// 6 to 14 edges, 15 to 17 the faces 0143, 1254, 2035.
constexpr std::array<Wedge, 8> wedge_pieces{{{0, 6, 8, 12, 15, 17},
                                             {6, 1, 7, 15, 13, 16},
                                             {8, 7, 2, 17, 16, 14},
                                             {6, 7, 8, 15, 16, 17},
                                             {12, 15, 17, 3, 9, 11},
                                             {15, 13, 16, 9, 4, 10},
                                             {17, 16, 14, 11, 10, 5},
                                             {15, 16, 17, 9, 10, 11}}};
constexpr std::array<Wedge, 4> low_wedge_pieces{
    {{0, 6, 8, 3, 9, 11}, {6, 1, 7, 9, 4, 10}, {8, 7, 2, 11, 10, 5}, {6, 7, 8, 9, 10, 11}}};

// 5 to 12 edges, 13 the base.
constexpr std::array<Pyramid, 6> pyramid_pieces{{{0, 5, 13, 8, 9},
                                                 {5, 1, 6, 13, 10},
                                                 {13, 6, 2, 7, 11},
                                                 {8, 13, 7, 3, 12},
                                                 {9, 10, 11, 12, 4},
                                                 {9, 12, 11, 10, 13}}};
constexpr std::array<Tet, 4> pyramid_tets{{{5, 13, 9, 10}, {6, 13, 10, 11}, {7, 13, 11, 12}, {8, 13, 12, 9}}};

// What a new point is made of.
struct Weighted {
    std::vector<VertexId> nodes;
    std::vector<double> weights;
};

class Subdivider {
public:
    explicit Subdivider(Dataset& dataset) : dataset_(dataset) {}

    // The pieces of cell `c` whose extra nodes are `extra`, into `cells`.
    void split(std::size_t c, std::span<const VertexId> extra, CellList& cells);
    // A face whose centre the file has.
    void announce_centres(std::size_t c, std::span<const VertexId> extra);
    const std::vector<Weighted>& new_points() const { return new_points_; }

private:
    using FaceKey = std::array<VertexId, 4>;

    std::span<const VertexId> corners(std::size_t c) const {
        const CellList& cells = dataset_.cells;
        return std::span(cells.vertices).subspan(cells.offsets[c], vertex_count(cells.kinds[c]));
    }
    void complete(CellKind kind);
    VertexId add(Weighted point);
    VertexId face_centre(const CellFace& face, CellKind kind);
    VertexId edge_node(CellKind kind, std::uint8_t a, std::uint8_t b) const;
    void split_tet(CellList& cells) const;
    template <class Pieces>
    void append(CellKind kind, const Pieces& pieces, CellList& cells) const {
        std::array<VertexId, 8> piece{};
        for (const auto& places : pieces) {
            for (std::size_t n = 0; n < places.size(); ++n)
                piece[n] = nodes_[places[n]];
            append_cell(cells, kind, std::span(piece).first(places.size()));
        }
    }
    glm::dvec3 position(VertexId node) const { return dataset_.points[node]; }

    Dataset& dataset_;
    std::vector<VertexId> nodes_;  // of the cell at hand: corners and extra nodes
    std::map<FaceKey, VertexId> centres_;
    std::vector<Weighted> new_points_;
};

template <class Visit>
void for_each_quad(CellKind kind, Visit visit) {
    for (const CellFace& face : faces_of(kind)) {
        if (face.size == 4) visit(face);
    }
}

std::array<VertexId, 4> key_of(const CellFace& face, std::span<const VertexId> corners) {
    std::array<VertexId, 4> key{};
    for (std::size_t n = 0; n < 4; ++n)
        key[n] = corners[face.corners[n]];
    std::sort(key.begin(), key.end());
    return key;
}

void Subdivider::announce_centres(std::size_t c, std::span<const VertexId> extra) {
    const CellKind kind = dataset_.cells.kinds[c];
    std::size_t place = second_order_edges(kind).size();
    for_each_quad(kind, [&](const CellFace& face) {
        if (extra[place] != no_node) centres_.emplace(key_of(face, corners(c)), extra[place]);
        ++place;
    });
}

VertexId Subdivider::add(Weighted point) {
    new_points_.push_back(std::move(point));
    const std::size_t id = dataset_.points.size() + new_points_.size() - 1;
    if (id < max_elements) return static_cast<VertexId>(id);
    throw Error({.kind = ErrorKind::data,
                 .place = dataset_.source,
                 .expected = "at most " + std::to_string(max_elements) + " points (ids have 32 bits)",
                 .found = "more, the centres of faces and cells of second order included",
                 .advice = "read the cells by their corners only (--subdivide 0), or cut the data into parts"});
}

VertexId Subdivider::edge_node(CellKind kind, std::uint8_t a, std::uint8_t b) const {
    const auto edges = second_order_edges(kind);
    const auto edge = std::find_if(edges.begin(), edges.end(),
                                   [&](const Edge& e) { return (e[0] == a && e[1] == b) || (e[0] == b && e[1] == a); });
    assert(edge != edges.end());
    return nodes_[vertex_count(kind) + static_cast<std::size_t>(edge - edges.begin())];
}

// Of the eight-node quadrilateral: N = -1/4 at corners and 1/2 at the middles of the sides.
VertexId Subdivider::face_centre(const CellFace& face, CellKind kind) {
    const auto [known, is_new] = centres_.try_emplace(key_of(face, nodes_), no_node);
    if (!is_new) return known->second;
    Weighted point;
    for (std::size_t n = 0; n < 4; ++n) {
        const std::uint8_t a = face.corners[n], b = face.corners[(n + 1) % 4];
        point.nodes.insert(point.nodes.end(), {nodes_[a], edge_node(kind, a, b)});
        point.weights.insert(point.weights.end(), {-0.25, 0.5});
    }
    return known->second = add(std::move(point));
}

// Makes the centres that the file does not have.
void Subdivider::complete(CellKind kind) {
    const std::size_t edges = second_order_edges(kind).size();
    std::size_t place = vertex_count(kind) + edges;
    for_each_quad(kind, [&](const CellFace& face) {
        if (nodes_[place] == no_node) nodes_[place] = face_centre(face, kind);
        ++place;
    });
    if (kind != CellKind::hexahedron || nodes_[place] != no_node) return;
    // The eight-node rule again, in the plane halfway up: the middles of the upright edges and the centres of the faces
    // between them. It is what the shape functions of the 20- and the 24-node hexahedron come to in the centre.
    Weighted point;
    for (std::size_t n = 0; n < 4; ++n) {
        point.nodes.insert(point.nodes.end(), {nodes_[16 + n], nodes_[22 + n]});
        point.weights.insert(point.weights.end(), {-0.25, 0.5});
    }
    nodes_[place] = add(std::move(point));
}

// Along the shortest of the three diagonals, which gives the best-shaped pieces; it is inside the cell, so no neighbour
// minds.
void Subdivider::split_tet(CellList& cells) const {
    append(CellKind::tetrahedron, tet_corners, cells);
    const auto length = [&](const Octahedron& o) {
        const glm::dvec3 d = position(nodes_[o.diagonal[0]]) - position(nodes_[o.diagonal[1]]);
        return glm::dot(d, d);
    };
    const auto* best =
        std::min_element(octahedron.begin(), octahedron.end(),
                         [&](const Octahedron& a, const Octahedron& b) { return length(a) < length(b); });
    std::array<Tet, 4> pieces{};
    for (std::size_t n = 0; n < 4; ++n)
        pieces[n] = {best->diagonal[0], best->diagonal[1], best->around[n], best->around[(n + 1) % 4]};
    append(CellKind::tetrahedron, pieces, cells);
}

void Subdivider::split(std::size_t c, std::span<const VertexId> extra, CellList& cells) {
    const CellKind kind = dataset_.cells.kinds[c];
    nodes_.assign(corners(c).begin(), corners(c).end());
    nodes_.insert(nodes_.end(), extra.begin(), extra.end());
    switch (kind) {
        case CellKind::tetrahedron:
            split_tet(cells);
            break;
        case CellKind::hexahedron:
            complete(kind);
            append(kind, hex_pieces, cells);
            break;
        case CellKind::wedge:
            if (nodes_[12] == no_node) {
                append(kind, low_wedge_pieces, cells);
                break;
            }
            complete(kind);
            append(kind, wedge_pieces, cells);
            break;
        case CellKind::pyramid:
            complete(kind);
            append(kind, pyramid_pieces, cells);
            append(CellKind::tetrahedron, pyramid_tets, cells);
            break;
        default:
            assert(!"a kind of second order");
    }
}

glm::dvec3 weighted_position(const Weighted& point, const std::vector<glm::dvec3>& points) {
    glm::dvec3 sum(0.0);
    for (std::size_t n = 0; n < point.nodes.size(); ++n)
        sum += point.weights[n] * points[point.nodes[n]];
    return sum;
}

// In their order: the inside of a hexahedron is made of centres that stand before it.
void append_points(Dataset& dataset, const std::vector<Weighted>& new_points) {
    dataset.points.reserve(dataset.points.size() + new_points.size());
    for (const Weighted& point : new_points)
        dataset.points.push_back(weighted_position(point, dataset.points));
    for (Field& field : dataset.point_fields) {
        const auto components = static_cast<std::size_t>(field.components);
        for (const Weighted& point : new_points) {
            for (std::size_t k = 0; k < components; ++k) {
                double value = 0.0;
                for (std::size_t n = 0; n < point.nodes.size(); ++n)
                    value += point.weights[n] * field.values[point.nodes[n] * components + k];
                field.values.push_back(value);
            }
        }
    }
}

void gather_rows(std::vector<Field>& fields, const std::vector<std::size_t>& rows) {
    for (Field& field : fields) {
        const auto components = static_cast<std::size_t>(field.components);
        std::vector<double> values;
        values.reserve(rows.size() * components);
        for (const std::size_t row : rows) {
            for (std::size_t k = 0; k < components; ++k)
                values.push_back(field.values[row * components + k]);
        }
        field.values = std::move(values);
    }
}

}  // namespace

std::span<const Edge> second_order_edges(CellKind kind) {
    switch (kind) {
        case CellKind::tetrahedron:
            return tet_edges;
        case CellKind::hexahedron:
            return hex_edges;
        case CellKind::wedge:
            return wedge_edges;
        case CellKind::pyramid:
            return pyramid_edges;
        default:
            return {};
    }
}

std::size_t extra_nodes(CellKind kind) {
    const std::size_t edges = second_order_edges(kind).size();
    if (edges == 0) return 0;
    std::size_t quads = 0;
    for_each_quad(kind, [&](const CellFace&) { ++quads; });
    return edges + quads + (kind == CellKind::hexahedron ? 1 : 0);
}

void CurvedCells::add(std::size_t cell, std::span<const VertexId> file_nodes, std::span<const std::int8_t> places) {
    cells.push_back(cell);
    for (const std::int8_t place : places)
        nodes.push_back(place < 0 ? no_node : file_nodes[static_cast<std::size_t>(place)]);
}

void subdivide_at_nodes(Dataset& dataset, const CurvedCells& curved) {
    if (curved.cells.empty()) return;
    Subdivider subdivider(dataset);
    const auto for_each_curved = [&](auto visit) {
        std::size_t first = 0;
        for (const std::size_t c : curved.cells) {
            const std::size_t count = extra_nodes(dataset.cells.kinds[c]);
            visit(c, std::span(curved.nodes).subspan(first, count));
            first += count;
        }
    };
    for_each_curved([&](std::size_t c, std::span<const VertexId> extra) { subdivider.announce_centres(c, extra); });
    CellList cells;
    std::vector<std::size_t> rows;
    const auto keep_until = [&](std::size_t end) {
        for (std::size_t c = rows.empty() ? 0 : rows.back() + 1; c < end; ++c) {
            const std::size_t begin = dataset.cells.offsets[c];
            append_cell(cells, dataset.cells.kinds[c],
                        std::span(dataset.cells.vertices).subspan(begin, dataset.cells.offsets[c + 1] - begin));
            rows.push_back(c);
        }
    };
    for_each_curved([&](std::size_t c, std::span<const VertexId> extra) {
        keep_until(c);
        subdivider.split(c, extra, cells);
        rows.resize(cells.size(), c);
    });
    keep_until(dataset.cells.size());
    dataset.cells = std::move(cells);
    gather_rows(dataset.cell_fields, rows);
    append_points(dataset, subdivider.new_points());
}

}  // namespace cellproj
