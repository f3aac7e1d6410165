// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces of regular grids by the CPU backend and, as slabs, by OpenGL: closed forms and the judge of grids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
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
#include "tests/support/spherical_harmonic.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace grid_surfaces_test {

using testing_support::constant_medium;
using testing_support::grid_of;
using testing_support::max_difference;
using testing_support::ramp;
using testing_support::unit_cube;
using testing_support::view_of_unit_cube;

using Projection = Camera::Projection;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{20, 16} : ImageSize{48, 40}, few{20, 16};
const std::vector<Projection> projections{Projection::parallel, Projection::perspective};

// How far silhouettes may be off [pixels]. float32 tells a scalar to some 1e-6 of the field's range. Where a ray just touches a surface
// that is what decides whether it is seen, and light jumps.
constexpr double float32_slack = 1e-3;

GridRenderer& cpu() {
    static const auto shared = make_grid_renderer(Backend::cpu);
    return *shared;
}

std::shared_ptr<const SurfaceScene> surfaces_of(std::vector<IsoSurface> surfaces, Shading shading = Shading::unlit, Lighting lighting = {}) {
    return std::make_shared<const SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(surfaces)), shading, std::move(lighting)});
}

GridScene scene_of(Grid grid, TransferFunction transfer, std::shared_ptr<const SurfaceScene> surfaces) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(std::move(transfer)), std::move(surfaces)};
}

GridQuality by(const std::string& method) { return {.method = parse_method(method)}; }

// The largest error of any channel. Where it is more than `tolerance`, against what the judge sees within `slack` pixels, too.
double error_of(const Image& image, const GridScene& scene, const Camera& camera, double tolerance, double slack = float32_slack) {
    return testing_support::error_but_for_silhouettes(image, GridReference(scene), camera, tolerance, slack);
}

// Normals: where gradients nearly vanish, float32 turns them.
constexpr double tolerance = 2e-4;

void expect_right(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {}) {
    EXPECT_LT(error_of(cpu().render(scene, camera, size, quality), scene, camera, tolerance), tolerance);
}

const TransferFunction no_medium = constant_medium(0);

Lighting two_lights() {
    Lighting lighting;
    lighting.lights.push_back({.towards = glm::dvec3(1, -2, 0.5), .color = {1, 0.5, 0.2}, .diffuse = 0.5, .specular = 0.6});
    return lighting;
}

// Three translucent ones.
std::vector<IsoSurface> glass(double low, double middle, double high) {
    return {{.value = low, .color = {1, 0.4, 0.1}, .opacity = 0.35},
            {.value = middle, .color = {0.3, 1, 0.3}, .opacity = 0.5, .back_color = glm::dvec3(0.8, 0.1, 0.9)},
            {.value = high, .color = {0.2, 0.4, 1}, .opacity = 0.7}};
}

// EKE01's volume, 16³ points, with three translucent surfaces; `middle`: of the second one, as a share of the highest scalar.
GridScene harmonic_scene(double middle) {
    const Grid grid = testing_support::spherical_harmonic(16);
    const double high = units_of(grid).scalar_high;
    return scene_of(grid, no_medium, surfaces_of(glass(-0.4 * high, middle * high, 0.4 * high)));
}
Camera view_of_harmonic(const GridScene& scene, Projection projection) {
    return frame_bounds(scene.grid->bounds(), projection, {0.2, -1, 0.1}, {0, 0, 1}, 1.0);
}

GridAxis uneven_axis(std::mt19937_64& random, std::size_t points) {
    std::uniform_real_distribution<double> both(-1, 1);
    GridAxis axis;
    for (double x = 0; axis.points() < points; x += std::pow(10, 0.5 * both(random)) / static_cast<double>(points)) axis.coordinates.push_back(x);
    return axis;
}

