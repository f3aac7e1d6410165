// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/surface_pass.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh/error.hpp"
#include "render/gl/surface_lists.hpp"

namespace cellproj::gl {

namespace {

// Behind those of the methods (segment_shader.hpp).
constexpr unsigned int surfaces_unit = 8, layers_unit = 11, first_unit = 12;

}  // namespace

void SurfacePass::require_drawn(const Scene& scene, const Quality& quality) {
    if (!has_surface_scene(scene)) return;
    if (!takes_surfaces(quality.method))
        throw Error({ErrorKind::option, "--method", "one of light per pixel, blended once, for a scene with isosurfaces or a lit medium",
                     to_string(quality.method), "use integral, exact or a table"});
}

SurfaceSides SurfacePass::sides_for(const SurfaceMethod& method) {
    return {.margin = float32_margin, .table_size = method.kind == SurfaceMethodKind::exact ? 0 : method.size};
}

SurfacePass::SurfacePass(const PreparedScene& prepared, const SurfaceMethod& method)
    : prepared_(prepared), method_(method), list_(surface_list(scene().isosurfaces, prepared.surfaces()->thresholds(), prepared.surfaces()->values())),
      lights_(light_list(scene().lighting)) {
    assert(prepared.surfaces()->sides() == sides_for(method));
    if (method.kind != SurfaceMethodKind::exact) upload_tables();
}

void SurfacePass::upload_tables() {
    const SceneUnits& units = prepared_.units();
    // A field of one value crosses nothing: any range will do.
    const double high = units.scalar_high > units.scalar_low ? units.scalar_high : units.scalar_low + 1.0 + std::abs(units.scalar_low);
    const IsoSurfaceTable table(scene().isosurfaces, units.scalar_low, high, method_.size);
    std::vector<float> layers, first;
    const auto grid = static_cast<std::size_t>(method_.size);
    layers.reserve(4 * grid * grid);
    first.reserve(4 * grid * grid);
    for (std::size_t i = 0; i < table.texels().size(); ++i) {
        const IsoSurfaceTable::Texel& texel = table.texels()[i];
        const double front = static_cast<double>(i % grid), back = static_cast<double>(i / grid);
        layers.insert(layers.end(), {texel.color[0], texel.color[1], texel.color[2], texel.opacity});
        // Its isovalue rather than its share of the way from texel to texel: the way between the scalars at hand is another.
        first.insert(first.end(), {static_cast<float>((front + texel.t * (back - front)) / table.intervals()), 0.0F, 0.0F, 0.0F});
    }
    layers_ = Texture::table_2d(method_.size, TableStorage::float32, layers);
    first_ = Texture::table_2d(method_.size, TableStorage::float32, first);
}

std::string SurfacePass::defines(bool perspective, bool nearest) const {
    const bool medium = prepared_.has_medium(), two_fields = fields_read(prepared_.scene()) == FieldsRead::two;
    const Shading shading = scene().shading;
    return std::string(perspective ? "#define PERSPECTIVE\n" : "") + (medium ? "#define MEDIUM\n" : "") +
           (medium && two_fields ? "#define TWO_FIELDS\n" : "") + (shading != Shading::unlit ? "#define LIT\n" : "") +
           lighting_defines(scene().lighting) + (prepared_.lights_medium() ? "#define LIT_MEDIUM\n" : "") +
           (shading == Shading::smooth ? "#define SMOOTH\n" : "") + (nearest ? "#define NEAREST\n" : "") +
           (method_.kind != SurfaceMethodKind::exact ? "#define TABLE\n" : "") +
           (method_.kind == SurfaceMethodKind::combined ? "#define COMBINED\n" : "");
}

// Sets what the variant reads, no more: a uniform that is not read is none.
void SurfacePass::bind(const Program& program, const CellStream& cells, const NearnessFrame& frame, Variant variant) const {
    const ScreenTransform& transform = cells.transform();
    const bool perspective = transform.perspective();
    const bool lit = scene().shading != Shading::unlit, medium = prepared_.has_medium();
    const auto [nearest, windowed] = variant;
    const auto set = [&](const char* name, double value) { program.set(name, static_cast<float>(value)); };
    if (perspective) set("inverse_far", frame.far);
    if (perspective && (medium || windowed)) set("inverse_near", 1.0 / cells.near_depth());
    if (nearest) set("inverse_nearest", 1.0 / frame.nearest);
    // Of translucent surfaces alone, not cut, unlit or lit by one normal for all of a cell, no place is asked for but that of the eye.
    const bool combined = method_.kind == SurfaceMethodKind::combined;
    if (medium || windowed || nearest || combined || scene().shading == Shading::smooth || (perspective && lit)) {
        const glm::dvec2 center = transform.principal_point();
        program.set("principal_point", static_cast<float>(center.x), static_cast<float>(center.y));
        set("pixels_per_unit", transform.pixels_per_unit());
    }
    if (method_.kind == SurfaceMethodKind::exact) {
        list_.bind(surfaces_unit);
    } else {
        const SurfaceSides& sides = prepared_.surfaces()->sides();
        set("table_scale", sides.texel_scale());
        set("table_shift", sides.texel_shift());
        layers_.bind(layers_unit);
        first_.bind(first_unit);
    }
    if (!lit) return;

    set_lighting(program, scene().lighting);
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
