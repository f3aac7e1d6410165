// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces of the CPU backend against the judge (render/judge) and closed forms: planes, spheres, layers, mixed scenes, and
// isovalues that points, faces and whole cells have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/cpu/kernels.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace cpu_surfaces_test {

using testing_support::ViewJudge;
using testing_support::constant_medium;
using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::max_difference;
using testing_support::nothing;
using testing_support::point_field;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;
using testing_support::with_surfaces;
using scenes::waves;

using Projection = Camera::Projection;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{40, 40} : ImageSize{96, 96};

Renderer& cpu() {
    static const auto shared = make_renderer(Backend::cpu);
    return *shared;
}

// Points are rounded to float32, which moves silhouettes, and edges of surfaces at the mesh's sides, by some 1e-5 of a pixel.
constexpr double slack = 1.0 / 512;

// Exact from 1e-6 on.
double error_of(const Scene& scene, const Camera& camera, ImageSize size = small, const Quality& quality = {}) {
    return largest(ViewJudge(Reference(scene), camera, size, slack).compare(cpu().render(scene, camera, size, quality), 1e-6));
}

const std::vector<IsoSurface> three{{0.3, {0.2, 0.9, 0.4}, 0.5, {}}, {0.5, {1, 0, 0}, 0.25, glm::dvec3(0, 0, 1)}, {0.7, {0.5, 0.5, 0.5}, 0.8, {}}};
const Lighting two_lights{.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}};

std::vector<IsoSurface> opaque(std::vector<IsoSurface> list) {
    for (IsoSurface& surface : list) surface.opacity = 1;
    return list;
}

// `count` of opacity .1 at low + (i + ½)/count.
std::vector<IsoSurface> layers(int count, double opacity = 0.1) {
    std::vector<IsoSurface> list;
    for (int i = 0; i < count; ++i) list.push_back({(i + 0.5) / count, {1, 0.5, 0}, opacity, {}});
    return list;
}

Camera from_above() {
    return {.projection = Projection::parallel, .eye = {0.5, 0.5, 9}, .center = {0.5, 0.5, 0}, .up = {0, 1, 0}, .height = 1};
}

Camera inside() {
    Camera camera = view_of_unit_cube(Projection::perspective);
    camera.eye = {0.31, 0.42, 0.53};
    camera.center = {0.9, 0.8, 0.6};
    camera.fov_y_degrees = 70;
    return camera;
}

// What a pixel sees of the unit cube where the scalar is `linear`.
struct CubeRay {
    ScreenTransform::Ray ray;
    double length, s_f, s_b;  // between both sides of the cube
};

CubeRay cube_ray(const ScreenTransform& transform, PixelId pixel) {
    const auto ray = transform.ray({pixel.x + 0.5, pixel.y + 0.5});
    const auto chord = testing_support::chord_in_unit_cube(ray, transform.perspective());
    const auto at = [&](double t) { return linear(ray.origin + t * ray.direction); };
    return {ray, chord.length(), at(chord.enter), at(chord.leave)};
}

class CpuSurfacesOfEither : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(CpuSurfaces, CpuSurfacesOfEither, testing_support::either_projection, testing_support::name_of_projection);

// Every shading, opaque and translucent, alone and in a medium, in the order of cells and of pixels.
TEST_P(CpuSurfacesOfEither, AgreeWithTheJudge) {
    const ImageSize size = sanitized ? ImageSize{24, 24} : ImageSize{64, 64};
    const Camera camera = view_of_unit_cube(GetParam());
    for (const Shading shading : {Shading::unlit, Shading::flat, Shading::smooth})
        for (const bool is_opaque : {true, false})
            for (const bool medium : {false, true}) {
                const Scene scene = with_surfaces(scene_of(grid_mesh(sanitized ? 5 : 9, 0.2, 2), waves, medium ? ramp() : nothing()),
                                         is_opaque ? opaque(three) : three, shading, two_lights);
                const ViewJudge view(Reference(scene), camera, size, slack);
                // Rounding of float32: 1e-7 a fragment, some 1e-6 of a normal near flat tops. The issue asks for 2e-3.
                for (const bool by_pixel : {false, true})
                    EXPECT_TRUE(view.within(cpu().render(scene, camera, size, {.order_per_pixel = by_pixel}), 1e-5))
                        << static_cast<int>(shading) << is_opaque << medium << by_pixel;
            }
}

