// SPDX-License-Identifier: AGPL-3.0-or-later
//
// All that needs CGAL's GPL packages (Polygon_mesh_processing, AABB_tree). A file of its own: it compiles for 16 s.
#include "repair.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "intersections.hpp"
#include "mesh/error.hpp"

namespace cellproj {

namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = Mesh::Face_index;

constexpr std::size_t told = 5;  // offenders named in a message

// A polygon that remembers, through sorting and merging, which facet of the file it was.
struct SoupPolygon : std::vector<std::size_t> {
    using std::vector<std::size_t>::vector;
    std::uint32_t origin = new_facet;
};

struct Soup {
    std::vector<Point> points;
    std::vector<SoupPolygon> polygons;
};

using Origins = Mesh::Property_map<Face, std::uint32_t>;
using FacetPairs = std::vector<std::array<std::uint32_t, 2>>;

class Refuse {
public:
    explicit Refuse(std::string place) : place_(std::move(place)) {}
    [[noreturn]] void operator()(const std::string& expected, const std::string& found,
                                 const std::string& advice) const {
        throw Error({.kind = ErrorKind::data, .place = place_, .expected = expected, .found = found, .advice = advice});
    }

private:
    std::string place_;
};

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string facet_name(std::uint32_t origin) {
    return origin == new_facet ? "a new one" : std::to_string(origin);
}

Soup to_soup(const Surface& surface) {
    Soup soup;
    for (const glm::dvec3& p : surface.points)
        soup.points.emplace_back(p.x, p.y, p.z);
    soup.polygons.resize(surface.polygons.size());
    for (std::size_t i = 0; i < surface.polygons.size(); ++i) {
        soup.polygons[i].assign(surface.polygons[i].begin(), surface.polygons[i].end());
        soup.polygons[i].origin = facet_of(surface, i);
    }
    return soup;
}

bool lie_in_one_plane(const std::vector<Point>& points) {
    const auto first = points.begin();
    const auto differs = [&](const Point& p) { return p != *first; };
    const auto second = std::find_if(first, points.end(), differs);
    if (second == points.end()) return true;
    const auto third =
        std::find_if(second, points.end(), [&](const Point& p) { return !CGAL::collinear(*first, *second, p); });
    if (third == points.end()) return true;
    return std::all_of(third, points.end(), [&](const Point& p) { return CGAL::coplanar(*first, *second, *third, p); });
}

void require_manifold_edges(const Soup& soup, const Refuse& refuse) {
    std::map<std::pair<std::size_t, std::size_t>, std::vector<std::uint32_t>> users;
    for (const SoupPolygon& polygon : soup.polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            users[std::minmax({polygon[i], polygon[(i + 1) % polygon.size()]})].push_back(polygon.origin);
        }
    }
    std::size_t overused = 0;
    std::string first;
    for (const auto& [edge, facets] : users) {
        if (facets.size() <= 2) continue;
        if (++overused > 1) continue;
        for (const std::uint32_t facet : facets)
            first += (first.empty() ? "" : ", ") + facet_name(facet);
    }
    if (overused == 0) return;
    refuse("edges shared by two facets",
           counted(overused, "non-manifold edge", "non-manifold edges") + ", the first between the facets " + first,
           "mark what is empty (--hole) or is a region of its own (--region), which allows inner walls, or remove them; save "
           "solids that touch in an edge as files of their own");
}

Mesh to_mesh(const Soup& soup, Origins& origins) {
    Mesh mesh;
    PMP::polygon_soup_to_polygon_mesh(soup.points, soup.polygons, mesh);
    origins = mesh.add_property_map<Face, std::uint32_t>("f:origin", new_facet).first;
    // A new mesh numbers its faces in the order in which they were added.
    for (const Face face : mesh.faces())
        origins[face] = soup.polygons[static_cast<std::size_t>(face)].origin;
    return mesh;
}

void close_or_refuse(Mesh& mesh, bool fill_holes, const Refuse& refuse) {
    PMP::stitch_borders(mesh);
    if (CGAL::is_closed(mesh)) return;
    std::vector<Mesh::Halfedge_index> holes;
    PMP::extract_boundary_cycles(mesh, std::back_inserter(holes));
    const auto open_edges = static_cast<std::size_t>(std::count_if(
        mesh.edges().begin(), mesh.edges().end(), [&](Mesh::Edge_index edge) { return mesh.is_border(edge); }));
    const std::string found =
        counted(open_edges, "open edge", "open edges") + " around " + counted(holes.size(), "hole", "holes");
    if (!fill_holes) {
        refuse("a closed surface", found,
               "close it, have the holes filled (--fill-holes), or fill a wrap around it (--wrap 0.05, larger for larger holes)");
    }
    for (const Mesh::Halfedge_index hole : holes) {
        std::vector<Face> patch;
        PMP::triangulate_hole(mesh, hole, std::back_inserter(patch));
    }
    if (!CGAL::is_closed(mesh)) refuse("holes that triangles can fill", found, "close the surface by hand");
}

