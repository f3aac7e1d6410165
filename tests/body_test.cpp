// SPDX-License-Identifier: BSD-3-Clause
//
// Opaque bodies in a volume: the judge against closed forms, both backends against both; bodies half inside, before, behind and in the
// plane of isosurfaces, around the eye, and of every size.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/cut_scenes.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace body_test {

using namespace testing_support;

constexpr double tau = 2.0;
const Lighting unlit{.ambient = glm::dvec3(1), .lights = {}};
const glm::dvec3 green(0.1, 0.8, 0.3), medium_color(1.0, 0.5, 0.25);

class BodiesOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Bodies, BodiesOfEither, either_projection, name_of_projection);

// How far along its ray a pixel sees the plane z = `height`, where |x|, |y| are at most `reach`: a rectangle.
std::optional<double> to_rectangle(const ScreenTransform::Ray& ray, double height, double reach) {
    const double t = (height - ray.origin.z) / ray.direction.z;
    const glm::dvec3 p = ray.origin + t * ray.direction;
    if (std::abs(p.x) > reach || std::abs(p.y) > reach) return std::nullopt;
    return t;
}

// A plane through a medium of constant extinction: (1 − e^(−τ·l))·c + e^(−τ·l)·C of the body, l the chord before it.
TEST_P(BodiesOfEither, HideWhatIsBehindThem) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{24, 24} : ImageSize{64, 64};
    const Camera camera = view_of_unit_cube(GetParam());
    const ScreenTransform transform(camera, size);
    for (const double reach : {0.6, 9.0}) {
        const Scene scene = with_bodies(scene_of(grid_mesh(4, 0.2), linear, constant_medium(tau)),
                                        {rectangle({0, 0, 0.4}, {reach, 0, 0}, {0, reach, 0}, green)}, unlit);
        const auto truth = [&](const glm::dvec2& p) {
            const auto ray = transform.ray(p);
            Chord chord = chord_in_unit_cube(ray, transform.perspective());
            const auto body = to_rectangle(ray, 0.4, reach);
            if (body) chord.leave = std::min(chord.leave, *body);
            const double a = -std::expm1(-tau * chord.length());
            return glm::dvec4(a * medium_color + (body ? (1 - a) * green : glm::dvec3(0)), body ? 1.0 : a);
        };
        EXPECT_LT(error_but_for_snapping(to_image(Reference(scene).picture(camera, size), size), truth), 1e-7) << reach;
        EXPECT_LT(error_but_for_snapping(cpu_backend().render(scene, camera, size), truth), 2e-6) << reach;
        EXPECT_LT(error_but_for_snapping(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), truth), 2e-6) << reach;
        EXPECT_LT(error_but_for_snapping(gl_backend().render(scene, camera, size), truth), 2e-4) << reach;
    }
}

// Pixels are covered whose centre is: the same ones as by float64 rays at every triangle, wherever the body is. Two ways to one number.
TEST_P(BodiesOfEither, SpheresHalfInsideAgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{12, 12} : ImageSize{40, 40};
    const Lighting lights{.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}};
    const Scene scene = with_bodies(scene_of(grid_mesh(6, 0.2), linear, ramp()),
                                    {sphere({0.5, 0.3, 1.0}, 0.4, 16, green), sphere({0.2, 0.8, 0.4}, 0.15, 10, {0.9, 0.9, 0.2})}, lights);
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())}) {
        const Reference judge(scene);
        const auto truths = judge.picture(camera, size);
        EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size), truths)), cpu_bound(camera));
        EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), truths)), cpu_bound(camera));
        EXPECT_TRUE(ViewJudge(judge, camera, size, rasterizer_slack).within(gl_backend().render(scene, camera, size), 2e-3));
    }
}

