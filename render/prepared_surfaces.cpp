// SPDX-License-Identifier: BSD-3-Clause
#include "render/prepared_surfaces.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/gradient.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj {

namespace {

// Isovalues beyond the field's range stay beyond it, and finite.
float normalized(const SceneUnits& units, double value) {
    return static_cast<float>(std::clamp(units.normalized(value), -1.0, 2.0));
}

// The first texel that is not below the isovalue, as the table has it to the bit. scalar_low < value <= scalar_high.
int first_texel(const SceneUnits& units, double value, int size) {
    const auto below = [&](int i) { return IsoSurfaceTable::scalar_at(units.scalar_low, units.scalar_high, size, i) < value; };
    auto texel = static_cast<int>(std::clamp(std::ceil(units.normalized(value) * (size - 1)), 0.0, size - 1.0));
    while (texel > 0 && !below(texel - 1)) --texel;
    while (texel + 1 < size && below(texel)) ++texel;
    return texel;
}

// Scalars lie in 0 .. 1: what is not met there stands well outside.
float threshold_of(const SceneUnits& units, double value, const SurfaceSides& sides) {
    if (value <= units.scalar_low) return -1.0F;
    if (value > units.scalar_high) return 2.0F;
    double threshold = units.normalized(value);
    if (sides.table_size > 0) threshold = (first_texel(units, value, sides.table_size) - 0.5) / sides.texel_scale();
    return static_cast<float>(threshold - sides.margin);
}

std::vector<std::int32_t> find_levels(const TetMesh& mesh, const ScalarField& field, const SceneUnits& units,
                                      std::span<const float> thresholds) {
    std::vector<std::int32_t> of_points(mesh.points.size()), levels(mesh.tets.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, of_points.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const double s = field.values[i];
            of_points[i] = std::isfinite(s) ? level_of(thresholds, normalized(units, s)) : PreparedSurfaces::no_scalar;
        }
    });
    oneapi::tbb::parallel_for(Range(0, levels.size(), 4096), [&](const Range& range) {
        for (std::size_t cell = range.begin(); cell != range.end(); ++cell) {
            std::int32_t low = of_points[mesh.tets[cell][0]], high = low;
            for (const VertexId v : mesh.tets[cell]) {
                low = std::min(low, of_points[v]);
                high = std::max(high, of_points[v]);
            }
            levels[cell] = low == PreparedSurfaces::no_scalar ? low : low < high ? PreparedSurfaces::crossed_cell : low;
        }
    });
    return levels;
}

// How much the normalized scalar differs in a flat cell between its two sides, at most: c·s / max |c| with c the weights of the
// affine relation of its four points (Σ c = 0, Σ c·p = 0), the signed areas of the faces opposite to them.
double jump_in(const TetMesh& mesh, const ScalarField& field, const SceneUnits& units, CellId cell) {
    const auto& tet = mesh.tets[cell];
    std::array<glm::dvec3, 4> p, normals;
    for (std::size_t i = 0; i < 4; ++i) p[i] = (mesh.points[tet[i]] - mesh.points[tet[0]]) / units.length;
    constexpr std::size_t faces[4][3]{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // turned as their signs are
    std::size_t widest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& [a, b, c] = faces[i];
        normals[i] = glm::cross(p[b] - p[a], p[c] - p[a]);
        if (glm::length(normals[i]) > glm::length(normals[widest])) widest = i;
    }
    const double area = glm::length(normals[widest]);
    if (!(area > 0)) return 0;  // a line: no ray meets it
    double jump = 0;
    for (std::size_t i = 0; i < 4; ++i)
        jump += glm::dot(normals[i] / area, normals[widest] / area) * units.normalized(field.values[tet[i]]);
    return std::abs(jump);
}

