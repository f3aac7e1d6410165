// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_surface_pass.hpp"

#include <cassert>
#include <vector>

#include "render/gl/surface_lists.hpp"
#include "render/grid_surfaces.hpp"
#include "render/prepared_surfaces.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int surfaces_unit = 11, gradients_unit = 12;  // shaders/grid_slab.frag

}  // namespace

GridSurfacePass::GridSurfacePass(const GridScene& scene, const GridUnits& units) : scene_(scene.surfaces.get()) {
    assert(has_surfaces(scene));
    const std::vector<float> values = kept_isovalues(scene_->isosurfaces, units);
    std::vector<float> thresholds = values;
    // Places whose scalar is the isovalue are on one side, whatever a texture unit makes of it.
    for (float& threshold : thresholds) threshold -= static_cast<float>(float32_margin);
    list_ = surface_list(scene_->isosurfaces, thresholds, values);
    lights_ = light_list(scene_->lighting);
    count_ = static_cast<float>(values.size());
}

std::string GridSurfacePass::defines() const {
    return std::string("#define SURFACES\n") + (scene_->shading != Shading::unlit ? "#define LIT\n" : "") + (smooth() ? "#define SMOOTH\n" : "");
}

void GridSurfacePass::bind(const Program& program, const Texture& gradients) const {
    list_.bind(surfaces_unit);
    program.set("surface_count", count_);
    if (scene_->shading == Shading::unlit) return;
    lights_.bind(lights_unit);
    set_lighting(program, scene_->lighting);
    if (smooth()) gradients.bind(gradients_unit);
}

}  // namespace cellproj::gl
