// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in the judge, against closed forms: planes of linear fields, layers, surfaces in a medium, light; and the rule that
// rays meet them exactly as often as they change sides, whatever they run through.
#include "render/judge/ray_surfaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <random>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "classify/segment_integral.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/scalar_field.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/layers.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace ray_surfaces_test {

using namespace testing_support;

constexpr ImageSize small{48, 48};
const glm::dvec3 linear_slope = glm::dvec3(1, 0.5, 0.25) / 1.75;  // of scenes.hpp's `linear`

// The bound that the judge states.
constexpr double stated = 1e-9;

std::shared_ptr<const SurfaceScene> surfaces(std::vector<IsoSurface> list, Shading shading = Shading::unlit,
                                             const Lighting& lighting = {}) {
    return std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), shading, lighting});
}

Scene with(Scene scene, std::shared_ptr<const SurfaceScene> surfaces) {
    scene.surfaces = std::move(surfaces);
    return scene;
}

Camera from_above() {
    return {.projection = Camera::Projection::parallel, .eye = {0.5, 0.5, 9}, .center = {0.5, 0.5, 0}, .up = {0, 1, 0}, .height = 1};
}

// What a ray sees of the unit cube where the scalar is `linear`.
struct CubeRay {
    ScreenTransform::Ray ray;
    Chord chord;
    double s_f, s_b;  // at the chord's ends

    double t_of(double s) const { return chord.enter + (s - s_f) / (s_b - s_f) * chord.length(); }
    bool between(double s) const { return (s_f < s) != (s_b < s); }
    bool doubtful(double s) const { return std::min(std::abs(s - s_f), std::abs(s - s_b)) < 1e-12; }  // by rounding
};

template <class Visit>
int for_rays_through_cube(const Camera& camera, ImageSize size, Visit visit) {
    const ScreenTransform transform(camera, size);
    int visited = 0;
    for (const PixelId& pixel : all_pixels(size)) {
        const auto ray = transform.ray({pixel.x + 0.5, pixel.y + 0.5});
        const Chord chord = chord_in_unit_cube(ray, transform.perspective());
        if (chord.length() < 1e-6) continue;
        const auto at = [&](double t) { return linear(ray.origin + t * ray.direction); };
        visit(pixel, CubeRay{ray, chord, at(chord.enter), at(chord.leave)});
        ++visited;
    }
    return visited;
}

class SurfacesOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(RaySurfaces, SurfacesOfEither, testing_support::either_projection, testing_support::name_of_projection);

// Values among them that many points have (.5), and that none has.
TEST_P(SurfacesOfEither, OfALinearFieldArePlanes) {
    const std::vector<double> values{-0.1, 0.2, 1.0 / 3, 0.5, 0.77, 1.2};
    for (const double jitter : {0.0, 0.2}) {
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            std::vector<IsoSurface> list;
            for (const double v : values)
                list.push_back({v});
            const Scene scene = with(scene_of(grid_mesh(4, jitter, 2), linear, nothing()), surfaces(list, shading));
            const Reference reference(scene);
            const Camera camera = view_of_unit_cube(GetParam(), {2, 0.7, -0.5});
            int met = 0;
            for_rays_through_cube(camera, small, [&](PixelId, const CubeRay& seen) {
                const ViewRay ray = reference.index().ray(seen.ray, GetParam() == Camera::Projection::perspective);
                const double moved = glm::dot(ray.origin + reference.index().middle() - seen.ray.origin, ray.direction);
                const auto hits = reference.surfaces_along(ray);
                for (std::size_t k = 0; k < values.size(); ++k) {
                    if (seen.doubtful(values[k])) continue;
                    const auto hit = std::ranges::find(hits, k, &SurfaceHit::surface);
                    ASSERT_EQ(std::ranges::count(hits, k, &SurfaceHit::surface), seen.between(values[k]));
                    if (hit == hits.end()) continue;
                    ++met;
                    // Rounding of scalars, 1e-16, over the slope along the ray; asked for: 1e-5.
                    const double slope = std::abs(glm::dot(linear_slope, ray.direction));
                    EXPECT_NEAR(hit->t + moved, seen.t_of(values[k]), 1e-14 + 1e-14 / slope);
                    EXPECT_LT(glm::length(reference.gradient_at(*hit) - linear_slope), 1e-13);
                    EXPECT_EQ(hit->rising, seen.s_f < seen.s_b);
                }
                EXPECT_TRUE(std::ranges::is_sorted(hits, {}, &SurfaceHit::t));
            });
            EXPECT_GT(met, 1500);
        }
    }
}

