// SPDX-License-Identifier: BSD-3-Clause
//
// The isosurfaces of a scene, and the light on them and the medium, as tiles see them: plain arrays, beside those of ScreenCells (kernels.hpp).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "render/prepared_surfaces.hpp"
#include "render/surface_scene.hpp"

namespace cellproj::cpu {

using SurfaceShading = cellproj::Shading;  // cpu::Shading is that of segments

// The material of a surface; its front side is that of the lower scalars.
struct SurfaceMaterial {
    glm::vec3 front, back;  // colours, not associated
    float opacity;
};

// The surfaces in the order in which a ray meets them, with the side that it sees. Behind the last one stand as many that are nothing as a vector
// has lanes.
struct SurfaceRun {
    static constexpr std::size_t padding = 16;

    std::vector<float> value;                  // normalized (PreparedSurfaces)
    std::vector<float> red, green, blue;       // associated
    std::vector<float> opacity;
};

// classify/lighting.hpp in float32.
struct SurfaceLighting {
    struct Light {
        bool headlight;
        glm::vec3 towards;            // of unit length, unless a headlight
        glm::vec3 diffuse, specular;  // with the light's colour
    };
    glm::vec3 ambient;
    float exponent;
    bool two_sided;
    std::vector<Light> lights;
};

std::vector<SurfaceMaterial> materials_of(const IsoSurfaces& surfaces);  // one for each, in their order
SurfaceRun run_of(const PreparedSurfaces& surfaces, bool rising);
SurfaceLighting kernel_lighting(const Lighting& lighting);

struct ScreenSurfaces {
    std::span<const float> values;              // ascending isovalues, normalized (PreparedSurfaces)
    SurfaceRun rising, falling;                 // along a ray on which the scalar rises, and falls
    SurfaceShading shading = SurfaceShading::unlit;
    SurfaceLighting lighting;
    bool medium = true;                         // whether there is light between them
    bool lit_medium = false;                    // which is lit
    std::span<const std::int32_t> levels;       // #T + #extra, as of PreparedSurfaces; parts of crossed cells are crossed
    // Places of crossed cells in float64: x and y as of ScreenCells::points, and the whole nearness, 1/depth in perspective.
    std::span<const glm::dvec3> points;
    std::span<const glm::vec3> gradients;       // flat: #T + #extra; smooth: like `points`; axes of the mesh
    glm::vec3 right, down, forward;             // of the camera, of unit length, in the axes of the mesh

    // Where the surface of that number stands in its run.
    std::size_t place(std::int32_t surface, bool rises) const {
        const auto number = static_cast<std::size_t>(surface);
        return rises ? number : values.size() - 1 - number;
    }
    bool is_opaque(std::int32_t surface) const { return rising.opacity[static_cast<std::size_t>(surface)] >= 1.0F; }
};

// Where the last fragment of a pixel ended, so that none of its surfaces is lost or doubled at the face to the next one.
struct PixelTrail {
    static constexpr std::int32_t none = -1, closed = -2;

    std::int32_t level = none;  // of its scalar; closed: behind an opaque surface
    float nearness = 0;
    std::uint32_t item = 0;
};

}  // namespace cellproj::cpu
