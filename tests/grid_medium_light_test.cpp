// SPDX-License-Identifier: BSD-3-Clause
//
// Media of regular grids that are lit by their gradient (SurfaceScene::lit_medium): the judge against closed forms and the judge of meshes,
// and the CPU backend against the judge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/cpu/kernels.hpp"
#include "render/grid_renderer.hpp"
#include "render/judge/cubic_light.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/lit_grids.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace grid_medium_light_test {

using namespace testing_support;
using scenes::waves;

using Projection = Camera::Projection;
using Ray = ScreenTransform::Ray;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{20, 16} : ImageSize{48, 40}, few{20, 16};

GridReference unlit_judge(const GridScene& scene) { return {scene.grid, scene.transfer}; }

// ---- The judge: one segment

Light lit_segment(const TransferFunction& transfer, const Cubic& scalar, double length, const ShareEnds& shares) {
    CubicLight light(transfer);
    light.add(scalar, length, shares);
    return light.light();
}

// Of a homogeneous medium, light comes from 1/D − 1/(e^D − 1) of the way in the mean, whether its scalar moves or not.
TEST(GridMediumLight, OfAHomogeneousSegmentIsAClosedForm) {
    const ShareEnds shares{{0.2, 1, 0.5}, {1.5, 0, 0.5}};
    for (const double depth : {1e-9, 1e-3, 0.1, 0.4999, 0.5001, 1.0, 5.0, 60.0, 1e4}) {
        for (const Cubic& scalar : {Cubic{{0.3, 0.3, 0.3, 0.3}}, Cubic{{0.3, 0.9, -0.2, 0.4}}}) {
            const Light found = lit_segment(constant_medium(depth), scalar, 1, shares);
            // In long double the difference of large numbers is right where it matters.
            const long double d = depth;
            const double opacity = -std::expm1(-depth), place = depth < 0.01 ? 0.5 - depth / 12 : static_cast<double>(1 / d - 1 / std::expm1(d));
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(found.color[k], opacity * glm::dvec3(1, 0.5, 0.25)[k] * glm::mix(shares.front, shares.back, place)[k], 1e-12) << depth;
            EXPECT_NEAR(found.opacity, opacity, 1e-15);
        }
    }
}

// Any function and any cubic, cut anywhere: the same light; and a plain sum over 2²⁰ midpoints.
TEST(GridMediumLight, OfPiecesIsThatOfTheWholeAndARiemannSum) {
    const TransferFunction transfer(OpticalModel::density, {{0.1, {1, 0, 0.3}}, {0.4, {0, 1, 0.2}}, {0.9, {0.5, 0.5, 1}}},
                                    {{0.0, 0.1}, {0.3, 5.0}, {0.35, 0.0}, {0.5, 0.0}, {0.8, 3.0}});
    const Cubic scalar{{0.05, 1.4, -0.6, 0.95}};
    const ShareEnds shares{{0.2, 1, 0.5}, {1.5, 0, 0.7}};
    const double length = 1.3;
    const Light whole = lit_segment(transfer, scalar, length, shares);
    CubicLight pieces(transfer);
    const std::vector<double> cuts{0, 0.2, 0.21, 0.7, 1};
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        pieces.add(scalar.part(cuts[i], cuts[i + 1]), length * (cuts[i + 1] - cuts[i]), shares.part(cuts[i], cuts[i + 1]));
    EXPECT_LT(distance(pieces.light(), whole), 1e-12);
    constexpr int n = 1 << 20;
    Light sum{};
    double depth = 0;
    for (int i = 0; i < n; ++i) {
        const double t = (i + 0.5) / n, s = scalar.at(t), tau = transfer.extinction(s);
        sum.color += glm::mix(shares.front, shares.back, t) * transfer.emission(s) * std::exp(-depth - 0.5 * tau * length / n) * (length / n);
        depth += tau * length / n;
    }
    sum.opacity = -std::expm1(-depth);
    EXPECT_LT(distance(whole, sum), 1e-9);  // h² from each kink, of which the turning scalar meets many
}

// ---- The judge: rays and pictures

class GridMediumLightOfEither : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(GridMediumLight, GridMediumLightOfEither, either_projection, name_of_projection);