// k layers of opacity a: 1 − (1 − a)^k, on every ray, k told by the scalars at the ends.
TEST_P(SurfacesOfEither, TwentyLayersOfATenth) {
    std::vector<IsoSurface> list;
    for (int i = 0; i < 20; ++i)
        list.push_back({(i + 0.5) / 20, {1, 0.5, 0}, 0.1, {}});
    const Scene scene = with(scene_of(grid_mesh(7, 0.2, 5), linear, nothing()), surfaces(list));
    const Camera camera = view_of_unit_cube(GetParam(), {-2, -0.8, -0.7});
    const auto truths = Reference(scene).picture(camera, small);
    int most = 0, doubtful = 0;
    for_rays_through_cube(camera, small, [&](PixelId pixel, const CubeRay& seen) {
        if (std::ranges::any_of(list, [&](const IsoSurface& s) { return seen.doubtful(s.value); })) {
            ++doubtful;
            return;
        }
        const auto k = static_cast<int>(std::ranges::count_if(list, [&](const IsoSurface& s) { return seen.between(s.value); }));
        const double opacity = 1 - std::pow(0.9, k);
        EXPECT_LT(distance(truths[static_cast<std::size_t>(pixel.x + 48 * pixel.y)].light, {opacity * glm::dvec3(1, 0.5, 0), opacity}),
                  1e-14);
        most = std::max(most, k);
    });
    EXPECT_GT(most, 10);
    EXPECT_EQ(doubtful, 0);
}

// Planes of other colours on both sides, lit, in a medium of constant extinction: Beer's law between, layer over layer.
TEST_P(SurfacesOfEither, PlanesInAConstantMedium) {
    const std::vector<IsoSurface> list{{0.3, {0.2, 0.9, 0.4}, 0.5, {}},
                                       {0.5, {1, 0, 0}, 0.25, glm::dvec3(0, 0, 1)},
                                       {0.75, {0.5, 0.5, 0.5}, 1, {}}};
    const Lighting lighting{.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}};
    constexpr double tau = 1.3;
    const auto medium = [&](double length) {
        const double opacity = -std::expm1(-tau * length);
        return Light{opacity * glm::dvec3(1, 0.5, 0.25), opacity};
    };
    for (const Shading shading : {Shading::flat, Shading::smooth, Shading::unlit}) {
        const Scene scene =
            with(scene_of(grid_mesh(4, 0.2, 3), linear, constant_medium(tau)), surfaces(list, shading, lighting));
        const Reference reference(scene);
        for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(-1, -0.4, 2)}) {
            const Camera camera = view_of_unit_cube(GetParam(), from);
            const auto truths = reference.picture(camera, small);
            for_rays_through_cube(camera, small, [&](PixelId pixel, const CubeRay& seen) {
                const bool rising = seen.s_f < seen.s_b;
                Light expected;
                double behind = seen.chord.enter;
                for (std::size_t i = 0; i < list.size(); ++i) {
                    const IsoSurface& surface = list[rising ? i : list.size() - 1 - i];
                    if (!seen.between(surface.value)) continue;
                    const double t = seen.t_of(surface.value);
                    const glm::dvec3 color = rising || !surface.back_color ? surface.color : *surface.back_color;
                    const glm::dvec3 lit =
                        shading == Shading::unlit ? color : shade(lighting, color, -linear_slope, -seen.ray.direction);
                    expected = composite(expected, medium(t - behind));
                    expected = composite(expected, {surface.opacity * lit, surface.opacity});
                    behind = t;
                }
                expected = composite(expected, medium(seen.chord.leave - behind));
                EXPECT_LT(distance(truths[static_cast<std::size_t>(pixel.x + 48 * pixel.y)].light, expected), stated);
            });
        }
    }
}

