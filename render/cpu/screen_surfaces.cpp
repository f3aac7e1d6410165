// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/screen_surfaces.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace cellproj::cpu {

std::vector<SurfaceMaterial> materials_of(const IsoSurfaces& surfaces) {
    std::vector<SurfaceMaterial> materials;
    for (const IsoSurface& surface : surfaces.surfaces())
        materials.push_back({surface.color, surface.back_color.value_or(surface.color), static_cast<float>(surface.opacity)});
    return materials;
}

SurfaceRun run_of(const PreparedSurfaces& surfaces, bool rising) {
    SurfaceRun run;
    const auto append = [&](float value, const glm::dvec3& color, double opacity) {
        run.value.push_back(value);
        run.red.push_back(static_cast<float>(opacity * color.r));
        run.green.push_back(static_cast<float>(opacity * color.g));
        run.blue.push_back(static_cast<float>(opacity * color.b));
        run.opacity.push_back(static_cast<float>(opacity));
    };
    const std::size_t count = surfaces.values().size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t surface = rising ? i : count - 1 - i;
        const IsoSurface& material = surfaces.scene().isosurfaces.surfaces()[surface];
        append(surfaces.values()[surface], seen_color(material, rising), material.opacity);
    }
    for (std::size_t i = 0; i < SurfaceRun::padding; ++i) append(0.0F, glm::dvec3(0), 0.0);
    return run;
}

SurfaceLighting kernel_lighting(const Lighting& lighting) {
    SurfaceLighting result{lighting.ambient, static_cast<float>(lighting.exponent), lighting.two_sided, {}};
    for (const DirectionalLight& light : lighting.lights) {
        const glm::dvec3 towards = light.towards.value_or(glm::dvec3(1));
        const double largest = std::max({std::abs(towards.x), std::abs(towards.y), std::abs(towards.z)});  // > 0
        result.lights.push_back({!light.towards, glm::normalize(towards / largest), light.color * light.diffuse, light.color * light.specular});
    }
    return result;
}

}  // namespace cellproj::cpu