double largest_difference(const std::vector<PixelTruth>& a, const std::vector<PixelTruth>& b) {
    double most = a.size() == b.size() ? 0 : 1e9;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, distance(a[i].light, b[i].light));
    return most;
}

// s = xyz in one cell, seen along z: its gradient at (x, y, z) is (yz, xz, xy), and its points' are those of the edges there are.
TEST(GridMediumLight, OfATrilinearFieldIsAClosedForm) {
    const auto product = [](const glm::dvec3& p) { return p.x * p.y * p.z; };
    const glm::dvec3 to_eye(0, 0, 1);
    const double depth = 1.7, x = 0.3, y = 0.8, per_weak = std::sqrt(3.0) / 2 / weak_gradient;
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        // With one cell differences at the points are one-sided: the same as in the cell.
        const Light found = judge(lit(unit_cube(1, product), constant_medium(depth), shading)).light({{x, y, 5}, {0, 0, -1}}, true);
        const glm::dvec3 front = lit_share(two_lights, per_weak * glm::dvec3(y, x, x * y), to_eye), back = lit_share(two_lights, per_weak * glm::dvec3(0, 0, x * y), to_eye);
        const double opacity = -std::expm1(-depth), place = 1 / depth - 1 / std::expm1(depth);
        EXPECT_GT(glm::length(front - back), 0.1);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(found.color[k], opacity * glm::dvec3(1, 0.5, 0.25)[k] * glm::mix(front, back, place)[k], 1e-12);
    }
    // An eye in the cell: from there on.
    const Light inside = judge(lit(unit_cube(1, product), constant_medium(depth), Shading::flat)).light({{x, y, 0.5}, {0, 0, -1}}, true);
    const glm::dvec3 front = lit_share(two_lights, per_weak * glm::dvec3(y / 2, x / 2, x * y), to_eye), back = lit_share(two_lights, per_weak * glm::dvec3(0, 0, x * y), to_eye);
    const double half = depth / 2, place = 1 / half - 1 / std::expm1(half);
    EXPECT_NEAR(inside.color[0], -std::expm1(-half) * glm::mix(front, back, place)[0], 1e-12);
}

// One gradient everywhere: the unlit picture times what the lights make of it in each pixel's direction.
TEST_P(GridMediumLightOfEither, OfALinearFieldIsTheUnlitPictureTimesAShare) {
    const glm::dvec3 slope(1, 0.5, 0.25);
    const Camera camera = view_of_unit_cube(GetParam());
    const ScreenTransform transform(camera, few);
    std::mt19937_64 random(601);
    for (const bool uneven : {false, true})
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            GridAxis axis = uniform_axis(0, 0.25, 5);
            if (uneven) axis.coordinates = {0, 0.1, 0.45, 0.5, 1}, axis.spacing.reset();
            const GridScene scene = lit(grid_of({axis, uniform_axis(0, 0.2, 6), axis}, linear), ramp(), shading);
            const auto found = judge(scene).pixels(camera, few, all_pixels(few)), plain = unlit_judge(scene).pixels(camera, few, all_pixels(few));
            double brightest = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                const Ray ray = transform.ray({found[i].pixel.x + 0.5, found[i].pixel.y + 0.5});
                const glm::dvec3 expected = plain[i].light.color * lit_share(two_lights, slope / (1.75 * weak_gradient) * (std::sqrt(3.0) / 2), -ray.direction);
                ASSERT_LT(glm::length(found[i].light.color - expected), 1e-10);
                ASSERT_EQ(found[i].light.opacity, plain[i].light.opacity);
                brightest = std::max(brightest, expected.r);
            }
            EXPECT_GT(brightest, 0.1);
        }
}

// The same by the judge of meshes, with surfaces in the medium.
TEST_P(GridMediumLightOfEither, OfALinearFieldIsThatOfTheTetrahedra) {
    const Camera camera = view_of_unit_cube(GetParam());
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const GridScene scene = lit(unit_cube(5, linear), ramp(), shading, two_lights, glass);
        Scene mesh = scene_of(grid_mesh(5), linear, ramp());
        mesh.surfaces = scene.surfaces;
        EXPECT_LT(largest_difference(judge(scene).pixels(camera, few, all_pixels(few)), Reference(mesh).picture(camera, few)), 1e-8);
    }
}