// RKE00, appendix: an unshaded isosurface is what a peak of the transfer function becomes as it gets thinner. A peak of area A
// gives the opacity 1 − exp(−A / |∇s·d|); here in a medium, seen in parallel, so that the slope is one number.
TEST(RaySurfaces, AreTheLimitOfPeaks) {
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    const glm::dvec3 along = ScreenTransform(camera, small).ray({24, 24}).direction;
    constexpr double area = 0.4, tau = 0.8, v = 0.45, width = 1e-8;
    constexpr double low = v - width, high = v + width, density = area / (2 * width);
    const TransferFunction peak(
        OpticalModel::density,
        {{low, {1, 0.5, 0.25}}, {low, {0.1, 0.2, 1}}, {high, {0.1, 0.2, 1}}, {high, {1, 0.5, 0.25}}},
        {{low, tau}, {low, density}, {high, density}, {high, tau}});
    const double opacity = -std::expm1(-area / std::abs(glm::dot(linear_slope, along)));
    const auto peaks = Reference(scene_of(grid_mesh(3, 0.2, 4), linear, peak)).picture(camera, small);
    const auto truths = Reference(with(scene_of(grid_mesh(3, 0.2, 4), linear, constant_medium(tau)),
                                       surfaces({{v, {0.1, 0.2, 1}, opacity, {}}})))
                            .picture(camera, small);
    // The medium that the peak takes the place of: 2·width of scalar.
    int compared = 0;
    for_rays_through_cube(camera, small, [&](PixelId pixel, const CubeRay& seen) {
        if (std::min(std::abs(seen.s_f - v), std::abs(seen.s_b - v)) < 2 * width) return;  // cut by the cube's side
        const auto i = static_cast<std::size_t>(pixel.x + 48 * pixel.y);
        EXPECT_LT(distance(peaks[i].light, truths[i].light), 20 * width);
        ++compared;
    });
    EXPECT_GT(compared, 1000);
}

// Where the ray is below and where not, at its ends, tells how often it must pass upwards more than downwards.
void expect_sides_add_up(const Scene& scene, const Camera& camera, ImageSize size) {
    const Reference reference(scene);
    const auto& list = scene.surfaces->isosurfaces.surfaces();
    const double rounding = rounding_along_ray(bounds(scene.mesh->points).diagonal());
    int met = 0;
    for (const PixelId& pixel : all_pixels(size)) {
        const ViewRay ray = reference.index().ray(camera, size, {pixel.x + 0.5, pixel.y + 0.5});
        auto segments = ray_segments(scene, reference.index().cells_along(ray));
        std::erase_if(segments, [&](const RaySegment& segment) { return segment.leave - segment.enter <= rounding; });
        if (segments.empty()) continue;
        std::vector<int> up(list.size()), sides(list.size());
        for (const SurfaceHit& hit : reference.surfaces_along(ray)) {
            up[hit.surface] += hit.rising ? 1 : -1;
            EXPECT_NEAR(std::reduce(hit.weights.begin(), hit.weights.end()), 1, 1e-14);
            EXPECT_TRUE(hit.t >= segments.front().enter && hit.t <= segments.back().leave);
            ++met;
        }
        const double first = segments.front().scalars.front;
        const double last = std::ranges::max_element(segments, {}, &RaySegment::leave)->scalars.back;
        for (std::size_t k = 0; k < list.size(); ++k)
            sides[k] = static_cast<int>(first < list[k].value) - static_cast<int>(last < list[k].value);
        ASSERT_EQ(up, sides) << pixel.x << " " << pixel.y;
        const double opacity = reference.light(ray).opacity;
        ASSERT_TRUE(opacity >= 0 && opacity <= 1);
    }
    EXPECT_GT(met, 100);
}