// Lit planes in a medium of constant extinction: the light in front tells the depth, the colour the normal. Isovalues that many points
// have (k/28 of linear() on this mesh without jitter) and others.
TEST_P(CpuSurfacesOfEither, OfALinearFieldAreExactPlanes) {
    constexpr double tau = 1.3;
    const glm::dvec3 slope = glm::dvec3(1, 0.5, 0.25) / 1.75;
    const Camera camera = view_of_unit_cube(GetParam(), {2, 0.7, -0.5});
    const ScreenTransform transform(camera, small);
    for (const double jitter : {0.0, 0.2})
        for (const Shading shading : {Shading::flat, Shading::smooth})
            for (const double v : {2.0 / 7, 0.5, 0.77}) {
                const IsoSurface plane{v, {0.9, 0.6, 0.3}, 1, glm::dvec3(0.2, 0.3, 0.8)};
                const Scene scene = with_surfaces(scene_of(grid_mesh(4, jitter, 2), linear, constant_medium(tau)), {plane}, shading, two_lights);
                const Image image = cpu().render(scene, camera, small);
                int met = 0;
                for (const PixelId& pixel : all_pixels(small)) {
                    const auto [ray, length, s_f, s_b] = cube_ray(transform, pixel);
                    if (length < 1e-3) continue;
                    if (std::min(std::abs(s_f - v), std::abs(s_b - v)) < 1e-5 || (s_f < v) == (s_b < v)) continue;
                    const double depth = (v - s_f) / (s_b - s_f) * length, alpha = -std::expm1(-tau * depth);
                    const glm::dvec3 lit = shade(two_lights, seen_color(plane, s_f < s_b), -slope, -ray.direction);
                    const glm::dvec3 expected = alpha * glm::dvec3(1, 0.5, 0.25) + (1 - alpha) * lit;
                    const glm::vec4 found = image.at(pixel.x, pixel.y);
                    // A depth off by 1e-5 of the box would change the light by 1e-5·τ·√3; the rounding of the scalar to float32, over
                    // its slope along the ray, is 4e-7 here.
                    for (int k = 0; k < 3; ++k) ASSERT_NEAR(found[k], expected[k], 3e-6) << v << " " << pixel.x << " " << pixel.y;
                    ASSERT_NEAR(found.a, 1, 1e-6);
                    ++met;
                }
                EXPECT_GT(met, sanitized ? 200 : 1000) << v;
            }
}

// k layers of .1 are 1 − .9^k in every pixel, also where cells meet: no edges of cells, nothing lost or doubled.
TEST_P(CpuSurfacesOfEither, TwentyLayersOfATenthShowNoCells) {
    const Camera camera = view_of_unit_cube(GetParam(), {-2, -0.8, -0.7});
    for (const bool medium : {false, true}) {
        // The medium is seen through only: a black one, and what remains is its transmittance.
        Scene scene = with_surfaces(scene_of(grid_mesh(sanitized ? 7 : 20, 0.2, 5), linear, medium ? constant_medium(1e-30) : nothing()), layers(20), Shading::unlit);
        const ScreenTransform transform(camera, small);
        for (const bool by_pixel : {false, true}) {
            const Image image = cpu().render(scene, camera, small, {.order_per_pixel = by_pixel});
            int most = 0;
            for (const PixelId& pixel : all_pixels(small)) {
                const CubeRay seen = cube_ray(transform, pixel);
                if (seen.length < 1e-5) continue;
                int k = 0;
                bool doubtful = false;  // within the rounding of points and scalars of the mesh's side
                for (const IsoSurface& layer : scene.surfaces->isosurfaces.surfaces()) {
                    k += (seen.s_f < layer.value) != (seen.s_b < layer.value);
                    doubtful |= std::min(std::abs(seen.s_f - layer.value), std::abs(seen.s_b - layer.value)) < 1e-6;
                }
                if (doubtful) continue;
                ASSERT_NEAR(image.at(pixel.x, pixel.y).a, 1 - std::pow(0.9, k), 1e-6) << pixel.x << " " << pixel.y;
                most = std::max(most, k);
            }
            EXPECT_GT(most, 10);
        }
    }
}

