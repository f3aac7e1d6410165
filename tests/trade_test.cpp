// SPDX-License-Identifier: BSD-3-Clause
#include "render/trade.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/meshes.hpp"

namespace cellproj {
namespace {

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

TEST(Trade, TheFastestWithinABoundCountsOpacityToo) {
    std::vector<TradeRow> rows{row(10, 0, 1e-2), row(20, 0, 1e-3), row(5, 0, 1e-4), row(30, 0, 1e-5)};
    rows[2].error.opacity.maximum = 0.5;
    EXPECT_EQ(fastest_within(rows, 2e-3), &rows[1]);
    EXPECT_EQ(fastest_within(rows, 1e-4), &rows[3]);
    EXPECT_EQ(fastest_within(rows, 1e-6), nullptr);
    EXPECT_EQ(fastest_within({}, 1), nullptr);
}

TEST(Trade, NotANumberIsOnNoFrontWithinNoBoundAndBrightOnTheMap) {
    Image image(1, 1);
    image.at(0, 0) = glm::vec4(std::nanf(""));
    const std::vector<PixelTruth> truths{{{0, 0}, {}, {}, {}}};
    TradeRow bad = row(1, 0, 0);
    bad.error = compare(image, truths);
    EXPECT_EQ(fastest_within(std::vector<TradeRow>{bad}, 1e9), nullptr);
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
    const auto truths = Reference(scene).picture(camera, size, 1.0 / 512);
    const std::vector<Quality> qualities{{.method = {.kind = MethodKind::preint3d, .size = 8}}, {.method = {.kind = MethodKind::preint3d, .size = 64}}};
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::size_t frames = 0;
    const auto rows = measure_trade(*renderer, scene, camera, size, qualities, truths,
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

}  // namespace
}  // namespace cellproj
