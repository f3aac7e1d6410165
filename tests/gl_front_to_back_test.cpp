// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids in OpenGL from front to back, which stops behind opaque tiles, against the same pictures from back to front and the judge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "mesh/error.hpp"
#include "render/gl/grid_traversal.hpp"
#include "render/grid_plan.hpp"
#include "render/grid_renderer.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace gl_front_to_back_test {

using testing_support::max_difference;
using testing_support::unit_cube;
using Projection = Camera::Projection;

GridRenderer& renderer() {
    static const auto one = make_grid_renderer(Backend::gl_osmesa);
    return *one;
}

GridRenderer& without_rule() {
    static const auto one = make_grid_renderer(Backend::gl_osmesa, {.rules = {.front_to_back = false}});
    return *one;
}

struct Drawn {
    Image image;
    Statistics statistics;
};

Drawn draw(GridRenderer& by, const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {}) {
    Drawn drawn;
    drawn.image = by.render(scene, camera, size, quality, &drawn.statistics);
    return drawn;
}

std::string order_of(const Statistics& statistics) {
    const auto found = std::find_if(statistics.plan.begin(), statistics.plan.end(), [](const Decision& d) { return d.rule == "order"; });
    return found == statistics.plan.end() ? "" : found->chosen;
}
bool front_to_back(const Statistics& statistics) { return order_of(statistics).starts_with("front to back"); }

double bumps(const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(5 * p.x) * std::cos(4 * p.y + 3 * p.z); }

TransferFunction dense_ramp(double factor = 40) { return with_scaled_extinction(testing_support::ramp(), factor); }

GridScene scene_of(Grid grid, const TransferFunction& transfer, std::vector<IsoSurface> surfaces = {}) {
    GridScene scene{std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(transfer)};
    if (!surfaces.empty()) scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(surfaces)), Shading::flat});
    return scene;
}

std::vector<Camera> cameras() {
    std::vector<Camera> all;
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
        all.push_back(testing_support::view_of_unit_cube(projection));
        if (CELLPROJ_SANITIZED) continue;
        all.push_back(testing_support::view_of_unit_cube(projection, {0, -1, 0}));
        all.push_back(testing_support::view_of_unit_cube(projection, {-2, 0.3, -0.6}));
    }
    Camera close = all[0];  // all of the picture is covered
    close.height *= 0.3;
    all.push_back(close);
    Camera inside;
    inside.eye = {0.4, 0.3, 0.6};
    inside.center = {0.9, 0.7, 0.2};
    inside.fov_y_degrees = 100;
    all.push_back(inside);
    return all;
}

constexpr int cells = CELLPROJ_SANITIZED ? 8 : 14;

// What is cut is less than 1e-4; roundings of float32 in another order, one a cell.
constexpr double cut = 1.02e-4 + 1e-6;

std::ptrdiff_t pixels_apart(const Image& a, const Image& b) {
    return std::inner_product(a.pixels.begin(), a.pixels.end(), b.pixels.begin(), std::ptrdiff_t{0}, std::plus<>(), [](const glm::vec4& p, const glm::vec4& q) {
        return max_difference(glm::dvec4(p), glm::dvec4(q)) < cut ? 0 : 1;
    });
}

// ---- The rule ----