// More surfaces than a batch of fragments holds, in cells that hold dozens of them.
TEST_P(CpuSurfacesOfEither, AThousandOfThem) {
    const Scene scene = with_surfaces(scene_of(grid_mesh(4, 0.2, 5), waves, ramp()), layers(1000, 0.003), Shading::smooth);
    EXPECT_LT(error_of(scene, view_of_unit_cube(GetParam()), {24, 24}), 1e-5);
}

// A coarse Delaunay mesh, whose sides have cells a thousandth as thick as they are long: the CPU moves no points, so that gradients in them,
// and colours, are float32's.
TEST_P(CpuSurfacesOfEither, InSlivers) {
#ifdef CELLPROJ_MESHER_PROGRAM
    const Scene bare = scene_of(testing_support::delaunay_mesh(300), waves, nothing());
    for (const Shading shading : {Shading::flat, Shading::smooth})
        EXPECT_LT(error_of(with_surfaces(bare, three, shading, two_lights), view_of_unit_cube(GetParam()), sanitized ? ImageSize{16, 16} : ImageSize{40, 40}), 2e-6);
#else
    GTEST_SKIP() << "no mesher";
#endif
}

TEST(CpuSurfaces, OfAQuadraticFieldAndACameraInside) {
    const glm::dvec3 c(0.5);
    const auto bowl = [&](const glm::dvec3& p) { return glm::dot(p - c, p - c); };
    const std::vector<IsoSurface> spheres{{0.04, {1, 0.3, 0.2}, 1, {}}, {0.09, {0.2, 0.6, 1}, 0.3, {}}, {0.16, {1, 1, 1}, 0.2, glm::dvec3(0, 1, 0)}};
    for (const bool medium : {false, true}) {
        const Scene scene = with_surfaces(scene_of(grid_mesh(sanitized ? 6 : 14, 0.1, 7), bowl, medium ? ramp() : nothing()), spheres);
        EXPECT_LT(error_of(scene, view_of_unit_cube(Projection::perspective)), 1e-5);
        // Between the eye and the near plane, 7e-4, a ray that changes cells there loses the medium before.
        for (const auto& list : {spheres, opaque(spheres)}) EXPECT_LT(error_of(with_surfaces(scene, list), inside()), medium ? 1e-3 : 1e-5);
    }
}

// The scene of the demo: 3 surfaces, lit, in the volume. The issue asks for 2e-3.
TEST(CpuSurfaces, InTheFlowAroundASphere) {
    if (sanitized) GTEST_SKIP() << "the mesh takes 20 s; the code is that of the other tests";
    const TetMesh mesh = make_sphere_flow_mesh({.program = CELLPROJ_MESHER_PROGRAM});
    const ScalarField field = select_scalar(mesh, "cp", "sphere");
    const std::vector<IsoSurface> list{{-0.5, {0.2, 0.4, 1}, 0.4, glm::dvec3(0, 1, 1)}, {-0.1, {1, 1, 1}, 0.2, {}}, {0.3, {1, 0.3, 0.2}, 0.7, {}}};
    for (const Shading shading : {Shading::flat, Shading::smooth})
        for (const bool is_opaque : {false, true}) {
            const Scene scene = with_surfaces(scene_of(mesh, field, sphere_flow_transfer_function()), is_opaque ? opaque(list) : list, shading, two_lights);
            const double error = error_of(scene, sphere_flow_camera(), {64, 64});
            std::printf("flow around a sphere, %s: largest error %.1e\n", is_opaque ? "opaque" : "translucent", error);
            EXPECT_LT(error, 2e-3);
        }
}