// A closed body has no holes: nothing behind it is seen, at any resolution, from outside and from within.
TEST_P(BodiesOfEither, AreWithoutHoles) {
    constexpr int side = CELLPROJ_SANITIZED ? 31 : 61;
    const ImageSize size{side, side};
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, GetParam(), {0, 0, 1}, {0, 1, 0}, 1.0);  // along the axis of the sphere, on which points and edges line up
    for (const bool inside : {false, true}) {
        // A camera in a parallel view is inside of nothing.
        const Body body = sphere({0.5, 0.5, 0.5}, inside ? 20 : 0.45, 24, green);
        const Scene scene = with_bodies(scene_of(grid_mesh(2), linear, constant_medium(0)), {body}, unlit);
        const Image image = cpu_backend().render(scene, camera, size);
        const Reference judge(scene);
        std::size_t covered = 0;
        for (const PixelTruth& truth : judge.picture(camera, size)) {
            covered += truth.light.opacity == 1.0;
            EXPECT_EQ(image.at(truth.pixel.x, truth.pixel.y).a, static_cast<float>(truth.light.opacity));
        }
        if (inside) {
            EXPECT_EQ(covered, static_cast<std::size_t>(side * side));
        } else {
            EXPECT_GT(covered, static_cast<std::size_t>(side * side) / 4);
        }
    }
}

// Isosurface and body in front of each other, and body and medium behind translucent surfaces.
TEST_P(BodiesOfEither, AndIsosurfacesAgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{10, 10} : ImageSize{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    for (const bool medium : {false, true})
        for (const double opacity : {0.3, 1.0}) {
            Scene scene = with_bodies(scene_of(grid_mesh(6, 0.2, 2), scenes::waves, medium ? ramp() : constant_medium(0)),
                                      {sphere({0.4, 0.2, 0.6}, 0.35, 12, green)});
            scene.surfaces = three_surfaces(opacity, Shading::smooth);
            for (const bool clipped : {false, true}) {
                if (clipped) scene.clip = std::make_shared<const ClipRegion>(ClipRegion{{{{0.4, 0.5, 0.6}, {1, 2, -0.5}}}});
                const Reference judge(scene);
                const ViewJudge view(judge, camera, size, cpu_slack);
                EXPECT_TRUE(view.within(cpu_backend().render(scene, camera, size), cpu_bound(camera))) << medium << opacity << clipped;
                EXPECT_TRUE(view.within(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), cpu_bound(camera))) << medium << opacity << clipped;
                EXPECT_TRUE(ViewJudge(judge, camera, size, rasterizer_slack).within(gl_backend().render(scene, camera, size), 2e-3))
                    << medium << opacity << clipped;
            }
        }
}

// A translucent surface in the plane of a body: it is seen or it is not, as rounding has it; nothing else.
TEST_P(BodiesOfEither, InThePlaneOfAnIsosurface) {
    const ImageSize size{24, 24};
    const Camera camera = view_of_unit_cube(GetParam());
    const auto height = [](const glm::dvec3& p) { return p.z; };
    Scene scene = with_bodies(scene_of(grid_mesh(4, 0.1), height, constant_medium(0)), {rectangle({0.5, 0.5, 0.4}, {9, 0, 0}, {0, 9, 0}, green)}, unlit);
    scene.surfaces = std::make_shared<const SurfaceScene>(SurfaceScene{IsoSurfaces({{0.4, {1, 0, 0}, 0.5, {}}}), Shading::unlit});
    const glm::dvec3 layer = 0.5 * glm::dvec3(1, 0, 0) + 0.5 * green;
    for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) {
        const Image image = renderer->render(scene, camera, size);
        for (const glm::vec4& pixel : image.pixels) {
            const glm::dvec3 color(pixel);
            const bool seen = glm::distance(color, layer) < 1e-6, hidden = glm::distance(color, green) < 1e-6, nothing = pixel == glm::vec4(0);
            EXPECT_TRUE(seen || hidden || nothing) << color.x << " " << color.y << " " << color.z;
        }
    }
}

