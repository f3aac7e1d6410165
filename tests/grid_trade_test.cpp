// SPDX-License-Identifier: BSD-3-Clause
//
// Time against error on regular grids, and the method that follows from a bound.
#include "render/grid_trade.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace grid_trade_test {

using testing_support::unit_cube;
using testing_support::view_of_unit_cube;

// Curved in every cell.
double bowl(const glm::dvec3& p) { return p.x * p.y + 0.5 * p.z * p.z + 0.3 * p.x * p.y * p.z; }

GridScene scene_of(Grid grid, TransferFunction transfer = testing_support::ramp()) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(std::move(transfer))};
}

std::vector<std::string> names_of(const std::vector<GridQuality>& qualities) {
    std::vector<std::string> names;
    for (const GridQuality& quality : qualities) names.push_back(to_string(quality));
    return names;
}

TEST(GridTrade, EachBackendHasTheWaysItDraws) {
    const GridScene scene = scene_of(unit_cube(6, bowl));
    const std::vector<std::string> rays = names_of(grid_trade_qualities(Backend::cpu, scene));
    for (const char* name : {"cells, integral", "cells, exact:0.001", "cells, preint3d:64"}) EXPECT_EQ(std::ranges::count(rays, name), 1) << name;
    EXPECT_TRUE(std::ranges::none_of(rays, [](const std::string& name) { return !name.starts_with("cells") || name.ends_with(":vertices"); }));
    const std::vector<std::string> gl = names_of(grid_trade_qualities(Backend::gl_osmesa, scene));
    for (const char* name : {"cells, homogeneous:vertices", "object:6:pre, integral", "object:24:post, integral", "view:6, integral"})
        EXPECT_EQ(std::ranges::count(gl, name), 1) << name;
    EXPECT_EQ(std::ranges::count(gl, "cells, exact:0.001"), 0);
    // What cannot be sliced is drawn by its cells only.
    Grid constant{scene.grid->axes, FieldLocation::cells, std::vector<double>(216, 0.5), {}};
    for (const std::string& name : names_of(grid_trade_qualities(Backend::gl_osmesa, scene_of(std::move(constant)))))
        EXPECT_TRUE(name.starts_with("cells")) << name;
    EXPECT_EQ(to_string(GridQuality{.target = TargetFormat::rgba8}), "cells, integral, rgba8");
}

// More slabs are nearer to the truth, and rays cut into lines nearest: what the table is made to show. A silhouette within the
// rasterizer's grid is no error.
TEST(GridTrade, RowsTellHowFarTheirPicturesAre) {
    const GridScene scene = scene_of(unit_cube(5, bowl));
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const ImageSize size{40, 40};
    const GridReference reference(scene.grid, scene.transfer);
    const TradeJudge judge = judge_by(reference, camera, size);
    const auto rays = make_grid_renderer(Backend::cpu), gl = make_grid_renderer(Backend::gl_osmesa);
    const std::vector<GridQuality> by_rays{{.method = parse_method("integral")}, {.method = parse_method("exact:1e-4")}};
    const std::vector<GridQuality> by_slabs{{.sampling = {GridSampling::Cut::object, 5, GridSampling::Light::post}},
                                            {.sampling = {GridSampling::Cut::object, 40, GridSampling::Light::post}}};
    std::vector<TradeWay> ways = ways_of(*rays, scene, camera, size, by_rays);
    for (TradeWay& way : ways_of(*gl, scene, camera, size, by_slabs)) ways.push_back(std::move(way));
    const std::vector<TradeRow> rows = measure_trade(ways, judge.truths(judge.sample(600)), {.rounds = 1});
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_EQ(rows[0].error.pixels, 600U);
    EXPECT_LE(rows[1].error.color.maximum, 1e-4);
    EXPECT_LT(rows[1].error.color.rms, rows[0].error.color.rms / 10);
    EXPECT_LT(rows[3].error.color.rms, rows[2].error.color.rms / 4);  // midpoints: second order, 64 times less where it holds
    EXPECT_EQ(rows[0].backend, "cpu");
    EXPECT_EQ(rows[3].backend, "gl_osmesa");
    EXPECT_EQ(rows[3].name, "object:40:post, integral");
    EXPECT_FALSE(rows[3].sampling->slabs != 40);
    EXPECT_GT(rows[2].frame_ms, 0);
}

TEST(GridTrade, TheChoiceKeepsItsWordOnTheWholePicture) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    constexpr int side = CELLPROJ_SANITIZED ? 40 : 80;
    const ImageSize size{side, side};
    const GridScene scene = scene_of(unit_cube(4, bowl), {OpticalModel::density, {{0, {1, 0.4, 0}}, {2, {0, 0.5, 1}}}, {{0, 0}, {0.8, 0}, {0.85, 9}, {0.9, 0}}});
    const GridReference reference(scene.grid, scene.transfer);
    const auto truths = reference.pixels(camera, size, all_pixels(size), rasterizer_slack);
    for (const Backend backend : {Backend::cpu, Backend::gl_osmesa}) {
        const auto renderer = make_grid_renderer(backend);
        const double bound = backend == Backend::cpu ? 1e-3 : 0.05;  // OpenGL's segments are lines: the peak moves in the large cells
        const QualityChoice choice = choose_grid_quality(*renderer, backend, scene, camera, size, bound, {.how = {.sample = 300}});
        const Candidate& best = choice.candidates[choice.chosen];
        EXPECT_TRUE(choice.met) << to_string(backend);
        const Image image = renderer->render(scene, camera, size, {best.quality.method, best.quality.target, *best.sampling});
        EXPECT_LE(largest(compare(image, truths)), bound) << best.name;
    }
    // What was asked for stays.
    const auto gl = make_grid_renderer(Backend::gl_osmesa);
    const GridSampling asked{GridSampling::Cut::view, 7};
    const QualityChoice choice = choose_grid_quality(*gl, Backend::gl_osmesa, scene, camera, size, 0.5, {.sampling = asked, .how = {.sample = 50}});
    for (const Candidate& candidate : choice.candidates) EXPECT_EQ(candidate.sampling, asked) << candidate.name;
}

TEST(GridTrade, TheSampleSeesTheGrid) {
    Grid half = unit_cube(2, bowl);
    half.blanked.assign(8, 0);
    for (std::size_t c = 0; c < 8; c += 2) half.blanked[c] = 1;  // x below a half
    const GridScene scene = scene_of(std::move(half));
    const GridReference reference(scene.grid, scene.transfer);
    const Camera camera{Camera::Projection::parallel, {0.5, -3, 0.5}, {0.5, 0.5, 0.5}, {0, 0, 1}, 2};
    const std::vector<PixelId> all = reference.sample(camera, {64, 64}, 100000), some = reference.sample(camera, {64, 64}, 100);
    EXPECT_EQ(all.size(), 16U * 32U);  // half of a cube of 32 pixels
    ASSERT_EQ(some.size(), 100U);
    for (const PixelId pixel : some) EXPECT_TRUE(pixel.x >= 32 && pixel.x < 48 && pixel.y >= 16 && pixel.y < 48);
}

}  // namespace
}  // namespace cellproj
