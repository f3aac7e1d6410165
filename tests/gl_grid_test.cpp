// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids in OpenGL against closed forms and the judge of grids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/gl/grid_gl_renderer.hpp"
#include "render/gl/grid_traversal.hpp"
#include "render/gl/osmesa_context.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace gl_grid_test {

using Projection = Camera::Projection;
using Field = std::function<double(const glm::dvec3&)>;

using testing_support::grid_of;
using testing_support::unit_cube;

GridScene scene_of(Grid grid, TransferFunction transfer) {
    return {std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(std::move(transfer))};
}

gl::GlGridRenderer& renderer() {
    static gl::GlGridRenderer one{std::make_unique<gl::OsmesaContext>(RendererOptions{}.osmesa_library)};
    return one;
}

Image draw(const GridScene& scene, const Camera& camera, ImageSize size, const std::string& method = "integral") {
    return renderer().render(scene, camera, size, {parse_method(method)}, nullptr);
}

glm::dvec4 pixel_of(const Light& light) { return {light.color, light.opacity}; }

// The largest difference from the judge, of all pixels or of some hundred of a larger picture.
double error_of(const GridScene& scene, const Camera& camera, ImageSize size, const std::string& method = "integral") {
    const Image image = draw(scene, camera, size, method);
    std::vector<PixelId> pixels = all_pixels(size);
    if (pixels.size() > 2500) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < pixels.size(); i += 211) pixels[kept++] = pixels[i];
        pixels.resize(kept);
    }
    double error = 0;
    for (const PixelTruth& truth : GridReference(scene.grid, scene.transfer).pixels(camera, size, pixels)) {
        error = std::max(error, testing_support::max_difference(pixel_of(truth.light),
                                                                glm::dvec4(image.at(truth.pixel.x, truth.pixel.y))));
    }
    return error;
}

// The judge takes most of the time.
constexpr ImageSize small = CELLPROJ_SANITIZED ? ImageSize{19, 17} : ImageSize{43, 41};

double bumps(const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(5 * p.x) * std::cos(4 * p.y + 3 * p.z); }

TransferFunction peaks() {
    return {OpticalModel::density,
            {{0.2, {1, 0, 0}}, {0.5, {0, 1, 0}}, {0.8, {0, 0, 1}}},
            {{0, 0.1}, {0.3, 0.1}, {0.31, 40}, {0.32, 0}, {0.6, 0}, {0.6, 9}, {0.7, 2}}};
}

// ---- The order ----

// Along any ray of any view, cells that are met first come last or, from front to back, first.
TEST(GridTraversal, CellsFollowEachOtherAlongEveryRay) {
    std::mt19937_64 random(501);
    std::uniform_real_distribution<double> both(-1, 1);
    GridAxis graded;
    for (int i = 0; i < 8; ++i) graded.coordinates.push_back(0.02 * i * i);
    const Grid grid = grid_of({uniform_axis(0, 0.2, 6), graded, uniform_axis(0, 0.25, 5)}, [](const glm::dvec3&) { return 0.0; });
    const Bounds box = grid.bounds();
    std::size_t pairs = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const bool parallel = trial % 4 == 0;
        glm::dvec3 eye(both(random), both(random), both(random));
        if (trial % 3 == 0) eye[trial % 9 / 3] = 0;  // along an axis
        if (!parallel) eye = box.center() + (trial % 4 == 1 ? 0.5 : 2.0) * (box.high - box.low) * eye;
        if (trial % 8 == 2) eye = {grid.axes[0].coordinates[2], grid.axes[1].coordinates[3], eye.z};  // on planes
        const std::vector<std::uint8_t> drawn(grid.cell_count(), 1);
        const bool reversed = trial % 5 < 2;
        gl::GridTraversal traversal(grid, {eye, parallel}, drawn,
                                    reversed ? gl::largest_slice_first(parallel ? -eye : box.center() - eye) : gl::GridOrder{});
        std::vector<std::size_t> place(grid.cell_count(), grid.cell_count());
        std::vector<std::uint32_t> chunk;
        std::size_t count = 0;
        for (traversal.next(7, chunk); !chunk.empty(); traversal.next(7, chunk)) {
            for (const std::uint32_t id : chunk) place[id] = count++;
        }
        ASSERT_EQ(count, grid.cell_count());
        for (int ray = 0; ray < 20; ++ray) {
            const glm::dvec3 inside = box.center() + 0.5 * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
            const glm::dvec3 direction = glm::normalize(parallel ? -eye : inside - eye);
            const auto cells = cells_along(grid, {parallel ? inside : eye, direction}, !parallel);
            for (std::size_t i = 1; i < cells.size(); ++i, ++pairs)
                ASSERT_EQ(place[grid.cell_id(cells[i].cell)] < place[grid.cell_id(cells[i - 1].cell)], !reversed) << trial;
        }
    }
    EXPECT_GT(pairs, 10000U);
}