// Planes in the planes of the grid, through all its points: once for every ray, along axes, diagonals, edges and faces, and where bricks that
// show nothing are leapt over up to the very plane of the surface.
TEST(CpuGridSurfaces, PlanesInThePlanesOfTheGrid) {
    for (const std::size_t cells : {1U, 4U, 32U, 64U}) {
        if (sanitized && cells == 64) continue;
        for (const double v : {0.25, 0.5, 0.75}) {
            for (int axis = 0; axis < 3; ++axis) {
                const GridScene scene = scene_of(unit_cube(cells, [&](const glm::dvec3& p) { return p[axis]; }), no_medium,
                                                 surfaces_of({{.value = v, .color = {0.5, 1, 0}, .opacity = 0.75, .back_color = glm::dvec3(1, 0, 0)}}));
                for (const double side : {-1.0, 1.0}) {
                    glm::dvec3 towards(0.0), up(0.0);
                    towards[axis] = side;
                    up[(axis + 1) % 3] = 1;
                    Camera camera{.projection = Projection::parallel, .up = up, .height = 2};
                    // 16 pixels across 2 units, seen off by half a pixel: rays along the planes of the grid.
                    camera.center = glm::dvec3(0.4375);
                    camera.eye = camera.center + 5.0 * towards;
                    const Image image = cpu().render(scene, camera, {16, 16});
                    int seen = 0;
                    for (const glm::vec4& pixel : image.pixels) {
                        if (pixel.a == 0) continue;
                        ++seen;
                        ASSERT_NEAR(pixel.a, 0.75, 1e-6) << cells << ' ' << v << ' ' << axis;
                        ASSERT_NEAR(pixel.g, side < 0 ? 0.75 : 0, 1e-6);  // the scalar rises along +axis: its front is seen
                        ASSERT_NEAR(pixel.r, side < 0 ? 0.375 : 0.75, 1e-6);
                    }
                    EXPECT_EQ(seen, 64);
                    for (const Projection projection : projections) {
                        const Camera oblique = frame_bounds(scene.grid->bounds(), projection, {side, 0.4 * side, 0.77}, {0.1, 0.2, 1}, 1.2);
                        const double error = error_of(cpu().render(scene, oblique, {20, 16}), scene, oblique, 1e-5);
                        ASSERT_LT(error, 1e-5) << cells << ' ' << v << ' ' << axis;
                    }
                }
            }
        }
    }
}

// More surfaces than are counted one by one, and more in a cell than a packet's steps: 1 − (1 − α)^n.
TEST(CpuGridSurfaces, AsManyAsThereAre) {
    for (const int count : {1, 7, 8, 9, 100, 301}) {
        std::vector<IsoSurface> surfaces;
        for (int i = 0; i < count; ++i) surfaces.push_back({.value = 0.1 + 0.8 * i / count, .opacity = 1.0 / count});
        const double opacity = 1 - std::pow(1 - 1.0 / count, count);
        for (const std::size_t cells : {1U, 3U, 50U}) {
            const GridScene scene = scene_of(unit_cube(cells, [](const glm::dvec3& p) { return p.z; }), no_medium, surfaces_of(surfaces));
            Camera camera{.projection = Projection::parallel, .eye = {0.5, 0.5, 4}, .center = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .height = 0.8};
            const Image image = cpu().render(scene, camera, {9, 7});
            for (const glm::vec4& pixel : image.pixels) ASSERT_NEAR(pixel.a, opacity, 1e-5) << count << ' ' << cells;
        }
    }
}

// Every root of the cubic in its order, the medium cut at each, lit as it should be, on even and uneven axes.
TEST(CpuGridSurfaces, RandomFieldsAgainstTheJudge) {
    std::mt19937_64 random(501);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < (sanitized ? 4 : 9); ++trial) {
        GridAxis axis = uniform_axis(0, 0.25, 5);
        const bool uniform = trial % 3 != 0;
        const auto value = [&](const glm::dvec3&) { return unit(random); };
        const Grid grid = uniform ? grid_of({axis, axis, axis}, value) : grid_of({uneven_axis(random, 5), uneven_axis(random, 6), uneven_axis(random, 4)}, value);
        const Shading shading = std::array{Shading::flat, Shading::smooth, Shading::unlit}[static_cast<std::size_t>(trial % 3)];
        const GridScene alone = scene_of(grid, no_medium, surfaces_of(glass(0.3, 0.5, 0.8), shading, two_lights()));
        const GridScene mixed = scene_of(grid, ramp(), alone.surfaces);
        const Camera camera = frame_bounds(grid.bounds(), projections[static_cast<std::size_t>(trial % 2)], {unit(random), -unit(random), unit(random)}, {0.1, 0.2, 1}, 1.2);
        expect_right(alone, camera, small);
        expect_right(mixed, camera, small, by("exact:1e-5"));
    }
}