// Each light adds its own, and ambient light its share.
TEST_P(GridMediumLightOfEither, OfSeveralLightsIsTheirSum) {
    const Camera camera = view_of_unit_cube(GetParam());
    std::mt19937_64 random(602);
    std::uniform_real_distribution<double> unit(0, 1);
    const Grid grid = unit_cube(4, [&](const glm::dvec3&) { return unit(random); });
    const auto picture = [&](Shading shading, std::vector<DirectionalLight> lights) {
        return judge(lit(grid, ramp(), shading, {.ambient = two_lights.ambient, .lights = std::move(lights)})).pixels(camera, few, all_pixels(few));
    };
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const auto& lights = two_lights.lights;
        const auto both = picture(shading, lights), first = picture(shading, {lights[0]}), second = picture(shading, {lights[1]}), none = picture(shading, {});
        for (std::size_t i = 0; i < both.size(); ++i)
            ASSERT_LT(glm::length(both[i].light.color + none[i].light.color - first[i].light.color - second[i].light.color), 1e-12);
    }
}

// A field that is trilinear in the whole cube has the same scalar on any number of cells; what changes with them is that shares are linear in
// each. They tend to the light that the share at every place sends, summed here along the rays from the field's own gradient: a quarter of the
// error with cells of half the size.
TEST_P(GridMediumLightOfEither, TendsToTheShareAtEveryPlace) {
    const auto field = [](const glm::dvec3& p) { return (1 + p.x) * (1 + p.y) * (1 + p.z) / 8; };
    const double tau = 2, per_weak = std::sqrt(3.0) / 2 / (7.0 / 8) / weak_gradient;
    // Eye and lights where all gradients point to: nothing turns its other side, or into shadow, inside a cell.
    const Lighting facing{.ambient = {0.1, 0.2, 0.05}, .lights = {{.towards = glm::dvec3(1, 2, 2), .color = {1, 0.8, 0.6}}, {.diffuse = 0.3, .specular = 0.5}}};
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, 2.1, 0.9});
    const ScreenTransform transform(camera, few);
    const auto truth = [&](const Ray& ray) {
        const Chord chord = chord_in_unit_cube(ray, transform.perspective());
        constexpr int n = 500;  // midpoints: within 1e-6
        glm::dvec3 sum(0.0);
        const double step = chord.length() / n;
        for (int i = 0; i < n; ++i) {
            const double way = (i + 0.5) * step;
            const glm::dvec3 p = 1.0 + ray.origin + (chord.enter + way) * ray.direction;
            sum += lit_share(facing, per_weak * glm::dvec3(p.y * p.z, p.x * p.z, p.x * p.y) / 8.0, -ray.direction) * (tau * step * std::exp(-tau * way));
        }
        return sum * glm::dvec3(1, 0.5, 0.25);
    };
    std::vector<glm::dvec3> truths;
    for (const PixelId& pixel : all_pixels(few)) truths.push_back(truth(transform.ray({pixel.x + 0.5, pixel.y + 0.5})));
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const auto error = [&](std::size_t n) {
            const auto found = judge(lit(unit_cube(n, field), constant_medium(tau), shading, facing)).pixels(camera, few, all_pixels(few));
            double most = 0;
            for (std::size_t i = 0; i < found.size(); ++i) most = std::max(most, glm::length(found[i].light.color - truths[i]));
            return most;
        };
        const double coarse = error(4), fine = error(8), finest = error(16);
        std::printf("[ MEASURED ] linear in a cell against everywhere: %.1e, %.1e, %.1e\n", coarse, fine, finest);
        EXPECT_LT(fine, coarse / 3);
        EXPECT_LT(finest, fine / 3);
    }
}