TEST(GridTraversal, LeavesOutWhatIsNotDrawn) {
    const Grid grid = unit_cube(4, testing_support::linear);
    std::vector<std::uint8_t> drawn(64, 0);
    std::vector<std::uint32_t> cells;
    gl::GridTraversal(grid, Eye::at({3, 2, 1}), drawn).next(64, cells);
    EXPECT_TRUE(cells.empty());
    drawn[9] = drawn[63] = 1;
    gl::GridTraversal(grid, Eye::at({3, 2, 1}), drawn).next(64, cells);
    EXPECT_EQ(std::set<std::uint32_t>(cells.begin(), cells.end()), (std::set<std::uint32_t>{9, 63}));
}

// ---- Light ----

// 1 − exp(−τ·chord), whatever the axes, values, scale, place and view, from outside and inside.
TEST(GlGrid, AConstantMediumOfAnyResolutionSpacingAndView) {
    std::mt19937_64 random(502);
    std::uniform_real_distribution<double> unit(0, 1), both(-1, 1);
    const ImageSize size{23, 19};
    double largest = 0;
    std::size_t met = 0;
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 40 : 120); ++trial) {
        SCOPED_TRACE(trial);
        const double scale = std::pow(10, 12 * both(random));
        const glm::dvec3 place = scale * std::pow(10, 3 * unit(random)) * glm::dvec3(both(random), both(random), both(random));
        std::array<GridAxis, 3> axes;
        for (int a = 0; a < 3; ++a) {
            GridAxis& axis = axes[static_cast<std::size_t>(a)];
            const auto points = 2 + random() % 9;
            const double step = scale * std::pow(10, 0.5 * both(random)) / static_cast<double>(points);
            if (trial % 2 == 0) axis = uniform_axis(place[a], step, points);
            for (double x = place[a]; axis.points() < points; x += step * std::pow(10, both(random))) axis.coordinates.push_back(x);
        }
        const Grid grid = grid_of(axes, [&](const glm::dvec3&) { return both(random); });
        const Bounds box = grid.bounds();
        const double tau = 2 * unit(random) / box.diagonal();
        const auto somewhere = [&](double reach) {
            return box.center() + reach * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
        };
        Camera camera;
        camera.projection = trial % 3 == 0 ? Projection::parallel : Projection::perspective;
        camera.eye = somewhere(trial % 3 == 1 ? 0.5 : 3);
        camera.center = somewhere(0.5);
        camera.up = glm::normalize(glm::dvec3(0.1, 1, 0.3));
        camera.height = 0.8 * box.diagonal();
        camera.fov_y_degrees = 20 + 80 * unit(random);
        const ScreenTransform transform(camera, size);
        const bool perspective = transform.perspective();
        const Image image = draw(scene_of(grid, testing_support::constant_medium(tau)), camera, size,
                                 trial % 5 == 0 ? "homogeneous" : "integral");
        for (int y = 0; y < size.height; ++y) {
            for (int x = 0; x < size.width; ++x) {
                double length = 0;
                for (const GridCrossing& c : cells_along(grid, transform.ray({x + 0.5, y + 0.5}), perspective))
                    length += c.leave - c.enter;
                const double opacity = -std::expm1(-tau * length);
                const double error = testing_support::max_difference(glm::dvec4(image.at(x, y)), opacity * glm::dvec4(1, 0.5, 0.25, 1));
                largest = std::max(largest, error);
                met += opacity > 0.01 ? 1 : 0;
                // float32: places are good to 6e-8 of the distance to the eye, five diagonals at most, a hundred times as
                // much in chords of rays that graze a face; one rounding for each of up to 27 cells.
                ASSERT_LT(error, 2e-5) << x << " " << y;
            }
        }
    }
    RecordProperty("largest", std::to_string(largest));
    EXPECT_GT(met, 100U);
}