// With one line from surface to surface the medium is right to second order in the edges, as without surfaces.
TEST(CpuGridSurfaces, LinesBetweenThemConverge) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const auto error = [&](std::size_t cells, const char* method) {
        const GridScene scene = scene_of(unit_cube(cells, scenes::waves), ramp(), surfaces_of(glass(0.3, 0.5, 0.7)));
        return error_of(cpu().render(scene, camera, small, by(method)), scene, camera, 1.0);
    };
    for (const char* method : {"integral", "preint2d-exp:256", "linear:32"}) EXPECT_LT(error(24, method), std::max(0.35 * error(10, method), 2e-3)) << method;
}

// Must-show 6 of regular volumes (EKE01 §5.2, the double hit): translucent surfaces show no rings.
TEST(CpuGridSurfaces, TheSphericalHarmonicHasNoRings) {
    const GridScene scene = harmonic_scene(0);  // three planes that cross each other
    const ImageSize size = sanitized ? ImageSize{40, 32} : ImageSize{120, 100};
    for (const Projection projection : projections) {
        const Camera camera = view_of_harmonic(scene, projection);
        const Image image = cpu().render(scene, camera, size);
        EXPECT_LT(error_of(image, scene, camera, 1e-5), 1e-5);
        float most = 0;
        for (const glm::vec4& pixel : image.pixels) most = std::max(most, pixel.a);
        EXPECT_GT(most, 0.9F);
    }
}

// Blanked cells hold no surface, nor does the jump over them; values of points that only they have count for nothing.
TEST(CpuGridSurfaces, BlankedCells) {
    Grid grid = unit_cube(9, scenes::waves);
    grid.blanked.assign(grid.cell_count(), 0);
    for (std::size_t k = 2; k < 7; ++k)
        for (std::size_t j = 2; j < 7; ++j)
            for (std::size_t i = 0; i < 7; ++i) grid.blanked[grid.cell_id({i, j, k})] = 1;
    const GridDimensions n = grid.dimensions();
    grid.values[3 + n.ni * (4 + n.nj * 4)] = std::numeric_limits<double>::quiet_NaN();
    grid.values[4 + n.ni * (4 + n.nj * 4)] = 1e300;
    const GridUnits units = units_of(grid);
    const auto at = [&](double share) { return units.scalar_low + share * (units.scalar_high - units.scalar_low); };
    for (const TransferFunction& medium : {no_medium, ramp()}) {
        const GridScene scene = scene_of(grid, medium, surfaces_of(glass(at(0.3), at(0.5), at(0.8)), Shading::smooth));
        for (const Projection projection : projections) expect_right(scene, view_of_unit_cube(projection), small, by("exact:1e-5"));
    }
}

// Most of a large grid shows nothing: rays leap to the surfaces, from all sides, also from inside, and lose none.
TEST(CpuGridSurfaces, LeapsOverEmptySpace) {
    std::mt19937_64 random(502);
    std::uniform_real_distribution<double> both(-1, 1);
    const std::size_t n = sanitized ? 50 : 90;
    for (const bool uniform : {true, false}) {
        const GridAxis even = uniform_axis(0, 1.0 / static_cast<double>(n - 1), n);
        const std::array<GridAxis, 3> axes = uniform ? std::array{even, even, even}
                                                     : std::array{uneven_axis(random, n), uneven_axis(random, n), uneven_axis(random, n)};
        const glm::dvec3 high{axes[0].coordinates.back(), axes[1].coordinates.back(), axes[2].coordinates.back()};
        const auto distance = [&](const glm::dvec3& p) { return glm::length(p / high - glm::dvec3(0.5, 0.45, 0.6)); };
        const GridScene scene = scene_of(grid_of(axes, distance), no_medium, surfaces_of(glass(0.1, 0.2, 0.205), Shading::smooth));
        for (int view = 0; view < 6; ++view) {
            Camera camera = frame_bounds(scene.grid->bounds(), projections[static_cast<std::size_t>(view % 2)], {both(random), both(random), both(random)},
                                         {0.1, 0.3, 1}, 1.2);
            if (view == 5) camera.eye = high * glm::dvec3(0.5, 0.45, 0.6);
            Statistics statistics;
            cpu().render(scene, camera, small, {}, &statistics);
            EXPECT_GT(statistics.counts.culled, statistics.counts.cells / 4);
            expect_right(scene, camera, few);
        }
    }
}

