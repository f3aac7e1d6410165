// SPDX-License-Identifier: BSD-3-Clause
//
// Clipping planes and boxes: the judge against closed forms, both backends against both; planes where they are hardest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/cpu/kernels.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/cut_scenes.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace clip_region_test {

using namespace testing_support;

constexpr double tau = 2.0;

Scene clipped(Scene scene, std::vector<HalfSpace> half_spaces) {
    scene.clip = std::make_shared<const ClipRegion>(ClipRegion{std::move(half_spaces)});
    return scene;
}

// What of the chord through the unit cube the half spaces keep.
double kept_chord(const ScreenTransform::Ray& ray, bool perspective, const std::vector<HalfSpace>& half_spaces) {
    Chord chord = chord_in_unit_cube(ray, perspective);
    for (const HalfSpace& half_space : half_spaces) {
        const double ahead = glm::dot(half_space.normal, ray.origin - half_space.point), speed = glm::dot(half_space.normal, ray.direction);
        if (speed > 0) chord.enter = std::max(chord.enter, -ahead / speed);
        if (speed < 0) chord.leave = std::min(chord.leave, -ahead / speed);
        if (speed == 0 && ahead < 0) return 0;
    }
    return chord.length();
}

// 1 − exp(−τ·chord): the largest distance over a picture of a medium of constant extinction, silhouettes of the cube aside.
double error_of_chords(const Image& image, const Camera& camera, const std::vector<HalfSpace>& half_spaces) {
    const ImageSize size{image.width, image.height};
    const ScreenTransform transform(camera, size);
    return error_but_for_snapping(image, [&](const glm::dvec2& p) {
        const double a = -std::expm1(-tau * kept_chord(transform.ray(p), transform.perspective(), half_spaces));
        return glm::dvec4(a * glm::dvec3(1.0, 0.5, 0.25), a);
    });
}

const std::vector<std::vector<HalfSpace>> regions{
    {{{0.4, 0.5, 0.6}, {1, 2, -0.5}}},                                             // a plane in general place
    {{{0.4, 0.5, 0.6}, {-1, -2, 0.5}}},                                            // and its other side
    {{{0.5, 0, 0}, {1e-200, 0, 0}}, {{0, 0.5, 0}, {0, -1e200, 0}}},                // through points and along faces of the grids; a wedge
    {{{0.3, 0.3, 0.3}, {1, 1, 1}}, {{0.6, 0.6, 0.6}, {-1, -1, -1}}},               // a slab
    box_region({{0.2, -3, 0.1}, {0.7, 0.55, 0.9}}).half_spaces,                    // a box that reaches beyond the mesh
};

class ClipOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Clip, ClipOfEither, either_projection, name_of_projection);

// The judge integrates to 1e-9; float32 lengths and exponentials: 1e-6. OpenGL's corners lie on a grid of 1/256 of a pixel, which
// moves planes of slivers.
TEST_P(ClipOfEither, AConstantMediumKeepsItsChord) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{16, 16} : ImageSize{48, 48};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene whole = scene_of(grid_mesh(4, 0.2), linear, constant_medium(tau));
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Scene scene = clipped(whole, regions[i]);
        EXPECT_LT(error_of_chords(to_image(Reference(scene).picture(camera, size), size), camera, regions[i]), 1e-7) << i;  // Image is float32
        EXPECT_LT(error_of_chords(cpu_backend().render(scene, camera, size), camera, regions[i]), 2e-6) << i;
        EXPECT_LT(error_of_chords(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), camera, regions[i]), 2e-6) << i;
        EXPECT_LT(error_of_chords(gl_backend().render(scene, camera, size), camera, regions[i]), 2e-4) << i;
    }
}

// What both sides of a plane let through is what the whole lets through: for any field and function.
TEST_P(ClipOfEither, BothSidesTogetherAreTheWhole) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene scene = scene_of(grid_mesh(5, 0.2), scenes::waves, ramp());
    for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) {
        const Image whole = renderer->render(scene, camera, size);
        const Image one = renderer->render(clipped(scene, regions[0]), camera, size);
        const Image other = renderer->render(clipped(scene, regions[1]), camera, size);
        double worst = 0;
        for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
            const double product = (1.0 - one.pixels[i].a) * (1.0 - other.pixels[i].a);
            worst = std::max(worst, std::abs(product - (1.0 - whole.pixels[i].a)));
        }
        EXPECT_LT(worst, 5e-6) << (renderer == &cpu_backend() ? "cpu" : "gl");  // twenty-odd factors of float32
    }
}

