// SPDX-License-Identifier: BSD-3-Clause
#include "render/prepared_surfaces.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/common.hpp>

#include "mesh/gradient.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj {

namespace {

// Isovalues beyond the field's range stay beyond it, and finite.
float normalized(const SceneUnits& units, double value) {
    return static_cast<float>(std::clamp(units.normalized(value), -1.0, 2.0));
}

std::vector<std::int32_t> find_levels(const TetMesh& mesh, const ScalarField& field, const SceneUnits& units,
                                      std::span<const float> values) {
    std::vector<std::int32_t> of_points(mesh.points.size()), levels(mesh.tets.size());
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, of_points.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const double s = field.values[i];
            of_points[i] = std::isfinite(s) ? level_of(values, normalized(units, s)) : PreparedSurfaces::no_scalar;
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

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

std::vector<glm::vec3> over_the_steepest(const std::vector<glm::dvec3>& gradients) {
    double steepest = 0;
    for (const glm::dvec3& g : gradients) steepest = std::max(steepest, largest(g));
    std::vector<glm::vec3> result(gradients.size(), glm::vec3(0));
    if (!(steepest > 0)) return result;
    std::transform(gradients.begin(), gradients.end(), result.begin(), [&](const glm::dvec3& g) { return glm::vec3(g / steepest); });
    return result;
}

}  // namespace

PreparedSurfaces::PreparedSurfaces(const Scene& scene, const SceneUnits& units) : scene_(scene.surfaces.get()) {
    assert(has_surfaces(scene) && scene.field->location == FieldLocation::points);
    for (const IsoSurface& surface : scene_->isosurfaces.surfaces()) values_.push_back(normalized(units, surface.value));
    levels_ = find_levels(*scene.mesh, *scene.field, units, values_);
    for (CellId cell = 0; cell < levels_.size(); ++cell)
        if (levels_[cell] == crossed_cell) crossed_.push_back(cell);

    const Gradients of_cells = cell_gradients(*scene.mesh, *scene.field);
    // The scalars of a crossed cell differ: its gradient is 0 only where it has none.
    in_flat_cells_ = of_cells.undefined > 0 &&
                     std::ranges::any_of(crossed_, [&](CellId cell) { return of_cells.values[cell] == glm::dvec3(0); });
    if (scene_->shading == Shading::flat) gradients_ = over_the_steepest(of_cells.values);
    if (scene_->shading == Shading::smooth) gradients_ = over_the_steepest(vertex_gradients(*scene.mesh, *scene.field).values);
}

}  // namespace cellproj
