// SPDX-License-Identifier: BSD-3-Clause
#include "render/trade_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace trade_test {

using testing_support::grid_mesh;
using testing_support::point_field;

TradeRow row(double ms, double rms, double maximum, const char* method = "preint3d") {
    TradeRow row;
    row.quality.method = parse_method(method);
    row.frame_ms = ms;
    row.error.color = {rms, maximum, maximum};
    return row;
}

TEST(Trade, TheFrontIsWhatNothingBeats) {
    std::vector<TradeRow> rows{row(10, 1e-2, 1), row(20, 1e-3, 1), row(20, 1e-2, 1), row(30, 1e-3, 1), row(40, 1e-4, 1), row(10, 1e-2, 1)};
    mark_front(rows);
    std::string front;
    for (const TradeRow& r : rows) front += r.on_front ? '1' : '0';
    EXPECT_EQ(front, "110011");  // equals do not beat each other
}

TEST(Trade, TheLargestErrorCountsOpacityToo) {
    ImageError error;
    error.color.maximum = 1e-4;
    EXPECT_EQ(largest(error), 1e-4);
    error.opacity.maximum = 0.5;
    EXPECT_EQ(largest(error), 0.5);
}

TEST(Trade, NotANumberIsWithinNoBoundAndBrightOnTheMap) {
    Image image(1, 1);
    image.at(0, 0) = glm::vec4(std::nanf(""));
    const std::vector<PixelTruth> truths{{{0, 0}, {}, {}, {}}};
    EXPECT_FALSE(largest(compare(image, truths)) <= 1e9);
    const Image map = error_map(image, truths);
    EXPECT_TRUE(std::isfinite(map.at(0, 0).r));
    EXPECT_GT(map.at(0, 0).r, 0.9F);
}

TEST(Trade, TheMapShowsWhereTheErrorsAre) {
    Image image(3, 1);
    image.at(1, 0) = {0.01F, 0, 0, 0};
    const std::vector<PixelTruth> truths{{{0, 0}, {}, {}, {}}, {{1, 0}, {}, {}, {}}};
    const Image map = error_map(image, truths);
    EXPECT_EQ(map.at(2, 0), glm::vec4(0));  // not judged
    EXPECT_EQ(map.at(0, 0).a, 1.0F);
    EXPECT_GT(map.at(1, 0).r, map.at(0, 0).r + 0.5F);
}

// A coarser table is further from the truth, and says what it weighs: 4 float32 per texel.
TEST(Trade, MeasuresErrorAndMemoryOfEachMethod) {
    auto mesh = std::make_shared<TetMesh>(grid_mesh(6, 0.2));
    auto field = std::make_shared<ScalarField>(point_field(*mesh, [](const glm::dvec3& p) { return p.x * p.x + p.y; }));
    auto transfer = std::make_shared<TransferFunction>(
        OpticalModel::density, std::vector<ColorNode>{{0, {0, 0, 1}}, {1, {1, 1, 0}}, {2, {1, 0, 0}}},
        std::vector<ExtinctionNode>{{0, 0}, {0.9, 0.5}, {1, 6}, {1.1, 0.5}, {2, 2}});
    const Scene scene{mesh, field, transfer};
    const ImageSize size{64, 64};
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::perspective, {1, 2, 1}, {0, 0, 1}, 1.0);
    const auto truths = Reference(scene).picture(camera, size, rasterizer_slack);
    const std::vector<Quality> qualities{{.method = {.kind = MethodKind::preint3d, .size = 8}}, {.method = {.kind = MethodKind::preint3d, .size = 64}}};
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::size_t frames = 0;
    const auto rows = measure_trade(ways_of(*renderer, scene, camera, size, qualities), truths,
                                    {.rounds = 2, .progress = [&](std::size_t done, std::size_t of) {
                                         ++frames;
                                         EXPECT_EQ(done, frames);
                                         EXPECT_EQ(of, 6U);
                                     }});
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_EQ(frames, 6U);
    EXPECT_EQ(rows[0].table_bytes, 8192U);
    EXPECT_EQ(rows[1].table_bytes, 4194304U);
    EXPECT_EQ(rows[0].error.pixels, 64U * 64U);
    EXPECT_LT(rows[1].error.color.rms, rows[0].error.color.rms / 4);  // second order: 64 times less where it holds
    EXPECT_LT(rows[1].error.color.maximum, 5e-2);                     // the peak is 6 texels wide
    EXPECT_GT(rows[0].frame_ms, 0);
    EXPECT_EQ(rows[0].image.width, 64);
}