class GlGridViews : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Projections, GlGridViews, testing::Values(Projection::parallel, Projection::perspective));

// In a linear field segments are linear, and `integral` is exact.
TEST_P(GlGridViews, ALinearFieldIsExact) {
    const TransferFunction emitter{OpticalModel::emitter, {{0, {0, 0.4, 1}}, {1, {1, 0.2, 0}}}, {{0.1, 0}, {0.4, 3}, {0.9, 0.5}}};
    GridAxis graded;
    for (int i = 0; i < 6; ++i) graded.coordinates.push_back(0.04 * i * i);
    for (const TransferFunction& transfer : {testing_support::ramp(), peaks(), emitter}) {
        for (const GridAxis& axis : {uniform_axis(0, 0.2, 6), graded}) {
            const GridScene scene = scene_of(grid_of({axis, uniform_axis(0, 0.2, 6), axis}, testing_support::linear), transfer);
            // float32 places, 1e-7, on a function that rises by 4000 per unit of the scalar.
            EXPECT_LT(error_of(scene, testing_support::view_of_unit_cube(GetParam()), small), 2e-4);
            EXPECT_LT(error_of(scene, testing_support::view_of_unit_cube(GetParam(), {0, -2, 0}), small), 2e-4);
        }
    }
}

// In any other field the scalar along a ray is a cubic in each cell, of which `integral` takes the chord: of second order in the edges.
TEST_P(GlGridViews, AFieldIsRightToSecondOrderInTheEdges) {
    const Camera camera = testing_support::view_of_unit_cube(GetParam());
    const double coarse = error_of(scene_of(unit_cube(8, bumps), testing_support::ramp()), camera, {31, 33});
    const double fine = error_of(scene_of(unit_cube(24, bumps), testing_support::ramp()), camera, {31, 33});
    RecordProperty("8 cells", std::to_string(coarse));
    RecordProperty("24 cells", std::to_string(fine));
    EXPECT_LT(coarse, 2e-2);
    EXPECT_LT(fine, coarse / 5);  // 9 in the limit
}

// Each within three times what it has here, but for rounding.
TEST_P(GlGridViews, EveryMethodDrawsAsItShould) {
    const GridScene scene = scene_of(unit_cube(16, testing_support::linear), testing_support::ramp());
    const Camera camera = testing_support::view_of_unit_cube(GetParam());
    for (const auto& [method, bound] : std::vector<std::pair<std::string, double>>{
             {"average", 8e-2}, {"average:half", 5e-2}, {"homogeneous", 3e-4}, {"linear:4", 3e-5}, {"stein", 3e-4},
             {"preint2d:256", 4e-2}, {"preint2d-exp:256", 3e-4}, {"preint3d:64", 2e-4}, {"integral", 5e-6}}) {
        const double error = error_of(scene, camera, small, method);
        EXPECT_LT(error, bound) << method;
    }
}