// Hands the origin of a polygon on to its triangles.
class InheritOrigin : public PMP::Triangulate_faces::Default_visitor<Mesh> {
public:
    explicit InheritOrigin(Origins origins) : origins_(origins) {}
    void before_subface_creations(Face whole) { origin_ = origins_[whole]; }
    void after_subface_created(Face part) { origins_[part] = origin_; }

private:
    Origins origins_;
    std::uint32_t origin_ = new_facet;
};

void triangulate(Mesh& mesh, const Origins& origins, const Refuse& refuse) {
    const bool done = PMP::triangulate_faces(mesh, CGAL::parameters::visitor(InheritOrigin(origins)));
    if (!done || !CGAL::is_triangle_mesh(mesh))
        refuse("polygons that can be triangulated", "one that cannot", "triangulate the surface before");
}

// `pairs` gets them even when they are refused.
void require_no_intersections(const std::vector<glm::dvec3>& points, const FacetTriangles& triangles, FacetPairs& pairs,
                              const Refuse& refuse) {
    if (triangles.corners.empty())
        refuse("a surface around a volume", "facets without area only", "give a closed surface");
    pairs = intersecting_facets(points, triangles);
    if (pairs.empty()) return;
    std::string found = counted(pairs.size(), "pair", "pairs") + " of facets that cross or touch: ";
    for (std::size_t i = 0; i < std::min(told, pairs.size()); ++i) {
        found += (i == 0 ? "" : ", ") + facet_name(pairs[i][0]) + " and " + facet_name(pairs[i][1]);
    }
    if (pairs.size() > told) found += ", …";
    refuse("a surface that does not intersect itself", found,
           "repair it there (--intersections FILE.vtp shows where; facets count from 0) or fill a wrap around it "
           "(--wrap 0.05)");
}

glm::dvec3 to_glm(const Point& p) {
    return {p.x(), p.y(), p.z()};
}

struct TriangleSoup {
    std::vector<glm::dvec3> points;
    FacetTriangles triangles;
};

TriangleSoup to_triangles(const Mesh& mesh, const Origins& origins) {
    TriangleSoup soup;
    std::vector<VertexId> ids(mesh.num_vertices());
    for (const Mesh::Vertex_index v : mesh.vertices()) {
        ids[v] = static_cast<VertexId>(soup.points.size());
        soup.points.push_back(to_glm(mesh.point(v)));
    }
    for (const Face face : mesh.faces()) {
        auto corner = soup.triangles.corners.emplace_back().begin();
        for (const Mesh::Vertex_index v : mesh.vertices_around_face(mesh.halfedge(face)))
            *corner++ = ids[v];
        soup.triangles.facets.push_back(origins[face]);
    }
    return soup;
}

// Polygons that need not form a manifold are triangulated apart from each other, over points of their own.
TriangleSoup to_triangles(const Soup& soup, const Refuse& refuse) {
    Mesh mesh;
    Origins origins = mesh.add_property_map<Face, std::uint32_t>("f:origin", new_facet).first;
    std::vector<VertexId> ids;  // of the vertices of `mesh`, which are numbered as they are added
    for (const SoupPolygon& polygon : soup.polygons) {
        std::vector<Mesh::Vertex_index> corners;
        for (const std::size_t v : polygon) {
            corners.push_back(mesh.add_vertex(soup.points[v]));
            ids.push_back(static_cast<VertexId>(v));
        }
        origins[mesh.add_face(corners)] = polygon.origin;
    }
    triangulate(mesh, origins, refuse);
    TriangleSoup result;
    for (const Point& p : soup.points)
        result.points.push_back(to_glm(p));
    for (const Face face : mesh.faces()) {
        std::vector<Mesh::Vertex_index> v;
        for (const Mesh::Vertex_index corner : mesh.vertices_around_face(mesh.halfedge(face)))
            v.push_back(corner);
        if (CGAL::collinear(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]))) continue;
        result.triangles.corners.push_back({ids[v[0]], ids[v[1]], ids[v[2]]});
        result.triangles.facets.push_back(origins[face]);
    }
    return result;
}

PiecewiseLinearComplex to_complex(TriangleSoup soup) {
    PiecewiseLinearComplex complex;
    complex.points = std::move(soup.points);
    for (const auto& corners : soup.triangles.corners)
        complex.facets.emplace_back(corners.begin(), corners.end());
    return complex;
}

