// SPDX-License-Identifier: BSD-3-Clause
//
// The judge of hierarchies of grids: as grid_reference.hpp, over the visible cells of all pieces, put in the order in which the ray meets
// them. It knows nothing of the boxes that renderers make of the pieces.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/judge/grid_reference.hpp"
#include "render/hierarchy_renderer.hpp"

namespace cellproj {

// Immutable: any number of threads may ask at once.
class HierarchyReference {
public:
    explicit HierarchyReference(HierarchyScene scene);

    Light light(const ScreenTransform::Ray& ray, bool from_origin) const;

    // As those of GridReference.
    std::vector<PixelTruth> pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels, double slack = 0) const;
    std::vector<PixelId> sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed = 1) const;

private:
    struct Crossing {
        std::size_t piece;
        GridCrossing cell;
    };
    std::vector<Crossing> cells_along(const ScreenTransform::Ray& ray, bool from_origin) const;

    HierarchyScene scene_;
};

}  // namespace cellproj