TEST_P(ClipOfEither, RampsAgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{12, 12} : ImageSize{36, 36};
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())}) {
        const Scene whole = scene_of(grid_mesh(5, 0.2), linear, ramp());
        for (std::size_t i = 0; i < regions.size(); ++i) {
            const Scene scene = clipped(whole, regions[i]);
            const Reference judge(scene);
            const auto truths = judge.picture(camera, size);
            EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size), truths)), cpu_bound(camera)) << i;
            EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), truths)), cpu_bound(camera)) << i;
            EXPECT_TRUE(ViewJudge(judge, camera, size, rasterizer_slack).within(gl_backend().render(scene, camera, size), 2e-3)) << i;
        }
    }
}

// Constant in a cell; and every method of light per pixel, which see a cut segment as any other.
TEST_P(ClipOfEither, FieldsOnCellsAndOtherMethods) {
    const ImageSize size{24, 24};
    const Camera camera = view_of_unit_cube(GetParam());
    const TetMesh mesh = grid_mesh(5, 0.2);
    ScalarField of_cells{"c", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) of_cells.values.push_back(linear(mesh.points[tet[0]]));
    const Scene cells = clipped(scene_of(mesh, of_cells, ramp()), regions[0]);
    EXPECT_LT(largest(compare(cpu_backend().render(cells, camera, size), Reference(cells).picture(camera, size))), cpu_bound(camera));
    EXPECT_TRUE(ViewJudge(Reference(cells), camera, size, rasterizer_slack).within(gl_backend().render(cells, camera, size), 2e-3));

    const Scene points = clipped(scene_of(mesh, linear, ramp()), regions[0]);
    const auto of_points = Reference(points).picture(camera, size, rasterizer_slack);
    for (const char* method : {"exact", "exact:1e-4", "linear:4", "homogeneous", "preint2d-exp:256", "preint3d:64"}) {
        const Quality quality{.method = parse_method(method, "method")};
        // Their own error on this scene, where it is not clipped, is as large: what they do in a segment is not exact.
        const double bound = std::string(method) == "exact" ? 1e-5 : 5e-3;
        EXPECT_LT(largest(compare(cpu_backend().render(points, camera, size, quality), of_points)), bound) << method;
        EXPECT_LT(largest(compare(gl_backend().render(points, camera, size, quality), of_points)), std::max(bound, 2e-3)) << method;
    }

    Scene two = points;
    two.opacity_field = std::make_shared<ScalarField>(point_field(mesh, [](const glm::dvec3& p) { return p.z; }));
    EXPECT_TRUE(ViewJudge(Reference(two), camera, size, rasterizer_slack).within(gl_backend().render(two, camera, size), 2e-3));
}

// Planes along rays, through the eye, and of regions with nothing in them.
TEST_P(ClipOfEither, PlanesWhereTheyAreHardest) {
    const ImageSize size{32, 32};
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, GetParam(), {0, 0, 1}, {0, 1, 0}, 1.0);
    const Scene whole = scene_of(grid_mesh(4), linear, constant_medium(tau));
    const glm::dvec3 eye = camera.eye;
    const std::vector<std::vector<HalfSpace>> hard{
        {{{0.5, 0.5, 0.5}, {1, 0, 0}}},            // along the view, through the middle of the picture: pixels on both sides
        {{eye, {0, 0, -1}}},                       // the eye in the plane: all is in front of it
        {{eye, {0, 0, 1}}},                        // or behind it
        {{eye, {1, 0.3, 0}}},                      // the eye in a plane that cuts the mesh
        {{{0.5, 0.5, 0.5}, {0, 0, 1}}, {{0.5, 0.5, 0.5}, {0, 0, -1}}},  // a plane
        {{{0.2, 0, 0}, {-1, 0, 0}}, {{0.8, 0, 0}, {1, 0, 0}}},          // nothing
        {{{5, 0, 0}, {1, 0, 0}}},                                       // outside
        {{{1, 0.5, 0.5}, {-1, 0, 0}}},                                  // along a side of the mesh: all of it
        {{{0.5, 0.5, 1}, {0, 0, 1}}},                                   // or nothing
    };
    for (std::size_t i = 0; i < hard.size(); ++i) {
        const Scene scene = clipped(whole, hard[i]);
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()})
            EXPECT_LT(error_of_chords(renderer->render(scene, camera, size), camera, hard[i]), 1e-5) << i << (renderer == &cpu_backend() ? " cpu" : " gl");
        EXPECT_LT(error_of_chords(to_image(Reference(scene).picture(camera, size), size), camera, hard[i]), 1e-7) << i;
    }
}