// Behind opaque surfaces nothing is looked at.
TEST(CpuGridSurfaces, OpaqueSurfacesEndRays) {
    const GridScene thin = scene_of(unit_cube(60, [](const glm::dvec3& p) { return p.x; }), ramp(), surfaces_of({{.value = 0.9, .opacity = 0.1}}));
    const GridScene opaque = scene_of(*thin.grid, ramp(), surfaces_of({{.value = 0.9}}));
    const Camera camera = frame_bounds(thin.grid->bounds(), Projection::perspective, {1, 0.1, 0.1}, {0, 0, 1}, 1.2);
    Statistics all, first;
    cpu().render(thin, camera, small, {}, &all);
    cpu().render(opaque, camera, small, {}, &first);
    EXPECT_LT(first.counts.fragments, all.counts.fragments / 3);
    expect_right(opaque, camera, small, by("exact:1e-5"));
}

// Constant fields, values, sizes and places of any magnitude, isovalues at points, outside, one beside the other: finite.
TEST(CpuGridSurfaces, ExtremesStayFinite) {
    std::mt19937_64 random(503);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < (sanitized ? 40 : 200); ++trial) {
        const double range = std::pow(10, 20 * unit(random));
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes) axis = uniform_axis(1e6 * (trial % 2), std::pow(10, 3 * unit(random)), 2 + random() % 9);
        if (trial % 4 == 0) axes[0].coordinates.back() += 1e6, axes[0].spacing.reset();
        const Grid grid = grid_of(axes, [&](const glm::dvec3&) { return trial % 7 == 0 ? range : range * std::round(2 * unit(random)) / 2; });
        const std::vector<IsoSurface> surfaces{{.value = -2 * range, .opacity = 0.5}, {.value = 0, .opacity = 0.5}, {.value = range * 1e-12, .opacity = 0.5},
                                               {.value = range / 2, .opacity = 0.5}, {.value = range, .opacity = 0.5}, {.value = range * (1 + 1e-15)}};
        const Camera camera = frame_bounds(grid.bounds(), projections[static_cast<std::size_t>(trial % 2)], {unit(random), unit(random), trial % 5 == 0 ? 0 : unit(random)},
                                           {0.1, 0.1, 1}, 1.2);
        const Shading shading = trial % 3 == 0 ? Shading::smooth : Shading::flat;
        const GridScene scene = scene_of(grid, trial % 2 == 0 ? no_medium : constant_medium(1 / grid.bounds().diagonal()), surfaces_of(surfaces, shading, two_lights()));
        const Image image = cpu().render(scene, camera, {24, 20}, by(trial % 2 == 0 ? "integral" : "exact:1e-3"));
        ASSERT_EQ(count_non_finite(image), 0U) << trial;
        for (const glm::vec4& pixel : image.pixels) ASSERT_TRUE(pixel.a >= 0 && pixel.a <= 1) << trial;
    }
}

TEST(CpuGridSurfaces, ThreadsAndInstructionSetsDoNotMatter) {
    const GridScene scene = scene_of(unit_cube(20, scenes::waves), ramp(), surfaces_of(glass(0.3, 0.5, 0.7), Shading::smooth, two_lights()));
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image image = cpu().render(scene, camera, {100, 70});
    const Image alone = make_grid_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {100, 70});
    EXPECT_EQ(max_difference(image, alone), 0);
    const std::string best = cpu::instruction_set();
    for (const std::string& name : cpu::instruction_sets()) {
        cpu::use_instruction_set(name);
        EXPECT_LT(max_difference(image, cpu().render(scene, camera, {100, 70})), 1e-3) << name;
    }
    cpu::use_instruction_set(best);
}

