// SPDX-License-Identifier: BSD-3-Clause
//
// Media that are lit by their gradient (SurfaceScene::lit_medium): against closed forms, and both backends against the judge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <glm/common.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/plan.hpp"
#include "render/prepared_scene.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace medium_light_test {

using namespace testing_support;
using scenes::waves;

using Projection = Camera::Projection;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{24, 24} : ImageSize{64, 64};
constexpr double slack = rasterizer_slack;

const std::vector<Backend> backends{Backend::cpu, Backend::gl_osmesa};

Renderer& renderer(Backend backend) {
    static const auto cpu = make_renderer(Backend::cpu), gl = make_renderer(Backend::gl_osmesa);
    return backend == Backend::cpu ? *cpu : *gl;
}

const Lighting two_lights{.ambient = {0.1, 0.2, 0.05},
                          .lights = {{.towards = glm::dvec3(1, -2, 2), .color = {1, 0.8, 0.6}}, {.diffuse = 0.3, .specular = 0.5}}};

Scene lit(Scene scene, Shading shading, const Lighting& lighting = two_lights, std::vector<IsoSurface> list = {}) {
    scene.surfaces = std::make_shared<SurfaceScene>(
        SurfaceScene{.isosurfaces = IsoSurfaces(std::move(list)), .shading = shading, .lighting = lighting, .lit_medium = true});
    return scene;
}

double error_of(Backend backend, const Scene& scene, const Camera& camera, const std::vector<PixelTruth>& truths, const Quality& quality = {}) {
    return largest(compare(renderer(backend).render(scene, camera, small, quality), truths));
}

// ---- The judge

Light lit_segment(const TransferFunction& transfer, const ScalarEnds& scalars, double length, const ShareEnds& shares) {
    RayLight light(transfer);
    light.add(std::vector{scalars}, {}, length, std::vector{shares});
    return light.light();
}

// Of a homogeneous medium, light comes from 1/D − 1/(e^D − 1) of the way in the mean.
TEST(MediumLight, OfAHomogeneousSegmentIsAClosedForm) {
    const ShareEnds shares{{0.2, 1, 0.5}, {1.5, 0, 0.5}};
    for (const double depth : {1e-3, 0.1, 1.0, 5.0, 60.0}) {
        const Light found = lit_segment(constant_medium(depth), {0.3, 0.3}, 1, shares);
        const double opacity = -std::expm1(-depth), place = depth < 0.01 ? 0.5 - depth / 12 : 1 / depth - 1 / std::expm1(depth);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(found.color[k], opacity * glm::dvec3(1, 0.5, 0.25)[k] * glm::mix(shares.front, shares.back, place)[k], 1e-12) << depth;
        EXPECT_DOUBLE_EQ(found.opacity, opacity);
    }
}

// Any function, cut anywhere: the same light; and a plain sum over 2²⁰ midpoints.
TEST(MediumLight, OfPiecesIsThatOfTheWholeAndARiemannSum) {
    const TransferFunction transfer(OpticalModel::density, {{0.1, {1, 0, 0.3}}, {0.4, {0, 1, 0.2}}, {0.9, {0.5, 0.5, 1}}},
                                    {{0.0, 0.1}, {0.3, 5.0}, {0.35, 0.0}, {0.5, 0.0}, {0.8, 3.0}});
    const ScalarEnds ends{0.05, 0.95};
    const ShareEnds shares{{0.2, 1, 0.5}, {1.5, 0, 0.7}};
    const double length = 1.3;
    const Light whole = lit_segment(transfer, ends, length, shares);
    RayLight pieces(transfer);
    const std::vector<double> cuts{0, 0.2, 0.21, 0.7, 1};
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        pieces.add(std::vector{ScalarEnds{std::lerp(ends.front, ends.back, cuts[i]), std::lerp(ends.front, ends.back, cuts[i + 1])}}, {},
                   length * (cuts[i + 1] - cuts[i]),
                   std::vector{ShareEnds{glm::mix(shares.front, shares.back, cuts[i]), glm::mix(shares.front, shares.back, cuts[i + 1])}});
    EXPECT_LT(distance(pieces.light(), whole), 1e-12);
    constexpr int n = 1 << 20;
    Light sum{};
    double depth = 0;
    for (int i = 0; i < n; ++i) {
        const double t = (i + 0.5) / n, s = std::lerp(ends.front, ends.back, t), tau = transfer.extinction(s);
        sum.color += glm::mix(shares.front, shares.back, t) * transfer.emission(s) * std::exp(-depth - 0.5 * tau * length / n) * (length / n);
        depth += tau * length / n;
    }
    sum.opacity = -std::expm1(-depth);
    EXPECT_LT(distance(whole, sum), 1e-10);  // h² from each kink
}

// ---- Pictures