// What is clipped is the field: a body in what is cut away stays, whole.
TEST_P(BodiesOfEither, AreNotClipped) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene alone = with_bodies(scene_of(grid_mesh(3), linear, constant_medium(0)), {sphere({0.5, 0.5, 0.5}, 0.4, 12, green)});
    Scene cut = alone;
    cut.transfer = std::make_shared<TransferFunction>(constant_medium(50));
    cut.clip = std::make_shared<const ClipRegion>(ClipRegion{{{{5, 5, 5}, {1, 1, 1}}}});  // nothing of the medium
    EXPECT_EQ(max_difference(cpu_backend().render(alone, camera, size), cpu_backend().render(cut, camera, size)), 0.0);
    EXPECT_EQ(max_difference(cpu_backend().render(cut, camera, size), gl_backend().render(cut, camera, size)), 0.0);
}

// The mesh behind the eye or beside the picture: what is left of the scene is drawn.
TEST_P(BodiesOfEither, AreSeenWhereTheMeshIsNot) {
    const ImageSize size{20, 20};
    Camera camera = view_of_unit_cube(GetParam());
    const glm::dvec3 away = 20.0 * (camera.eye - camera.center);
    for (const glm::dvec3& move : {away, 20.0 * glm::cross(away, camera.up)}) {
        Camera moved = camera;
        moved.eye += move;
        moved.center += move;
        if (move == away) moved.center = moved.eye + 0.05 * away;  // looks away from it
        const Scene scene = with_bodies(scene_of(grid_mesh(3), linear, ramp()), {sphere(moved.center, 0.5, 12, green)}, unlit);
        const auto truths = Reference(scene).picture(moved, size);
        EXPECT_TRUE(std::ranges::any_of(truths, [](const PixelTruth& truth) { return truth.light.opacity == 1.0; }));
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) EXPECT_LT(largest(compare(renderer->render(scene, moved, size), truths)), 1e-6);
    }
}

// Triangles around the eye, of no area, and nearer than the near plane; pixels and depths of random ones agree with the judge.
TEST_P(BodiesOfEither, OfRandomTriangles) {
    const ImageSize size{20, 20};
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const Camera camera = inside_of_unit_cube(GetParam());
    const Scene mesh = scene_of(grid_mesh(3, 0.2), linear, ramp());
    for (int round = 0; round < (CELLPROJ_SANITIZED ? 3 : 12); ++round) {
        const double reach = std::pow(10.0, 2 * unit(random) - 1);  // .001 to 10
        Body body{.points = {}, .triangles = {}, .color = green};
        for (VertexId i = 0; i < 30; i += 3) {
            for (int corner = 0; corner < 3; ++corner) body.points.push_back(camera.eye + reach * glm::dvec3(unit(random), unit(random), unit(random)));
            if (i % 2 == 0) body.points.back() = body.points[body.points.size() - 2];  // no area
            body.triangles.push_back({i, i + 1, i + 2});
        }
        const Scene scene = with_bodies(mesh, {body});
        const auto truths = Reference(scene).picture(camera, size);
        EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size), truths)), cpu_bound(camera)) << reach;
        EXPECT_LT(largest(compare(gl_backend().render(scene, camera, size), truths)), 2e-3) << reach;
    }
}

TEST_P(BodiesOfEither, AtAnyScaleAndPlace) {
    const ImageSize size{24, 24};
    const auto picture = [&](Renderer& renderer, double scale, const glm::dvec3& place) {
        TetMesh mesh = grid_mesh(4, 0.2);
        const ScalarField field = point_field(mesh, linear);
        Body body = sphere({0.5, 0.3, 1.0}, 0.4, 12, green);
        for (auto* points : {&mesh.points, &body.points})
            for (glm::dvec3& p : *points) p = scale * p + place;
        Camera camera = view_of_unit_cube(GetParam());
        for (glm::dvec3* p : {&camera.eye, &camera.center}) *p = scale * *p + place;
        camera.height *= scale;
        return renderer.render(with_bodies(scene_of(mesh, field, with_scaled_extinction(ramp(), 1 / scale)), {body}), camera, size);
    };
    for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) {
        const Image usual = picture(*renderer, 1, {0, 0, 0});
        for (const double scale : {1e-12, 1e12}) EXPECT_LT(max_difference(usual, picture(*renderer, scale, {0, 0, 0})), 2e-6) << scale;
        // Points at 1e6 are multiples of 1e-10: another mesh and body, by some 1e-8 of a pixel.
        EXPECT_LT(max_difference(usual, picture(*renderer, 1, {1e6, -1e6, 1e6})), 1e-4);
    }
}