TEST(CpuGridSurfaces, WhatIsKeptIsThatOfTheScene) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    GridScene scene = scene_of(unit_cube(10, scenes::waves), ramp(), nullptr);
    const auto same = [&] {
        EXPECT_EQ(max_difference(cpu().render(scene, camera, small), make_grid_renderer(Backend::cpu)->render(scene, camera, small)), 0);
    };
    same();
    for (const Shading shading : {Shading::unlit, Shading::smooth, Shading::flat}) {
        scene.surfaces = surfaces_of(glass(0.2, 0.5, 0.7), shading);
        same();
    }
    scene.surfaces = surfaces_of(glass(0.2, 0.5, 0.8), Shading::smooth);
    same();
    scene.transfer = std::make_shared<const TransferFunction>(no_medium);
    same();
    scene.grid = std::make_shared<const Grid>(unit_cube(7, testing_support::linear));
    same();
    scene.surfaces = surfaces_of({});
    same();
    scene.surfaces = nullptr;
    same();
}

TEST(CpuGridSurfaces, WhatTheyCannotBeIsRefused) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    GridScene scene = scene_of(unit_cube(3, scenes::waves), ramp(), surfaces_of({{.value = 0.5}}));
    EXPECT_NO_THROW(cpu().render(scene, camera, small));
    EXPECT_THROW(cpu().render(scene, camera, small, by("average:half")), Error);
    Grid cells = *scene.grid;
    cells.location = FieldLocation::cells;
    cells.values.resize(cells.cell_count());
    EXPECT_THROW(cpu().render(scene_of(cells, ramp(), scene.surfaces), camera, small), Error);
    Lighting dark;
    dark.exponent = 0;
    EXPECT_THROW(cpu().render(scene_of(*scene.grid, ramp(), surfaces_of({{.value = 0.5}}, Shading::flat, dark)), camera, small), Error);
    EXPECT_NO_THROW(cpu().render(scene, camera, small));
}

// ---- Cells and slabs, by OpenGL ----

GridRenderer& gl() {
    static const auto shared = make_grid_renderer(Backend::gl_osmesa);
    return *shared;
}

GridQuality slabs(const std::string& sampling, const std::string& method = "integral") {
    return {.method = parse_method(method), .sampling = parse_grid_sampling(sampling)};
}

// A linear scalar is linear in slabs: nothing is left of the error but float32 and what texture units make of weights. Planes of the grid and
// isovalues at points among them; several lights; surfaces alone and in a medium.
TEST(GlGridSurfaces, ALinearFieldIsExact) {
    for (const auto& [shading, medium] : {std::pair(Shading::flat, no_medium), std::pair(Shading::smooth, ramp()), std::pair(Shading::unlit, ramp())}) {
        const GridScene scene = scene_of(unit_cube(8, testing_support::linear), medium, surfaces_of(glass(0.31, 0.5, 0.75), shading, two_lights()));
        for (const Projection projection : projections) {
            const Camera camera = view_of_unit_cube(projection);
            for (const char* sampling : {"cells", "object:8:x2", "view:31:x2"}) {
                const Image image = gl().render(scene, camera, few, slabs(sampling));
                EXPECT_LT(error_of(image, scene, camera, 1e-4, 0.01), 1e-4) << sampling;
            }
        }
    }
}

