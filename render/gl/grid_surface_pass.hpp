// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in the slabs of a grid (shaders/grid_slab.frag): what the scene's surfaces, lights and gradients are to the fragments.
#pragma once

#include <string>

#include "render/gl/grid_volume.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/grid_scene.hpp"

namespace cellproj::gl {

class GridSurfacePass {
public:
    // Of a scene that has_surfaces, as they are now; it must outlive this.
    GridSurfacePass(const GridScene& scene, const GridUnits& units);

    std::string defines() const;
    // `gradients`: of GridVolume, read where shading is smooth.
    void bind(const Program& program, const Texture& gradients) const;

    bool smooth() const { return scene_->shading == Shading::smooth; }

private:
    const SurfaceScene* scene_;
    Texture list_, lights_;
    float count_;
};

}  // namespace cellproj::gl