// Values on cells are constant in each; blanked cells are empty, whatever they hold.
TEST_P(GlGridViews, BlankedCellsAreEmptyAndCellFieldsConstant) {
    std::mt19937_64 random(503);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const FieldLocation location : {FieldLocation::points, FieldLocation::cells}) {
        Grid grid = unit_cube(5, bumps);
        grid.location = location;
        grid.blanked.resize(125);
        for (auto& blanked : grid.blanked) blanked = unit(random) < 0.3 ? 1 : 0;
        if (location == FieldLocation::cells) {
            grid.values.resize(125);
            for (std::size_t c = 0; c < 125; ++c) grid.values[c] = grid.blanked[c] ? std::nan("") : unit(random);
        }
        const GridScene scene = scene_of(grid, testing_support::ramp());
        // Values on points: what the chord of the cubic costs, as above. Edges seen from the side are jumps then, off by 1e-7.
        EXPECT_LT(error_of(scene, testing_support::view_of_unit_cube(GetParam()), small),
                  location == FieldLocation::cells ? 2e-5 : 3e-2);
    }
}

// What a point cannot cover is drawn by rectangles: cells larger than the largest point, long ones, and those around the eye.
TEST(GlGrid, CellsOfAnySizeOnTheScreen) {
    const Field linear = testing_support::linear;
    for (const auto& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(0, -1, 0), glm::dvec3(1, 1, 0.001)}) {
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            const Camera camera = testing_support::view_of_unit_cube(projection, from);
            EXPECT_LT(error_of(scene_of(unit_cube(1, linear), testing_support::ramp()), camera, {401, 397}), 2e-5);
            const Grid oblong = grid_of({uniform_axis(0, 1.0 / 40, 41), uniform_axis(0, 1.0 / 40, 41), uniform_axis(0, 1, 2)}, linear);
            EXPECT_LT(error_of(scene_of(oblong, testing_support::ramp()), camera, {61, 57}), 2e-5);
        }
    }
    std::mt19937_64 random(504);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 4 : 12); ++trial) {
        SCOPED_TRACE(trial);
        Camera camera;
        camera.eye = {unit(random), unit(random), unit(random)};
        if (trial % 3 == 0) camera.eye[trial % 9 / 3] = 0.5;  // in a plane of the grid
        if (trial % 5 == 0) camera.eye = {0.5, 0.25, 0.75};   // at one of its points
        camera.center = {unit(random), unit(random), unit(random)};
        camera.fov_y_degrees = 100;
        EXPECT_LT(error_of(scene_of(unit_cube(trial % 2 == 0 ? 4 : 20, linear), testing_support::ramp()), camera, {33, 29}), 3e-5);
    }
}

// A picture after a change is that of a renderer that has seen nothing before.
TEST(GlGrid, SeesEveryChangeOfTheScene) {
    const Camera camera = testing_support::view_of_unit_cube(Projection::perspective);
    const ImageSize size{31, 29};
    const auto grid = std::make_shared<Grid>(unit_cube(6, bumps)), other = std::make_shared<Grid>(unit_cube(5, testing_support::linear));
    const auto ramp = std::make_shared<TransferFunction>(testing_support::ramp()), narrow = std::make_shared<TransferFunction>(peaks());
    for (const GridScene& scene : {GridScene{grid, ramp}, {grid, narrow}, {other, narrow}, {other, ramp}, {grid, ramp}}) {
        for (const std::string method : {"integral", "preint2d-exp:32"}) {
            gl::GlGridRenderer fresh{std::make_unique<gl::OsmesaContext>(RendererOptions{}.osmesa_library)};
            const Image image = draw(scene, camera, size, method);
            EXPECT_EQ(testing_support::max_difference(image, fresh.render(scene, camera, size, {parse_method(method)}, nullptr)), 0);
        }
    }
}

