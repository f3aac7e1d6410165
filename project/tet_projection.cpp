// SPDX-License-Identifier: BSD-3-Clause
#include "project/tet_projection.hpp"

#include <cmath>
#include <utility>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

namespace {

// Twice the signed screen areas of the four faces, face i opposite to corner i, turned outwards: they sum to 0, and those
// of one sign together cover the silhouette once.
std::array<double, 4> face_areas(const std::array<ScreenVertex, 4>& corners) {
    std::array<double, 4> areas{};
    for (std::size_t face = 0; face < 4; ++face) {
        const auto& f = face_corners[face];
        areas[face] = doubled_area(corners[static_cast<std::size_t>(f[0])].position, corners[static_cast<std::size_t>(f[1])].position,
                                   corners[static_cast<std::size_t>(f[2])].position);
    }
    return areas;
}

ProjectedVertex silhouette_vertex(const ScreenVertex& v) { return {v.position, v.depth, 0.0, v.scalar, v.scalar}; }

// Sets the thick vertex: the base has the terms of `base`, the other side those of `other`; `depth_difference` is
// other.depth − base.depth, computed by the caller without cancellation.
void set_thick_vertex(ProjectedTet& tet, const ScreenVertex& base, const ScreenVertex& other, double depth_difference,
                      bool perspective) {
    tet.base_is_front = perspective == (depth_difference < 0);
    const ScreenVertex& front = tet.base_is_front ? base : other;
    const ScreenVertex& back = tet.base_is_front ? other : base;
    tet.vertices[static_cast<std::size_t>(tet.thick)] = {other.position, front.depth, std::abs(depth_difference),
                                                         front.scalar, back.scalar};
}

ScreenVertex mix(const ScreenVertex& a, const ScreenVertex& b, double t) {
    return {a.position + t * (b.position - a.position), a.depth + t * (b.depth - a.depth),
            a.scalar + t * (b.scalar - a.scalar)};
}

// Corner m lies inside the triangle of the others, on its border or on one of its corners.
void project_around_vertex(ProjectedTet& tet, const std::array<ScreenVertex, 4>& corners,
                           const std::array<double, 4>& areas, std::size_t m, bool perspective) {
    // The weight of corner j at m is the area of face j, which joins m with the two corners other than j.
    double total = 0.0;
    for (std::size_t j = 0; j < 4; ++j) total += j == m ? 0.0 : std::abs(areas[j]);
    ScreenVertex base{corners[m].position, 0.0, 0.0};
    double base_depth_above = 0.0;  // base.depth − corners[m].depth
    std::size_t triangles = 0;
    for (std::size_t j = 0; j < 4; ++j) {
        if (j == m || areas[j] == 0.0) continue;
        const double weight = std::abs(areas[j]) / total;
        tet.base_weights[j] = weight;
        base_depth_above += weight * (corners[j].depth - corners[m].depth);
        base.scalar += weight * corners[j].scalar;

        auto& triangle = tet.triangles[triangles++];
        std::size_t corner = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            if (k != j && k != m) triangle[corner++] = static_cast<std::uint8_t>(k);
        }
        triangle[2] = static_cast<std::uint8_t>(m);
    }
    base.depth = corners[m].depth + base_depth_above;
    tet.kind = static_cast<ProjectionClass>(triangles);
    tet.thick = static_cast<int>(m);
    set_thick_vertex(tet, base, corners[m], -base_depth_above, perspective);
}

// Edges (i, j) and (k, l) cross; faces i and j are seen from one side, faces k and l from the other.
void project_crossing_edges(ProjectedTet& tet, const std::array<ScreenVertex, 4>& corners,
                            const std::array<double, 4>& areas, std::array<std::size_t, 2> ij,
                            std::array<std::size_t, 2> kl, bool perspective) {
    const auto [i, j] = ij;
    const auto [k, l] = kl;
    // Face l = (i, j, k): its area is the distance of k from the line ij, up to a factor.
    const double t = std::abs(areas[l]) / (std::abs(areas[l]) + std::abs(areas[k]));
    const double u = std::abs(areas[j]) / (std::abs(areas[j]) + std::abs(areas[i]));
    const ScreenVertex on_kl = mix(corners[k], corners[l], t);
    const ScreenVertex on_ij = mix(corners[i], corners[j], u);
    const double depth_difference = (1 - t) * (corners[k].depth - corners[i].depth) +
                                    t * (corners[l].depth - corners[i].depth) -
                                    u * (corners[j].depth - corners[i].depth);
    tet.kind = ProjectionClass::edges_cross;
    tet.thick = 4;
    tet.base_weights[i] = 1 - u;
    tet.base_weights[j] = u;
    set_thick_vertex(tet, on_ij, on_kl, depth_difference, perspective);
    const auto id = [](std::size_t corner) { return static_cast<std::uint8_t>(corner); };
    tet.triangles = {{{id(i), id(k), 4}, {id(k), id(j), 4}, {id(j), id(l), 4}, {id(l), id(i), 4}}};
}

}  // namespace

ProjectedTet project_tet(const std::array<ScreenVertex, 4>& corners, bool perspective) {
    const std::array<double, 4> areas = face_areas(corners);
    std::array<std::size_t, 4> positive{}, negative{};
    std::size_t positives = 0, negatives = 0;
    for (std::size_t face = 0; face < 4; ++face) {
        if (areas[face] > 0) positive[positives++] = face;
        if (areas[face] < 0) negative[negatives++] = face;
    }
    ProjectedTet tet;
    if (positives == 0 || negatives == 0) return tet;  // edge-on: all areas are 0
    for (std::size_t v = 0; v < 4; ++v) tet.vertices[v] = silhouette_vertex(corners[v]);
    // One face against the others: it is as large as they are together, and its opposite corner lies over it. With two
    // faces edge-on both remaining ones qualify, and so do both of their corners: they coincide.
    if (positives == 1) {
        project_around_vertex(tet, corners, areas, positive[0], perspective);
    } else if (negatives == 1) {
        project_around_vertex(tet, corners, areas, negative[0], perspective);
    } else {
        project_crossing_edges(tet, corners, areas, {positive[0], positive[1]}, {negative[0], negative[1]},
                               perspective);
    }
    return tet;
}

}  // namespace cellproj