TEST(HidingOpacity, IsThatOfScenesThatMayBecomeOpaque) {
    const auto of = [](const TransferFunction& transfer, std::vector<IsoSurface> list = {}, const Lighting& lighting = {}) {
        const SurfaceScene surfaces{IsoSurfaces(std::move(list)), Shading::flat, lighting};
        return hiding_opacity(transfer, &surfaces);
    };
    // Optical depth 9.2 along the diagonal, of length 2, lets 1e-4 through.
    EXPECT_FALSE(of(testing_support::constant_medium(4.6)));
    ASSERT_TRUE(of(testing_support::constant_medium(4.61)));
    EXPECT_EQ(*of(testing_support::constant_medium(4.61)), 1.0F - 1e-4F);
    // Ten times as bright: a tenth of it.
    const TransferFunction bright(OpticalModel::density, {{0, {1, 10, 2}}}, {{0, 100}});
    EXPECT_EQ(*of(bright), 1.0F - 1e-5F);
    // Emission adds up along the diagonal.
    const TransferFunction emitter(OpticalModel::emitter, {{0, {5, 0, 0}}}, {{0, 100}});
    EXPECT_EQ(*of(emitter), 1.0F - 1e-5F);
    // Beside it, a surface.
    EXPECT_EQ(*of(emitter, {{0.5, {1, 1, 10}, 0.5, {}}}), 1.0F - 5e-6F);
    EXPECT_FALSE(of({OpticalModel::emitter, {{0, {1e3, 0, 0}}}, {{0, 100}}}));  // too near to 1 for sums in float32
    EXPECT_FALSE(of({OpticalModel::emitter, {{0, {1e60, 0, 0}}}, {{0, 1e60}}}));
    // Surfaces.
    EXPECT_TRUE(of(testing_support::nothing(), {{0.5, {1, 1, 1}, 1, {}}}));
    EXPECT_FALSE(of(testing_support::nothing(), {{0.5, {1, 1, 1}, 0.9, {}}}));
    EXPECT_TRUE(of(testing_support::nothing(), {{0.5, {1, 1, 1}, 0.9, {}}, {0.6, {1, 1, 1}, 0.95, {}}}));
    Lighting lighting;
    lighting.lights = {{.color = glm::dvec3(4), .diffuse = 1, .specular = 1.475}};  // and .1
    EXPECT_EQ(*of(testing_support::nothing(), {{0.5, {0.1, 0.1, 1}, 1, {{0, 0, 2}}}}, lighting), 1.0F - 5e-6F);
    EXPECT_FALSE(hiding_opacity(testing_support::nothing(), nullptr));
}

TEST(GlFrontToBack, OnlyWhereItPays) {
    const Camera camera = testing_support::view_of_unit_cube(Projection::parallel);
    const ImageSize size{31, 29};
    const GridScene thin = scene_of(unit_cube(8, bumps), testing_support::ramp()), dense = scene_of(unit_cube(8, bumps), dense_ramp());
    const Drawn as_ever = draw(renderer(), thin, camera, size);
    EXPECT_EQ(order_of(as_ever.statistics), "slices, back to front");
    EXPECT_EQ(max_difference(as_ever.image, draw(without_rule(), thin, camera, size).image), 0);
    EXPECT_TRUE(front_to_back(draw(renderer(), dense, camera, size).statistics));
    EXPECT_FALSE(front_to_back(draw(without_rule(), dense, camera, size).statistics));
    for (const TargetFormat target : {TargetFormat::rgba8, TargetFormat::rgba16, TargetFormat::rgba16f}) {
        const Drawn coarse = draw(renderer(), dense, camera, size, {.target = target});
        EXPECT_FALSE(front_to_back(coarse.statistics));
        EXPECT_EQ(max_difference(coarse.image, draw(without_rule(), dense, camera, size, {.target = target}).image), 0);
    }
    // Another scene, format or surface alone changes it.
    EXPECT_TRUE(front_to_back(draw(renderer(), dense, camera, size).statistics));
    EXPECT_FALSE(front_to_back(draw(renderer(), thin, camera, size).statistics));
    GridScene surface = thin;
    surface.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces({{0.5, {1, 1, 1}, 1, {}}})});
    EXPECT_TRUE(front_to_back(draw(renderer(), surface, camera, size).statistics));
    EXPECT_EQ(max_difference(as_ever.image, draw(renderer(), thin, camera, size).image), 0);
}

// ---- The same picture ----

