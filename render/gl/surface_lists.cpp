// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/surface_lists.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace cellproj::gl {

namespace {

void append(std::vector<float>& texels, const glm::dvec3& v, double last) {
    for (int axis = 0; axis < 3; ++axis) texels.push_back(static_cast<float>(v[axis]));
    texels.push_back(static_cast<float>(last));
}

// Directions of any finite length > 0.
glm::dvec3 unit(const glm::dvec3& v) {
    const glm::dvec3 size = glm::abs(v);
    return glm::normalize(v / std::max({size.x, size.y, size.z}));
}

// As most scenes have.
bool has_one_headlight(const Lighting& lighting) { return lighting.lights.size() == 1 && !lighting.lights.front().towards; }

}  // namespace

Texture surface_list(const IsoSurfaces& surfaces, std::span<const float> thresholds, std::span<const float> values) {
    std::vector<float> texels;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const IsoSurface& surface = surfaces.surfaces()[i];
        append(texels, {thresholds[i], values[i], surface.opacity}, 0.0);
        append(texels, surface.opacity * seen_color(surface, true), surface.opacity);
        append(texels, surface.opacity * seen_color(surface, false), surface.opacity);
    }
    if (texels.empty()) texels.resize(12);  // a medium that is lit, alone: read by what is not drawn
    return Texture::list(texels);
}

std::string lighting_defines(const Lighting& lighting) { return has_one_headlight(lighting) ? "#define HEADLIGHT\n" : ""; }

Texture light_list(const Lighting& lighting) {
    std::vector<float> texels;
    for (const DirectionalLight& light : lighting.lights) {
        append(texels, light.towards ? unit(*light.towards) : glm::dvec3(0.0), light.diffuse);
        append(texels, light.color, light.specular);
    }
    if (texels.empty()) texels.resize(4);  // a list holds something
    return Texture::list(texels);
}

void set_lighting(const Program& program, const Lighting& lighting) {
    program.set("two_sided", lighting.two_sided ? 1.0F : 0.0F);
    if (has_one_headlight(lighting)) {
        const DirectionalLight& light = lighting.lights.front();
        program.set("headlight_diffuse", glm::vec4(light.diffuse * light.color, 0.0));
        program.set("headlight_specular", glm::vec4(light.specular * light.color, 0.0));
    } else {
        program.set("light_count", static_cast<float>(lighting.lights.size()));
    }
    program.set("ambient", glm::vec4(lighting.ambient, lighting.exponent));
}

}  // namespace cellproj::gl