// Every scalar is an isovalue, and most rays from above run along faces and edges and through points.
TEST(RaySurfaces, ChangeSidesWhateverTheRayRunsThrough) {
    std::mt19937_64 random(31);
    for (int trial = 0; trial < 6; ++trial) {
        const double jitter = trial % 2 ? 0.2 : 0;
        const double scale = std::vector{1.0, 1e-12, 1e12}[static_cast<std::size_t>(trial) / 2];
        Scene scene = scene_of(grid_mesh(6, jitter, random()), [&](const glm::dvec3&) { return scale * static_cast<double>(random() % 4); },
                               nothing());
        scene = with(scene, surfaces({{0, {1, 1, 1}, 0.1, {}}, {scale, {1, 1, 1}, 0.1, {}}, {2 * scale, {1, 1, 1}, 0.1, {}},
                                      {1.5 * scale, {1, 1, 1}, 0.1, {}}, {3 * scale, {1, 1, 1}, 0.1, {}}}));
        expect_sides_add_up(scene, from_above(), {24, 24});  // pixel centres on 1/48, 3/48, …: symmetry planes of the boxes
        expect_sides_add_up(scene, from_above(), {23, 23});
        expect_sides_add_up(scene, view_of_unit_cube(Camera::Projection::perspective, {1, 1, 1}), {25, 25});
        expect_sides_add_up(scene, view_of_unit_cube(Camera::Projection::parallel), {24, 24});
    }
}

// The count itself, not only the difference: planes of a linear field seen along edges and faces of a regular grid, at scalars
// that its points have and others.
TEST(RaySurfaces, AreMetOnceAlsoAlongEdgesAndFaces) {
    std::vector<IsoSurface> list;
    for (int i = 1; i < 24; ++i)
        list.push_back({i / 24.0, {1, 1, 1}, 0.1, {}});
    const auto f = [](const glm::dvec3& p) { return 0.5 * (p.z + 1.0 / 16 * p.x); };  // 0 .. 17/32
    const Reference reference(with(scene_of(grid_mesh(6), f, nothing()), surfaces(list)));
    for (const int side : {24, 23, 36}) {
        for (const PixelId& pixel : all_pixels({side, side})) {
            const auto hits = reference.surfaces_along(reference.index().ray(from_above(), {side, side}, {pixel.x + 0.5, pixel.y + 0.5}));
            const double x = (pixel.x + 0.5) / side, low = x / 32, high = low + 0.5;
            for (std::size_t k = 0; k < list.size(); ++k) {
                const double v = list[k].value;
                if (std::min(std::abs(v - low), std::abs(v - high)) < 1e-12) continue;  // by rounding
                ASSERT_EQ(std::ranges::count(hits, k, &SurfaceHit::surface), low < v && v < high) << pixel.x << " " << pixel.y << " " << v;
            }
        }
    }
}

// 20 surfaces of opacity .1 through 187,395 cells of a real flow: k of them, 1 − .9^k.
TEST(RaySurfaces, OfTheBluntFinAddUp) {
    const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    TetMesh mesh = tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"}));
    const ScalarField field = select_scalar(mesh, "Density", "bluntfin");
    std::vector<IsoSurface> list;
    for (int i = 1; i <= 20; ++i)
        list.push_back({quantile(field.values, i / 21.0), {1, 0.5, 0}, 0.1, {}});
    const Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::perspective, {-0.6, -1.5, 0.9}, {0, 0, 1}, 1);
    const Scene scene = with(scene_of(std::move(mesh), field, nothing()), surfaces(list));
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{16, 16} : ImageSize{64, 64};
    expect_sides_add_up(scene, camera, size);
    const Reference reference(scene);
    std::size_t most = 0;
    for (const PixelId& pixel : all_pixels(size)) {
        const ViewRay ray = reference.index().ray(camera, size, {pixel.x + 0.5, pixel.y + 0.5});
        const std::size_t k = reference.surfaces_along(ray).size();
        EXPECT_NEAR(reference.light(ray).opacity, 1 - std::pow(0.9, k), 1e-14);
        most = std::max(most, k);
    }
    EXPECT_GE(most, 15U);
}

