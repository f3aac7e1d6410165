// SPDX-License-Identifier: BSD-3-Clause
//
// The judge of regular grids against closed forms, the judge of meshes and a plainer quadrature.
#include "render/judge/grid_reference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "mesh/grid_gradient.hpp"
#include "render/judge/ray_light.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace grid_reference_test {

using testing_support::constant_medium;
using testing_support::grid_of;
using testing_support::unit_cube;
using Ray = ScreenTransform::Ray;

GridReference judge(Grid grid, TransferFunction transfer) {
    return {std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(std::move(transfer))};
}

// 1 − exp(−τ·chord), whatever the axes, values, scale and view.
TEST(GridReference, AConstantMediumOfAnyResolutionSpacingAndView) {
    std::mt19937_64 random(301);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    int met = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        const double size = std::pow(10, 12 * both(random));
        const glm::dvec3 place =
            size * std::pow(10, 3 * unit(random)) * glm::dvec3(both(random), both(random), both(random));
        std::array<GridAxis, 3> axes;
        for (int a = 0; a < 3; ++a) {
            GridAxis& axis = axes[static_cast<std::size_t>(a)];
            const auto points = 2 + random() % 12;
            const double step = size * std::pow(10, both(random)) / static_cast<double>(points);
            if (trial % 2 == 0) axis = uniform_axis(place[a], step, points);
            for (double x = place[a]; axis.points() < points; x += step * std::pow(10, both(random)))
                axis.coordinates.push_back(x);
        }
        const Grid grid = grid_of(axes, [&](const glm::dvec3&) { return both(random); });
        const Bounds box = grid.bounds();
        const double tau = 2 * unit(random) / glm::length(box.high - box.low);
        const auto somewhere = [&](double reach) {
            return box.center() + reach * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
        };
        const glm::dvec3 origin = somewhere(trial % 3 == 0 ? 0.5 : 3);  // inside the grid, too
        const Ray ray{origin, glm::normalize(somewhere(0.5) - origin)};
        const bool from_origin = trial % 5 < 3;
        const double length = testing_support::chord_in_box(box, ray, from_origin);
        const Light light = judge(grid, constant_medium(tau)).light(ray, from_origin);
        const double opacity = -std::expm1(-tau * length);
        // The coordinates are a thousand sizes from 0 at most, 1e-16 of which is what a chord rounds to; at grazing
        // angles it is up to some hundred times as much.
        ASSERT_NEAR(light.opacity, opacity, 1e-11) << trial;
        ASSERT_NEAR(light.color.g, 0.5 * opacity, 1e-11) << trial;
        met += opacity > 0.01 ? 1 : 0;
    }
    EXPECT_GT(met, 2500);
}

// Through points, along edges and faces of cells: neither counted twice nor left out.
TEST(GridReference, RaysInThePlanesOfTheGrid) {
    const Grid grid = unit_cube(4, [](const glm::dvec3& p) { return p.x; });
    const GridReference reference = judge(grid, constant_medium(1));
    for (const double x : {0.0, 0.25, 0.3, 0.5, 0.75}) {
        for (const double y : {0.0, 0.25, 0.6, 0.75})
            EXPECT_NEAR(reference.light({{x, y, -1}, {0, 0, 1}}, true).opacity, -std::expm1(-1.0), 1e-15);
        EXPECT_EQ(reference.light({{1, x, 2}, {0, 0, -1}}, true).opacity, 0);  // the outermost plane above
        EXPECT_EQ(reference.light({{x, -1e-9, 2}, {0, 0, -1}}, true).opacity, 0);
    }
    const double third = 1 / std::sqrt(3.0);
    EXPECT_NEAR(reference.light({{-1, -1, -1}, {third, third, third}}, true).opacity, -std::expm1(-std::sqrt(3.0)),
                1e-14);
    EXPECT_NEAR(reference.light({{0.5, 0.5, 0.5}, {third, third, third}}, false).opacity, -std::expm1(-std::sqrt(3.0)),
                1e-14);
    EXPECT_EQ(reference.light({{0.5, 0.5, 2}, {0, 0, 1}}, true).opacity, 0);  // behind the eye
}

TEST(GridReference, BlankedCellsAreEmptyAndCellFieldsConstant) {
    Grid grid{{uniform_axis(0, 1, 5), uniform_axis(0, 1, 2), uniform_axis(0, 1, 2)},
              FieldLocation::cells,
              {1, 2, 7, 3},
              {0, 0, 1, 0}};
    const TransferFunction medium{OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {10, 1}}};  // τ = s/10
    EXPECT_NEAR(judge(grid, medium).light({{-1, 0.5, 0.5}, {1, 0, 0}}, true).opacity, -std::expm1(-0.6), 1e-15);
    grid.values[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(judge(grid, medium), Error);
}

