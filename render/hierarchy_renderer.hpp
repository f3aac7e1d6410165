// SPDX-License-Identifier: BSD-3-Clause
//
// Hierarchy of grids and camera to picture (mesh/grid_hierarchy.hpp), as grid_renderer.hpp for one grid: rays walk the cells of the finest
// piece that covers each place. By the native backend only.
#pragma once

#include <memory>

#include "classify/method.hpp"
#include "classify/transfer_function.hpp"
#include "mesh/grid_hierarchy.hpp"
#include "project/camera.hpp"
#include "render/grid_scene.hpp"
#include "render/image.hpp"
#include "render/statistics.hpp"

namespace cellproj {

// Neither may be null. Do not change them while a renderer may use them.
struct HierarchyScene {
    std::shared_ptr<const GridHierarchy> hierarchy;
    std::shared_ptr<const TransferFunction> transfer;
};

// What a renderer counts in: of all pieces as one.
GridUnits units_of(const GridHierarchy& hierarchy);

// A renderer keeps what does not depend on the view for the scene it drew last. Not thread-safe: one thread at a time.
class HierarchyRenderer {
public:
    virtual ~HierarchyRenderer() = default;

    // Does now what the first picture of a scene would do besides drawing. Throws Error (option) for a method of light at vertices, Error
    // (data) for more values than 32 bits count.
    virtual void prepare(const HierarchyScene& scene, const Method& method = {}) = 0;

    // The associated picture, over nothing. Throws as `prepare`, and Error (option) for an unusable camera or size.
    virtual Image render(const HierarchyScene& scene, const Camera& camera, ImageSize size, const Method& method = {},
                         Statistics* statistics = nullptr) = 0;
};

// `threads` ≥ 0; 0: all that the process may use.
std::unique_ptr<HierarchyRenderer> make_hierarchy_renderer(int threads = 0);

}  // namespace cellproj