// Cells that hold nothing to see are not drawn, and the picture is the same.
TEST(GlGrid, LeavesOutCellsThatCannotBeSeen) {
    const TransferFunction upper{OpticalModel::density, {{0, {1, 0.5, 0.25}}}, {{0.5, 0}, {0.5, 3}}};
    const GridScene scene = scene_of(unit_cube(8, [](const glm::dvec3& p) { return p.x; }), upper);
    Statistics statistics;
    const Camera camera = testing_support::view_of_unit_cube(Projection::parallel);
    renderer().render(scene, camera, {31, 33}, {}, &statistics);
    EXPECT_EQ(statistics.counts.cells, 512U);
    EXPECT_EQ(statistics.counts.drawn, 5 * 64U);  // the cells that end at 0.5 as well: the step is theirs, too
    EXPECT_EQ(statistics.counts.culled, 3 * 64U);
    EXPECT_LT(error_of(scene, camera, {31, 33}), 2e-5);
}

// Both backends take the same segments from the same cells.
TEST_P(GlGridViews, AgreesWithTheCpuBackend) {
    const GridScene scene = scene_of(unit_cube(24, bumps), peaks());
    const Camera camera = testing_support::view_of_unit_cube(GetParam());
    const auto cpu = make_grid_renderer(Backend::cpu);
    for (const std::string method : {"integral", "homogeneous", "stein"}) {
        // Places of float32, 1e-7, on a function that rises by 4000 per unit of the scalar, over up to 70 cells.
        EXPECT_LT(testing_support::max_difference(draw(scene, camera, {65, 67}, method), cpu->render(scene, camera, {65, 67}, {parse_method(method)})), 3e-4)
            << method;
    }
}

// ---- Light at the vertices of templates ----

// WVG91 Fig. 3: in a constant volume no cell shows with exponential interpolation. With Gouraud their borders do: opacity is right at the
// vertices of templates and too low between them.
TEST_P(GlGridViews, GouraudShowsTheCellsOfAConstantVolume) {
    const GridScene scene = scene_of(unit_cube(4, testing_support::linear), testing_support::constant_medium(2));
    const Camera camera = testing_support::view_of_unit_cube(GetParam());
    EXPECT_LT(error_of(scene, camera, small, "homogeneous"), 2e-6);
    const double coarse = error_of(scene, camera, small, "homogeneous:vertices");
    EXPECT_GT(coarse, 3e-2);
    EXPECT_LT(coarse, 1e-1);
    const double fine =
        error_of(scene_of(unit_cube(16, testing_support::linear), testing_support::constant_medium(2)), camera, small, "homogeneous:vertices");
    EXPECT_LT(fine, coarse / 3);  // 1 − e^(−τl) bends by (τl)², over a number of cells that grows with 1/l
    RecordProperty("borders of 4 cells", std::to_string(coarse));
    RecordProperty("borders of 16 cells", std::to_string(fine));
}

// The template that the device moves from cell to cell, and a template for every cell: the same picture. (Not where axes tie: there the
// last bit of an edge's length decides along which diagonal quadrilaterals are cut.)
TEST(GlGrid, MovedTemplatesAreThoseOfEveryCell) {
    Grid grid = unit_cube(7, bumps);
    const GridScene uniform = scene_of(grid, testing_support::ramp());
    for (GridAxis& axis : grid.axes) axis.spacing.reset();
    const GridScene rectilinear = scene_of(grid, testing_support::ramp());
    for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(1, 1.2, 0), glm::dvec3(0, -1, 0), glm::dvec3(-1, 2, 3.1)}) {
        const Camera camera = testing_support::view_of_unit_cube(Projection::parallel, from);
        for (const std::string method : {"average:vertices", "average:half:vertices", "homogeneous:vertices", "linear:4:vertices"}) {
            const Image moved = draw(uniform, camera, {61, 59}, method), streamed = draw(rectilinear, camera, {61, 59}, method);
            // Where the rasterizer's rounding of an edge falls to the other side of a pixel centre, half a percent of a cell.
            EXPECT_LT(testing_support::max_difference(moved, streamed), 2e-3) << method;
        }
    }
}