// Where rays run through points, along edges and faces, and faces and whole cells are at the isovalue: as often as the judge says.
TEST(CpuSurfaces, AtTheValuesOfFacesAndCells) {
    struct Case {
        double (*f)(const glm::dvec3&);
        int layers;
    };
    for (const Case& c : {Case{[](const glm::dvec3& p) { return std::min(p.z, 0.5); }, 1},   // below a plateau: its border
                          Case{[](const glm::dvec3& p) { return std::max(p.z, 0.5); }, 0},   // above one: none
                          Case{[](const glm::dvec3& p) { return p.z; }, 1},
                          Case{[](const glm::dvec3& p) { return p.z == 0.5 || p.z == 0.25 ? 0.5 : 0.0; }, 2},  // both sides of a plateau
                          Case{[](const glm::dvec3&) { return 0.5; }, 0}})
        for (const bool medium : {false, true})
            for (const double opacity : {0.1, 1.0})
                for (const int side : {16, 23, 32}) {
                    const Scene scene = with_surfaces(scene_of(grid_mesh(4), c.f, medium ? constant_medium(1e-30) : nothing()),
                                             {{0.5, {1, 1, 1}, opacity, {}}}, Shading::flat);
                    Camera camera = from_above();
                    camera.height = 0.999;  // the outermost pixels are inside
                    for (const bool by_pixel : {false, true}) {
                        const Image image = cpu().render(scene, camera, {side, side}, {.order_per_pixel = by_pixel});
                        for (const glm::vec4& pixel : image.pixels) ASSERT_NEAR(pixel.a, 1 - std::pow(1 - opacity, c.layers), 1e-6);
                    }
                }
}

// Every point's scalar is an isovalue: a ray that touches one and turns back meets it twice or not at all, else all are met as often
// as the judge says.
TEST(CpuSurfaces, AtTheValuesOfAllPoints) {
    std::mt19937_64 random(31);
    const Scene scene = with_surfaces(scene_of(grid_mesh(6, 0.2, 3), [&](const glm::dvec3&) { return static_cast<double>(random() % 4); }, nothing()),
                             {{0, {1, 1, 1}, 0.1, {}}, {1, {1, 1, 1}, 0.1, {}}, {1.5, {1, 1, 1}, 0.1, {}}, {2, {1, 1, 1}, 0.1, {}}, {3, {1, 1, 1}, 0.1, {}}},
                             Shading::unlit);
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
        const Camera camera = view_of_unit_cube(projection);
        const Image image = cpu().render(scene, camera, small);
        for (const PixelTruth& truth : Reference(scene).picture(camera, small, slack)) {
            if (truth.low.opacity != truth.high.opacity) continue;
            const auto met = [](double opacity) { return std::log1p(-opacity) / std::log(0.9); };
            const double difference = met(image.at(truth.pixel.x, truth.pixel.y).a) - met(truth.light.opacity);
            ASSERT_NEAR(difference, 2 * std::round(difference / 2), 1e-3);
        }
    }
}

TEST(CpuSurfaces, OutsideTheRangeChangeNothing) {
    const Scene scene = scene_of(grid_mesh(5, 0.2), waves, ramp());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image without = cpu().render(scene, camera, small);
    const Image outside = cpu().render(with_surfaces(scene, {{-3}, {1.5}, {1e300}}), camera, small);
    EXPECT_LT(max_difference(without, outside), 1e-6);  // other segments share a vector
    const Image nothing_at_all = cpu().render(with_surfaces(scene_of(grid_mesh(5, 0.2), waves, nothing()), {{-3}, {1.5}}), camera, small);
    for (const glm::vec4& pixel : nothing_at_all.pixels) EXPECT_EQ(pixel, glm::vec4(0));
}