class MediumLightOfEither : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(MediumLight, MediumLightOfEither, either_projection, name_of_projection);

// One gradient everywhere: the unlit picture, times what the lights make of it in each pixel's direction.
TEST_P(MediumLightOfEither, OfALinearFieldIsTheUnlitPictureTimesAShare) {
    const glm::dvec3 slope(1, 0.5, 0.25);
    const Camera camera = view_of_unit_cube(GetParam());
    const ScreenTransform transform(camera, small);
    const Scene scene = scene_of(grid_mesh(4, 0.2, 2), linear, ramp());
    for (const Backend backend : backends)
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            // A copy of the scene without light goes the other way through the renderer.
            const Image unlit = renderer(backend).render(scene, camera, small), found = renderer(backend).render(lit(scene, shading), camera, small);
            double worst = 0, brightest = 0;
            for (const PixelId& pixel : all_pixels(small)) {
                const auto ray = transform.ray({pixel.x + 0.5, pixel.y + 0.5});
                const glm::dvec4 share(lit_share(two_lights, slope / (1.75 * weak_gradient) * (std::sqrt(3.0) / 2), -ray.direction), 1);
                const glm::dvec4 expected = share * glm::dvec4(unlit.at(pixel.x, pixel.y));
                worst = std::max(worst, max_difference(expected, glm::dvec4(found.at(pixel.x, pixel.y))));
                brightest = std::max(brightest, expected.r);
            }
            EXPECT_GT(brightest, 0.1);
            // cpu: float32 over some ten cells. OpenGL: the lit medium's segments are told from other planes than the unlit one's, which differ
            // by the rasterizer's 1/256 of a pixel at the silhouettes of cells.
            EXPECT_LT(worst, backend == Backend::cpu ? 2e-5 : 4e-3) << to_string(backend) << static_cast<int>(shading);
        }
}

// Homogeneous media are exact in the stated model; all that is left is float32 and, in OpenGL, the rasterizer's grid.
TEST_P(MediumLightOfEither, AgreesWithTheJudge) {
    const Camera camera = view_of_unit_cube(GetParam());
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const Scene scene = lit(scene_of(grid_mesh(sanitized ? 5 : 8, 0.2, 2), waves, constant_medium(2)), shading);
        const auto truths = Reference(scene).picture(camera, small, slack);
        EXPECT_LT(error_of(Backend::cpu, scene, camera, truths), 1e-5) << static_cast<int>(shading);
        EXPECT_LT(error_of(Backend::cpu, scene, camera, truths, {.order_per_pixel = true}), 1e-5) << static_cast<int>(shading);
        EXPECT_LT(error_of(Backend::gl_osmesa, scene, camera, truths), 5e-4) << static_cast<int>(shading);
    }
}

// Where colour and extinction change inside a cell, the place of a segment's light is that of a homogeneous one: second order in its size.
TEST_P(MediumLightOfEither, OfARampErrsBySecondOrder) {
    if (sanitized) GTEST_SKIP() << "the finest mesh takes long";
    const Camera camera = view_of_unit_cube(GetParam());
    std::vector<double> rms;
    for (const int n : {4, 8, 16}) {
        const Scene scene = lit(scene_of(grid_mesh(n), waves, ramp()), Shading::smooth);
        const auto truths = Reference(scene).picture(camera, small, slack);
        const ImageError cpu = compare(renderer(Backend::cpu).render(scene, camera, small), truths);
        const ImageError gl = compare(renderer(Backend::gl_osmesa).render(scene, camera, small), truths);
        std::printf("[ MEASURED ] ramp, %d³ boxes: cpu rms %.1e, largest %.1e; gl %.1e, %.1e\n", n, cpu.color.rms, cpu.color.maximum, gl.color.rms, gl.color.maximum);
        rms.push_back(cpu.color.rms);
        EXPECT_LT(cpu.opacity.maximum, 1e-5);
    }
    EXPECT_LT(rms[1], rms[0] / 2.5);
    EXPECT_LT(rms[2], rms[1] / 2.5);
}

// Isosurfaces, clipping and a camera inside cut segments: the shares stay those of the cell.
TEST_P(MediumLightOfEither, GoesOnThroughCuts) {
    const std::vector<IsoSurface> three{{0.3, {0.2, 0.9, 0.4}, 0.5, {}}, {0.5, {1, 0, 0}, 0.25, {}}, {0.7, {0.5, 0.5, 0.5}, 0.8, {}}};
    const Camera camera = view_of_unit_cube(GetParam());
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        Scene scene = lit(scene_of(grid_mesh(sanitized ? 4 : 6, 0.2, 2), waves, constant_medium(2)), shading, two_lights, three);
        auto truths = Reference(scene).picture(camera, small, slack);
        EXPECT_LT(error_of(Backend::cpu, scene, camera, truths), 1e-5) << static_cast<int>(shading);
        // Where a surface grazes a ray, 1/256 of a pixel decides of half a layer: the slack knows.
        EXPECT_LT(error_of(Backend::gl_osmesa, scene, camera, truths), 2e-3) << static_cast<int>(shading);
        scene.clip = std::make_shared<ClipRegion>(ClipRegion{.half_spaces = {{.point = glm::dvec3(0.5), .normal = {1, 0.3, -0.2}}}});
        truths = Reference(scene).picture(camera, small, slack);
        EXPECT_LT(error_of(Backend::cpu, scene, camera, truths), 2e-5) << static_cast<int>(shading);
        EXPECT_LT(error_of(Backend::gl_osmesa, scene, camera, truths), 2e-3) << static_cast<int>(shading);
    }
}