// A linear field on a grid is that on the tetrahedra it is cut into.
TEST(GridReference, ALinearFieldIsThatOfTheTetrahedra) {
    const TransferFunction peaks{OpticalModel::density,
                                 {{0.2, {1, 0, 0}}, {0.5, {0, 1, 0}}, {0.8, {0, 0, 1}}},
                                 {{0, 0.1}, {0.3, 0.1}, {0.31, 40}, {0.32, 0}, {0.6, 0}, {0.6, 9}, {0.7, 2}}};
    const TransferFunction emitter{
        OpticalModel::emitter, {{0, {0, 0.4, 1}}, {1, {1, 0.2, 0}}}, {{0.1, 0}, {0.4, 3}, {0.9, 0.5}}};
    for (const TransferFunction& transfer : {testing_support::ramp(), peaks, emitter}) {
        const Scene scene = testing_support::scene_of(testing_support::grid_mesh(5), testing_support::linear, transfer);
        const GridReference reference = judge(unit_cube(5, testing_support::linear), transfer);
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Camera camera = testing_support::view_of_unit_cube(projection);
            const ImageSize size{25, 21};
            const std::vector<PixelTruth> of_mesh = Reference(scene).picture(camera, size);
            const std::vector<PixelTruth> of_grid = reference.pixels(camera, size, all_pixels(size));
            ASSERT_EQ(of_mesh.size(), of_grid.size());
            double error = 0, brightest = 0;
            for (std::size_t p = 0; p < of_mesh.size(); ++p) {
                ASSERT_EQ(of_mesh[p].pixel, of_grid[p].pixel);
                const glm::dvec3 difference = of_mesh[p].light.color - of_grid[p].light.color;
                error = std::max(
                    {error, glm::length(difference), std::abs(of_mesh[p].light.opacity - of_grid[p].light.opacity)});
                brightest = std::max(brightest, of_grid[p].light.opacity);
            }
            EXPECT_LT(error, 1e-9);  // what the judge of meshes promises
            EXPECT_GT(brightest, 0.5);
        }
    }
}

// On the diagonal of one cell, s = xyz is t³ and s = x(1 − y) is t(1 − t): cubic and turning.
TEST(GridReference, ClosedFormsOfTrilinearFields) {
    const double third = 1 / std::sqrt(3.0), root3 = std::sqrt(3.0), root2 = std::sqrt(2.0);
    const Ray diagonal{{-1, -1, -1}, {third, third, third}};
    const auto cubic = [](const glm::dvec3& p) { return p.x * p.y * p.z; };
    const TransferFunction ramp{OpticalModel::density, {{0, {1, 0.5, 0}}}, {{0, 0}, {1, 1}}};
    EXPECT_NEAR(judge(unit_cube(1, cubic), ramp).light(diagonal, true).opacity, -std::expm1(-root3 / 4), 1e-15);
    EXPECT_NEAR(judge(unit_cube(1, cubic), ramp).light(diagonal, true).color.g, -0.5 * std::expm1(-root3 / 4), 1e-13);
    // A step at s = 1/2, met at t = 2^(−1/3).
    const TransferFunction step{OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {0.5, 0}, {0.5, 3}, {1, 3}}};
    EXPECT_NEAR(judge(unit_cube(1, cubic), step).light(diagonal, true).opacity,
                -std::expm1(-3 * root3 * (1 - std::cbrt(0.5))), 1e-14);
    // Emission t³ without extinction: a quarter of the length.
    const TransferFunction glow{OpticalModel::emitter, {{0, {0, 0, 0}}, {1, {1, 2, 4}}}, {{0, 0}}};
    EXPECT_NEAR(judge(unit_cube(1, cubic), glow).light(diagonal, true).color.b, root3, 1e-14);

    const auto saddle = [](const glm::dvec3& p) { return p.x * (1 - p.y); };
    const Ray across{{-1, -1, 0.5}, {1 / root2, 1 / root2, 0}};
    // Above 4/25 between t = 1/5 and 4/5: both ends of the cell lie below.
    const TransferFunction inner{OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {0.16, 0}, {0.16, 2}, {1, 2}}};
    EXPECT_NEAR(judge(unit_cube(1, saddle), inner).light(across, true).opacity, -std::expm1(-2 * root2 * 0.6), 1e-14);
    // The top, 1/4, only touches the step.
    const TransferFunction top{OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {0.25, 0}, {0.25, 2}, {1, 2}}};
    EXPECT_NEAR(judge(unit_cube(1, saddle), top).light(across, true).opacity, 0, 1e-7);  // √1e-16: how flat the top is
}

