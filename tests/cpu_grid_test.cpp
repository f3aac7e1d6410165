// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids on the CPU backend: closed forms, the judge of grids, and pictures that must not change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/cpu/kernels.hpp"
#include "render/judge/grid_reference.hpp"
#include "render/grid_renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace cpu_grid_test {

using testing_support::constant_medium;
using testing_support::grid_of;
using testing_support::max_difference;
using testing_support::ramp;
using testing_support::unit_cube;
using testing_support::view_of_unit_cube;

using Projection = Camera::Projection;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small{48, 40};
constexpr ImageSize few = sanitized ? ImageSize{20, 16} : small;  // pixels, where the judge takes longest
const std::vector<Projection> projections{Projection::parallel, Projection::perspective};

GridRenderer& cpu() {
    static const auto shared = make_grid_renderer(Backend::cpu);
    return *shared;
}

GridScene scene_of(Grid grid, TransferFunction transfer) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(std::move(transfer))};
}

GridQuality by(const std::string& method) { return {.method = parse_method(method)}; }

// The worst channel of all pixels.
double error_of(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {}) {
    const Image image = cpu().render(scene, camera, size, quality);
    EXPECT_EQ(count_non_finite(image), 0U);
    return largest(compare(image, GridReference(scene.grid, scene.transfer).pixels(camera, size, all_pixels(size))));
}

GridAxis random_axis(std::mt19937_64& random, double low, double size, std::size_t points, bool uniform) {
    std::uniform_real_distribution<double> both(-1, 1);
    const double step = size / static_cast<double>(points - 1);
    if (uniform) return uniform_axis(low, step, points);
    GridAxis axis;
    for (double x = low; axis.points() < points; x += step * std::pow(10, both(random))) axis.coordinates.push_back(x);
    return axis;
}

// 1 − exp(−τ·chord) whatever the axes, values, scale, place and view: parallel, perspective, from inside. What float32 places
// are worth, 1e-7 of the grid, makes some 1e-6 of a chord of optical depth 2; grazing rays some ten times as much.
TEST(CpuGrid, AConstantMediumOfAnyResolutionSpacingAndView) {
    std::mt19937_64 random(401);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    std::size_t met = 0;
    double worst = 0;
    for (int trial = 0; trial < (sanitized ? 60 : 400); ++trial) {
        const double size = std::pow(10, 12 * both(random));
        const double far = trial % 3 == 0 ? 1e6 : 1;  // sizes from 0
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes)
            axis = random_axis(random, far * size * both(random), size * std::pow(10, both(random)), 2 + random() % 40, trial % 2 == 0);
        Grid grid = grid_of(axes, [&](const glm::dvec3&) { return both(random); });
        if (trial % 4 == 1) {
            grid.location = FieldLocation::cells;
            grid.values.resize(grid.cell_count());
        }
        const Bounds box = grid.bounds();
        const double tau = 2 / box.diagonal();
        const bool inside = trial % 5 == 0;
        const glm::dvec3 towards = glm::normalize(glm::dvec3(both(random), both(random), both(random)));
        Camera camera = frame_bounds(box, trial % 5 < 3 ? Projection::perspective : Projection::parallel, towards, {0.1, 0.2, 1}, 1.2);
        if (inside) camera.eye = box.center() + 0.4 * (box.high - box.low) * towards;
        const ImageSize view{16, 12};
        const ScreenTransform transform(camera, view);
        const Image image = cpu().render(scene_of(std::move(grid), constant_medium(tau)), camera, view);
        for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
                const ScreenTransform::Ray ray = transform.ray({x + 0.5, y + 0.5});
                double enter = transform.perspective() ? 0 : -1e300, leave = 1e300;
                for (int a = 0; a < 3; ++a) {
                    const double from = (box.low[a] - ray.origin[a]) / ray.direction[a], to = (box.high[a] - ray.origin[a]) / ray.direction[a];
                    enter = std::max(enter, std::min(from, to));
                    leave = std::min(leave, std::max(from, to));
                }
                const double opacity = -std::expm1(-tau * std::max(0.0, leave - enter));
                const glm::vec4 pixel = image.at(x, y);
                ASSERT_NEAR(pixel.a, opacity, 3e-6) << trial << ' ' << x << ' ' << y;
                worst = std::max({worst, std::abs(pixel.a - opacity), std::abs(pixel.g - 0.5 * opacity)});
                met += opacity > 0.01 ? 1 : 0;
            }
    }
    EXPECT_LT(worst, 3e-6);
    EXPECT_GT(met, sanitized ? 3000U : 20000U);
}