// Between the eye and the near plane cells are drawn as from the eye on; a cut there is as exact.
TEST(ClipRegion, BetweenTheEyeAndTheNearPlane) {
    const ImageSize size{32, 32};
    const Camera camera = inside_of_unit_cube(Camera::Projection::perspective);
    const Scene whole = scene_of(grid_mesh(4, 0.2), linear, constant_medium(100 * tau));
    const glm::dvec3 ahead = glm::normalize(camera.center - camera.eye);
    for (const double depth : {1e-5, 3e-4})
        for (const double side : {1.0, -1.0}) {
            const Scene scene = clipped(whole, {{camera.eye + depth * ahead, side * ahead}});
            const auto truths = Reference(scene).picture(camera, size);
            // 1e-7 of the distance, 1/200 of which is an optical depth of 1; beyond that it is float32 alone.
            EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size), truths)), 2e-5) << depth << side;
            EXPECT_LT(largest(compare(gl_backend().render(scene, camera, size), truths)), 2e-3) << depth << side;
        }
}

// Units of the mesh and its place do not matter: decisions are made relative to the eye, in float64.
TEST_P(ClipOfEither, AtAnyScaleAndPlace) {
    const ImageSize size{24, 24};
    const auto picture = [&](Renderer& renderer, double scale, const glm::dvec3& place) {
        TetMesh mesh = grid_mesh(4, 0.2);
        const ScalarField field = point_field(mesh, linear);
        for (glm::dvec3& p : mesh.points) p = scale * p + place;
        Camera camera = view_of_unit_cube(GetParam());
        for (glm::dvec3* p : {&camera.eye, &camera.center}) *p = scale * *p + place;
        camera.height *= scale;
        HalfSpace plane = regions[0][0];
        plane.point = scale * plane.point + place;
        return renderer.render(clipped(scene_of(mesh, field, with_scaled_extinction(ramp(), 1 / scale)), {plane}), camera, size);
    };
    for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) {
        const Image usual = picture(*renderer, 1, {0, 0, 0});
        for (const double scale : {1e-12, 1e12}) EXPECT_LT(max_difference(usual, picture(*renderer, scale, {0, 0, 0})), 2e-6) << scale;
        // Points at 1e6 are multiples of 1e-10: the mesh itself is another, by some 1e-8 of a pixel.
        EXPECT_LT(max_difference(usual, picture(*renderer, 1, {1e6, -1e6, 1e6})), 1e-4);
    }
}

// Translucent and opaque isosurfaces, alone and in a medium, flat and smooth.
TEST_P(ClipOfEither, IsosurfacesAgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{10, 10} : ImageSize{24, 24};
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())})
        for (const bool medium : {false, true})
            for (const double opacity : {0.4, 1.0})
                for (const Shading shading : {Shading::flat, Shading::smooth}) {
                    Scene scene = scene_of(grid_mesh(6, 0.2, 2), scenes::waves, medium ? ramp() : constant_medium(0));
                    scene.surfaces = three_surfaces(opacity, shading);
                    for (const std::size_t region : {std::size_t{0}, std::size_t{4}}) {
                        const Scene cut = clipped(scene, regions[region]);
                        const Reference judge(cut);
                        const ViewJudge view(judge, camera, size, cpu_slack);
                        EXPECT_TRUE(view.within(cpu_backend().render(cut, camera, size), cpu_bound(camera))) << medium << opacity << region;
                        EXPECT_TRUE(view.within(cpu_backend().render(cut, camera, size, {.order_per_pixel = true}), cpu_bound(camera))) << medium << opacity << region;
                        EXPECT_TRUE(ViewJudge(judge, camera, size, rasterizer_slack).within(gl_backend().render(cut, camera, size), 2e-3))
                            << medium << opacity << region;
                    }
                }
}

