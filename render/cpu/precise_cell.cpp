// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/precise_cell.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/cpu/screen_surfaces.hpp"

namespace cellproj::cpu {

namespace {

// Whether the order of the corners by their numbers is an odd permutation of the given one.
bool sort_corners(std::array<VertexId, 4>& corners) {
    bool odd = false;
    for (std::size_t i = 1; i < 4; ++i)
        for (std::size_t j = i; j > 0 && corners[j] < corners[j - 1]; --j) {
            std::swap(corners[j], corners[j - 1]);
            odd = !odd;
        }
    return odd;
}

// Twice the signed area of the face on the screen.
double area(const glm::dvec3& u, const glm::dvec3& v) { return u.x * v.y - u.y * v.x; }

}  // namespace

PreciseCell precise_cell(const ScreenCells& cells, std::uint32_t item) {
    PreciseCell cell;
    cell.corners = cells.corners(item);
    const bool odd = sort_corners(cell.corners);
    std::array<double, 4> f;  // affine on the screen over any plane
    for (std::size_t i = 0; i < 4; ++i) {
        cell.points[i] = cells.surfaces->points[cell.corners[i]];
        cell.scalars[i] = cells.points[cell.corners[i]].scalar;
        f[i] = cells.view.perspective ? cell.scalars[i] * cell.points[i].z : cell.scalars[i];
    }
    for (std::size_t k = 0; k < 4; ++k) {
        const auto a = static_cast<std::size_t>(face_corners[k][0]), b = static_cast<std::size_t>(face_corners[k][1]),
                   c = static_cast<std::size_t>(face_corners[k][2]);
        const glm::dvec3 u = cell.points[b] - cell.points[a], v = cell.points[c] - cell.points[a];
        const double z = area(u, v), nx = u.y * v.z - u.z * v.y, ny = u.z * v.x - u.x * v.z;
        // Seen edge-on within a billionth of a pixel, a face counts as vertical: a ray is on one side of it or on the other. Slopes of
        // 1e20, as in cell_planes-inl.hpp: then all products below are finite.
        const double steep = std::abs(nx) + std::abs(ny), deep = std::max({std::abs(u.z), std::abs(v.z), std::abs(u.z - v.z)});
        const bool vertical = std::abs(z) * deep < 1e-9 * steep;
        const double inverse = 1.0 / std::copysign(vertical ? 1e-20 * steep + 1e-60 : std::abs(z), z);
        cell.thin |= std::abs(z) < 3e-4 * (std::abs(u.x) + std::abs(u.y) + std::abs(v.x) + std::abs(v.y));
        cell.nearness[k] = {cell.points[a].z, -nx * inverse, -ny * inverse};
        const double fu = f[b] - f[a], fv = f[c] - f[a];
        const auto bounded = [&](double numerator) { return std::clamp(numerator * inverse, -1e30, 1e30); };
        cell.scalar[k] = {f[a], bounded(fu * v.y - fv * u.y), bounded(fv * u.x - fu * v.x)};
        cell.towards_eye[k] = (k % 2 == 0) == (std::signbit(z) != odd);
        cell.lowest[k] = std::min({cell.scalars[a], cell.scalars[b], cell.scalars[c]});
        cell.highest[k] = std::max({cell.scalars[a], cell.scalars[b], cell.scalars[c]});
    }
    return cell;
}

std::array<double, 3> weights_on_face(const PreciseCell& cell, int face, const glm::dvec2& p, bool perspective) {
    const int(&corners)[3] = face_corners[face];
    const auto corner = [&](int i) -> const glm::dvec3& { return cell.points[static_cast<std::size_t>(corners[i])]; };
    const glm::dvec3 u = corner(1) - corner(0), v = corner(2) - corner(0), d = glm::dvec3(p, 0) - corner(0);
    const double whole = area(u, v);
    std::array<double, 3> weights{0.0, area(d, v) / whole, area(u, d) / whole};
    weights[0] = 1.0 - weights[1] - weights[2];
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        double& w = weights[static_cast<std::size_t>(i)];
        w = std::max(w, 0.0) * (perspective ? corner(i).z : 1.0);
        sum += w;
    }
    // Edge-on: seen as a line, from which weights cannot be told.
    if (!(sum > 0.0 && std::isfinite(sum))) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
    for (double& w : weights) w /= sum;
    return weights;
}

glm::vec3 gradient_on_face(const ScreenSurfaces& surfaces, const PreciseCell& cell, std::uint32_t item, int face, const glm::dvec2& p,
                           bool perspective) {
    if (surfaces.shading == SurfaceShading::unlit) return glm::vec3(0);
    if (surfaces.shading == SurfaceShading::flat) return surfaces.gradients[item];
    const auto weights = weights_on_face(cell, face, p, perspective);
    glm::vec3 sum(0);
    for (std::size_t i = 0; i < 3; ++i)
        sum += static_cast<float>(weights[i]) * surfaces.gradients[cell.corners[static_cast<std::size_t>(face_corners[face][i])]];
    return sum;
}

glm::vec3 gradient_at_end(const ScreenCells& cells, std::uint32_t item, const glm::dvec2& p, bool enters) {
    const PreciseCell cell = precise_cell(cells, item);
    int at = 0;
    double end = enters ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 4; ++k) {
        const auto face = static_cast<std::size_t>(k);
        if (cell.towards_eye[face] != enters) continue;
        const glm::dvec3& anchor = cell.points[static_cast<std::size_t>(face_corners[k][0])];
        const ScreenPlane& plane = cell.nearness[face];
        const double n = plane.value + plane.slope_x * (p.x - anchor.x) + plane.slope_y * (p.y - anchor.y);
        if (enters ? n < end : n > end) {
            end = n;
            at = k;
        }
    }
    return gradient_on_face(*cells.surfaces, cell, item, at, p, cells.view.perspective);
}

}  // namespace cellproj::cpu
