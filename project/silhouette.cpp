// SPDX-License-Identifier: BSD-3-Clause
#include "project/silhouette.hpp"

namespace cellproj {

namespace {

// A corner with less weight counts as having none: the thick vertex then lies on the opposite edge, to within a millionth
// of the cell's extent on the screen, and the ridge would be steeper than float32 can draw.
constexpr double smallest_weight = 1e-6;

// All corners but the thick one; where edges cross, the base edge with each of the two other corners.
void set_triangles(Silhouette& silhouette, const ProjectedTet& tet) {
    if (tet.kind == ProjectionClass::edges_cross) {
        // The classical triangles go round: base, other, base, other corner.
        const auto [i, k, j, l] = std::array{tet.triangles[0][0], tet.triangles[1][0], tet.triangles[2][0], tet.triangles[3][0]};
        silhouette.triangle_count = 2;
        silhouette.triangles = {{{i, j, k}, {i, j, l}}};
        return;
    }
    silhouette.triangle_count = 1;
    std::size_t count = 0;
    for (std::uint8_t corner = 0; corner < 4; ++corner) {
        if (corner != tet.thick) silhouette.triangles[0][count++] = corner;
    }
}

}  // namespace

Silhouette make_silhouette(const std::array<ScreenVertex, 4>& corners, bool perspective) {
    Silhouette silhouette;
    const ProjectedTet tet = project_tet(corners, perspective);
    const ProjectedVertex& thick = tet.vertices[static_cast<std::size_t>(tet.thick)];
    if (tet.kind == ProjectionClass::nothing || thick.thickness == 0.0) return silhouette;
    set_triangles(silhouette, tet);

    silhouette.base_is_front = tet.base_is_front;
    const double rise = tet.base_is_front ? thick.back_scalar - thick.front_scalar : thick.front_scalar - thick.back_scalar;
    silhouette.scalar_slope = rise / thick.thickness;

    for (std::size_t c = 0; c < 4; ++c) {
        silhouette.vertices[c] = {corners[c].position, corners[c].depth, corners[c].scalar, glm::dvec3(thick.thickness)};
    }
    int ridge = 0;
    for (std::size_t c = 0; c < 4; ++c) {
        if (tet.base_weights[c] < smallest_weight) continue;
        for (SilhouetteVertex& v : silhouette.vertices) v.ridges[ridge] = 0.0;
        silhouette.vertices[c].ridges[ridge++] = thick.thickness / tet.base_weights[c];
    }
    return silhouette;
}

}  // namespace cellproj