Mesh to_mesh(const PiecewiseLinearComplex& complex) {
    Mesh mesh;
    std::vector<Mesh::Vertex_index> vertices;
    for (const glm::dvec3& p : complex.points)
        vertices.push_back(mesh.add_vertex(Point(p.x, p.y, p.z)));
    for (const std::vector<VertexId>& facet : complex.facets)
        mesh.add_face(vertices[facet[0]], vertices[facet[1]], vertices[facet[2]]);
    return mesh;
}

Point centroid(const TetMesh& mesh, CellId cell) {
    glm::dvec3 sum(0.0);
    for (const VertexId v : mesh.tets[cell])
        sum += mesh.points[v];
    return {sum.x / 4, sum.y / 4, sum.z / 4};
}

// The largest cell of each region: its centroid is the safest point to ask where the region lies.
std::map<double, CellId> largest_cells(const TetMesh& mesh, const std::vector<double>& regions) {
    std::map<double, CellId> largest;
    const auto volume = [&](CellId cell) {
        const auto& t = mesh.tets[cell];
        const glm::dvec3 a = mesh.points[t[1]] - mesh.points[t[0]], b = mesh.points[t[2]] - mesh.points[t[0]],
                         c = mesh.points[t[3]] - mesh.points[t[0]];
        return std::abs(a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x));
    };
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        const auto [entry, is_new] = largest.try_emplace(regions[cell], cell);
        if (!is_new && volume(cell) > volume(entry->second)) entry->second = cell;
    }
    return largest;
}

void drop_unused_points(TetMesh& mesh) {
    std::vector<VertexId> ids(mesh.points.size(), no_cell);
    std::vector<glm::dvec3> used;
    for (auto& tet : mesh.tets) {
        for (VertexId& v : tet) {
            if (ids[v] == no_cell) {
                ids[v] = static_cast<VertexId>(used.size());
                used.push_back(mesh.points[v]);
            }
            v = ids[v];
        }
    }
    mesh.points = std::move(used);
}

// Coincident points merged, equal polygons and those without three different points dropped.
Soup repaired_soup(const Surface& surface, const Refuse& refuse) {
    Soup soup = to_soup(surface);
    PMP::repair_polygon_soup(soup.points, soup.polygons);
    if (soup.polygons.empty())
        refuse("a closed surface", "no facet with three different points", "give a closed surface");
    if (lie_in_one_plane(soup.points))
        refuse("a surface around a volume", "points that all lie in one plane (volume 0)", "give a closed surface");
    return soup;
}

}  // namespace

PiecewiseLinearComplex closed_boundary(const Surface& surface, bool fill_holes, FacetPairs& intersections) {
    const Refuse refuse(surface.name);
    Soup soup = repaired_soup(surface, refuse);
    require_manifold_edges(soup, refuse);
    PMP::orient_polygon_soup(soup.points, soup.polygons);
    Origins origins;
    Mesh mesh = to_mesh(soup, origins);
    close_or_refuse(mesh, fill_holes, refuse);
    triangulate(mesh, origins, refuse);
    PMP::remove_degenerate_faces(mesh);
    TriangleSoup triangles = to_triangles(mesh, origins);
    require_no_intersections(triangles.points, triangles.triangles, intersections, refuse);
    return to_complex(std::move(triangles));
}

PiecewiseLinearComplex enclosing_facets(const Surface& surface, FacetPairs& intersections) {
    const Refuse refuse(surface.name);
    TriangleSoup triangles = to_triangles(repaired_soup(surface, refuse), refuse);
    require_no_intersections(triangles.points, triangles.triangles, intersections, refuse);
    return to_complex(std::move(triangles));
}

void keep_inside(TetMesh& mesh, const PiecewiseLinearComplex& boundary) {
    if (mesh.cell_fields.empty()) return;
    const std::vector<double> regions = std::move(mesh.cell_fields.front().values);
    mesh.cell_fields.clear();
    const std::map<double, CellId> samples = largest_cells(mesh, regions);
    if (samples.size() < 2) return;  // TetGen has removed what is connected with infinity
    const Mesh sheets = to_mesh(boundary);
    const CGAL::Side_of_triangle_mesh<Mesh, Kernel> side(sheets);
    std::map<double, bool> inside;
    for (const auto& [region, cell] : samples)
        inside[region] = side(centroid(mesh, cell)) == CGAL::ON_BOUNDED_SIDE;
    std::vector<std::array<VertexId, 4>> kept;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        if (inside[regions[cell]]) kept.push_back(mesh.tets[cell]);
    }
    mesh.tets = std::move(kept);
    drop_unused_points(mesh);
}

}  // namespace cellproj
