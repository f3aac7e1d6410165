// SPDX-License-Identifier: AGPL-3.0-or-later
//
// CGAL's Alpha_wrap_3 (GPL): Portaneri, Rouxel-Labbé, Hemmer, Cohen-Steiner, Alliez, Alpha Wrapping with an Offset,
// ACM TOG 41(4), 2022. A file of its own: it compiles for long.
#include "wrap.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

// What CGAL's manual suggests: near enough to follow the surface, far enough to leave the wrap's triangles well shaped.
constexpr double offset_share = 1.0 / 30.0;

// Polygons as fans: the wrap does not care which way a polygon is cut.
std::vector<std::array<std::size_t, 3>> fans(const Surface& surface) {
    std::vector<std::array<std::size_t, 3>> triangles;
    for (const std::vector<VertexId>& polygon : surface.polygons) {
        for (std::size_t i = 2; i < polygon.size(); ++i)
            triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
    return triangles;
}

}  // namespace

PiecewiseLinearComplex wrapped(const Surface& surface, double alpha) {
    std::vector<Point> points;
    for (const glm::dvec3& p : surface.points)
        points.emplace_back(p.x, p.y, p.z);
    const std::vector<std::array<std::size_t, 3>> triangles = fans(surface);
    CGAL::Bbox_3 box;
    for (const auto& corners : triangles) {
        const Kernel::Triangle_3 triangle(points[corners[0]], points[corners[1]], points[corners[2]]);
        if (!triangle.is_degenerate()) box += triangle.bbox();
    }
    const double alpha_length = alpha * std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin());
    Mesh wrap;
    // An empty box is one of infinite extent, turned inside out.
    if (box.xmin() <= box.xmax()) CGAL::alpha_wrap_3(points, triangles, alpha_length, offset_share * alpha_length, wrap);
    if (wrap.is_empty()) {
        throw Error({.kind = ErrorKind::data,
                     .place = surface.name,
                     .expected = "a surface to wrap",
                     .found = "facets without area only",
                     .advice = "give another file"});
    }

    PiecewiseLinearComplex complex;
    std::vector<VertexId> ids(wrap.num_vertices());
    for (const Mesh::Vertex_index v : wrap.vertices()) {
        ids[v] = static_cast<VertexId>(complex.points.size());
        const Point& p = wrap.point(v);
        complex.points.emplace_back(p.x(), p.y(), p.z());
    }
    for (const Mesh::Face_index face : wrap.faces()) {
        std::vector<VertexId>& facet = complex.facets.emplace_back();
        for (const Mesh::Vertex_index v : wrap.vertices_around_face(wrap.halfedge(face)))
            facet.push_back(ids[v]);
    }
    return complex;
}

}  // namespace cellproj