TEST(MediumLight, OfACameraInside) {
    Camera camera = view_of_unit_cube(Projection::perspective);
    camera.eye = {0.31, 0.42, 0.53};
    camera.center = {0.9, 0.8, 0.6};
    camera.fov_y_degrees = 70;
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const Scene scene = lit(scene_of(grid_mesh(5, 0.2, 2), waves, constant_medium(2)), shading);
        const auto truths = Reference(scene).picture(camera, small, slack);
        // A cell is cut at the near plane into parts, each with a share that is linear between its own ends: closer to the gradients in between
        // than what the judge takes for the whole cell. Those of flat shading are the same in all parts.
        for (const Backend backend : backends)
            EXPECT_LT(error_of(backend, scene, camera, truths), shading == Shading::flat ? 1e-3 : 5e-2) << to_string(backend);
    }
}

// Light that nothing absorbs adds up in any order.
TEST_P(MediumLightOfEither, OfAnEmitter) {
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.1, 0.2, 0.4}}}, {{0, 0}});
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene scene = lit(scene_of(grid_mesh(5, 0.2, 2), waves, glow), Shading::smooth);
    const auto truths = Reference(scene).picture(camera, small, slack);
    for (const Backend backend : backends)
        EXPECT_LT(error_of(backend, scene, camera, truths), backend == Backend::cpu ? 1e-5 : 5e-4) << to_string(backend);
}

// Without a gradient there is nothing to be lit by: the medium's own light.
TEST_P(MediumLightOfEither, WithoutAGradientIsUnlit) {
    const Camera camera = view_of_unit_cube(GetParam());
    const auto plateau = [](const glm::dvec3& p) { return std::max(p.x, 0.5); };
    const auto one_value = [](const glm::dvec3&) { return 0.5; };
    for (const Backend backend : backends)
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            const Scene flat_field = scene_of(grid_mesh(4), one_value, constant_medium(2));
            const double difference =
                max_difference(renderer(backend).render(lit(flat_field, shading), camera, small), renderer(backend).render(flat_field, camera, small));
            EXPECT_LT(difference, backend == Backend::cpu ? 2e-6 : 4e-3) << to_string(backend);
            // Half of the cells have one: the judge says the same of them.
            const Scene half = lit(scene_of(grid_mesh(4), plateau, constant_medium(2)), shading);
            const auto truths = Reference(half).picture(camera, small, slack);
            EXPECT_LT(error_of(backend, half, camera, truths), backend == Backend::cpu ? 1e-5 : 1e-3) << to_string(backend);
        }
}

// The side of higher scalars is lit like that of lower ones, or by ambient light alone.
TEST_P(MediumLightOfEither, HasTwoSidesOrOne) {
    const Camera camera = view_of_unit_cube(GetParam());
    const auto reversed = [](const glm::dvec3& p) { return 1 - linear(p); };
    Lighting lighting;  // a headlight
    lighting.ambient = glm::dvec3(0.1, 0.2, 0.3);
    for (const Backend backend : backends) {
        const auto picture = [&](const auto& field) {
            return renderer(backend).render(lit(scene_of(grid_mesh(4), field, constant_medium(2)), Shading::flat, lighting), camera, small);
        };
        lighting.two_sided = true;
        const double either = max_difference(picture(linear), picture(reversed));
        EXPECT_LT(either, 1e-5) << to_string(backend);
        lighting.two_sided = false;
        // Seen from low x, the scalar of one rises and that of the other falls along every ray.
        Camera from_low = view_of_unit_cube(GetParam(), {-5, -2, -1});
        const Scene falling = lit(scene_of(grid_mesh(4), reversed, constant_medium(2)), Shading::flat, lighting);
        const glm::vec4 center = renderer(backend).render(falling, from_low, small).at(small.width / 2, small.height / 2);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(center[k], center.a * glm::dvec3(1, 0.5, 0.25)[k] * lighting.ambient[k], 1e-5) << to_string(backend);
    }
}