// The light of a ray cut into many segments with a linear scalar, by the judge of these.
Light light_of_linear_segments(const Grid& grid, const TransferFunction& transfer, const Ray& ray, int parts) {
    RayLight linear(transfer);
    for (const GridCrossing& c : cells_along(grid, ray, true)) {
        const Bounds box = grid.cell_bounds(c.cell);
        const auto scalar = [&](int part) {
            const double t = c.enter + (c.leave - c.enter) * part / parts;
            return interpolate(grid.corner_values(c.cell),
                               (ray.origin + t * ray.direction - box.low) / (box.high - box.low));
        };
        for (int part = 0; part < parts; ++part)
            linear.add(std::array{ScalarEnds{scalar(part), scalar(part + 1)}}, (c.leave - c.enter) / parts);
    }
    return linear.light();
}

// Their error falls with the square of their number: what they tend to is the judge's light.
TEST(GridReference, ManyLinearSegmentsTendToIt) {
    std::mt19937_64 random(302);
    std::uniform_real_distribution<double> unit(0, 1);
    double coarse = 0, fine = 0;
    for (int trial = 0; trial < 40; ++trial) {
        const Grid grid = unit_cube(2, [&](const glm::dvec3&) { return unit(random); });
        const TransferFunction transfer{trial % 2 == 0 ? OpticalModel::density : OpticalModel::emitter,
                                        {{0.1, {1, 0, 0.3}}, {0.45, {0, 1, 0.3}}, {0.9, {0.2, 0.2, 1}}},
                                        {{0, 0}, {0.4, 5}, {0.6, 0.5}, {1, 20}}};
        const glm::dvec3 origin(3 * unit(random), -1, 2 * unit(random)), aim(unit(random), unit(random), unit(random));
        const Ray ray{origin, glm::normalize(aim - origin)};
        const Light light = judge(grid, transfer).light(ray, true);
        const auto error = [&](int parts) {
            const Light linear = light_of_linear_segments(grid, transfer, ray, parts);
            return std::max(glm::length(light.color - linear.color), std::abs(light.opacity - linear.opacity));
        };
        ASSERT_GT(light.opacity, 0.01);
        coarse = std::max(coarse, error(100));
        fine = std::max(fine, error(3200));
    }
    EXPECT_GT(coarse, 1e-5);
    EXPECT_LT(fine, coarse / 900);  // 1024
}

TEST(GridReference, ExtremesStayFinite) {
    double worst = 0;  // colour 1 against opacity
    int met = 0;
    std::mt19937_64 random(303);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < 300; ++trial) {
        const double size = std::pow(10, 12 * unit(random)), range = std::pow(10, 20 * unit(random));
        const double peak = std::pow(10, 12 * unit(random)) / size;
        const double thin = trial % 5 == 0 ? 1e-12 : 1e-6;  // share of the range
        GridAxis axis = uniform_axis(1e6 * size * (trial % 2), size, 4);
        Grid grid = grid_of({axis, axis, axis},
                            [&](const glm::dvec3&) { return trial % 7 == 0 ? range : range * unit(random); });
        const TransferFunction transfer{
            trial % 3 == 0 ? OpticalModel::emitter : OpticalModel::density,
            {{-range, {1, 0, 1}}, {range, {0, 1, 1}}},
            {{-range, 0}, {0, 0}, {0, peak}, {range * thin, peak}, {range * 1.1 * thin, 0}, {range, peak}}};
        const glm::dvec3 middle = grid.bounds().center();
        const Ray ray{middle + size * glm::dvec3(unit(random), unit(random), -9),
                      glm::normalize(glm::dvec3(0.05 * unit(random), 0, 1))};
        const Light light = judge(grid, transfer).light(ray, trial % 2 == 0);
        ASSERT_TRUE(light.opacity >= 0 && light.opacity <= 1) << trial;
        for (int k = 0; k < 3; ++k)
            ASSERT_TRUE(std::isfinite(light.color[k]) && light.color[k] >= 0) << trial;
        met += light.opacity > 0 ? 1 : 0;
        if (transfer.model() != OpticalModel::density) continue;
        worst = std::max(worst, std::abs(light.color.b - light.opacity));
    }
    EXPECT_GT(met, 200);
    EXPECT_LT(worst, 1e-12);
}