// A field on cells has no gradient; unlit shading lights nothing.
TEST(GridMediumLight, OfWhatHasNoGradient) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const GridScene plateau = lit(unit_cube(3, [](const glm::dvec3&) { return 0.5; }), constant_medium(2), Shading::smooth);
    EXPECT_EQ(largest_difference(judge(plateau).pixels(camera, few, all_pixels(few)), unlit_judge(plateau).pixels(camera, few, all_pixels(few))), 0);
    const GridScene unlit = lit(unit_cube(3, waves), constant_medium(2), Shading::unlit);
    EXPECT_EQ(largest_difference(judge(unlit).pixels(camera, few, all_pixels(few)), unlit_judge(unlit).pixels(camera, few, all_pixels(few))), 0);
    Grid cells = unit_cube(3, waves);
    cells.location = FieldLocation::cells;
    cells.values.resize(cells.cell_count());
    EXPECT_THROW(judge(lit(cells, ramp(), Shading::flat)), Error);
    EXPECT_NO_THROW(judge(lit(cells, ramp(), Shading::unlit)));
    Lighting bad;
    bad.exponent = 0;
    EXPECT_THROW(judge(lit(unit_cube(3, waves), ramp(), Shading::flat, bad)), Error);
}

// ---- The CPU backend

GridRenderer& cpu() {
    static const auto shared = make_grid_renderer(Backend::cpu);
    return *shared;
}

GridQuality by(const std::string& method) { return {.method = parse_method(method)}; }

double error_of(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {}, double tolerance = 1e-5) {
    return error_against_judge(cpu().render(scene, camera, size, quality), scene, camera, tolerance);
}

// Homogeneous media are exact in the stated model; what is left is float32. Noise: gradients turn from cell to cell. Even and uneven axes, blanked
// cells, surfaces in the medium.
TEST_P(GridMediumLightOfEither, AgreesWithTheJudge) {
    std::mt19937_64 random(603);
    double most[2]{};
    for (int trial = 0; trial < (sanitized ? 6 : 16); ++trial) {
        const auto [scene, camera, surfaces] = lit_noise(trial, GetParam(), random);
        const double error = error_of(scene, camera, few, {}, surfaces ? 2e-4 : 1e-5);
        EXPECT_LT(error, surfaces ? 2e-4 : 1e-5) << trial;  // of surfaces' normals: grid_surfaces_test
        most[surfaces ? 1 : 0] = std::max(most[surfaces ? 1 : 0], error);
    }
    std::printf("[ MEASURED ] noise, homogeneous: %.1e; with surfaces %.1e\n", most[0], most[1]);
}

// The same of every number of lines in a cell, and of light that nothing absorbs.
TEST_P(GridMediumLightOfEither, AgreesByEveryMethod) {
    const Camera camera = view_of_unit_cube(GetParam());
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.1, 0.2, 0.4}}}, {{0, 0}});
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        // Two steps of one height: a constant that exact takes for a function, and cuts cells.
        const TransferFunction cut(OpticalModel::density, {{0, {1.0, 0.5, 0.25}}}, {{0, 2}, {0.5, 2.001}, {1, 2}});
        for (const char* method : {"integral", "exact:1e-5", "linear:8", "homogeneous", "preint2d-exp:256", "preint3d:64"}) {
            const GridScene scene = lit(unit_cube(6, waves), method[0] == 'e' ? cut : constant_medium(2), shading, two_lights, glass);
            // Steps of preint3d in depth; the function that exact walks through is not quite constant.
            const double bound = method == std::string("preint3d:64") ? 2e-3 : method == std::string("exact:1e-5") ? 5e-4 : 2e-4;
            EXPECT_LT(error_of(scene, camera, few, by(method), bound), bound) << method;
        }
        EXPECT_LT(error_of(lit(unit_cube(6, waves), glow, shading), camera, few), 1e-5);
        // One gradient everywhere: whatever a method makes of the medium, times one share in a parallel view.
        const GridScene scene = lit(unit_cube(6, linear), ramp(), shading);
        const Camera parallel = view_of_unit_cube(Projection::parallel);
        const glm::dvec3 to_eye = glm::normalize(parallel.eye - parallel.center);
        const glm::dvec4 share(lit_share(two_lights, glm::dvec3(1, 0.5, 0.25) / (1.75 * weak_gradient) * (std::sqrt(3.0) / 2), to_eye), 1);
        for (const char* method : {"integral", "exact:1e-5", "linear:8", "homogeneous", "average", "preint2d-exp:256", "preint3d:64"}) {
            const Image found = cpu().render(scene, parallel, few, by(method)), plain = cpu().render({scene.grid, scene.transfer}, parallel, few, by(method));
            for (std::size_t i = 0; i < found.pixels.size(); ++i)
                ASSERT_LT(max_difference(glm::dvec4(found.pixels[i]), share * glm::dvec4(plain.pixels[i])), 1e-5) << method;
        }
    }
}