// A linear field is linear along every segment: nothing is left of the error but float32 and the method's own.
TEST(CpuGrid, ALinearFieldIsExact) {
    std::mt19937_64 random(402);
    for (const bool uniform : {true, false}) {
        std::array<GridAxis, 3> axes{random_axis(random, 0, 1, 17, uniform), random_axis(random, 0, 1, 9, uniform),
                                     random_axis(random, 0, 1, 30, uniform)};
        const glm::dvec3 high{axes[0].coordinates.back(), axes[1].coordinates.back(), axes[2].coordinates.back()};
        const GridScene scene = scene_of(grid_of(axes, [&](const glm::dvec3& p) { return testing_support::linear(p / high); }), ramp());
        for (const Projection projection : projections) {
            const Camera camera = frame_bounds(scene.grid->bounds(), projection, {1.3, -2.1, 0.9}, {0, 0, 1}, 1.2);
            EXPECT_LT(error_of(scene, camera, few), 5e-6);
            EXPECT_LT(error_of(scene, camera, few, by("exact:1e-6")), 5e-6);
        }
    }
}

// The same where segments lie inside one piece of the transfer function, reach the next one, or cross many, and are dark, thin and deep
// (the closed forms of grid_light-inl.hpp, and the walk), by all sets of instructions. Extinction changes by up to 2000 over the range
// of scalars here, of which float32 places are worth 1e-7.
TEST(CpuGrid, LinearFieldsThroughManyPiecesAreExact) {
    std::vector<ColorNode> colors;
    std::vector<ExtinctionNode> extinctions;
    for (int i = 0; i <= 60; ++i) {  // more pieces than vectors hold
        colors.push_back({i / 60.0, {i % 2, 0.5, i % 3 == 0 ? 1 : 0.1}});
        extinctions.push_back({i / 60.0, i % 5 == 0 ? 0.0 : i % 7 == 0 ? 12.0 : 3.0});
    }
    const TransferFunction many(OpticalModel::density, colors, extinctions);
    const std::string best = cpu::instruction_set();
    for (const TransferFunction& transfer : {scenes::table_peaks(), many})
        for (const std::size_t cells : {2, 9, 60}) {
            const GridScene scene = scene_of(unit_cube(cells, testing_support::linear), transfer);
            for (const Projection projection : projections) {
                const Camera camera = view_of_unit_cube(projection);
                const auto truths = GridReference(scene.grid, scene.transfer).pixels(camera, few, all_pixels(few));
                for (const std::string& name : cpu::instruction_sets()) {
                    cpu::use_instruction_set(name);
                    EXPECT_LT(largest(compare(cpu().render(scene, camera, few), truths)), 3e-5) << name << ' ' << cells << ' ' << transfer.pieces().size();
                }
                cpu::use_instruction_set(best);
            }
        }
}

Grid random_grid(std::mt19937_64& random, std::size_t cells) {
    std::uniform_real_distribution<double> unit(0, 1);
    return unit_cube(cells, [&](const glm::dvec3&) { return unit(random); });
}

// Random values at the points, which is as far from linear as a grid can be: the error of one line per cell, by method, and
// of as many as `exact` wants.
TEST(CpuGrid, RandomFieldsAgainstTheJudge) {
    std::mt19937_64 random(403);
    const TransferFunction emitter{OpticalModel::emitter, {{0, {0, 0.4, 1}}, {1, {1, 0.2, 0}}}, {{0.1, 0}, {0.4, 3}, {0.9, 0.5}}};
    for (const TransferFunction& transfer : {ramp(), emitter}) {
        const GridScene scene = scene_of(random_grid(random, 8), transfer);
        for (const Projection projection : projections) {
            const Camera camera = view_of_unit_cube(projection);
            for (const char* method : {"integral", "preint3d:64", "linear:8"}) {
                const double error = error_of(scene, camera, few, by(method));
                EXPECT_GT(error, 0.01) << method;
                EXPECT_LT(error, 0.25) << method;
            }
            EXPECT_LT(error_of(scene, camera, few, by("exact:1e-3")), 1e-3);
            EXPECT_LT(error_of(scene, camera, few, by("exact:1e-5")), 2e-5);  // the most that a cell is cut
        }
    }
}