// Surfaces alone: no light between them.
GridReference judge_of_surfaces(Grid grid, std::vector<IsoSurface> surfaces, Shading shading = Shading::unlit, TransferFunction medium = constant_medium(0)) {
    return {std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(std::move(medium)),
            std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(surfaces)), shading, {}})};
}

// Three roots in one cell: on the diagonal of the unit cell with these corners the cubic is (t − 1/5)(t − 1/2)(t − 4/5), whose Bézier points
// are the means of the corners with 0, 1, 2, 3 ends up.
TEST(GridReference, AllRootsOfACubicInTheirOrder) {
    const std::array<double, 4> control{-0.08, -0.08 + 0.66 / 3, -0.08 + 2 * 0.66 / 3 - 0.5, 0.08};
    const Grid grid = unit_cube(1, [&](const glm::dvec3& p) { return control[static_cast<std::size_t>(p.x + p.y + p.z + 0.5)]; });
    const double third = 1 / std::sqrt(3.0), root3 = std::sqrt(3.0);
    const Ray diagonal{{-1, -1, -1}, {third, third, third}};
    const auto hits = judge_of_surfaces(grid, {{.value = 0, .opacity = 0.25}}).surfaces_along(diagonal, true);
    ASSERT_EQ(hits.size(), 3U);
    for (const auto& [i, t, rising] : {std::tuple(0, 0.2, true), std::tuple(1, 0.5, false), std::tuple(2, 0.8, true)}) {
        const GridSurfaceHit& hit = hits[static_cast<std::size_t>(i)];
        EXPECT_NEAR(hit.t, root3 * (1 + t), 1e-14);
        EXPECT_EQ(hit.rising, rising);
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(hit.u[axis], t, 1e-14);
    }
    // Mixed with a medium τ = 1: cut at each of them. Front red, back blue.
    const IsoSurface paper{.value = 0, .color = {1, 0, 0}, .opacity = 0.25, .back_color = glm::dvec3(0, 0, 1)};
    const TransferFunction black{OpticalModel::density, {{0, {0, 0, 0}}}, {{0, 1}}};
    const Light light = judge_of_surfaces(grid, {paper}, Shading::unlit, black).light(diagonal, true);
    EXPECT_NEAR(light.color.r, 0.25 * std::exp(-0.2 * root3) + 0.75 * 0.75 * 0.25 * std::exp(-0.8 * root3), 1e-14);
    EXPECT_NEAR(light.color.b, 0.75 * 0.25 * std::exp(-0.5 * root3), 1e-14);
    EXPECT_NEAR(light.opacity, 1 - 0.75 * 0.75 * 0.75 * std::exp(-root3), 1e-14);
}

// A surface in the planes of the grid, through its points, and cells that are wholly at the isovalue: once where the ray changes sides.
TEST(GridReference, SurfacesInTheFacesAreMetOnce) {
    const GridReference plane = judge_of_surfaces(unit_cube(4, [](const glm::dvec3& p) { return p.z; }), {{.value = 0.5, .opacity = 0.5}, {.value = 0.75, .opacity = 0.5}});
    std::mt19937_64 random(311);
    std::uniform_real_distribution<double> unit(0.2, 0.7);
    for (int trial = 0; trial < 2000; ++trial) {
        const auto snapped = [&](double x) { return trial % 3 == 0 ? std::round(4 * x) / 4 : x; };
        const glm::dvec3 from(snapped(unit(random)), snapped(unit(random)), -1), to(snapped(unit(random)), snapped(unit(random)), 2);
        const Ray up{from, glm::normalize(to - from)}, down{to, glm::normalize(from - to)};
        EXPECT_NEAR(plane.light(up, true).opacity, 0.75, 1e-15) << trial;
        EXPECT_NEAR(plane.light(down, true).opacity, 0.75, 1e-15) << trial;
    }
    // The plateau between 1/4 and 3/4 belongs to the side above.
    const auto plateau = [](const glm::dvec3& p) { return std::min(p.z, 0.25) + std::max(p.z - 0.75, 0.0); };
    const GridReference step = judge_of_surfaces(unit_cube(4, plateau), {{.value = 0.25, .opacity = 0.5}});
    for (const double x : {0.25, 0.3, 0.5}) {
        const auto hits = step.surfaces_along({{x, x, -1}, {0, 0, 1}}, true);
        ASSERT_EQ(hits.size(), 1U);
        EXPECT_EQ(hits[0].t, 1.25);
        EXPECT_EQ(step.surfaces_along({{x, x, 2}, {0, 0, -1}}, true).at(0).t, 1.75);
    }
    // A ray in the surface itself never changes sides; one that touches it does so twice or never.
    EXPECT_TRUE(plane.surfaces_along({{-1, 0.3, 0.5}, {1, 0, 0}}, true).empty());
    const GridReference roof = judge_of_surfaces(unit_cube(4, [](const glm::dvec3& p) { return 0.5 - std::abs(p.z - 0.5); }), {{.value = 0.5}});
    EXPECT_EQ(roof.surfaces_along({{0.3, 0.3, -1}, {0, 0, 1}}, true).size() % 2, 0U);
}