// Where colour and extinction change inside a cell, the place of a segment's light is that of a homogeneous one: second order in its size.
// Cutting cells into lines makes it that of shorter ones.
TEST_P(GridMediumLightOfEither, OfARampErrsBySecondOrder) {
    const Camera camera = view_of_unit_cube(GetParam());
    std::vector<double> rms;
    for (const std::size_t n : {4U, 8U, 16U}) {
        const GridScene scene = lit(unit_cube(n, waves), ramp(), Shading::smooth);
        const auto truths = judge(scene).pixels(camera, small, all_pixels(small));
        const ImageError lines = compare(cpu().render(scene, camera, small), truths), exact = compare(cpu().render(scene, camera, small, by("exact:1e-5")), truths);
        std::printf("[ MEASURED ] ramp, %zu³ cells: integral rms %.1e, largest %.1e; exact:1e-5 %.1e, %.1e\n", n, lines.color.rms, lines.color.maximum, exact.color.rms, exact.color.maximum);
        rms.push_back(lines.color.rms);
        EXPECT_LT(exact.color.rms, lines.color.rms);
    }
    EXPECT_LT(rms[1], rms[0] / 2.5);
    EXPECT_LT(rms[2], rms[1] / 2.5);
    // Along an axis the scalar is linear and needs no lines, but light goes on growing where the share changes.
    const Camera along = view_of_unit_cube(GetParam(), {0, -1, 0});
    for (const auto& [method, bound] : {std::pair("exact:1e-3", 2e-4), std::pair("exact:1e-5", 1e-5)})
        EXPECT_LT(error_of(lit(unit_cube(8, waves), ramp(), Shading::smooth), along, small, by(method), bound), bound) << method;
}

// Bricks that show nothing are leapt over; what rays send where they come out is found anew.
TEST_P(GridMediumLightOfEither, GoesOnBehindEmptySpace) {
    const auto blobs = [](const glm::dvec3& p) {
        return std::exp(-80 * glm::dot(p - glm::dvec3(0.2, 0.3, 0.3), p - glm::dvec3(0.2, 0.3, 0.3))) + std::exp(-60 * glm::dot(p - glm::dvec3(0.8, 0.7, 0.6), p - glm::dvec3(0.8, 0.7, 0.6)));
    };
    // Steps: homogeneous where there is anything.
    const TransferFunction shells(OpticalModel::density, {{0, {1, 0.5, 0.25}}}, {{0, 0}, {0.25, 0}, {0.25, 8}, {1, 8}});
    const Camera camera = view_of_unit_cube(GetParam());
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const GridScene scene = lit(unit_cube(32, blobs), shells, shading);
        Statistics statistics;
        cpu().render(scene, camera, few, by("exact:1e-5"), &statistics);
        EXPECT_GT(statistics.counts.culled, statistics.counts.cells / 2);
        // Where a step lies in a cell, its light is not in the middle of what the cell shows: a share's change over the cell, at most.
        EXPECT_LT(error_of(scene, camera, few, by("exact:1e-5"), 2e-3), 2e-3);
    }
}

