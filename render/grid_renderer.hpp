// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grid and camera to picture: what renderer.hpp is for meshes. Cells are drawn as they are, with the trilinear
// scalar of their corners, and need no sorting.
#pragma once

#include <memory>

#include "classify/method.hpp"
#include "project/camera.hpp"
#include "render/grid_sampling.hpp"
#include "render/grid_scene.hpp"
#include "render/image.hpp"
#include "render/renderer.hpp"
#include "render/statistics.hpp"
#include "render/target_format.hpp"

namespace cellproj {

// The speed–accuracy choices of one picture.
struct GridQuality {
    Method method = {};                           // how a segment becomes light
    TargetFormat target = TargetFormat::rgba32f;  // what cells are blended in
    GridSampling sampling = {};                   // what cuts rays into segments; slabs are OpenGL's
};

// A renderer keeps what does not depend on the view for the scene it drew last. Not thread-safe: one thread at a time.
class GridRenderer {
public:
    virtual ~GridRenderer() = default;

    // Does now what the first picture of a scene would do besides drawing. Throws as `validate` and
    // `require_grid_drawn`.
    virtual void prepare(const GridScene& scene, const GridQuality& quality = {}) = 0;

    // The associated picture, over nothing. Throws as `prepare`, Error (option) for an unusable camera or size, Error
    // (environment) when the driver fails.
    virtual Image render(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {},
                         Statistics* statistics = nullptr) = 0;
};

// Throws Error (option), which says what to do instead, when a backend does not draw grids so; renderers do it, too.
void require_grid_drawn(Backend backend, const GridQuality& quality, const GridShading& shading);

// Likewise for grids whose rays are cut: only the light of a piece of a ray through a cell can be, not that of slabs or at vertices.
void require_grid_cut(const GridQuality& quality, const RayCuts& cuts);

// Throws Error (environment) when the backend is not available here.
std::unique_ptr<GridRenderer> make_grid_renderer(Backend backend, const RendererOptions& options = {});

}  // namespace cellproj