TEST(GlFrontToBack, IsThePictureFromBackToFront) {
    std::vector<GridQuality> ways;
    for (const char* method : {"integral", "average:half", "homogeneous:vertices", "average:half:vertices", "preint2d-exp:64"}) ways.push_back({parse_method(method)});
    for (const char* sampling : {"object:30", "view:33:x4", "object:40:x3:post", "view:24:pre"}) ways.push_back({.sampling = parse_grid_sampling(sampling)});
    const std::vector<Camera> all = cameras();
    Grid rectilinear = unit_cube(cells, bumps);
    for (GridAxis& axis : rectilinear.axes) axis.spacing.reset();
    for (const TransferFunction& transfer : {dense_ramp(), dense_ramp(1000), TransferFunction(OpticalModel::emitter, {{0, {1, 2, 3}}}, {{0.4, 0}, {0.5, 300}, {0.6, 0}})}) {
        const GridScene uniform = scene_of(unit_cube(cells, bumps), transfer), not_uniform = scene_of(rectilinear, transfer);
        for (const GridQuality& way : ways) {
            bool other_axes = false;
            for (const Camera& camera : all) {
                other_axes = !other_axes && way.sampling.cut == GridSampling::Cut::cells;
                const GridScene& scene = other_axes ? not_uniform : uniform;
                const Drawn one = draw(renderer(), scene, camera, {67, 50}, way), other = draw(without_rule(), scene, camera, {67, 50}, way);
                ASSERT_TRUE(front_to_back(one.statistics) && !front_to_back(other.statistics));
                // From inside, cells drawn by polygons, whose edges are rounded, lie beside some drawn by their rays: of two that overlap in a
                // pixel it matters which comes first.
                const bool may_overlap = light_at_vertices(way.method) && &camera == &all.back();
                EXPECT_LE(pixels_apart(one.image, other.image), may_overlap ? 1 : 0) << to_string(way.method) << " " << to_string(way.sampling);
                EXPECT_LE(one.statistics.counts.drawn, other.statistics.counts.drawn);
            }
        }
    }
}

TEST(GlFrontToBack, WithSurfacesAloneAndInAMedium) {
    for (const auto& [transfer, opacity] : std::vector<std::pair<TransferFunction, double>>{{testing_support::nothing(), 1}, {testing_support::ramp(), 1}, {dense_ramp(), 0.5}}) {
        const GridScene scene = scene_of(unit_cube(cells, bumps), transfer, {{0.35, {1, 0.5, 0}, opacity, {{0, 1, 0}}}, {0.75, {0.2, 0.4, 1}, 0.4, {}}});
        for (const char* sampling : {"cells", "object:30", "view:33:x4"}) {
            for (const Camera& camera : cameras()) {
                const GridQuality way{.sampling = parse_grid_sampling(sampling)};
                const Drawn one = draw(renderer(), scene, camera, {67, 50}, way), other = draw(without_rule(), scene, camera, {67, 50}, way);
                ASSERT_TRUE(front_to_back(one.statistics));
                EXPECT_LT(max_difference(one.image, other.image), cut) << sampling;
            }
        }
    }
}

// The judge knows no tiles. In a linear field segments are linear.
TEST(GlFrontToBack, IsThePictureOfTheJudge) {
    const GridScene scene = scene_of(unit_cube(8, testing_support::linear), dense_ramp(20));
    for (const Camera& camera : cameras()) {
        for (const ImageSize size : {ImageSize{1, 1}, {1, 20}, CELLPROJ_SANITIZED ? ImageSize{9, 8} : ImageSize{25, 17}}) {
            const Image image = draw(renderer(), scene, camera, size).image;
            for (const PixelTruth& truth : GridReference(scene.grid, scene.transfer).pixels(camera, size, all_pixels(size))) {
                // 2e-4: what gl_grid_test allows for float32 places on functions as steep as this.
                ASSERT_LT(max_difference(glm::dvec4(truth.light.color, truth.light.opacity), glm::dvec4(image.at(truth.pixel.x, truth.pixel.y))), cut + 2e-4)
                    << truth.pixel.x << " " << truth.pixel.y;
            }
        }
    }
}