// As the cells get smaller than what the field does, one line per cell converges: with the square of their size.
TEST(CpuGrid, SmoothFieldsConverge) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    std::vector<double> errors;
    for (const std::size_t cells : {8, 16, 32}) errors.push_back(error_of(scene_of(unit_cube(cells, scenes::waves), ramp()), camera, small));
    EXPECT_LT(errors[1], errors[0] / 3);
    EXPECT_LT(errors[2], errors[1] / 3);
    EXPECT_LT(errors[2], 1.5e-3);
}

TEST(CpuGrid, NarrowPeaksAndSteps) {
    const TransferFunction step{OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 1}}}, {{0, 0}, {0.5, 0}, {0.5, 8}, {0.7, 8}, {0.7, 0.1}, {1, 0.1}}};
    for (const TransferFunction& transfer : {scenes::table_peaks(), step}) {
        const GridScene scene = scene_of(unit_cube(20, scenes::waves), transfer);
        for (const Projection projection : projections) {
            const Camera camera = view_of_unit_cube(projection);
            EXPECT_LT(error_of(scene, camera, small), 0.3);
            EXPECT_LT(error_of(scene, camera, small, by("exact:1e-4")), 5e-4);
        }
    }
}

TEST(CpuGrid, CellFieldsAndBlankedCells) {
    std::mt19937_64 random(404);
    for (const bool on_cells : {true, false}) {
        Grid grid = random_grid(random, 11);
        if (on_cells) {
            grid.location = FieldLocation::cells;
            grid.values.resize(grid.cell_count());
        }
        grid.blanked.resize(grid.cell_count());
        for (auto& blanked : grid.blanked) blanked = random() % 3 == 0;
        if (on_cells) {
            for (std::size_t c = 0; c < grid.values.size(); ++c)
                if (grid.blanked[c]) grid.values[c] = std::numeric_limits<double>::quiet_NaN();
        }
        const GridScene scene = scene_of(std::move(grid), ramp());
        for (const Projection projection : projections) {
            const double error = error_of(scene, view_of_unit_cube(projection), small, by("exact:1e-5"));
            EXPECT_LT(error, 2e-5) << on_cells;
        }
    }
}

// Values that only blanked cells have are no part of the range, and no NaN gets out.
TEST(CpuGrid, PointsOfBlankedCellsOnly) {
    Grid grid = unit_cube(9, scenes::waves);
    grid.blanked.assign(grid.cell_count(), 0);
    for (std::size_t k = 2; k < 7; ++k)
        for (std::size_t j = 2; j < 7; ++j)
            for (std::size_t i = 0; i < 7; ++i) grid.blanked[grid.cell_id({i, j, k})] = 1;
    const GridDimensions n = grid.dimensions();
    grid.values[3 + n.ni * (4 + n.nj * 4)] = std::numeric_limits<double>::quiet_NaN();
    grid.values[4 + n.ni * (4 + n.nj * 4)] = 1e300;
    const GridScene scene = scene_of(std::move(grid), ramp());
    EXPECT_LE(units_of(*scene.grid).scalar_high, 1);
    for (const Projection projection : projections)
        EXPECT_LT(error_of(scene, view_of_unit_cube(projection), small, by("exact:1e-5")), 2e-5);
}

// Most of the grid shows nothing: rays leap over bricks of every level, in every direction, and lose nothing.
TEST(CpuGrid, LeapsOverEmptySpaceChangeNothing) {
    std::mt19937_64 random(405);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    const std::size_t n = sanitized ? 50 : 90;
    const TransferFunction hot{OpticalModel::density, {{0, {1, 0.5, 0}}, {1, {0, 0.5, 1}}}, {{0, 0}, {0.6, 0}, {0.65, 9}, {1, 15}}};
    for (const bool uniform : {true, false}) {
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes) axis = random_axis(random, 0, 1, n, uniform);
        std::vector<glm::dvec3> blobs;
        for (int i = 0; i < 5; ++i) blobs.emplace_back(unit(random), unit(random), unit(random));
        const glm::dvec3 high{axes[0].coordinates.back(), axes[1].coordinates.back(), axes[2].coordinates.back()};
        const GridScene scene = scene_of(grid_of(axes, [&](const glm::dvec3& p) {
            double sum = 0;
            for (const glm::dvec3& c : blobs) sum = std::max(sum, 1 - 7 * glm::length(p / high - c));
            return sum;
        }), hot);
        for (int view = 0; view < 6; ++view) {
            const glm::dvec3 from(both(random), both(random), both(random));
            const Camera camera = frame_bounds(scene.grid->bounds(), projections[static_cast<std::size_t>(view % 2)], from, {0.1, 0.3, 1}, 1.2);
            Statistics statistics;
            cpu().render(scene, camera, small, {}, &statistics);
            EXPECT_GT(statistics.counts.culled, statistics.counts.cells / 2);
            EXPECT_LT(error_of(scene, camera, small, by("exact:1e-4")), 2e-4);
        }
    }
}