// Thin, flat and far cells: finite, and as the judge says.
TEST_P(MediumLightOfEither, StaysFiniteInSlivers) {
    TetMesh mesh = grid_mesh(4, 0.2, 2);
    for (glm::dvec3& p : mesh.points) p = glm::dvec3(1e6) + glm::dvec3(1e-3 * p.x, p.y, p.z);
    const auto field = [](const glm::dvec3& p) { return waves({1e3 * (p.x - 1e6), p.y - 1e6, p.z - 1e6}); };
    const Scene scene = lit(scene_of(mesh, field, constant_medium(3)), Shading::smooth);
    const Camera camera = frame_bounds(bounds(mesh.points), GetParam(), {3, 1, 0.5}, {0, 0, 1}, 1.0);
    for (const Backend backend : backends) {
        const Image image = renderer(backend).render(scene, camera, small);
        for (const glm::vec4& pixel : image.pixels)
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(pixel[k]) && pixel[k] >= 0 && pixel[k] <= 2) << to_string(backend);
    }
}

// Colour of one field, extinction of another: lit by the gradient of the first. OpenGL alone draws it.
TEST(MediumLight, OfTwoFields) {
    Scene scene = scene_of(grid_mesh(5, 0.2, 2), waves, constant_medium(2));
    scene.opacity_field = std::make_shared<ScalarField>(point_field(*scene.mesh, linear));
    scene = lit(scene, Shading::smooth);
    const Camera camera = view_of_unit_cube(Projection::perspective);
    EXPECT_LT(error_of(Backend::gl_osmesa, scene, camera, Reference(scene).picture(camera, small, slack)), 5e-4);
}

// ---- What is asked for, and no more

TEST(MediumLight, NeedsNoGradientsWhereNothingIsLit) {
    const Scene scene = scene_of(grid_mesh(3), linear, ramp());
    const auto gradients = [](const Scene& s) {
        const Plan made = plan(s, view_of_unit_cube(Projection::parallel), small, {}, Backend::cpu);
        return std::ranges::find(made.decisions, "gradients", &Decision::rule)->chosen;
    };
    EXPECT_EQ(gradients(scene), "none");
    EXPECT_EQ(gradients(lit(scene, Shading::unlit)), "none");
    EXPECT_EQ(gradients(lit(scene_of(grid_mesh(3), linear, nothing()), Shading::smooth)), "none");
    EXPECT_EQ(gradients(lit(scene, Shading::flat)), "one for a cell");
    EXPECT_EQ(gradients(lit(scene, Shading::smooth)), "at points");
    EXPECT_EQ(PreparedScene(scene).surfaces(), nullptr);
    EXPECT_EQ(PreparedScene(lit(scene, Shading::unlit)).surfaces(), nullptr);
}

// From scene to scene in one renderer: with light, without, with another function that shows nothing.
TEST(MediumLight, ComesAndGoes) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Scene scene = scene_of(grid_mesh(4, 0.2, 2), waves, ramp());
    for (const Backend backend : backends) {
        const auto fresh = make_renderer(backend);
        const Image lit_alone = make_renderer(backend)->render(lit(scene, Shading::smooth), camera, small);
        Scene changing = scene;
        const Image before = fresh->render(changing, camera, small);
        changing.surfaces = lit(scene, Shading::smooth).surfaces;
        EXPECT_EQ(max_difference(fresh->render(changing, camera, small), lit_alone), 0) << to_string(backend);
        changing.transfer = std::make_shared<TransferFunction>(nothing());
        EXPECT_EQ(max_difference(fresh->render(changing, camera, small), Image(small.width, small.height)), 0) << to_string(backend);
        changing.transfer = scene.transfer;
        changing.surfaces = nullptr;
        EXPECT_LT(max_difference(fresh->render(changing, camera, small), before), 1e-6) << to_string(backend);  // the order may be another exact one
    }
}

TEST(MediumLight, RefusesWhatItCannotLight) {
    const TetMesh mesh = grid_mesh(2);
    const Scene on_cells = scene_of(mesh, ScalarField{"c", FieldLocation::cells, std::vector<double>(mesh.tets.size(), 0.5)}, ramp());
    EXPECT_THROW(Reference{lit(on_cells, Shading::flat)}, Error);
    const Camera camera = view_of_unit_cube(Projection::perspective);
    EXPECT_THROW(renderer(Backend::cpu).render(lit(on_cells, Shading::flat), camera, small), Error);
    const Scene scene = lit(scene_of(mesh, linear, ramp()), Shading::flat);
    for (const char* method : {"shirley-tuchman", "average:half"})
        EXPECT_THROW(renderer(Backend::gl_osmesa).render(scene, camera, small, {.method = parse_method(method)}), Error) << method;
    Lighting bad;
    bad.exponent = 0;
    EXPECT_THROW(Reference{lit(scene, Shading::flat, bad)}, Error);
}

}  // namespace
}  // namespace cellproj