// However few the slabs: a ray that begins and ends outside of closed surfaces crosses each of them an even number of times, so that its
// opacity is one of 1 − (1/2)^(2n). A crossing that two slabs show, or none does, is another one: EKE01's rings.
TEST(GlGridSurfaces, NoCrossingIsShownTwiceOrLost) {
    const auto ball = [](const glm::dvec3& p) { return 1 - 2 * glm::length(p - glm::dvec3(0.5)); };  // 0 and less on the faces of the cube
    const GridScene scene = scene_of(unit_cube(16, ball), no_medium, surfaces_of({{.value = 0.1, .opacity = 0.5}, {.value = 0.5, .opacity = 0.5}}));
    for (const Projection projection : projections) {
        for (const glm::dvec3& from : {glm::dvec3(0, 0, 1), glm::dvec3(-1, 0, 0), glm::dvec3(1.3, -2.1, 0.9)}) {
            const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, projection, from, {0.1, 0.9, 0.2}, 1.0);
            for (const char* sampling : {"cells", "object:3", "object:16", "object:15:x4", "view:4", "view:40", "view:41:x3", "view:333:x16"}) {
                const Image image = gl().render(scene, camera, {61, 53}, slabs(sampling));
                int seen = 0;
                for (const glm::vec4& pixel : image.pixels) {
                    const double pairs = -0.5 * std::log2(1 - pixel.a);
                    ASSERT_NEAR(pairs, std::round(pairs), 1e-4) << sampling;
                    seen += pairs > 1.5 ? 1 : 0;
                }
                EXPECT_GT(seen, 50) << sampling;
            }
        }
    }
}

// The roots of cells are exact: three planes that cross each other, and noise with isovalues at many points, on even and uneven axes, beside
// blanked cells.
TEST(GlGridSurfaces, CellsHaveEveryRoot) {
    const GridScene harmonic = harmonic_scene(0);
    for (const Projection projection : projections) {
        const Camera camera = view_of_harmonic(harmonic, projection);
        EXPECT_LT(error_of(gl().render(harmonic, camera, small, slabs("cells")), harmonic, camera, 1e-5), 1e-5);
    }
    std::mt19937_64 random(504);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < 6; ++trial) {
        const GridAxis even = uniform_axis(0, 0.25, 5);
        const auto value = [&](const glm::dvec3&) { return trial < 3 ? unit(random) : 0.25 * static_cast<double>(random() % 5); };
        Grid grid = trial % 2 == 0 ? grid_of({even, even, even}, value) : grid_of({uneven_axis(random, 5), uneven_axis(random, 6), uneven_axis(random, 4)}, value);
        grid.blanked.assign(grid.cell_count(), 0);
        grid.blanked[5] = grid.blanked[17] = grid.blanked[33] = 1;
        const Shading shading = std::array{Shading::flat, Shading::smooth, Shading::unlit}[static_cast<std::size_t>(trial % 3)];
        const GridScene scene = scene_of(grid, no_medium, surfaces_of(trial < 3 ? glass(0.3, 0.5, 0.8) : glass(0.25, 0.6, 0.75), shading, two_lights()));
        const Camera camera = frame_bounds(grid.bounds(), projections[static_cast<std::size_t>(trial % 2)], {unit(random), -unit(random), unit(random)}, {0.1, 0.2, 1}, 1.2);
        EXPECT_LT(error_of(gl().render(scene, camera, few, slabs("cells")), scene, camera, tolerance, 0.01), tolerance) << trial;
    }
}

// Clipping planes cut rays in cells before surfaces do: as on the CPU.
TEST(GlGridSurfaces, CellsAreClipped) {
    GridScene scene = scene_of(unit_cube(8, scenes::waves), ramp(), surfaces_of(glass(0.3, 0.5, 0.7), Shading::smooth));
    scene.clip = std::make_shared<const ClipRegion>(ClipRegion{{{.point = {0.43, 0.5, 0.5}, .normal = {1, 0.3, -0.2}}}});
    for (const Projection projection : projections) {
        const Camera camera = view_of_unit_cube(projection);
        const Image by_rays = cpu().render(scene, camera, small), by_cells = gl().render(scene, camera, small, slabs("cells"));
        std::size_t different = 0;  // both cut at the same places, but for float32 at silhouettes
        for (std::size_t i = 0; i < by_rays.pixels.size(); ++i) different += glm::length(by_rays.pixels[i] - by_cells.pixels[i]) > 1e-3F ? 1 : 0;
        EXPECT_LE(different, 2U);
    }
}