// Without order, and without the cells around: the same picture.
TEST(CpuSurfaces, OpaqueOnesAloneNeedNoOrder) {
    const TetMesh mesh = grid_mesh(sanitized ? 6 : 12, 0.2);
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
        const Camera camera = view_of_unit_cube(projection);
        Statistics fast, whole;
        const Image nearest = cpu().render(with_surfaces(scene_of(mesh, waves, nothing()), opaque(three)), camera, small, {}, &fast);
        const Image ordered = cpu().render(with_surfaces(scene_of(mesh, waves, constant_medium(1e-30)), opaque(three)), camera, small, {}, &whole);
        EXPECT_LT(max_difference(nearest, ordered), 1e-6);
        EXPECT_EQ(fast.order, "none");
        EXPECT_TRUE(fast.order_exact);
        EXPECT_EQ(whole.order, "mpvo");
        EXPECT_LT(fast.counts.drawn, whole.counts.drawn);
    }
}

// Sectors that all lie over one another, and no order of them is right.
TEST(CpuSurfaces, InACyclicMesh) {
    const TetMesh mesh = testing_support::cyclic_ring(7);
    for (const bool medium : {false, true}) {
        const Scene scene = with_surfaces(scene_of(mesh, [](const glm::dvec3& p) { return 0.5 + 0.2 * p.x + 0.3 * p.z; }, medium ? ramp() : nothing()), layers(9, 0.3), Shading::smooth, two_lights);
        const Camera camera = frame_bounds(bounds(mesh.points), Projection::perspective, {0.1, 0.2, 1}, {0, 1, 0}, 1.0);
        for (const bool by_pixel : {false, true}) EXPECT_LT(error_of(scene, camera, small, {.order_per_pixel = by_pixel}), 1e-5) << medium << by_pixel;
    }
}

// Between the two diagonals of a square lies a flat cell, where the scalar jumps from 1 to 0.
TEST(CpuSurfaces, LieInFlatCells) {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}, {0.5, 0.5, -1}};
    mesh.tets = {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 3, 5}, {1, 2, 3, 5}, {0, 1, 2, 3}};
    orient_cells(mesh);
    const ScalarField field{"s", FieldLocation::points, {1, 0, 1, 0, 1, 0}};
    for (const bool medium : {false, true})
        for (const double opacity : {0.3, 1.0})
            for (const bool by_pixel : {false, true}) {
                const Scene scene = with_surfaces(scene_of(mesh, field, medium ? ramp() : nothing()), {{0.5, {1, 0.5, 0}, opacity, {}}}, Shading::unlit);
                EXPECT_LT(error_of(scene, from_above(), {31, 31}, {.order_per_pixel = by_pixel}), 1e-5) << medium << opacity << by_pixel;
            }
}

// Layers of cells as thin as 1e-9 of the mesh, as at walls: float32 cannot tell their points apart, and no pixel may fall through.
TEST(CpuSurfaces, LieInLayersThinnerThanRounding) {
    for (const double thin : {1e-4, 1e-6, 1e-7, 1e-9}) {
        TetMesh mesh = grid_mesh(6, 0.0);
        ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.z; });
        for (glm::dvec3& p : mesh.points) p.z = p.z < 0.5 + 1e-9 ? thin * p.z : 0.5 * p.z + 0.25 * p.x;
        for (const double opacity : {1.0, 0.25})
            for (const Projection projection : {Projection::parallel, Projection::perspective}) {
                const Scene scene = with_surfaces(scene_of(mesh, field, nothing()), {{0.2, {1, 1, 1}, opacity, {}}, {0.3, {1, 1, 1}, opacity, {}}}, Shading::unlit);
                Camera camera = view_of_unit_cube(projection, {0.3, -0.2, 1});
                camera.center = {0.5, 0.5, 0};
                camera.height = camera.height / 3;
                camera.fov_y_degrees /= 3;
                const Image image = cpu().render(scene, camera, small);
                std::size_t wrong = 0;
                for (const glm::vec4& pixel : image.pixels) wrong += !(std::abs(pixel.a - (1 - (1 - opacity) * (1 - opacity))) < 1e-6);
                EXPECT_EQ(wrong, 0U) << thin << " " << opacity;
            }
    }
}

