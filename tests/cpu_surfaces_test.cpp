// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces of the CPU backend against the judge (render/reference) and closed forms: planes, spheres, layers, mixed scenes, and
// isovalues that points, faces and whole cells have.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/cpu/kernels.hpp"
#include "render/prepared_scene.hpp"
#include "render/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace {

using testing_support::constant_medium;
using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::point_field;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;
using scenes::waves;

using Projection = Camera::Projection;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{40, 40} : ImageSize{96, 96};

Renderer& cpu() {
    static const auto shared = make_renderer(Backend::cpu);
    return *shared;
}

TransferFunction nothing() { return constant_medium(0); }

Scene with(Scene scene, std::vector<IsoSurface> list, Shading shading = Shading::smooth, const Lighting& lighting = {}) {
    scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), shading, lighting});
    return scene;
}

// Points are rounded to float32, which moves silhouettes, and edges of surfaces at the mesh's sides, by some 1e-5 of a pixel.
constexpr double slack = 1.0 / 512;

struct Judged {
    double largest = 0, rms = 0;
    std::size_t beyond = 0;  // pixels with an error above 2e-3, the bar of the issue
};

Judged judge(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality = {}, Statistics* statistics = nullptr) {
    const Image image = cpu().render(scene, camera, size, quality, statistics);
    const auto truths = Reference(scene).picture(camera, size, slack);
    Judged judged;
    for (const PixelTruth& truth : truths) {
        const glm::dvec4 error = error_of_pixel(image, truth);
        const double worst = std::max({error.x, error.y, error.z, error.w});
        judged.beyond += worst > 2e-3;
        judged.largest = std::max(judged.largest, worst);
    }
    const ImageError error = compare(image, truths);
    judged.rms = error.color.rms;
    return judged;
}

const std::vector<IsoSurface> three{{0.3, {0.2, 0.9, 0.4}, 0.5, {}}, {0.5, {1, 0, 0}, 0.25, glm::dvec3(0, 0, 1)}, {0.7, {0.5, 0.5, 0.5}, 0.8, {}}};

std::vector<IsoSurface> opaque(std::vector<IsoSurface> list) {
    for (IsoSurface& surface : list) surface.opacity = 1;
    return list;
}

TEST(CpuSurfaces, Explore) {
    for (const Projection projection : {Projection::parallel, Projection::perspective})
        for (const Shading shading : {Shading::unlit, Shading::flat, Shading::smooth})
            for (const bool is_opaque : {true, false})
                for (const bool medium : {false, true})
                    for (const bool by_pixel : {false, true}) {
                        Scene scene = scene_of(grid_mesh(sanitized ? 5 : 9, 0.2, 2), waves, medium ? ramp() : nothing());
                        scene = with(scene, is_opaque ? opaque(three) : three, shading, {.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}});
                        Statistics s;
                        const Judged j = judge(scene, view_of_unit_cube(projection), small, {.order_per_pixel = by_pixel}, &s);
                        std::printf("%d shading %d opaque %d medium %d pixel %d: largest %.1e rms %.1e beyond %zu order %s drawn %zu\n", int(projection), int(shading), is_opaque, medium, by_pixel,
                                    j.largest, j.rms, j.beyond, s.order.c_str(), s.counts.drawn);
                    }
}

}  // namespace
}  // namespace cellproj