// Must-show 6 for slabs: enough of them are within 1e-3 of the judge at every ray. Lines between slices move surfaces, by a hundredth of a
// pixel here; rays that just touch one see it or not. (Where two sheets cross each other, as those of 0 do, slabs as thick as their distance
// show neither.)
TEST(GlGridSurfaces, TheSphericalHarmonicHasNoRings) {
    const GridScene scene = harmonic_scene(0.15);
    const ImageSize size = sanitized ? ImageSize{24, 20} : ImageSize{60, 50};
    for (const Projection projection : projections) {
        const Camera camera = view_of_harmonic(scene, projection);
        const char* sampling = projection == Projection::parallel ? "object:400:x4" : "view:500:x4";
        EXPECT_LT(error_of(gl().render(scene, camera, size, slabs(sampling)), scene, camera, 1e-3, 0.02), 1e-3) << sampling;
    }
}

// Twice the slabs, a quarter of the error: of the light of lit surfaces and the medium between, too. Told by nine tenths of the rays; one that just
// touches a surface sees it or not, which is no matter of second order.
TEST(GlGridSurfaces, SlabsConverge) {
    const GridScene scene = scene_of(unit_cube(6, scenes::waves), ramp(), surfaces_of(glass(0.3, 0.5, 0.7), Shading::smooth));
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const std::vector<PixelTruth> truths = GridReference(scene.grid, scene.transfer, scene.surfaces).pixels(camera, small, all_pixels(small));
    const auto error = [&](const char* sampling) {
        const Image image = gl().render(scene, camera, small, slabs(sampling));
        std::vector<double> errors;
        for (const PixelTruth& truth : truths) {
            const glm::dvec4 e = error_of_pixel(image, truth);
            errors.push_back(std::max({e.r, e.g, e.b}));
        }
        const auto ninth = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() * 9 / 10);
        std::nth_element(errors.begin(), ninth, errors.end());
        return *ninth;
    };
    EXPECT_LT(error("view:100"), 0.35 * error("view:50"));
    EXPECT_LT(error("view:800"), 1e-5);
}

TEST(GlGridSurfaces, SeeEveryChangeOfTheScene) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    GridScene scene = scene_of(unit_cube(10, scenes::waves), ramp(), nullptr);
    const auto same = [&](const char* sampling = "view:20") {
        const Image fresh = make_grid_renderer(Backend::gl_osmesa)->render(scene, camera, small, slabs(sampling));
        EXPECT_EQ(max_difference(gl().render(scene, camera, small, slabs(sampling)), fresh), 0);
    };
    same("view:20:pre");
    for (const Shading shading : {Shading::unlit, Shading::smooth, Shading::flat}) {
        scene.surfaces = surfaces_of(glass(0.2, 0.5, 0.7), shading);
        same();
    }
    const auto good = scene.surfaces;
    Lighting dark;
    dark.exponent = 0;
    scene.surfaces = surfaces_of({{.value = 0.5}}, Shading::flat, dark);
    EXPECT_THROW(gl().render(scene, camera, small, slabs("view:20")), Error);
    scene.surfaces = good;
    same();
    scene.transfer = std::make_shared<const TransferFunction>(no_medium);
    same();
    scene.grid = std::make_shared<const Grid>(unit_cube(7, testing_support::linear));
    same();
    scene.surfaces = surfaces_of(glass(0.2, 0.5, 0.7));
    same("cells");
    scene.surfaces = nullptr;
    same("cells");
}

TEST(GlGridSurfaces, WhatSlabsCannotShowIsRefused) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const GridScene scene = scene_of(unit_cube(3, scenes::waves), ramp(), surfaces_of({{.value = 0.5}}));
    EXPECT_NO_THROW(gl().render(scene, camera, small, slabs("object:4")));
    for (const char* sampling : {"object:4:pre", "view:4:post"}) EXPECT_THROW(gl().render(scene, camera, small, slabs(sampling)), Error) << sampling;
    EXPECT_THROW(gl().render(scene, camera, small, slabs("object:4", "average:half")), Error);
}

}  // namespace
}  // namespace cellproj
