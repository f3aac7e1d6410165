// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_surface_pass.hpp"

#include <cassert>
#include <vector>

#include "render/gl/shaders.hpp"
#include "render/gl/surface_lists.hpp"
#include "render/grid_surfaces.hpp"
#include "render/prepared_surfaces.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int surfaces_unit = 11, gradients_unit = 12;  // shaders/grid_surfaces.glsl, shaders/grid_light.glsl

}  // namespace

GridSurfacePass::GridSurfacePass(const GridScene& scene, const GridUnits& units) : scene_(scene.surfaces.get()) {
    assert(has_surfaces(scene) || has_lit_medium(scene));
    const std::vector<float> values = kept_isovalues(scene_->isosurfaces, units);
    thresholds_ = values;
    // Places whose scalar is the isovalue are on one side, whatever rounding makes of it.
    for (float& threshold : thresholds_) threshold -= static_cast<float>(float32_margin);
    list_ = surface_list(scene_->isosurfaces, thresholds_, values);
    lights_ = light_list(scene_->lighting);
}

std::string GridLight::defines() const {
    std::string defines = shader ? "#define MEDIUM\n" : "";
    if (isosurfaces()) defines += "#define SURFACES\n";
    if (lit()) defines += "#define LIT\n" + lighting_defines(surfaces->scene_->lighting) + (surfaces->smooth() ? "#define SMOOTH\n" : "");
    if (lit_medium) defines += "#define LIT_MEDIUM\n";
    return defines;
}

const std::string& GridLight::vertex_source() const { return shader ? shader->vertex_source() : shaders::no_cell_glsl; }

std::string GridLight::fragment_source(const std::string& own) const {
    return shaders::grid_light_glsl + (isosurfaces() ? shaders::grid_surfaces_glsl : "") + own + (lit() ? shaders::reflected_glsl : "") +
           (lit_medium ? shaders::lit_medium_glsl : "") + (shader ? shaders::light_glsl + shader->source() : "");
}

void GridLight::bind(const Program& program) const {
    if (shader) shader->bind(program);
    if (isosurfaces()) {
        surfaces->list_.bind(surfaces_unit);
        program.set("surface_count", static_cast<float>(surfaces->thresholds_.size()));
    }
    if (lit_medium) program.set("per_weak_gradient", static_cast<float>(1.0 / weak_gradient));
    if (!lit()) return;
    surfaces->lights_.bind(lights_unit);
    set_lighting(program, surfaces->scene_->lighting);
    if (surfaces->smooth()) gradients->bind(gradients_unit);
}

}  // namespace cellproj::gl