TEST(Trade, QualitiesAreToldApartByMethodAndTarget) {
    EXPECT_EQ(to_string(Quality{}), "integral");
    EXPECT_EQ(to_string(Quality{.method = parse_method("average:half"), .target = TargetFormat::rgba8}), "average:half, rgba8");
    std::vector<std::string> names;
    for (const Quality& quality : trade_qualities()) names.push_back(to_string(quality));
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    const Quality table{.target = TargetFormat::rgba8, .surfaces = parse_surface_method("table:9")};
    EXPECT_EQ(to_string(table), "integral, table:9, rgba8");
}

// Light at vertices and by halves know no place in a segment.
TEST(Trade, ScenesWithSurfacesAreDrawnByMethodsThatCanAndByEveryWayToThem) {
    std::vector<std::string> names;
    for (const Quality& quality : surface_qualities()) {
        EXPECT_TRUE(takes_surfaces(quality.method)) << to_string(quality);
        names.push_back(to_string(quality));
    }
    for (const char* name : {"integral", "average", "integral, table:512", "integral, combined:512", "preint3d:64, table:512", "integral, rgba8"})
        EXPECT_EQ(std::ranges::count(names, name), 1) << name;
}

TEST(TradeChoice, TheWidestDifferencesComeFirstAndOnlyDifferences) {
    Image a(3, 2), b(3, 2);
    a.at(1, 0).a = 0.25F;
    a.at(2, 1).g = 0.5F;
    b.at(0, 1).r = std::numeric_limits<float>::quiet_NaN();
    b.at(2, 0).b = 0.25F;  // as wide as that at (1, 0), behind it
    EXPECT_EQ(widest_differences(a, b, 10), (std::vector<PixelId>{{0, 1}, {2, 1}, {1, 0}, {2, 0}}));
    EXPECT_EQ(widest_differences(a, b, 2), (std::vector<PixelId>{{0, 1}, {2, 1}}));
    EXPECT_TRUE(widest_differences(a, a, 5).empty());
}

TEST(TradeChoice, TheToleranceOfExactFollowsFromTheBound) {
    EXPECT_EQ(to_string(choice_methods(0.002).back()), "exact:2e-05");
    for (const double bound : {1e-300, 1e-9, 1.0, 1e9})
        EXPECT_NO_THROW(parse_method(to_string(choice_methods(bound).back()))) << bound;
}

// Six peaks of half width .01, optical depth 20 per unit in their middle: half of a peak is no wider than what most cells span.
TransferFunction peaks() {
    std::vector<ExtinctionNode> nodes{{0, 0}};
    for (int i = 0; i < 6; ++i) {
        const double s = (i + 0.5) / 6;
        nodes.insert(nodes.end(), {{s - 0.01, 0}, {s, 20}, {s + 0.01, 0}});
    }
    nodes.push_back({1, 0});
    return {OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {0.5, {0.9, 0.9, 0.2}}, {1, {1.0, 0.2, 0.0}}}, nodes};
}

// The error of the whole picture. A silhouette within the rasterizer's grid is no error (Reference::pixels), which takes five
// rays a pixel: only where one says that the bound is broken.
double error_of_all_pixels(const Image& image, const Scene& scene, const Camera& camera, double bound) {
    const Reference reference(scene);
    const ImageSize size{image.width, image.height};
    double widest = 0;
    std::vector<PixelId> doubtful;
    for (const PixelTruth& truth : reference.picture(camera, size)) {
        const double error = largest(compare(image, {&truth, 1}));
        if (error > bound) doubtful.push_back(truth.pixel);
        else widest = std::max(widest, error);
    }
    return std::max(widest, largest(compare(image, reference.pixels(camera, size, doubtful, rasterizer_slack))));
}