// A clip that cuts nothing away changes no bit.
TEST_P(ClipOfEither, WhatKeepsAllChangesNothing) {
    const ImageSize size{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    Scene scene = scene_of(grid_mesh(5, 0.2), linear, ramp());
    for (const bool surfaces : {false, true}) {
        if (surfaces) scene.surfaces = three_surfaces(0.5, Shading::smooth);
        const Scene kept = clipped(scene, {{{0, 0, -2}, {0, 0, 1}}});
        EXPECT_EQ(max_difference(cpu_backend().render(scene, camera, size), cpu_backend().render(kept, camera, size)), 0.0);
        EXPECT_LT(max_difference(gl_backend().render(scene, camera, size), gl_backend().render(kept, camera, size)), 1e-6);
    }
}

// Vectors of 16, 8 and 4 lanes: the same segments, sums in another order.
TEST_P(ClipOfEither, ByEveryInstructionSet) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    Scene scene = clipped(scene_of(grid_mesh(6, 0.2), linear, ramp()), regions[0]);
    for (const bool surfaces : {false, true}) {
        if (surfaces) scene.surfaces = three_surfaces(0.5, Shading::flat);
        const Image best = cpu_backend().render(scene, camera, size);
        for (const std::string& set : cpu::instruction_sets()) {
            cpu::use_instruction_set(set);
            EXPECT_LT(max_difference(cpu_backend().render(scene, camera, size), best), 2e-6) << set;
        }
        cpu::use_instruction_set(cpu::instruction_sets().front());
    }
}

TEST(ClipRegion, TellsWhetherARegionMeetsABox) {
    const Bounds cube{{0, 0, 0}, {1, 1, 1}};
    EXPECT_TRUE(meets({}, cube));
    EXPECT_TRUE(meets({{{{0.5, 0.5, 0.5}, {1, 2, 3}}}}, cube));
    EXPECT_TRUE(meets({{{{1, 0, 0}, {1, 0, 0}}}}, cube));           // a side of it
    EXPECT_TRUE(meets({{{{1, 1, 1}, {1, 1, 1}}}}, cube));           // a corner
    EXPECT_FALSE(meets({{{{1.001, 1, 1}, {1, 1, 1}}}}, cube));
    EXPECT_FALSE(meets({{{{0.4, 0, 0}, {-1, 0, 0}}, {{0.6, 0, 0}, {1, 0, 0}}}}, cube));
    EXPECT_TRUE(meets(box_region({{0.4, 0.4, 0.4}, {0.6, 0.6, 0.6}}), cube));
    EXPECT_FALSE(meets(box_region({{2, 0, 0}, {3, 1, 1}}), cube));
    // Three planes across each other about an edge that passes the cube.
    EXPECT_FALSE(meets({{{{1.2, 1.2, 0}, {1, 0, 0}}, {{1.2, 1.2, 0}, {0, 1, 0}}}}, cube));
    const Bounds far{{1e12, 1e12, 1e12}, {1e12 + 1e6, 1e12 + 1e6, 1e12 + 1e6}};
    EXPECT_TRUE(meets({{{far.center(), {1, 0, 0}}}}, far));
    EXPECT_FALSE(meets({{{far.high + 1e5, {1, 0, 0}}}}, far));
}

TEST(ClipRegion, RefusesPlanesWithoutAPlace) {
    for (const HalfSpace& bad : {HalfSpace{{0, 0, 0}, {0, 0, 0}}, HalfSpace{{0, 0, NAN}, {0, 0, 1}}, HalfSpace{{0, 0, 0}, {0, INFINITY, 1}}}) {
        const Scene scene = clipped(scene_of(grid_mesh(2), linear, ramp()), {bad});
        EXPECT_THROW(Reference{scene}, Error);
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) EXPECT_THROW(renderer->render(scene, view_of_unit_cube(Camera::Projection::parallel), {8, 8}), Error);
    }
}

// Light at vertices knows no place in a segment: refused by name, not drawn whole.
TEST(ClipRegion, LightAtVerticesIsRefused) {
    const Scene scene = clipped(scene_of(grid_mesh(2), linear, ramp()), regions[0]);
    const Quality quality{.method = parse_method("shirley-tuchman", "method")};
    EXPECT_THROW(gl_backend().render(scene, view_of_unit_cube(Camera::Projection::parallel), {8, 8}, quality), Error);
}

}  // namespace
}  // namespace cellproj
