// SPDX-License-Identifier: BSD-3-Clause
#include "render/surface_cells.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace cellproj {

namespace {

constexpr double below_isovalue = 0x1p-21;

// Scalars lie in 0 .. 1: what is not met there stands well outside.
float threshold_of(double isovalue, const SceneUnits& units) {
    if (isovalue <= units.scalar_low) return -1.0F;
    if (isovalue > units.scalar_high) return 2.0F;
    return static_cast<float>(units.normalized(isovalue) - below_isovalue);
}

Gradients gradients_of(const Scene& scene) {
    switch (scene.surfaces->shading) {
        case Shading::flat:
            return cell_gradients(*scene.mesh, *scene.field);
        case Shading::smooth:
            return vertex_gradients(*scene.mesh, *scene.field);
        case Shading::unlit:
            break;
    }
    return {};
}

}  // namespace

SurfaceCells::SurfaceCells(const Scene& scene, const SceneUnits& units)
    : mesh_(scene.mesh.get()), shading_(scene.surfaces->shading), crossed_(scene.mesh->tets.size()), gradients_(gradients_of(scene)) {
    for (const IsoSurface& surface : scene.surfaces->isosurfaces.surfaces())
        thresholds_.push_back(threshold_of(surface.value, units));
    using Cells = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Cells(0, crossed_.size(), 4096), [&](const Cells& cells) {
        for (std::size_t cell = cells.begin(); cell != cells.end(); ++cell) {
            float low = 1.0F, high = 0.0F;
            bool finite = true;
            for (int corner = 0; corner < 4; ++corner) {
                const double s = scene.field->at(*scene.mesh, static_cast<CellId>(cell), corner);
                const auto scalar = static_cast<float>(units.normalized(s));
                const ScalarField* opacity = scene.opacity_field.get();
                finite = finite && std::isfinite(s) &&
                         (!opacity || std::isfinite(opacity->at(*scene.mesh, static_cast<CellId>(cell), corner)));
                low = std::min(low, scalar);
                high = std::max(high, scalar);
            }
            if (!finite) continue;
            const Range range = between(low, high);
            crossed_[cell] = range.first < range.last;
        }
    });
    crossed_count_ = static_cast<std::size_t>(std::count(crossed_.begin(), crossed_.end(), std::uint8_t{1}));
}

SurfaceCells::Range SurfaceCells::between(float low, float high) const {
    const auto rank = [&](float s) {
        return static_cast<std::size_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), s) - thresholds_.begin());
    };
    return {rank(low), rank(high)};
}

std::array<glm::dvec3, 4> SurfaceCells::gradients(CellId cell) const {
    std::array<glm::dvec3, 4> result{};
    for (std::size_t corner = 0; corner < 4 && shading_ != Shading::unlit; ++corner)
        result[corner] = gradients_.values[shading_ == Shading::flat ? cell : mesh_->tets[cell][corner]];
    return result;
}

}  // namespace cellproj