TEST_P(GlGridViews, LightAtVerticesTendsToTheJudge) {
    const Camera camera = testing_support::view_of_unit_cube(GetParam());
    for (const auto& [method, bound] : std::vector<std::pair<std::string, double>>{{"average:vertices", 6e-2},
                                                                                   {"average:half:vertices", 6e-2},
                                                                                   {"homogeneous:vertices", 4e-2},
                                                                                   {"linear:4:vertices", 4e-2}}) {
        const double coarse = error_of(scene_of(unit_cube(6, bumps), testing_support::ramp()), camera, small, method);
        const double fine = error_of(scene_of(unit_cube(24, bumps), testing_support::ramp()), camera, small, method);
        EXPECT_LT(fine, bound) << method;
        EXPECT_LT(fine, coarse / 3) << method;
    }
}

// Cells that come too near for a projection are drawn per pixel: nothing is lost, whatever the eye is in.
TEST(GlGrid, LightAtVerticesFromInside) {
    std::mt19937_64 random(505);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 3 : 10); ++trial) {
        SCOPED_TRACE(trial);
        Camera camera;
        camera.eye = {unit(random), unit(random), unit(random)};
        camera.center = {unit(random), unit(random), unit(random)};
        camera.fov_y_degrees = 90;
        EXPECT_LT(error_of(scene_of(unit_cube(12, testing_support::linear), testing_support::constant_medium(2)), camera, {33, 29}, "homogeneous:vertices"), 5e-2);
    }
}

// In perspective, too, whatever the eye's distance; and it is told.
TEST(GlGrid, CellsSmallerThanAPixelAreOnePointEach) {
    const GridScene scene = scene_of(unit_cube(24, bumps), testing_support::ramp());
    const auto reason = [](const Statistics& statistics) {
        const auto segments = std::ranges::find_if(statistics.plan, [](const Decision& decision) { return decision.rule == "segments"; });
        return segments == statistics.plan.end() ? std::string() : segments->why;
    };
    for (const auto projection : {Projection::parallel, Projection::perspective}) {
        const Camera camera = testing_support::view_of_unit_cube(projection);
        Statistics statistics;
        const Image image = renderer().render(scene, camera, {17, 13}, {parse_method("homogeneous:vertices")}, &statistics);
        EXPECT_EQ(statistics.counts.triangles, 2 * statistics.counts.drawn);
        EXPECT_EQ(testing_support::max_difference(image, draw(scene, camera, {17, 13}, "homogeneous")), 0);
        EXPECT_NE(reason(statistics).find("smaller than pixels"), std::string::npos) << reason(statistics);
        renderer().render(scene, camera, {160, 120}, {parse_method("homogeneous:vertices")}, &statistics);
        EXPECT_GT(statistics.counts.triangles, statistics.counts.drawn * 10);  // three visible faces: 5 quads and 2 triangles
        EXPECT_EQ(reason(statistics).find("pixels"), std::string::npos) << reason(statistics);
    }
}

// ---- What it does not draw ----

TEST(GlGrid, RefusesByName) {
    const GridScene scene = scene_of(unit_cube(2, bumps), testing_support::ramp());
    const Camera camera = testing_support::view_of_unit_cube(Projection::parallel);
    for (const char* method : {"exact", "shirley-tuchman"}) {
        try {
            draw(scene, camera, {8, 8}, method);
            ADD_FAILURE() << method;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(method), std::string::npos);
        }
    }
    Grid broken = unit_cube(2, bumps);
    broken.values[3] = std::nan("");
    EXPECT_THROW(draw(scene_of(broken, testing_support::ramp()), camera, {8, 8}), Error);
    EXPECT_THROW(draw(scene, camera, {0, 8}), Error);
    EXPECT_NO_THROW(draw(scene, camera, {8, 8}));  // and is as good as new
}

}  // namespace
}  // namespace cellproj