// Of rays that begin or end in cells, shares are those of the gradients there. So a grid that is cut looks as the part that is left, whose cells
// end there: of a field that is trilinear in the whole, gradients of cells and points are the same in both.
TEST_P(GridMediumLightOfEither, GoesOnThroughCuts) {
    const auto field = [](const glm::dvec3& p) { return (1 + p.x) * (1 + p.y) * (1 + p.z) / 8; };
    const Camera camera = view_of_unit_cube(GetParam());
    GridAxis rest = uniform_axis(0, 0.2, 6);
    rest.coordinates = {0.27, 0.4, 0.6, 0.8, 1};
    rest.spacing.reset();
    const GridAxis whole = uniform_axis(0, 0.2, 6);
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        GridScene scene = lit(grid_of({whole, whole, whole}, field), constant_medium(2), shading, two_lights, glass);
        scene.clip = std::make_shared<ClipRegion>(ClipRegion{.half_spaces = {{.point = {0.27, 0, 0}, .normal = {1, 0, 0}}}});
        const Image cut = cpu().render(scene, camera, small);
        const GridReference part = judge(lit(grid_of({rest, whole, whole}, field), constant_medium(2), shading, two_lights, glass));
        // Range and size of the part are other units of weak gradients: 1e-6 of the light.
        EXPECT_LT(largest(compare(cut, part.pixels(camera, small, all_pixels(small), 1e-3))), 5e-5) << static_cast<int>(shading);
    }
    Camera inside = view_of_unit_cube(Projection::perspective);
    inside.eye = {0.31, 0.42, 0.53};
    inside.center = {0.9, 0.8, 0.6};
    inside.fov_y_degrees = 70;
    for (const Shading shading : {Shading::flat, Shading::smooth})
        EXPECT_LT(error_of(lit(unit_cube(5, waves), constant_medium(2), shading), inside, few), 1e-5);
}

// Oblique planes and bodies: a linear field is that of the tetrahedra.
TEST_P(GridMediumLightOfEither, OfALinearFieldIsCutAsTetrahedra) {
    const Camera camera = view_of_unit_cube(GetParam());
    GridScene scene = lit(unit_cube(5, linear), constant_medium(2), Shading::smooth, two_lights, glass);
    scene.clip = std::make_shared<ClipRegion>(ClipRegion{.half_spaces = {{.point = glm::dvec3(0.5), .normal = {1, 0.3, -0.2}}}});
    Scene mesh = scene_of(grid_mesh(5), linear, constant_medium(2));
    mesh.surfaces = scene.surfaces;
    mesh.clip = scene.clip;
    EXPECT_LT(largest(compare(cpu().render(scene, camera, small), Reference(mesh).picture(camera, small, 1e-3))), 2e-5);
}

// The side of higher scalars is lit like that of lower ones, or by ambient light alone.
TEST_P(GridMediumLightOfEither, HasTwoSidesOrOne) {
    const Camera from_low = view_of_unit_cube(GetParam(), {-5, -2, -1});
    const auto reversed = [](const glm::dvec3& p) { return 1 - linear(p); };
    Lighting lighting;  // a headlight
    lighting.ambient = glm::dvec3(0.1, 0.2, 0.3);
    const auto picture = [&](const auto& field) { return cpu().render(lit(unit_cube(4, field), constant_medium(2), Shading::flat, lighting), from_low, few); };
    EXPECT_LT(max_difference(picture(linear), picture(reversed)), 1e-5);
    lighting.two_sided = false;
    const glm::vec4 center = picture(reversed).at(few.width / 2, few.height / 2);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(center[k], center.a * glm::dvec3(1, 0.5, 0.25)[k] * lighting.ambient[k], 1e-5);
}

// Constant fields, sizes, places and ranges of any magnitude, cells of 1e-12 of the grid and thinner than float32 has widths for: finite, and
// opacity as without light. By every instruction set in turn: what the least and the largest of something that is no number is differs among them.
TEST(GridMediumLight, ExtremesStayFinite) {
    std::mt19937_64 random(604);
    std::uniform_real_distribution<double> unit(-1, 1);
    const std::string best = cpu::instruction_set();
    const std::vector<std::string> sets = cpu::instruction_sets();
    for (int trial = 0; trial < (sanitized ? 40 : 150); ++trial) {
        cpu::use_instruction_set(sets[static_cast<std::size_t>(trial / 12) % sets.size()]);
        const double range = std::pow(10, 20 * unit(random));
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes) axis = uniform_axis(1e6 * (trial % 2), std::pow(10, 3 * unit(random)), 2 + random() % 9);
        if (trial % 4 == 0) axes[0].coordinates.back() += 1e6, axes[0].spacing.reset();
        if (trial % 6 == 2) axes[1].coordinates = {0, 1e-12, 1e-3, 1, 2}, axes[1].spacing.reset();
        if (trial % 12 == 8) axes[2].coordinates = {0, 1e-41, 1}, axes[2].spacing.reset();
        const Grid grid = grid_of(axes, [&](const glm::dvec3&) { return trial % 7 == 0 ? range : range * std::round(2 * unit(random)) / 2; });
        const Camera camera = frame_bounds(grid.bounds(), trial % 2 == 0 ? Projection::parallel : Projection::perspective,
                                           {unit(random), unit(random), trial % 5 == 0 ? 0 : unit(random)}, {0.1, 0.1, 1}, 1.2);
        const GridScene scene = lit(grid, constant_medium(1 / grid.bounds().diagonal()), trial % 3 == 0 ? Shading::smooth : Shading::flat);
        const GridQuality quality = by(trial % 2 == 0 ? "integral" : "exact:1e-3");
        const Image image = cpu().render(scene, camera, few, quality), plain = cpu().render({scene.grid, scene.transfer}, camera, few, quality);
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(image.pixels[i][k]) && image.pixels[i][k] >= 0 && image.pixels[i][k] <= 2) << trial;
            ASSERT_NEAR(image.pixels[i].a, plain.pixels[i].a, 1e-5) << trial;
            if (trial % 7 == 0) {  // no gradient
                ASSERT_NEAR(image.pixels[i].r, plain.pixels[i].r, 1e-5) << trial;
            }
        }
    }
    cpu::use_instruction_set(best);
}