// Between the two diagonals of a square lies a flat cell, which rays cross with no length: the scalar jumps, its surface is there.
TEST(RaySurfaces, LieInFlatCells) {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}, {0.5, 0.5, -1}};
    mesh.tets = {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 3, 5}, {1, 2, 3, 5}, {0, 1, 2, 3}};
    orient_cells(mesh);
    const ScalarField field{"s", FieldLocation::points, {1, 0, 1, 0, 1, 0}};
    const Scene scene = with(scene_of(mesh, field, nothing()), surfaces({{0.5}}, Shading::flat));
    expect_sides_add_up(scene, from_above(), {31, 31});
    // Through the middle: 1 from the top down to the first diagonal, 0 below the other.
    const Reference reference(scene);
    const auto hits = reference.surfaces_along(reference.index().ray(from_above(), {31, 31}, {15.5, 15.5}));
    ASSERT_EQ(hits.size(), 1U);
    EXPECT_FALSE(hits[0].rising);
    EXPECT_NE(hits[0].cell, 4U);
    EXPECT_NEAR(hits[0].t, 0, 1e-15);  // z = 0, the middle of the mesh
}

// Over a hole in the mesh nothing is known, and no surface is put there.
TEST(RaySurfaces, DoNotCloseHoles) {
    TetMesh mesh = stacked_cells(3);
    mesh.tets.erase(mesh.tets.begin() + 1);
    const ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.z < 0.5 ? 0.0 : 1.0; });
    const Reference reference(with(scene_of(mesh, field, nothing()), surfaces({{0.5}})));
    EXPECT_TRUE(reference.surfaces_along(reference.index().ray(view_along_z(), {31, 31}, {15.5, 15.5})).empty());
}

TEST(RaySurfaces, AtAWholeCellsValueAreItsBorderToWhatIsBelow) {
    const auto hits_of = [](double (*f)(const glm::dvec3&)) {
        const Reference reference(with(scene_of(grid_mesh(4), f, nothing()), surfaces({{0.5}})));
        std::vector<SurfaceHit> all;
        for (const PixelId& pixel : all_pixels({16, 16})) {
            const auto hits = reference.surfaces_along(reference.index().ray(from_above(), {16, 16}, {pixel.x + 0.5, pixel.y + 0.5}));
            all.insert(all.end(), hits.begin(), hits.end());
        }
        return all;
    };
    // Two layers of boxes at .5, below them less: one hit per ray, on the face between (z = .5, the mesh's middle).
    const auto below = hits_of([](const glm::dvec3& p) { return std::min(p.z, 0.5); });
    EXPECT_EQ(below.size(), 256U);
    for (const SurfaceHit& hit : below)
        EXPECT_EQ(hit.t, 0);
    // More above them: none. A face of that value, passed: one. A layer of its own in what is less: its two sides.
    EXPECT_TRUE(hits_of([](const glm::dvec3& p) { return std::max(p.z, 0.5); }).empty());
    EXPECT_EQ(hits_of([](const glm::dvec3& p) { return p.z; }).size(), 256U);
    EXPECT_EQ(hits_of([](const glm::dvec3& p) { return p.z == 0.5 || p.z == 0.25 ? 0.5 : 0.0; }).size(), 512U);
}

TEST(RaySurfaces, KeepTheirPlaceAtAnyScaleAndFarAway) {
    for (const auto& place_of_mesh : {std::pair(1e-12, 0.0), {1e12, 0.0}, {1.0, 1e6}}) {
        const double scale = place_of_mesh.first, offset = place_of_mesh.second;
        TetMesh mesh = grid_mesh(5, 0.2, 6);
        for (glm::dvec3& p : mesh.points)
            p = scale * p + glm::dvec3(offset);
        const glm::dvec3 middle(0.5 * scale + offset);
        const Scene scene = with(scene_of(std::move(mesh), [&](const glm::dvec3& p) { return (p.z - offset) / scale; }, nothing()),
                                 surfaces({{0.4}}, Shading::smooth));
        const Camera camera{.projection = Camera::Projection::parallel,
                            .eye = middle + glm::dvec3(scale),
                            .center = middle,
                            .up = {0, 1, 0},
                            .height = 0.4 * scale};
        const Reference reference(scene);
        for (const PixelId& pixel : all_pixels({16, 16})) {
            const ViewRay ray = reference.index().ray(camera, {16, 16}, {pixel.x + 0.5, pixel.y + 0.5});
            const auto hits = reference.surfaces_along(ray);
            ASSERT_EQ(hits.size(), 1U);
            const glm::dvec3 place = ray.origin + hits[0].t * ray.direction + reference.index().middle();
            // At 1e6 points are multiples of 1e-10.
            EXPECT_NEAR((place.z - offset) / scale, 0.4, offset > 0 ? 1e-9 : 1e-14);
            EXPECT_LT(glm::length(glm::normalize(reference.gradient_at(hits[0])) - glm::dvec3(0, 0, 1)), 1e-12);
        }
    }
}

