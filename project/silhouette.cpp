// SPDX-License-Identifier: BSD-3-Clause
#include "project/silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "mesh/tet_mesh.hpp"

namespace cellproj {

namespace {

// A corner with less weight counts as having none: the thick vertex then lies on the opposite edge, to within a millionth
// of the cell's extent on the screen, and the ridge would be steeper than float32 can draw.
constexpr double smallest_weight = 1e-6;

// A face that moves changes by more than this share of its range of depths only where it is seen nearly edge-on.
constexpr double largest_share = 1.0 / 8.0;

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

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// The cell before its corners were moved.
class MovedCell {
public:
    MovedCell(const std::array<ScreenVertex, 4>& corners, const std::array<glm::dvec2, 4>& moved, const glm::dvec2& origin)
        : corners_(corners), moved_(moved), origin_(origin) {}

    struct FaceTerms {
        ScreenPlane depth, scalar;
    };

    // On the plane of the face opposite to a corner.
    FaceTerms terms(std::size_t face) const {
        const auto& f = face_corners[face];
        const std::array<std::size_t, 3> corners{static_cast<std::size_t>(f[0]), static_cast<std::size_t>(f[1]),
                                                 static_cast<std::size_t>(f[2])};
        const FaceTerms before = through(corners, [&](std::size_t c) { return place_before(c); });
        double low = corners_[corners[0]].depth, high = low, change = 0.0;
        for (const std::size_t c : corners) {
            low = std::min(low, corners_[c].depth);
            high = std::max(high, corners_[c].depth);
            change = std::max(change, std::abs(glm::dot(before.depth.gradient, moved_[c])));
        }
        if (change <= largest_share * (high - low) && std::isfinite(before.depth.value + before.scalar.value)) return before;
        return through(corners, [&](std::size_t c) { return corners_[c].position; });
    }

    // Change of the scalar term with the depth term along a ray; not finite for a flat cell.
    double scalar_slope() const {
        const auto edge = [&](std::size_t c) {
            return glm::dvec3(place_before(c) - place_before(0), corners_[c].depth - corners_[0].depth);
        };
        const auto rise = [&](std::size_t c) { return corners_[c].scalar - corners_[0].scalar; };
        const glm::dvec3 a = edge(1), b = edge(2), c = edge(3), bc = glm::cross(b, c);
        return (rise(1) * bc.z + rise(2) * glm::cross(c, a).z + rise(3) * glm::cross(a, b).z) / glm::dot(a, bc);
    }

private:
    glm::dvec2 place_before(std::size_t c) const { return corners_[c].position - moved_[c]; }

    template <class Place>
    FaceTerms through(const std::array<std::size_t, 3>& corners, Place place) const {
        const auto [a, b, c] = corners;
        const glm::dvec2 at = place(a), ab = place(b) - at, ac = place(c) - at;
        const double share = 1.0 / cross(ab, ac);
        const auto plane = [&](double at_a, double at_b, double at_c) {
            const double rise_b = at_b - at_a, rise_c = at_c - at_a;
            const glm::dvec2 gradient{(rise_b * ac.y - rise_c * ab.y) * share, (rise_c * ab.x - rise_b * ac.x) * share};
            return ScreenPlane{at_a + glm::dot(gradient, origin_ - at), gradient};
        };
        return {plane(corners_[a].depth, corners_[b].depth, corners_[c].depth),
                plane(corners_[a].scalar, corners_[b].scalar, corners_[c].scalar)};
    }

    const std::array<ScreenVertex, 4>& corners_;
    const std::array<glm::dvec2, 4>& moved_;
    const glm::dvec2& origin_;
};

Silhouette outline_of(const ProjectedTet& tet, const std::array<ScreenVertex, 4>& corners) {
    Silhouette silhouette;
    if (tet.kind == ProjectionClass::nothing) return silhouette;
    set_triangles(silhouette, tet);
    silhouette.base_is_front = tet.base_is_front;
    const double thickness = tet.vertices[static_cast<std::size_t>(tet.thick)].thickness;
    const double height = thickness > 0.0 ? thickness : 1.0;
    // A ridge that there is not is never the smallest, not by rounding either.
    for (std::size_t c = 0; c < 4; ++c) silhouette.vertices[c] = {corners[c].position, glm::dvec3(2.0 * height)};
    for (std::uint8_t c = 0; c < 4; ++c) {
        if (tet.base_weights[c] < smallest_weight) continue;
        const auto ridge = static_cast<int>(silhouette.ridge_count);
        silhouette.ridge_corners[silhouette.ridge_count++] = c;
        for (SilhouetteVertex& v : silhouette.vertices) v.ridges[ridge] = 0.0;
        silhouette.vertices[c].ridges[ridge] = height / tet.base_weights[c];
    }
    return silhouette;
}

}  // namespace

Silhouette make_outline(const std::array<ScreenVertex, 4>& corners, bool perspective) {
    return outline_of(project_tet(corners, perspective), corners);
}

Silhouette make_silhouette(const std::array<ScreenVertex, 4>& corners, const std::array<glm::dvec2, 4>& moved,
                           const glm::dvec2& origin, bool perspective) {
    const ProjectedTet tet = project_tet(corners, perspective);
    const ProjectedVertex& thick = tet.vertices[static_cast<std::size_t>(tet.thick)];
    if (tet.kind == ProjectionClass::nothing || thick.thickness == 0.0) return {};
    Silhouette silhouette = outline_of(tet, corners);
    silhouette.origin = origin;

    const MovedCell cell(corners, moved, origin);
    for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
        const auto base = cell.terms(base_corner(silhouette.triangles[t]));
        silhouette.terms[t] = {base.depth, base.scalar, {}};
    }
    // Thickness counts from the base: away from the eye, where z grows and 1/z falls, or towards it.
    const double sign = tet.base_is_front == perspective ? -1.0 : 1.0;
    for (std::size_t ridge = 0; ridge < silhouette.ridge_count; ++ridge) {
        // The ridge vanishes where the face opposite to the corner meets the base.
        const ScreenPlane other = cell.terms(silhouette.ridge_corners[ridge]).depth;
        for (std::size_t t = 0; t < silhouette.triangle_count; ++t) {
            SilhouetteTerms& terms = silhouette.terms[t];
            terms.thickness[ridge] = {sign * (other.value - terms.base_depth.value),
                                      sign * (other.gradient - terms.base_depth.gradient)};
        }
    }

    const double slope = sign * cell.scalar_slope();
    const double rise = tet.base_is_front ? thick.back_scalar - thick.front_scalar : thick.front_scalar - thick.back_scalar;
    silhouette.scalar_slope = std::isfinite(slope) ? slope : rise / thick.thickness;
    return silhouette;
}

}  // namespace cellproj