TEST(CpuSurfaces, AtAnyScaleAndFarAway) {
    const TetMesh mesh = grid_mesh(6, 0.2, 6);
    const auto picture = [&](double scale, double offset, double field_scale, bool medium) {
        TetMesh moved = mesh;
        for (glm::dvec3& p : moved.points) p = scale * p + glm::dvec3(offset);
        ScalarField field = point_field(mesh, waves);
        for (double& s : field.values) s *= field_scale;
        std::vector<IsoSurface> list = medium ? three : opaque(three);
        for (IsoSurface& surface : list) surface.value *= field_scale;
        Camera camera = view_of_unit_cube(Projection::perspective);
        camera.eye = scale * camera.eye + glm::dvec3(offset);
        camera.center = scale * camera.center + glm::dvec3(offset);
        return cpu().render(with_surfaces(scene_of(moved, field, medium ? constant_medium(1.3 / scale) : nothing()), list), camera, small);
    };
    for (const bool medium : {false, true}) {
        const Image usual = picture(1, 0, 1, medium);
        for (const double scale : {1e-12, 1e12}) {
            EXPECT_LT(max_difference(picture(scale, 0, 1, medium), usual), 1e-4);
            EXPECT_LT(max_difference(picture(1, 0, scale, medium), usual), 1e-4);
        }
        // Points there are multiples of 1e-10; single pixels at the surface's edges change.
        const Image far_away = picture(1, 1e6, 1, medium);
        std::size_t changed = 0;
        for (std::size_t i = 0; i < usual.pixels.size(); ++i) changed += !(glm::length(far_away.pixels[i] - usual.pixels[i]) < 1e-3F);
        EXPECT_LE(changed, 3U);
    }
}

TEST(CpuSurfaces, AnyNumberOfThreadsGivesTheSameBits) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    for (const bool medium : {false, true})
        for (const bool by_pixels : {false, true}) {
            const Scene scene = with_surfaces(scene_of(grid_mesh(sanitized ? 6 : 12, 0.2), waves, medium ? ramp() : nothing()), medium ? three : opaque(three));
            const Quality quality{.order_per_pixel = by_pixels};
            const Image one = make_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {150, 100}, quality);
            const Image many = make_renderer(Backend::cpu, {.threads = 3})->render(scene, camera, {150, 100}, quality);
            EXPECT_TRUE(one.pixels == many.pixels);
        }
}

TEST(CpuSurfaces, EveryInstructionSetGivesTheSamePicture) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    for (const bool medium : {false, true}) {
        const Scene scene = with_surfaces(scene_of(grid_mesh(6, 0.2), waves, medium ? ramp() : nothing()), medium ? three : opaque(three), Shading::smooth, two_lights);
        const ViewJudge view(Reference(scene), camera, {48, 48}, slack);
        for (const std::string& set : cpu::instruction_sets()) {
            cpu::use_instruction_set(set);
            EXPECT_TRUE(view.within(cpu().render(scene, camera, {48, 48}), 2e-5)) << set;
        }
        cpu::use_instruction_set(cpu::instruction_sets().front());
    }
}