// Behind blanked cells the field begins anew: the jump over them is no surface.
TEST(GridReference, NoSurfacesInBlankedCells) {
    Grid grid = unit_cube(4, [](const glm::dvec3& p) { return p.z; });
    grid.blanked.assign(grid.cell_count(), 0);
    for (std::size_t i = 0; i < 16; ++i) grid.blanked[i + 16] = 1;  // z from 1/4 to 1/2
    const GridReference reference = judge_of_surfaces(grid, {{.value = 0.3, .opacity = 0.5}, {.value = 0.6, .opacity = 0.5}});
    EXPECT_EQ(reference.surfaces_along({{0.3, 0.3, -1}, {0, 0, 1}}, true).size(), 1U);
    Grid cells = unit_cube(4, [](const glm::dvec3& p) { return p.z; });
    cells.location = FieldLocation::cells;
    cells.values.resize(cells.cell_count());
    EXPECT_THROW(judge_of_surfaces(cells, {{.value = 0.3}}), Error);
}

// Along any ray through random fields sides change from root to root, every root lies on its isovalue, and the number of roots has the parity
// of the sides at both ends. At scales and places of all kinds.
TEST(GridReference, RootsAreThoseOfTheField) {
    std::mt19937_64 random(312);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    std::size_t met = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double size = std::pow(10, 12 * both(random)), range = std::pow(10, 12 * both(random));
        const GridAxis axis = uniform_axis(1e3 * size * both(random), size, 6);
        // Few values, so that points, edges, faces and cells at the isovalue are common.
        const Grid grid = grid_of({axis, axis, axis}, [&](const glm::dvec3&) { return range * (trial % 2 == 0 ? static_cast<double>(random() % 4) : unit(random)); });
        const std::vector<IsoSurface> surfaces{{.value = range * 0.4}, {.value = range}, {.value = 2 * range}};
        const GridReference reference = judge_of_surfaces(grid, surfaces, Shading::flat);
        const Bounds box = grid.bounds();
        const auto somewhere = [&] { return box.low + (box.high - box.low) * glm::dvec3(unit(random), unit(random), unit(random)); };
        const glm::dvec3 from = somewhere(), aim = somewhere();
        const Ray ray{from, glm::normalize(aim - from)};
        const auto cells = cells_along(grid, ray, true);
        const double first = scalar_along(grid, cells.front(), ray).control[0], last = scalar_along(grid, cells.back(), ray).control[3];
        std::array<int, 3> side{}, end{};
        for (std::size_t s = 0; s < 3; ++s) {
            side[s] = first >= surfaces[s].value;
            end[s] = last >= surfaces[s].value;
        }
        double before = 0;
        for (const GridSurfaceHit& hit : reference.surfaces_along(ray, true)) {
            ASSERT_GE(hit.t, before);
            before = hit.t;
            ASSERT_EQ(side[hit.surface], hit.rising ? 0 : 1) << trial;
            side[hit.surface] = hit.rising ? 1 : 0;
            const double s = interpolate(grid.corner_values(hit.cell), hit.u);
            ASSERT_NEAR(s, surfaces[hit.surface].value, 1e-12 * range * 1e3);  // a place 1e3 sizes from 0
            ++met;
        }
        ASSERT_EQ(side, end) << trial;
    }
    EXPECT_GT(met, 3000U);
}