TEST(GridMediumLight, ThreadsAndInstructionSetsDoNotMatter) {
    const GridScene scene = lit(unit_cube(20, waves), ramp(), Shading::smooth, two_lights, glass);
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image image = cpu().render(scene, camera, {100, 70});
    EXPECT_EQ(max_difference(image, make_grid_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {100, 70})), 0);
    const std::string best = cpu::instruction_set();
    for (const std::string& name : cpu::instruction_sets()) {
        cpu::use_instruction_set(name);
        EXPECT_LT(max_difference(image, cpu().render(scene, camera, {100, 70})), 1e-3) << name;
    }
    cpu::use_instruction_set(best);
}

// From scene to scene in one renderer: with light and without, of another function that shows nothing, of another grid.
TEST(GridMediumLight, ComesAndGoes) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    GridScene scene = lit(unit_cube(10, waves), ramp(), Shading::flat);
    const auto same = [&] {
        const Image fresh = make_grid_renderer(Backend::cpu)->render(scene, camera, few);
        EXPECT_EQ(max_difference(cpu().render(scene, camera, few), fresh), 0);
        return fresh;
    };
    const Image flat = same();
    scene.surfaces = nullptr;
    const Image plain = same();
    EXPECT_GT(max_difference(flat, plain), 0.05);
    for (const Shading shading : {Shading::smooth, Shading::unlit, Shading::flat, Shading::smooth}) {
        scene.surfaces = lit_by(two_lights, shading);
        EXPECT_EQ(max_difference(same(), plain) < 1e-5, shading == Shading::unlit);
    }
    scene.transfer = std::make_shared<const TransferFunction>(nothing());
    EXPECT_EQ(max_difference(same(), Image(few.width, few.height)), 0);
    scene.surfaces = lit_by(two_lights, Shading::smooth, glass);
    same();
    scene.transfer = std::make_shared<const TransferFunction>(ramp());
    scene.grid = std::make_shared<const Grid>(unit_cube(7, linear));
    same();
}

TEST(GridMediumLight, WhatCannotBeLitIsRefused) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const GridScene scene = lit(unit_cube(3, waves), ramp(), Shading::flat);
    EXPECT_NO_THROW(cpu().render(scene, camera, few));
    EXPECT_THROW(cpu().render(scene, camera, few, by("average:half")), Error);
    Grid cells = unit_cube(3, waves);
    cells.location = FieldLocation::cells;
    cells.values.resize(cells.cell_count());
    EXPECT_THROW(cpu().render(lit(cells, ramp(), Shading::flat), camera, few), Error);
    EXPECT_NO_THROW(cpu().render(lit(cells, ramp(), Shading::unlit), camera, few));
    Lighting dark;
    dark.exponent = 0;
    EXPECT_THROW(cpu().render(lit(*scene.grid, ramp(), Shading::flat, dark), camera, few), Error);
    EXPECT_NO_THROW(cpu().render(scene, camera, few));
}

}  // namespace
}  // namespace cellproj