// Coordinates up to the largest there are: what float64 cannot tell is not seen, and nothing is not a number.
TEST_P(BodiesOfEither, BeyondAllBounds) {
    const ImageSize size{16, 16};
    const Camera camera = view_of_unit_cube(GetParam());
    for (const double huge : {1e30, 1e160, 1.7e308}) {
        const Body body{.points = {{0.5, 0.5, 0.5}, {huge, 0, 0}, {0, huge, -huge}, {-huge, -huge, huge}}, .triangles = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}}, .color = green};
        const Scene scene = with_bodies(scene_of(grid_mesh(3), linear, ramp()), {body});
        for (const Image& image : {cpu_backend().render(scene, camera, size), gl_backend().render(scene, camera, size), to_image(Reference(scene).picture(camera, size), size)})
            for (const glm::vec4& pixel : image.pixels) EXPECT_TRUE(std::isfinite(pixel.r + pixel.g + pixel.b + pixel.a)) << huge;
    }
}

TEST(Bodies, AreTheSameForAnyNumberOfThreads) {
    const Scene scene = with_bodies(scene_of(grid_mesh(4), linear, ramp()), {sphere({0.5, 0.3, 1.0}, 0.4, 12, green)});
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const auto one = make_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {70, 70});
    EXPECT_EQ(max_difference(one, make_renderer(Backend::cpu, {.threads = 3})->render(scene, camera, {70, 70})), 0.0);
}

// One renderer, scenes with and without: nothing of one is left in the next.
TEST(Bodies, ComeAndGo) {
    const Scene without = scene_of(grid_mesh(4), linear, ramp());
    const Scene with = with_bodies(without, {sphere({0.5, 0.3, 1.0}, 0.4, 12, green)});
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    for (const Backend backend : {Backend::cpu, Backend::gl_osmesa}) {
        const auto renderer = make_renderer(backend);
        const Image first = renderer->render(without, camera, {40, 40}), second = renderer->render(with, camera, {40, 40});
        EXPECT_GT(max_difference(first, second), 0.1);
        EXPECT_EQ(max_difference(first, renderer->render(without, camera, {40, 40})), 0.0);
        EXPECT_EQ(max_difference(second, renderer->render(with, camera, {40, 40})), 0.0);
    }
}

TEST(Bodies, OfPolygonsAreTheirTriangles) {
    // An L, not convex, and a triangle.
    const Surface surface{.name = "L",
                          .points = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 1}},
                          .polygons = {{0, 1, 2, 3, 4, 5}, {0, 1, 6}},
                          .point_fields = {}};
    const Body body = make_body(surface, green);
    ASSERT_EQ(body.triangles.size(), 5U);
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& t = body.triangles[i];
        const glm::dvec3 twice = glm::cross(body.points[t[1]] - body.points[t[0]], body.points[t[2]] - body.points[t[0]]);
        EXPECT_GT(twice.z, 0);
        area += twice.z / 2;
    }
    EXPECT_DOUBLE_EQ(area, 3);
    EXPECT_THROW(make_body({.name = "empty", .points = {}, .polygons = {}, .point_fields = {}}, green), Error);
}

TEST(Bodies, ThatAreBrokenAreRefused) {
    const Scene mesh = scene_of(grid_mesh(2), linear, ramp());
    Body far_vertex = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, green), not_finite = far_vertex;
    far_vertex.triangles[1][2] = 4;
    not_finite.points[2].y = std::numeric_limits<double>::quiet_NaN();
    for (const Body& body : {far_vertex, not_finite}) {
        const Scene scene = with_bodies(mesh, {body});
        EXPECT_THROW(Reference{scene}, Error);
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) EXPECT_THROW(renderer->render(scene, view_of_unit_cube(Camera::Projection::parallel), {8, 8}), Error);
    }
}

}  // namespace
}  // namespace cellproj