// Rays in the planes of the grid and through its points, along axes and diagonals: every pixel's ray runs where cells meet.
TEST(CpuGrid, RaysInThePlanesOfTheGrid) {
    const double opacity = -std::expm1(-1.0);
    const GridScene scene = scene_of(unit_cube(8, testing_support::linear), constant_medium(1));
    Camera camera{.projection = Projection::parallel, .eye = {0, 0, 5}, .center = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};
    camera.eye = {0.4375, 0.4375, 5};  // 16 pixels across 2 units: centres at multiples of 1/8 when seen off by half a pixel
    camera.center = {0.4375, 0.4375, 0};
    const ImageSize size{16, 16};
    const ScreenTransform transform(camera, size);
    const Image image = cpu().render(scene, camera, size);
    int inside = 0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const glm::dvec3 origin = transform.ray({x + 0.5, y + 0.5}).origin;
            EXPECT_EQ(8 * origin.x, std::round(8 * origin.x));
            const bool in = origin.x >= 0 && origin.x < 1 && origin.y >= 0 && origin.y < 1;  // GridReference's rule
            EXPECT_NEAR(image.at(x, y).a, in ? opacity : 0, 1e-6) << x << ' ' << y;
            inside += in ? 1 : 0;
        }
    EXPECT_EQ(inside, 64);
    camera = {.projection = Projection::parallel, .eye = {6, 6, 6}, .center = {0.5, 0.5, 0.5}, .up = {0, 0, 1}, .height = 2};
    const Image diagonal = cpu().render(scene, camera, {1, 1});
    EXPECT_NEAR(diagonal.at(0, 0).a, -std::expm1(-std::sqrt(3.0)), 1e-6);
}

TEST(CpuGrid, AnEyeInsideSeesWhatIsAhead) {
    const GridScene scene = scene_of(unit_cube(12, scenes::waves), ramp());
    for (const glm::dvec3& towards : {glm::dvec3(1, 0.2, 0.1), glm::dvec3(-0.3, -1, 0.4), glm::dvec3(0, 0, -1)}) {
        const Camera camera{.eye = {0.5, 0.25, 0.52}, .center = glm::dvec3(0.5, 0.25, 0.52) + towards, .up = {0.1, 1, 0}, .fov_y_degrees = 90};
        EXPECT_LT(error_of(scene, camera, small, by("exact:1e-5")), 2e-5);
    }
}

// Behind what is opaque nothing is looked at; what is left out is less than 1e-4 of it.
TEST(CpuGrid, OpaqueMediaEndEarly) {
    const TransferFunction thick{OpticalModel::density, {{0, {0, 0, 1}}, {1, {1, 0.5, 0}}}, {{0, 20}, {1, 200}}};
    const GridScene scene = scene_of(unit_cube(60, scenes::waves), thick);
    const GridScene thin = scene_of(unit_cube(60, scenes::waves), ramp());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    Statistics opaque, all;
    EXPECT_LT(error_of(scene, camera, few, by("exact:1e-4")), 3e-4);
    cpu().render(scene, camera, few, {}, &opaque);
    cpu().render(thin, camera, few, {}, &all);
    EXPECT_LT(opaque.counts.fragments, all.counts.fragments / 2);
}

TEST(CpuGrid, ThreadsAndInstructionSetsDoNotMatter) {
    std::mt19937_64 random(406);
    const GridScene scene = scene_of(random_grid(random, 20), scenes::table_peaks());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image image = cpu().render(scene, camera, {100, 70});
    const Image alone = make_grid_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {100, 70});
    EXPECT_EQ(max_difference(image, alone), 0);
    const std::string best = cpu::instruction_set();
    for (const std::string& name : cpu::instruction_sets()) {
        cpu::use_instruction_set(name);
        EXPECT_LT(max_difference(image, cpu().render(scene, camera, {100, 70})), 1e-4) << name;
    }
    cpu::use_instruction_set(best);
}