// The choice is made on 1000 of some 23,000 pixels and a few suspects; its word is checked on all of them. Few cells of many pixels, so
// that their light decides about the time.
TEST(TradeChoice, KeepsItsWordOnTheWholePicture) {
    constexpr int side = CELLPROJ_SANITIZED ? 112 : 224;
    const ImageSize size{side, side};
    const double bound = 0.002;
    const Camera camera = testing_support::view_of_unit_cube(Camera::Projection::perspective);
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::vector<std::string> chosen;
    for (const TransferFunction& transfer : {testing_support::ramp(), peaks()}) {
        const Scene scene = testing_support::scene_of(grid_mesh(8, 0.2), testing_support::linear, transfer);
        const QualityChoice choice = choose_quality(*renderer, scene, camera, size, bound, {.sample = 1000});
        const Candidate& best = choice.candidates[choice.chosen];
        const Image image = renderer->render(scene, camera, size, best.quality);
        EXPECT_TRUE(choice.met);
        EXPECT_LE(error_of_all_pixels(image, scene, camera, bound), bound) << to_string(best.quality);
        EXPECT_LE(largest(best.error), bound);
        EXPECT_EQ(choice.sample, 1000U);
        EXPECT_GT(choice.judged, 1000U);
        chosen.push_back(to_string(best.quality));
    }
    // The pieces take half as long again as what is enough for the ramp; not where the sanitizers slow all but the drawing.
    if (!CELLPROJ_SANITIZED) {
        EXPECT_NE(chosen[0], chosen[1]);
    }
}

// One cell among thousands has a scalar in a peak that no table resolves. Few pixels see it and none of the sample, by which a table
// would do.
TEST(TradeChoice, FindsErrorsThatASampleMisses) {
    TetMesh mesh = grid_mesh(12);
    ScalarField field{"s", FieldLocation::cells, std::vector<double>(mesh.tets.size(), 0.0)};
    field.values[0] = 1.0;
    field.values[mesh.tets.size() / 3] = 0.953;
    const TransferFunction transfer{OpticalModel::density, {{0, {1, 0.5, 0.2}}}, {{0, 0.5}, {0.95, 0.5}, {0.953, 80}, {0.956, 0.5}}};
    const Scene scene = testing_support::scene_of(std::move(mesh), std::move(field), transfer);
    const ImageSize size{128, 128};
    const double bound = 1e-3;
    const Camera camera = testing_support::view_of_unit_cube(Camera::Projection::parallel);
    const auto renderer = make_renderer(Backend::gl_osmesa);

    const Reference reference(scene);
    const auto sample = reference.pixels(camera, size, reference.sample(camera, size, 20), rasterizer_slack);
    const Image by_table = renderer->render(scene, camera, size, {.method = parse_method("preint2d-exp:256")});
    ASSERT_LE(largest(compare(by_table, sample)), bound);
    ASSERT_GT(error_of_all_pixels(by_table, scene, camera, bound), 10 * bound);

    const QualityChoice choice = choose_quality(*renderer, scene, camera, size, bound, {.sample = 20});
    const Image image = renderer->render(scene, camera, size, choice.candidates[choice.chosen].quality);
    EXPECT_TRUE(choice.met);
    EXPECT_LE(error_of_all_pixels(image, scene, camera, bound), bound);
}

// Eight bits cannot: each of the many layers is rounded to 1/255.
TEST(TradeChoice, SaysWhenNothingIsWithinAndTakesExact) {
    const Scene scene = testing_support::scene_of(grid_mesh(6), testing_support::linear, testing_support::ramp());
    const Camera camera = testing_support::view_of_unit_cube(Camera::Projection::parallel);
    const auto renderer = make_renderer(Backend::gl_osmesa);
    const QualityChoice choice =
        choose_quality(*renderer, scene, camera, {48, 48}, 1e-4, {.base = {.target = TargetFormat::rgba8}, .sample = 200});
    EXPECT_FALSE(choice.met);
    EXPECT_EQ(to_string(choice.candidates[choice.chosen].quality), "exact:1e-06, rgba8");
    EXPECT_GT(largest(choice.candidates[choice.chosen].error), 1e-4);
}

TEST(TradeChoice, APictureOfNothingHasNoError) {
    const Scene scene = testing_support::scene_of(grid_mesh(2), testing_support::linear, testing_support::ramp());
    const Camera away{Camera::Projection::parallel, {90, 0, 0}, {90, 9, 0}, {0, 0, 1}, 1};
    const QualityChoice choice = choose_quality(*make_renderer(Backend::gl_osmesa), scene, away, {16, 16}, 1e-6);
    EXPECT_TRUE(choice.met);
    EXPECT_EQ(choice.judged, 0U);
}

}  // namespace
}  // namespace cellproj