// Linear in space: the same for meshes, lit as theirs. Quadratic: central differences are right inside, on any axes.
TEST(GridReference, GradientsOfPointsAndCells) {
    GridAxis uneven;
    uneven.coordinates = {0, 0.1, 0.3, 0.35, 0.8, 1};
    const auto quadratic = [](const glm::dvec3& p) { return p.x * p.x - 3 * p.y * p.y + p.x * p.z + 2 * p.z; };
    const Grid grid = grid_of({uneven, uneven, uneven}, quadratic);
    for (std::size_t i = 1; i < 5; ++i) {
        const glm::dvec3 p(uneven.coordinates[i], uneven.coordinates[5 - i], uneven.coordinates[i]);
        const glm::dvec3 wrong = point_gradient(grid, {i, 5 - i, i}) - glm::dvec3(2 * p.x + p.z, -6 * p.y, p.x + 2);
        EXPECT_LT(glm::length(wrong), 1e-13) << i;
    }
    Grid linear = grid_of({uneven, uneven, uneven}, testing_support::linear);
    const glm::dvec3 slope = point_gradient(linear, {2, 2, 2});
    EXPECT_LT(glm::length(point_gradient(linear, {0, 5, 0}) - slope), 1e-13);
    EXPECT_LT(glm::length(trilinear_gradient(linear.corner_values({1, 2, 3}), {0.2, 0.9, 0.5}, linear.cell_edges({1, 2, 3})) - slope), 1e-13);
    // Beside blanked cells one-sided, and nothing where no edge is left.
    linear.blanked.assign(linear.cell_count(), 1);
    linear.blanked[linear.cell_id({2, 2, 2})] = 0;
    linear.values[1] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_LT(glm::length(point_gradient(linear, {3, 2, 3}) - slope), 1e-13);
    EXPECT_EQ(point_gradient(linear, {1, 0, 0}), glm::dvec3(0));
}

// A linear field's surfaces are those on the tetrahedra it is cut into, whatever lights them and whatever lies between.
TEST(GridReference, SurfacesOfALinearFieldAreThoseOfTheTetrahedra) {
    Lighting lighting;
    lighting.lights.push_back({.towards = glm::dvec3(1, -2, 0.5), .color = {1, 0.5, 0.2}, .diffuse = 0.5, .specular = 0.6});
    const std::vector<IsoSurface> surfaces{{.value = 0.31, .color = {1, 0.8, 0}, .opacity = 0.5}, {.value = 0.5, .color = {0, 0.2, 1}, .opacity = 0.3}, {.value = 0.77}};
    for (const Shading shading : {Shading::flat, Shading::smooth, Shading::unlit}) {
        const auto shared = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(surfaces), shading, lighting});
        Scene scene = testing_support::scene_of(testing_support::grid_mesh(5), testing_support::linear, testing_support::ramp());
        scene.surfaces = shared;
        const GridReference reference(std::make_shared<Grid>(unit_cube(5, testing_support::linear)), scene.transfer, shared);
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Camera camera = testing_support::view_of_unit_cube(projection);
            const ImageSize size{25, 21};
            const std::vector<PixelTruth> of_mesh = Reference(scene).picture(camera, size);
            const std::vector<PixelTruth> of_grid = reference.pixels(camera, size, all_pixels(size));
            for (std::size_t p = 0; p < of_mesh.size(); ++p) {
                ASSERT_LT(glm::length(of_mesh[p].light.color - of_grid[p].light.color), 1e-8) << p;  // normals of tiny steps
                ASSERT_NEAR(of_mesh[p].light.opacity, of_grid[p].light.opacity, 1e-9);
            }
        }
    }
}

// The picture is that of its rays, and the same at each call.
TEST(GridReference, PixelsInTheirOrder) {
    const GridReference reference = judge(unit_cube(3, testing_support::linear), testing_support::ramp());
    const Camera camera = testing_support::view_of_unit_cube(Camera::Projection::perspective);
    const std::vector<PixelId> pixels{{7, 3}, {4, 4}, {0, 0}};
    const std::vector<PixelTruth> truths = reference.pixels(camera, {9, 9}, pixels);
    ASSERT_EQ(truths.size(), 3U);
    const ScreenTransform transform(camera, {9, 9});
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(truths[i].pixel, pixels[i]);
        const Light light = reference.light(transform.ray({pixels[i].x + 0.5, pixels[i].y + 0.5}), true);
        EXPECT_EQ(truths[i].light.color, light.color);
        EXPECT_EQ(truths[i].high.opacity, light.opacity);
    }
    EXPECT_GT(truths[1].light.opacity, 0);
    EXPECT_EQ(truths[2].light.opacity, 0);
    EXPECT_THROW(reference.pixels(camera, {0, 9}, pixels), Error);
}

}  // namespace
}  // namespace cellproj
