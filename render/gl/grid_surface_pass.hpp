// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in the cells and slabs of a grid (shaders/grid_surfaces.glsl), and the light on them and on the medium
// (shaders/grid_light.glsl): what the scene's surfaces, lights and gradients are to the fragments.
#pragma once

#include <string>
#include <vector>

#include "render/gl/grid_volume.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/segment_shader.hpp"
#include "render/gl/textures.hpp"
#include "render/grid_scene.hpp"

namespace cellproj::gl {

class GridSurfacePass {
public:
    // Of a scene that has_surfaces or has_lit_medium, as they are now; it must outlive this.
    GridSurfacePass(const GridScene& scene, const GridUnits& units);

    // Against scalars as fragments have them, ascending.
    const std::vector<float>& thresholds() const { return thresholds_; }
    bool isosurfaces() const { return !thresholds_.empty(); }
    bool smooth() const { return scene_->shading == Shading::smooth; }

private:
    const SurfaceScene* scene_;
    std::vector<float> thresholds_;
    Texture list_, lights_;

    friend class GridLight;
};

// What the fragments of a grid show.
class GridLight {
public:
    const SegmentShader* shader = nullptr;      // null: no medium, or one of another kind
    const GridSurfacePass* surfaces = nullptr;  // null: none, and nothing is lit
    const Texture* gradients = nullptr;         // of GridVolume, for what is smooth
    bool lit_medium = false;                    // by `surfaces`

    std::string defines() const;
    const std::string& vertex_source() const;
    // Behind shaders/grid_rays.frag: `own`, which draws, with what it needs before and behind it.
    std::string fragment_source(const std::string& own) const;
    void bind(const Program& program) const;

private:
    bool isosurfaces() const { return surfaces && surfaces->isosurfaces(); }
    bool lit() const { return surfaces && surfaces->scene_->shading != Shading::unlit && (isosurfaces() || lit_medium); }
};

}  // namespace cellproj::gl