TEST(GlFrontToBack, OfAnyScaleAndPlace) {
    std::mt19937_64 random(521);
    std::uniform_real_distribution<double> both(-1, 1);
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 8 : 24); ++trial) {
        SCOPED_TRACE(trial);
        const double scale = std::pow(10, 12 * both(random));
        const glm::dvec3 place = 1e3 * scale * glm::dvec3(both(random), both(random), both(random));
        std::array<GridAxis, 3> axes;
        for (int a = 0; a < 3; ++a) axes[static_cast<std::size_t>(a)] = uniform_axis(place[a], scale / 16, 17 + 4 * static_cast<std::size_t>(a));
        const Grid grid = testing_support::grid_of(axes, [&](const glm::dvec3&) { return both(random); });
        const Bounds box = grid.bounds();
        const double reach = trial % 3 == 0 ? 0.4 : 2;
        Camera camera;
        camera.projection = trial % 4 == 0 ? Projection::parallel : Projection::perspective;
        camera.eye = box.center() + reach * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
        camera.center = box.center() + 0.3 * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
        camera.height = 0.5 * box.diagonal();
        camera.fov_y_degrees = 60;
        const GridScene scene = scene_of(grid, testing_support::constant_medium(60 / box.diagonal()));
        const Drawn one = draw(renderer(), scene, camera, {37, 41}), other = draw(without_rule(), scene, camera, {37, 41});
        ASSERT_TRUE(front_to_back(one.statistics));
        EXPECT_LT(max_difference(one.image, other.image), cut);
    }
}

TEST(GlFrontToBack, OfRaysThatAreCut) {
    GridScene scene = scene_of(unit_cube(cells, bumps), dense_ramp());
    auto clip = std::make_shared<ClipRegion>();
    clip->half_spaces.push_back({{0.5, 0.5, 0.6}, {0.2, 0.5, -1}});
    scene.clip = clip;
    auto slices = std::make_shared<SliceScene>();
    slices->slices.push_back({{{0.4, 0.5, 0.5}, {1, 0.1, 0.2}}});
    slices->colors = scene.transfer;
    for (const bool sliced : {false, true}) {
        if (sliced) scene.slices = slices;
        for (const Camera& camera : cameras()) {
            const Drawn one = draw(renderer(), scene, camera, {67, 50}), other = draw(without_rule(), scene, camera, {67, 50});
            ASSERT_TRUE(front_to_back(one.statistics));
            EXPECT_LT(max_difference(one.image, other.image), cut);
        }
    }
}

// ---- What it leaves out ----

// A wall in front: what lies behind it is not drawn, but for the bricks that the wall is in.
TEST(GlFrontToBack, NothingIsDrawnBehindAWall) {
    constexpr int n = 32;
    const TransferFunction wall(OpticalModel::density, {{0, {1, 0.5, 0.25}}}, {{0, 1000}, {0.1, 1000}, {0.1, 1}});
    const GridScene scenes[] = {scene_of(unit_cube(n, [](const glm::dvec3& p) { return p.y; }), wall),
                                scene_of(unit_cube(n, [](const glm::dvec3& p) { return p.y; }), testing_support::constant_medium(1), {{0.1, {1, 0.5, 0}, 1, {}}})};
    for (const GridScene& scene : scenes) {
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            Camera camera = testing_support::view_of_unit_cube(projection, {0, -1, 0});
            camera.height *= 0.8;
            if (projection == Projection::perspective) camera.fov_y_degrees *= 0.8;
            for (const char* sampling : {"cells", "object:64", "view:64"}) {
                const GridQuality way{.sampling = parse_grid_sampling(sampling)};
                const Drawn one = draw(renderer(), scene, camera, {64, 64}, way), other = draw(without_rule(), scene, camera, {64, 64}, way);
                EXPECT_LT(max_difference(one.image, other.image), cut);
                // The wall ends in the fourth slice of 32; looks come behind slices 1, 3 and 6, as nothing closes at once.
                EXPECT_LT(static_cast<double>(one.statistics.counts.triangles), 0.21 * static_cast<double>(other.statistics.counts.triangles)) << sampling;
            }
            const Statistics statistics = draw(renderer(), scene, camera, {64, 64}).statistics;
            EXPECT_LT(statistics.counts.drawn, std::size_t{7} * n * n);
            EXPECT_EQ(statistics.counts.drawn + statistics.counts.culled, statistics.counts.cells);
        }
    }
}