// What is kept from picture to picture belongs to the scene of the last one.
TEST(CpuSurfaces, ChangeBetweenPictures) {
    const Scene bare = scene_of(grid_mesh(5, 0.2), waves, ramp());
    Scene dark = bare;
    dark.transfer = std::make_shared<TransferFunction>(nothing());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const auto renderer = make_renderer(Backend::cpu);
    for (const Scene& scene : {bare, with_surfaces(bare, three), with_surfaces(bare, {{0.4, {1, 0, 0}, 0.5, {}}}, Shading::flat), with_surfaces(dark, opaque(three)),
                               with_surfaces(dark, three, Shading::unlit), dark, with_surfaces(bare, opaque(three)), bare}) {
        const Image fresh = make_renderer(Backend::cpu)->render(scene, camera, small);
        // Neighbours without relation may change places, and with them who shares a vector with whom.
        EXPECT_LT(max_difference(renderer->render(scene, camera, small), fresh), 1e-6);
    }
}

// Regions of 1024 pixels, each with bins of its own.
TEST(CpuSurfaces, AcrossRegionsOfThePicture) {
    Camera camera = view_of_unit_cube(Projection::parallel);
    const ImageSize wide{1200, 24};
    camera.height /= 30;
    for (const bool medium : {false, true}) {
        const Scene scene = with_surfaces(scene_of(grid_mesh(5, 0.2), waves, medium ? ramp() : nothing()), medium ? three : opaque(three));
        const Image image = cpu().render(scene, camera, wide);
        const Reference judge(scene);
        EXPECT_TRUE(ViewJudge(judge, camera, wide, slack, judge.sample(camera, wide, sanitized ? 200 : 2000)).within(image, 1e-5));
    }
}

TEST(CpuSurfaces, CellsOfValuesThatAreNotFiniteAreLeftOut) {
    TetMesh mesh = grid_mesh(5, 0.2);
    ScalarField field = point_field(mesh, waves);
    for (std::size_t i = 3; i < field.values.size(); i += 17) field.values[i] = std::numeric_limits<double>::quiet_NaN();
    for (const bool medium : {false, true}) {
        const Scene scene = with_surfaces(scene_of(mesh, field, medium ? ramp() : nothing()), medium ? three : opaque(three), Shading::flat);
        EXPECT_LT(error_of(scene, view_of_unit_cube(Projection::perspective)), 1e-5);
    }
}

TEST(CpuSurfaces, OfTheBluntFin) {
    const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    TetMesh mesh = tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"}));
    const ScalarField field = select_scalar(mesh, "Density", "bluntfin");
    const Camera camera = frame_bounds(bounds(mesh.points), Projection::perspective, {-0.6, -1.5, 0.9}, {0, 0, 1}, 1);
    std::vector<IsoSurface> twenty;
    for (int i = 1; i <= 20; ++i) twenty.push_back({quantile(field.values, i / 21.0), {1, 0.5, 0}, 0.1, {}});
    const ImageSize size = sanitized ? ImageSize{8, 8} : ImageSize{64, 64};
    const auto expect_within = [&](double bar, const char* what, const Scene& scene) {
        const double error = error_of(scene, camera, size);
        std::printf("blunt fin, %s: largest error %.1e\n", what, error);
        EXPECT_LT(error, bar);
    };
    // Asked for; a surface lost or doubled would be .01 and more.
    expect_within(1e-3, "20 layers", with_surfaces(scene_of(mesh, field, nothing()), twenty, Shading::unlit));
    const std::vector<IsoSurface> few{{1.2, {0.2, 0.5, 1}, 0.4, {}}, {2, {1, 1, 1}, 0.4, {}}, {3.5, {1, 0.2, 0.1}, 0.7, {}}};
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        if (sanitized && shading == Shading::flat) continue;
        expect_within(2e-3, "three in a volume", with_surfaces(scene_of(mesh, field, scenes::ramp(0.19, 5, 20)), few, shading));
        expect_within(2e-3, "three opaque ones", with_surfaces(scene_of(mesh, field, nothing()), opaque(few), shading));
    }
}

}  // namespace
}  // namespace cellproj
