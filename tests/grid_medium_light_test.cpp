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
#include "render/grid_renderer.hpp"
#include "render/judge/cubic_light.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace {

using namespace testing_support;
using scenes::waves;

using Projection = Camera::Projection;
using Ray = ScreenTransform::Ray;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{20, 16} : ImageSize{48, 40}, few{20, 16};

const Lighting two_lights{.ambient = {0.1, 0.2, 0.05},
                          .lights = {{.towards = glm::dvec3(1, -2, 2), .color = {1, 0.8, 0.6}}, {.diffuse = 0.3, .specular = 0.5}}};

std::shared_ptr<const SurfaceScene> lit_by(const Lighting& lighting, Shading shading, std::vector<IsoSurface> list = {}) {
    return std::make_shared<SurfaceScene>(
        SurfaceScene{.isosurfaces = IsoSurfaces(std::move(list)), .shading = shading, .lighting = lighting, .lit_medium = true});
}

GridScene lit(Grid grid, TransferFunction transfer, Shading shading, const Lighting& lighting = two_lights, std::vector<IsoSurface> list = {}) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(std::move(transfer)), lit_by(lighting, shading, std::move(list))};
}

GridReference judge(const GridScene& scene) { return {scene.grid, scene.transfer, scene.surfaces}; }
GridReference unlit_judge(const GridScene& scene) { return {scene.grid, scene.transfer}; }

// Translucent ones among the medium.
const std::vector<IsoSurface> glass{{.value = 0.3, .color = {0.2, 0.9, 0.4}, .opacity = 0.5}, {.value = 0.5, .color = {1, 0, 0}, .opacity = 0.25}, {.value = 0.7, .color = {0.5, 0.5, 0.5}, .opacity = 0.8}};

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
        constexpr int n = 2000;
        glm::dvec3 sum(0.0);
        const double step = chord.length() / n;
        for (int i = 0; i < n; ++i) {
            const double way = (i + 0.5) * step;
            const glm::dvec3 p = 1.0 + ray.origin + (chord.enter + way) * ray.direction;
            sum += lit_share(facing, per_weak * glm::dvec3(p.y * p.z, p.x * p.z, p.x * p.y) / 8.0, -ray.direction) * (tau * step * std::exp(-tau * way));
        }
        return sum * glm::dvec3(1, 0.5, 0.25);
    };
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const auto error = [&](std::size_t n) {
            const GridReference reference = judge(lit(unit_cube(n, field), constant_medium(tau), shading, facing));
            double most = 0;
            for (const PixelTruth& found : reference.pixels(camera, few, all_pixels(few)))
                most = std::max(most, glm::length(found.light.color - truth(transform.ray({found.pixel.x + 0.5, found.pixel.y + 0.5}))));
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

}  // namespace
}  // namespace cellproj
