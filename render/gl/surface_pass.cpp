// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/surface_pass.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mesh/error.hpp"

namespace cellproj::gl {

namespace {

// Behind those of the methods (segment_shader.hpp).
constexpr unsigned int surfaces_unit = 8, lights_unit = 9;

void append(std::vector<float>& texels, const glm::dvec3& v, double last) {
    for (int axis = 0; axis < 3; ++axis) texels.push_back(static_cast<float>(v[axis]));
    texels.push_back(static_cast<float>(last));
}

Texture upload(const IsoSurfaces& surfaces, const std::vector<float>& thresholds, const SceneUnits& units) {
    std::vector<float> texels;
    for (std::size_t i = 0; i < thresholds.size(); ++i) {
        const IsoSurface& surface = surfaces.surfaces()[i];
        const double value = units.normalized(std::clamp(surface.value, units.scalar_low, units.scalar_high));
        append(texels, {thresholds[i], value, surface.opacity}, 0.0);
        append(texels, seen_color(surface, true), 0.0);
        append(texels, seen_color(surface, false), 0.0);
    }
    return Texture::list(texels);
}

// Directions of any finite length > 0.
glm::dvec3 unit(const glm::dvec3& v) {
    const glm::dvec3 size = glm::abs(v);
    return glm::normalize(v / std::max({size.x, size.y, size.z}));
}

Texture upload(const std::vector<DirectionalLight>& lights) {
    std::vector<float> texels;
    for (const DirectionalLight& light : lights) {
        append(texels, light.towards ? unit(*light.towards) : glm::dvec3(0.0), light.diffuse);
        append(texels, light.color, light.specular);
    }
    if (texels.empty()) texels.resize(4);  // a list holds something
    return Texture::list(texels);
}

}  // namespace

bool SurfacePass::is_needed(const Scene& scene) { return scene.surfaces && !scene.surfaces->isosurfaces.surfaces().empty(); }

void SurfacePass::require_drawn(const Scene& scene, const Quality& quality) {
    if (!is_needed(scene)) return;
    if (light_at_vertices(quality.method) || quality.method.blending != Blending::once)
        throw Error({ErrorKind::option, "--method", "one of light per pixel, blended once, for a scene with isosurfaces",
                     to_string(quality.method), "use integral, exact or a table"});
}

SurfacePass::SurfacePass(const Scene& scene, const SceneUnits& units)
    : scene_(scene),
      cells_(scene, units),
      opaque_(scene.surfaces->isosurfaces.opaque()),
      two_fields_(scene.opacity_field != nullptr),
      shading_(scene.surfaces->shading),
      list_(upload(scene.surfaces->isosurfaces, cells_.thresholds(), units)),
      lights_(upload(scene.surfaces->lighting.lights)) {}

bool SurfacePass::is_of(const Scene& scene) const {
    return scene_.surfaces == scene.surfaces && scene_.mesh == scene.mesh && scene_.field == scene.field &&
           scene_.opacity_field == scene.opacity_field;
}

void SurfacePass::set_visible(std::shared_ptr<const TransferFunction> transfer, std::span<const std::uint8_t> visible) {
    if (!drawn_.empty() && scene_.transfer == transfer) return;
    scene_.transfer = std::move(transfer);
    const std::vector<std::uint8_t>& crossed = cells_.crossed();
    has_medium_ = std::ranges::find(visible, std::uint8_t{1}) != visible.end();
    drawn_ = crossed;
    if (has_medium_) {
        for (std::size_t cell = 0; cell < drawn_.size(); ++cell) drawn_[cell] |= visible[cell];
    }
    drawn_items_.clear();
    for (std::size_t cell = 0; cell < drawn_.size() && !needs_order(); ++cell) {
        if (drawn_[cell]) drawn_items_.push_back(static_cast<CellId>(cell));
    }
}

std::string SurfacePass::defines(bool perspective) const {
    return std::string(perspective ? "#define PERSPECTIVE\n" : "") + (has_medium_ ? "#define MEDIUM\n" : "") +
           (has_medium_ && two_fields_ ? "#define TWO_FIELDS\n" : "") +
           (shading_ != Shading::unlit ? "#define LIT\n" : "") +
           (shading_ == Shading::smooth ? "#define SMOOTH\n" : "") + (needs_order() ? "" : "#define NEAREST\n");
}

// Sets what the variant reads, no more: a uniform that is not read is none.
void SurfacePass::bind(const Program& program, const CellStream& cells, const NearnessFrame& frame, bool windowed) const {
    const ScreenTransform& transform = cells.transform();
    const bool perspective = transform.perspective();
    const bool lit = shading_ != Shading::unlit;
    const auto set = [&](const char* name, double value) { program.set(name, static_cast<float>(value)); };
    if (perspective) set("inverse_far", frame.far);
    if (perspective && (has_medium_ || windowed)) set("inverse_near", 1.0 / cells.near_depth());
    if (!needs_order()) set("inverse_nearest", 1.0 / frame.nearest);
    // Of translucent surfaces alone, not cut, unlit or lit by one normal for all of a cell, no place is asked for but that of the eye.
    if (has_medium_ || windowed || !needs_order() || shading_ == Shading::smooth || (perspective && lit)) {
        const glm::dvec2 center = transform.principal_point();
        program.set("principal_point", static_cast<float>(center.x), static_cast<float>(center.y));
        set("pixels_per_unit", transform.pixels_per_unit());
    }
    list_.bind(surfaces_unit);
    if (!lit) return;

    const Lighting& lighting = scene_.surfaces->lighting;
    set("two_sided", lighting.two_sided ? 1.0 : 0.0);
    set("light_count", static_cast<double>(lighting.lights.size()));
    program.set("ambient", glm::vec4(lighting.ambient, lighting.exponent));
    // The rows of the rotation, seen through what it makes of the axes.
    const glm::dvec3 x = transform.to_eye({1, 0, 0}), y = transform.to_eye({0, 1, 0}), z = transform.to_eye({0, 0, 1});
    if (perspective) {
        program.set("axis_right", glm::vec4(x.x, y.x, z.x, 0.0));
        program.set("axis_down", glm::vec4(x.y, y.y, z.y, 0.0));
    }
    program.set("axis_forward", glm::vec4(x.z, y.z, z.z, 0.0));
    lights_.bind(lights_unit);
}

}  // namespace cellproj::gl