// A scene that changes in one part is drawn as if it were new.
TEST(CpuGrid, WhatIsKeptIsThatOfTheScene) {
    GridScene scene = scene_of(unit_cube(10, scenes::waves), ramp());
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const auto fresh = [&](const GridQuality& quality) { return make_grid_renderer(Backend::cpu)->render(scene, camera, small, quality); };
    cpu().render(scene, camera, small);
    scene.transfer = std::make_shared<const TransferFunction>(scenes::peaks());
    EXPECT_EQ(max_difference(cpu().render(scene, camera, small), fresh({})), 0);
    EXPECT_EQ(max_difference(cpu().render(scene, camera, small, by("exact:1e-4")), fresh(by("exact:1e-4"))), 0);
    scene.grid = std::make_shared<const Grid>(unit_cube(7, testing_support::linear));
    EXPECT_EQ(max_difference(cpu().render(scene, camera, small, by("exact:1e-4")), fresh(by("exact:1e-4"))), 0);
}

// Constant fields, values of any size, cells a million times as long as wide, extinctions from nothing to everything: finite, and
// colour 1 is as much as opacity.
TEST(CpuGrid, ExtremesStayFinite) {
    std::mt19937_64 random(407);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < (sanitized ? 40 : 200); ++trial) {
        const double range = std::pow(10, 20 * unit(random));
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes) axis = uniform_axis(1e6 * (trial % 2), std::pow(10, 3 * unit(random)), 2 + random() % 9);
        if (trial % 4 == 0) axes[0].coordinates.back() += 1e6, axes[0].spacing.reset();
        Grid grid = grid_of(axes, [&](const glm::dvec3&) { return trial % 7 == 0 ? range : range * unit(random); });
        const double peak = std::pow(10, 15 * unit(random));
        const TransferFunction transfer{trial % 3 == 0 ? OpticalModel::emitter : OpticalModel::density,
                                        {{-range, {1, 0, 1}}, {range, {0, 1, 1}}},
                                        {{-range, 0}, {0, 0}, {0, peak}, {range * 1e-6, peak}, {range * 1.1e-6, 0}, {range, peak}}};
        const Camera camera = frame_bounds(grid.bounds(), projections[static_cast<std::size_t>(trial % 2)],
                                           {unit(random), unit(random), trial % 5 == 0 ? 0 : unit(random)}, {0.1, 0.1, 1}, 1.2);
        const GridScene scene = scene_of(std::move(grid), transfer);
        for (const char* method : {"integral", "exact:1e-4", "preint2d-exp:32"}) {
            const Image image = cpu().render(scene, camera, {24, 20}, by(method));
            ASSERT_EQ(count_non_finite(image), 0U) << trial << ' ' << method;
            for (const glm::vec4& pixel : image.pixels) {
                ASSERT_TRUE(pixel.a >= 0 && pixel.a <= 1) << trial << ' ' << method;
                if (transfer.model() == OpticalModel::density) {
                    ASSERT_NEAR(pixel.b, pixel.a, 2e-3) << trial << ' ' << method;
                }
            }
        }
    }
}

TEST(CpuGrid, WhatItDoesNotDrawIsRefused) {
    const GridScene scene = scene_of(unit_cube(3, scenes::waves), ramp());
    const Camera camera = view_of_unit_cube(Projection::parallel);
    EXPECT_THROW(cpu().render(scene, camera, small, by("linear:8:vertices")), Error);
    EXPECT_THROW(cpu().render(scene, camera, small, {.target = TargetFormat::rgba8}), Error);
    EXPECT_THROW(cpu().render(scene, camera, {0, 4}), Error);
    Grid holes = *scene.grid;
    holes.blanked.assign(holes.cell_count(), 1);
    EXPECT_THROW(cpu().render(scene_of(holes, ramp()), camera, small), Error);
    Grid incomplete = *scene.grid;
    incomplete.values.pop_back();
    EXPECT_THROW(cpu().render(scene_of(incomplete, ramp()), camera, small), Error);
    EXPECT_NO_THROW(cpu().render(scene, camera, small));  // as if nothing had happened
}

}  // namespace
}  // namespace cellproj