std::vector<VertexId> points_of(const TetMesh& mesh, std::span<const CellId> cells) {
    std::vector<std::uint8_t> some(cells.empty() ? 0 : mesh.points.size());
    for (const CellId cell : cells)
        for (const VertexId v : mesh.tets[cell]) some[v] = 1;
    std::vector<VertexId> points;
    for (VertexId v = 0; v < some.size(); ++v)
        if (some[v]) points.push_back(v);
    return points;
}

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Squares and sums of what is left, those of slivers as well, are finite in float32.
std::vector<glm::vec3> over_weak_ones(const std::vector<glm::dvec3>& gradients, const SceneUnits& units) {
    constexpr double longest = 1e15;
    const double range = units.scalar_high - units.scalar_low;
    std::vector<glm::vec3> result(gradients.size(), glm::vec3(0));
    if (!(range > 0)) return result;
    std::transform(gradients.begin(), gradients.end(), result.begin(), [&](const glm::dvec3& g) {
        const glm::dvec3 relative = g / range * units.length / weak_gradient;
        const double size = largest(relative);
        return glm::vec3(size > longest ? longest / size * relative : relative);
    });
    return result;
}

}  // namespace

PreparedSurfaces::PreparedSurfaces(const Scene& scene, const SceneUnits& units, const SurfaceSides& sides, const PreparedSurfaces* before)
    : scene_(scene.surfaces.get()), sides_(sides) {
    assert(has_surface_scene(scene) && scene.field->location == FieldLocation::points);
    for (const IsoSurface& surface : scene_->isosurfaces.surfaces()) {
        values_.push_back(normalized(units, surface.value));
        thresholds_.push_back(threshold_of(units, surface.value, sides));
    }
    levels_ = find_levels(*scene.mesh, *scene.field, units, thresholds_);
    for (CellId cell = 0; cell < levels_.size(); ++cell)
        if (levels_[cell] == crossed_cell) crossed_.push_back(cell);
    crossed_points_ = points_of(*scene.mesh, crossed_);
    of_field_ = before && before->of_field_->shading == scene_->shading ? before->of_field_ : find_gradients(scene, units);
    find_jumps(scene, units);
}

std::shared_ptr<const PreparedSurfaces::OfField> PreparedSurfaces::find_gradients(const Scene& scene, const SceneUnits& units) {
    const TetMesh& mesh = *scene.mesh;
    OfField found{.shading = scene.surfaces->shading, .gradients = {}, .flat_cells = {}};
    const Gradients of_cells = cell_gradients(mesh, *scene.field);
    // A flat cell has the gradient 0, and so have others.
    for (CellId cell = 0; of_cells.undefined > 0 && cell < mesh.tets.size(); ++cell)
        if (of_cells.values[cell] == glm::dvec3(0) && is_flat(mesh, cell)) found.flat_cells.push_back(cell);
    if (found.shading == Shading::flat) found.gradients = over_weak_ones(of_cells.values, units);
    if (found.shading == Shading::smooth) found.gradients = over_weak_ones(vertex_gradients(mesh, *scene.field).values, units);
    return std::make_shared<const OfField>(std::move(found));
}

void PreparedSurfaces::find_jumps(const Scene& scene, const SceneUnits& units) {
    const TetMesh& mesh = *scene.mesh;
    // Within 1e-6 of the field's range float32 loses surfaces at points as well.
    jump_ = std::ranges::any_of(of_field_->flat_cells, [&](CellId cell) {
        return levels_[cell] == crossed_cell && jump_in(mesh, *scene.field, units, cell) > 1e-6;
    });
    if (!jump_) return;
    std::vector<std::uint8_t> touched(mesh.points.size());
    for (const CellId cell : of_field_->flat_cells)
        for (const VertexId v : mesh.tets[cell]) touched[v] = 1;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell)
        if (levels_[cell] >= 0 && std::ranges::any_of(mesh.tets[cell], [&](VertexId v) { return touched[v] != 0; }))
            beside_jumps_.push_back(cell);
}

}  // namespace cellproj