// A wall over half of the picture hides what is behind that half.
TEST(GlFrontToBack, HalfAWallHidesHalf) {
    constexpr int n = 32;
    const auto field = [](const glm::dvec3& p) { return p.x < 0.5 && p.y < 0.1 ? 1.0 : 0.0; };
    const TransferFunction wall(OpticalModel::density, {{0, {1, 0.5, 0.25}}}, {{0, 1}, {0.99, 1}, {1, 1e5}});
    const GridScene scene = scene_of(unit_cube(n, field), wall);
    const Camera camera = testing_support::view_of_unit_cube(Projection::parallel, {0, -1, 0});
    const Drawn one = draw(renderer(), scene, camera, {256, 256}), other = draw(without_rule(), scene, camera, {256, 256});
    EXPECT_LT(max_difference(one.image, other.image), cut);
    EXPECT_GT(one.statistics.counts.drawn, scene.grid->cell_count() / 2);
    EXPECT_LT(one.statistics.counts.drawn, scene.grid->cell_count() * 7 / 10);
}

// Parts of the order are all of it, but for the bricks that are said to be hidden.
TEST(GridTraversal, PartsLeaveOutHiddenBricks) {
    const Grid grid = testing_support::grid_of({uniform_axis(0, 0.1, 20), uniform_axis(0, 0.1, 14), uniform_axis(0, 0.1, 12)}, bumps);
    const std::vector<std::uint8_t> drawn(grid.cell_count(), 1);
    for (const Eye& eye : {Eye::at({0.55, -3, 0.35}), Eye{{0.3, 0.2, -1}, true}, Eye::at({0.72, 0.81, 0.44})}) {
        const glm::dvec3 middle = grid.bounds().center(), forward = eye.at_infinity ? -eye.xyz : middle - eye.xyz;
        gl::GridTraversal traversal(grid, eye, drawn, gl::largest_slice_first(forward));
        std::vector<int> seen(grid.cell_count(), 0);
        const auto mark = [&](const gl::CellRange& range, int as) {
            for (std::size_t k = range.low[2]; k < range.high[2]; ++k)
                for (std::size_t j = range.low[1]; j < range.high[1]; ++j)
                    for (std::size_t i = range.low[0]; i < range.high[0]; ++i) {
                        int& state = seen[grid.cell_id({i, j, k})];
                        state = std::max(state, as);
                    }
        };
        std::vector<std::uint32_t> some;
        std::size_t count = 0;
        for (int part = 0; traversal.slices_left() > 0; ++part) {
            const gl::CellRange rest = traversal.rest();
            int bricks = 0;
            std::vector<gl::CellRange> hidden;
            traversal.begin_part(3, [&](const gl::CellRange& brick) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    EXPECT_LE(rest.low[axis], brick.low[axis]);
                    EXPECT_GE(rest.high[axis], brick.high[axis]);
                }
                if ((bricks++ + part) % 3 != 0) return false;
                hidden.push_back(brick);
                return true;
            });
            for (traversal.next(50, some); !some.empty(); traversal.next(50, some)) {
                for (const std::uint32_t id : some) {
                    EXPECT_LT(seen[id], 2);
                    seen[id] = 2;
                    ++count;
                }
            }
            for (const gl::CellRange& brick : hidden) mark(brick, 1);
        }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 0), 0);
        EXPECT_LT(count, grid.cell_count() * 4 / 5);
    }
}

}  // namespace gl_front_to_back_test
}  // namespace cellproj