// |p − c|² = r²: the interpolated field is off by at most h²·3/4 (curvature 2 over a cell of diagonal √3 h, /8), its surface by that
// over the slope 2r; normals to first order at worst.
TEST(RaySurfaces, OfAQuadraticFieldConvergeToTheSphere) {
    const glm::dvec3 c(0.5);
    constexpr double r = 0.4;
    double coarse = 0;
    for (const int n : {8, 16}) {
        const Scene scene = with(scene_of(grid_mesh(n, 0.1, 7), [&](const glm::dvec3& p) { return glm::dot(p - c, p - c); }, nothing()),
                                 surfaces({{r * r}}, Shading::smooth));
        const Reference reference(scene);
        const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
        double normal = 0;
        int met = 0;
        for (const PixelId& pixel : all_pixels(small)) {
            const ViewRay ray = reference.index().ray(camera, small, {pixel.x + 0.5, pixel.y + 0.5});
            for (const SurfaceHit& hit : reference.surfaces_along(ray)) {
                const glm::dvec3 p = ray.origin + hit.t * ray.direction;
                EXPECT_LT(std::abs(glm::length(p) - r), 0.75 * 1.4 * 1.4 / (n * n) / (2 * r) * 1.1);  // jittered edges: to 1.4 h
                normal = std::max(normal, glm::length(glm::normalize(reference.gradient_at(hit)) - p / glm::length(p)));
                ++met;
            }
        }
        EXPECT_GT(met, 500);
        EXPECT_LT(normal, 1.0 / n);
        if (coarse > 0) {
            EXPECT_LT(normal, 0.7 * coarse);
        }
        coarse = normal;
    }
}

TEST(RaySurfaces, OutsideTheRangeChangeNothing) {
    const Scene scene = scene_of(grid_mesh(4), linear, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const auto plain = Reference(scene).picture(camera, small);
    const auto none = Reference(with(scene, surfaces({{-1}, {1.5}}))).picture(camera, small);
    for (std::size_t i = 0; i < plain.size(); ++i)
        EXPECT_EQ(distance(plain[i].light, none[i].light), 0);
}

TEST(RaySurfaces, HideWhatIsBehind) {
    RayLight light(*std::make_shared<TransferFunction>(ramp()));
    light.add(Light{glm::dvec3(0.5), 0.5});
    light.add(Light{glm::dvec3(0.25, 0, 1), 1});
    EXPECT_TRUE(light.opaque());
    light.add(Light{glm::dvec3(9), 0.5});
    light.add(std::vector<ScalarEnds>{{0.5, 0.5}}, 1);
    EXPECT_LT(distance(light.light(), {{0.625, 0.5, 1}, 1}), 1e-15);
}

ErrorKind kind_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::file;
}

TEST(RaySurfaces, AreRefusedWhereTheyCannotBe) {
    const TetMesh mesh = grid_mesh(1);
    const ScalarField on_cells{"c", FieldLocation::cells, std::vector<double>(mesh.tets.size(), 1.0)};
    const Scene cells = with(scene_of(mesh, on_cells, nothing()), surfaces({{0.5}}));
    EXPECT_EQ(kind_of([&] { Reference reference(cells); }), ErrorKind::option);
    const Scene bad_light = with(scene_of(mesh, linear, nothing()),
                                 surfaces({{0.5}}, Shading::smooth, {.lights = {{.towards = glm::dvec3(0)}}}));
    EXPECT_EQ(kind_of([&] { Reference reference(bad_light); }), ErrorKind::option);
    // No surfaces: no question.
    EXPECT_NO_THROW(Reference(with(scene_of(mesh, on_cells, nothing()), surfaces({}))));
}

}  // namespace
}  // namespace cellproj
