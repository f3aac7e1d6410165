// SPDX-License-Identifier: BSD-3-Clause
//
// Colour bar, lines, axes and outline: against the transfer function, the camera's projection and rays through a box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "render/annotation/color_bar.hpp"
#include "render/annotation/outline.hpp"
#include "render/annotation/triad.hpp"
#include "tests/support/annotation_fixtures.hpp"

namespace cellproj {
namespace annotation_test {

using testing_support::font;
using testing_support::numbered_picture;
using testing_support::peaks;
using testing_support::ramp;
using testing_support::same;
using testing_support::scene_with;

AnnotationStyle plain_style(double em = 13.5) { return {em, 0.8 * em, 1, {glm::dvec3(0)}, {glm::dvec3(1)}}; }

ColorBarPlan plan_of(const Scene& scene, BarSide side, const PixelBox& within = {0, 0, 512, 512}, double em = 13.5) {
    return plan_color_bar(describe_color_bar(scene, "Pa"), side, within, *font(), plain_style(em));
}

TEST(AnnotationColorBar, PixelsAreTheTransferFunctions) {
    for (const BarSide side : {BarSide::left, BarSide::right, BarSide::bottom}) {
        const ColorBarPlan plan = plan_of(scene_with(peaks), side);
        Image image(512, 512);
        draw_color_bar(image, plan);
        EXPECT_EQ(plan.scalar(0), 0.1);
        EXPECT_EQ(plan.scalar(plan.length()), 0.9);
        EXPECT_EQ(plan.distance(0.1), 0);
        EXPECT_EQ(plan.distance(0.9), plan.length());
        ASSERT_GT(plan.length(), 100);
        for (int i = 0; i < plan.length(); ++i) {
            const double s = 0.1 + 0.8 * (i + 0.5) / plan.length();
            const PixelBox slice = plan.slice(plan.bar, i);
            for (int y = slice.y0; y < slice.y1; ++y)
                for (int x = slice.x0; x < slice.x1; ++x)
                    for (int channel = 0; channel < 3; ++channel)
                        // Float32 of a colour; s is off by an ulp times the steepest slope.
                        ASSERT_NEAR(image.at(x, y)[channel], peaks.color(s)[channel], 1e-7);
            ASSERT_EQ(image.at(slice.x0, slice.y0).a, 1);
        }
        // Low is at the bottom or the left.
        const PixelBox first = plan.slice(plan.bar, 0);
        EXPECT_EQ(plan.vertical() ? first.y1 : first.x0, plan.vertical() ? plan.bar.y1 : plan.bar.x0);
    }
}

// Ticks stand at their scalars: a row of ink beside the bar, its middle within a pixel.
TEST(AnnotationColorBar, TicksStandAtTheirScalars) {
    const ColorBarPlan plan = plan_of(scene_with(peaks), BarSide::right);
    Image image(512, 512);
    draw_color_bar(image, plan);
    ASSERT_GE(plan.ticks.ticks.size(), 4U);
    for (const Tick& tick : plan.ticks.ticks) {
        const double y = plan.bar.y1 - plan.length() * (tick.value - 0.1) / 0.8;
        double ink = 0, moment = 0;
        for (int row = static_cast<int>(y) - 4; row <= static_cast<int>(y) + 4; ++row) {
            ink += image.at(plan.bar.x1 + 2, row).a;
            moment += image.at(plan.bar.x1 + 2, row).a * (row + 0.5);
        }
        EXPECT_EQ(ink, plan.style.line) << tick.label;
        EXPECT_NEAR(moment / ink, y, 0.5 + 1e-9) << tick.label;
    }
}

// α = 1 − exp(−τ·path), the path 1, 2 or 5 · 10^e with an optical depth of 0.8 .. 2 at the densest scalar.
TEST(AnnotationColorBar, OpacityIsThatOfTheNamedPath) {
    for (const double tau : {1.0, 3.0, 7.7, 1e-9, 1e40}) {
        const Scene scene = scene_with({OpticalModel::density, {{0, {1, 1, 1}}, {1, {0, 0, 1}}}, {{0, 0}, {1, tau}}});
        const ColorBarPlan plan = plan_of(scene, BarSide::right);
        ASSERT_TRUE(plan.content.path);
        const double depth = tau * *plan.content.path;
        EXPECT_LE(depth, 2 * (1 + 1e-12));
        EXPECT_GE(depth, 0.8 * (1 - 1e-12));
        EXPECT_NEAR(plan.content.opacity(0.2, 0.5), 1 - std::exp(-0.5 * depth), 1e-14);
        Image image(512, 512);
        draw_color_bar(image, plan);
        const int across = plan.strip.width();
        for (int i = 0; i < plan.length(); ++i) {
            // Half-transparent ink as wide as the opacity; the last column holds the line of 1 besides.
            double shade = 0;
            for (int x = plan.strip.x0 + 1; x < plan.strip.x1; ++x) shade += image.at(x, plan.slice(plan.strip, i).y0).a;
            const double opacity = 1 - std::exp(-depth * (i + 1.0) / plan.length());
            ASSERT_NEAR(shade, 0.5 * std::min(opacity * across, across - 1.0), 1e-5);
        }
    }
    EXPECT_FALSE(plan_of(scene_with({OpticalModel::emitter, {{0, {1, 1, 1}}}, {{0, 0}}}), BarSide::right).content.path);
}

// A peak that is narrower than a pixel of the bar is seen in the curve.
TEST(AnnotationColorBar, NarrowPeaksAreSeen) {
    const ColorBarPlan plan = plan_of(scene_with({OpticalModel::density, {{0, {1, 1, 1}}}, {{0, 0}, {0.49999, 0}, {0.5, 5}, {0.50001, 0}, {1, 0}}}), BarSide::right);
    int seen = 0;
    for (int i = 0; i < plan.length(); ++i) seen += plan.content.opacity(plan.scalar(i), plan.scalar(i + 1)) > 0.5;
    EXPECT_GE(seen, 1);
    EXPECT_LE(seen, 2);
}

TEST(AnnotationColorBar, EmissionIsRelativeToItsBrightest) {
    const ColorBar bar = describe_color_bar(scene_with({OpticalModel::emitter, {{0, {0, 0, 4}}, {1, {8, 2, 0}}}, {{0, 1}}}));
    EXPECT_EQ(bar.color(0), glm::dvec3(0, 0, 0.5));
    EXPECT_EQ(bar.color(1), glm::dvec3(1, 0.25, 0));
    const ColorBar bright = describe_color_bar(scene_with({OpticalModel::density, {{0, {0, 0, 4}}}, {{0, 1}}}));
    EXPECT_EQ(bright.color(0), glm::dvec3(0, 0, 1)) << "chromaticity is cut, as a PNG cuts it";
}

// Over 4³ points of the cube, linear(p) is 0 at one corner and 1 at another.
TEST(AnnotationColorBar, SaysWhatLiesBeyond) {
    const auto bar_of = [](double low, double high, double tau_low, Outside outside = Outside::clamp) {
        return describe_color_bar(scene_with({OpticalModel::density, {{low, {0, 0, 1}}, {high, {1, 0, 0}}}, {{low, tau_low}, {high, 1}}, outside}));
    };
    ColorBar bar = bar_of(0, 1, 0);
    EXPECT_EQ(bar.note, "");
    EXPECT_EQ(bar.below, Beyond::nothing);
    EXPECT_EQ(bar.above, Beyond::nothing);
    bar = bar_of(0.001, 2, 1);
    EXPECT_EQ(bar.below, Beyond::clamped);
    EXPECT_EQ(bar.above, Beyond::nothing);
    EXPECT_EQ(bar.note, "p: 1.6 % of the values lie below 0.001 and are drawn as 0.001.");  // 1 of 64 points
    bar = bar_of(0.001, 0.999, 0);
    EXPECT_EQ(bar.below, Beyond::hidden);
    EXPECT_EQ(bar.above, Beyond::clamped);
    EXPECT_EQ(bar.note, "p: 1.6 % of the values lie below 0.001 and are not drawn; 1.6 % lie above 0.999 and are drawn as 0.999.");
    bar = bar_of(0.001, 0.999, 1, Outside::transparent);
    EXPECT_EQ(bar.below, Beyond::hidden);
    EXPECT_EQ(bar.above, Beyond::hidden);
    EXPECT_EQ(bar.note, "p: 1.6 % of the values lie below 0.001 and are not drawn; 1.6 % lie above 0.999 and are not drawn.");
    bar = bar_of(2, 3, 1);
    EXPECT_EQ(bar.note, "p: 100 % of the values lie below 2 and are drawn as 2.");

    // The labels at the ends say it, too.
    Scene scene = scene_with({OpticalModel::density, {{0.25, {0, 0, 1}}, {0.75, {1, 0, 0}}}, {{0.25, 1}, {0.75, 1}}});
    const ColorBarPlan with = plan_of(scene, BarSide::right);
    EXPECT_GT(with.arrow, 0);
    scene = scene_with({OpticalModel::density, {{0, {0, 0, 1}}, {1, {1, 0, 0}}}, {{0.25, 1}, {0.75, 1}}});
    EXPECT_EQ(plan_of(scene, BarSide::right).arrow, 0);
}

// The marks beyond the ends: filled with the end's colour where it stands for more, empty where nothing is drawn.
TEST(AnnotationColorBar, MarksShowTheFateOfWhatLiesBeyond) {
    const Scene scene = scene_with({OpticalModel::density, {{0.25, {0, 0, 1}}, {0.75, {1, 0, 0}}}, {{0.25, 0}, {0.75, 1}}});
    const ColorBarPlan plan = plan_of(scene, BarSide::right, {0, 0, 512, 512}, 30);
    Image image(512, 512);
    draw_color_bar(image, plan);
    const int middle = (plan.bar.x0 + plan.bar.x1) / 2;
    EXPECT_TRUE(same(image.at(middle, plan.bar.y0 - 4), {1, 0, 0, 1}));
    EXPECT_TRUE(same(image.at(middle, plan.bar.y1 + 4), {0, 0, 0, 0}));
}

std::shared_ptr<const SurfaceScene> three_surfaces() {
    SurfaceScene surfaces;
    surfaces.isosurfaces = IsoSurfaces({{0.25, {1, 0, 0}}, {0.5, {0, 1, 0}}, {2, {0, 0, 1}}});
    return std::make_shared<const SurfaceScene>(surfaces);
}

// Of surfaces alone there is nothing in the bar but their bands, and their values beside it.
TEST(AnnotationColorBar, SurfacesAreBands) {
    for (const bool medium : {false, true}) {
        Scene scene = scene_with(medium ? ramp() : TransferFunction(OpticalModel::density, {{0, glm::dvec3(0)}}, {{0, 0}}));
        scene.surfaces = three_surfaces();
        for (const BarSide side : {BarSide::left, BarSide::bottom}) {
            const ColorBarPlan plan = plan_of(scene, side);
            EXPECT_EQ(plan.content.medium, medium);
            EXPECT_EQ(plan.content.low, 0);
            EXPECT_EQ(plan.content.high, 2);
            EXPECT_EQ(plan.content.note, "");
            Image image(512, 512);
            draw_color_bar(image, plan);
            const auto in_bar = [&](double s) {
                const PixelBox slice = plan.slice(plan.bar, std::min(static_cast<int>(plan.distance(s)), plan.length() - 1));
                return image.at(slice.x0 + slice.width() / 2, slice.y0 + slice.height() / 2);
            };
            EXPECT_TRUE(same(in_bar(0.25), {1, 0, 0, 1}));
            EXPECT_TRUE(same(in_bar(0.5), {0, 1, 0, 1}));
            EXPECT_EQ(in_bar(1.2).a, medium ? 1 : 0);
            if (!medium) {
                EXPECT_TRUE(same(in_bar(2), {0, 0, 1, 1}));
                EXPECT_EQ(plan.ticks.ticks.size(), 3U);
                EXPECT_EQ(plan.ticks.ticks[1].label, "0.5");
                EXPECT_FALSE(plan.content.path);
            }
        }
    }
}

// Isovalues may be any finite scalars.
TEST(AnnotationColorBar, SurfacesOfAnyValueAreInTheBar) {
    SurfaceScene surfaces;
    surfaces.isosurfaces = IsoSurfaces({{-1.7e308}, {0.5}, {1.7e308}});
    Scene scene = scene_with(ramp());
    scene.surfaces = std::make_shared<const SurfaceScene>(surfaces);
    for (const ScalarAxis axis : {ScalarAxis::linear, ScalarAxis::log}) {
        const ColorBarPlan plan = plan_color_bar(describe_color_bar(scene, "", axis), BarSide::right, {0, 0, 512, 512}, *font(), plain_style());
        EXPECT_EQ(plan.distance(-1.7e308), 0);
        EXPECT_EQ(plan.distance(0.5), plan.length() / 2.0);
        EXPECT_EQ(plan.distance(1.7e308), plan.length());
        Image image(512, 512);
        draw_color_bar(image, plan);
        EXPECT_EQ(count_non_finite(image), 0U);
    }
}

TEST(AnnotationColorBar, TwoFieldsAreNamed) {
    Scene scene = scene_with({OpticalModel::density, {{0.5, {0, 0, 1}}, {3, {1, 0, 0}}}, {{-5, 0}, {0.9, 1}}});
    ScalarField other = *scene.field;
    other.name = "T";
    scene.opacity_field = std::make_shared<ScalarField>(other);
    const ColorBar bar = describe_color_bar(scene);
    EXPECT_EQ(bar.low, 0.5);
    EXPECT_EQ(bar.high, 3);
    EXPECT_EQ(bar.opacity_name, "T");
    EXPECT_FALSE(bar.path);
    EXPECT_EQ(bar.below, Beyond::clamped);
    EXPECT_NE(bar.note.find("are drawn as 0.5. T: "), std::string::npos) << bar.note;
    EXPECT_NE(bar.note.find("lie above 0.9 and are as opaque as 0.9."), std::string::npos) << bar.note;
}

TEST(AnnotationColorBar, LogarithmicAxis) {
    const Scene scene = scene_with(default_transfer_function(0.01, 100, 1, "viridis", ScalarAxis::log), 100);
    const ColorBarPlan plan = plan_color_bar(describe_color_bar(scene, "", ScalarAxis::log), BarSide::right, {0, 0, 512, 512}, *font(), plain_style());
    EXPECT_EQ(plan.scalar(0), 0.01);
    EXPECT_EQ(plan.scalar(plan.length()), 100);
    EXPECT_NEAR(plan.scalar(plan.length() / 2.0), 1, 1e-13);
    EXPECT_NEAR(plan.distance(10), 0.75 * plan.length(), 1e-10);
    EXPECT_EQ(plan.ticks.ticks.front().label, "0.01");
    EXPECT_EQ(describe_color_bar(scene_with(ramp()), "", ScalarAxis::log).axis, ScalarAxis::linear) << "from 0: no logarithm";
}

// Ranges of any kind, names of any length, at any place and size: all of the bar lies in its area, no two texts touch, and nothing else of the
// picture is changed.
TEST(AnnotationColorBar, KeepsToItsArea) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    const std::vector<std::string> names{"p", "StagnationEnergyPerUnitVolumeOfTheMixture", "ρ", ""};
    const std::vector<ImageSize> sizes{{200, 150}, {512, 512}, {300, 900}, {1920, 1080}};
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 12 : 64); ++trial) {
        const double width = std::pow(10.0, 8 * number(random)), low = number(random) * std::pow(10.0, 8 * number(random)), high = low + width;
        const Scene scene = scene_with({OpticalModel::density, {{low, {0, 0, 1}}, {high, {1, 0, 0}}}, {{low, trial % 2 ? 1.0 : 0.0}, {high, 2}}},
                                       trial % 5 ? 2 * width : 1, trial % 5 ? low - width / 2 : low, names[static_cast<std::size_t>(trial % 4)]);
        const ImageSize size = sizes[static_cast<std::size_t>(trial / 4 % 4)];
        for (const BarSide side : {BarSide::left, BarSide::right, BarSide::bottom}) {
            const PixelBox within{5, 20, size.width - 3, size.height - 10};
            const ColorBarPlan plan = plan_of(scene, side, within, std::max(9.0, std::min(size.width, size.height) / 38.0));
            const auto inside = [&](const PixelBox& box) {
                const PixelBox cut = intersection(box, plan.area);
                return cut.width() == box.width() && cut.height() == box.height();
            };
            ASSERT_TRUE(inside(plan.bar) && inside(plan.strip));
            std::vector<PixelBox> boxes;
            for (const PlacedText& text : plan.texts) {
                const PixelBox box = box_of(text.mask, text.x, text.y);
                ASSERT_TRUE(inside(box)) << low << " " << high << " " << trial << " " << size.width << " text " << boxes.size();
                for (const PixelBox& other : boxes) {
                    const PixelBox both = intersection(box, other);
                    ASSERT_EQ(both.width() * both.height(), 0) << low << " " << high << " " << trial << " " << size.width << " side " << int(side);
                }
                boxes.push_back(box);
            }
            const Image before = numbered_picture(size);
            Image image = before;
            draw_color_bar(image, plan);
            for (int y = 0; y < size.height; ++y)
                for (int x = 0; x < size.width; ++x)
                    if (!plan.area.contains(x, y)) {
                        ASSERT_TRUE(same(image.at(x, y), before.at(x, y)));
                    }
        }
    }
}

TEST(AnnotationColorBar, ConstantField) {
    const ColorBarPlan plan = plan_of(scene_with(default_transfer_function(5, 5, 1), 0, 5), BarSide::right);
    EXPECT_EQ(plan.content.note, "");
    EXPECT_EQ(plan.distance(5), plan.length() / 2.0);
    EXPECT_EQ(plan.scalar(0), 5);
    Image image(512, 512);
    draw_color_bar(image, plan);
    EXPECT_TRUE(same(image.at(plan.bar.x0, plan.bar.y0), image.at(plan.bar.x0, plan.bar.y1 - 1)));
}

// ---- lines

// Along a level line of two pixels two rows are full, and nothing else is touched but its round ends.
TEST(AnnotationCanvas, LinesCoverTheirWidth) {
    Image image(60, 40);
    const Segment line{{10, 20}, {50, 20}};
    draw_lines(image, {&line, 1}, 2, {glm::dvec3(1)}, whole(image));
    for (int y = 0; y < 40; ++y)
        for (int x = 11; x < 49; ++x) ASSERT_EQ(image.at(x, y).a, y == 19 || y == 20 ? 1 : 0);
    for (int y = 0; y < 40; ++y) ASSERT_EQ(image.at(8, y).a + image.at(51, y).a, 0);
}

// Lines through the middle of the picture at any slope and of any length cover it there, and keep to their clip.
TEST(AnnotationCanvas, LinesOfAnySlopeAndLength) {
    const PixelBox clip{5, 5, 55, 35};
    for (const double length : {3.0, 1e3, 1e9, 1e200})
        for (const glm::dvec2 direction : {glm::dvec2(1, 0), {0, 1}, {1, 1e-320}, {1, 1e-9}, {1e-9, 1}, {1e-320, 1}, {0.6, -0.8}, {-0.999, 0.02}}) {
            Image image(60, 40);
            const Segment line{glm::dvec2(30.5, 20.5) - length * direction, glm::dvec2(30.5, 20.5) + length * direction};
            draw_lines(image, {&line, 1}, 1, {glm::dvec3(1)}, clip);
            if (length < 1e200) {
                EXPECT_GT(image.at(30, 20).a, 0.99) << length << " " << direction.x << " " << direction.y;
            }
            for (int y = 0; y < 40; ++y)
                for (int x = 0; x < 60; ++x) {
                    ASSERT_TRUE(image.at(x, y).a >= 0 && image.at(x, y).a <= 1);
                    if (!clip.contains(x, y)) {
                        ASSERT_EQ(image.at(x, y).a, 0);
                    }
                }
        }
}

// ---- axes and outline

Camera random_camera(std::mt19937_64& random, Camera::Projection projection) {
    std::normal_distribution<double> normal;
    Camera camera;
    camera.projection = projection;
    camera.center = {normal(random), normal(random), normal(random)};
    camera.eye = camera.center + 10.0 * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    camera.up = {normal(random), normal(random), normal(random)};
    camera.height = 4;
    return camera;
}

// The derivative of the camera's projection in its middle, for each axis; in perspective by a difference whose error is its square.
TEST(AnnotationTriad, DirectionsAreThoseOfTheProjection) {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 200; ++trial) {
        const bool parallel = trial % 2;
        const Camera camera = random_camera(random, parallel ? Camera::Projection::parallel : Camera::Projection::perspective);
        const ScreenTransform transform(camera, {400, 300});
        const double step = parallel ? 1 : 1e-4, scale = transform.pixels_per_unit() / (parallel ? 1 : 10);
        const std::array<glm::dvec3, 3> axes = axes_seen(camera);
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 offset(0.0);
            offset[axis] = step;
            const auto on_screen = [&](const glm::dvec3& p) { return transform.to_screen(transform.to_eye(p)); };
            const glm::dvec2 slope = (on_screen(camera.center + offset) - on_screen(camera.center - offset)) / (2 * step * scale);
            EXPECT_NEAR(slope.x, axes[static_cast<std::size_t>(axis)].x, 1e-8);
            EXPECT_NEAR(slope.y, axes[static_cast<std::size_t>(axis)].y, 1e-8);
            EXPECT_NEAR(glm::length(axes[static_cast<std::size_t>(axis)]), 1, 1e-14);
        }
    }
}

// The pixel in the middle belongs to the axis that comes nearest to the eye; nothing is drawn beyond the box.
TEST(AnnotationTriad, NearestAxisIsDrawnLast) {
    const AnnotationStyle style = plain_style(20);
    for (int axis = 0; axis < 3; ++axis) {
        Camera camera;
        camera.eye = glm::dvec3(0.3, 0.35, 0.4);
        camera.eye[axis] = 1;
        camera.up = {0.1, 0.2, 0.3};
        camera.up[(axis + 1) % 3] = 1;
        const int side = triad_size(style);
        const Image before = numbered_picture({side + 40, side + 30});
        Image image = before;
        const PixelBox box{20, 10, 20 + side, 10 + side};
        draw_triad(image, camera, box, *font(), style);
        const glm::vec4 middle = image.at(20 + side / 2, 10 + side / 2);
        for (int other = 0; other < 3; ++other)
            if (other != axis) {
                EXPECT_GT(middle[axis], middle[other] + 0.3F) << axis;
            }
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x)
                if (!box.contains(x, y)) {
                    ASSERT_TRUE(same(image.at(x, y), before.at(x, y)));
                }
        // Arrows and labels lie well inside: the last ring of pixels stays free.
        for (int x = box.x0; x < box.x1; ++x) EXPECT_TRUE(same(image.at(x, box.y0), before.at(x, box.y0)));
    }
}

// Where a ray from the eye through the middle of each edge enters and leaves the box, by slabs, decides: the edge is before all that is inside when the
// ray enters there, behind when it leaves.
TEST(AnnotationOutline, EdgesAreBeforeOrBehindAsRaysMeetThem) {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(0.1, 2);
    const ImageSize size{400, 300};
    int before_count = 0, behind_count = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const Camera camera = random_camera(random, trial % 2 ? Camera::Projection::parallel : Camera::Projection::perspective);
        const glm::dvec3 half(unit(random), unit(random), unit(random));
        const Bounds box{camera.center - half, camera.center + half};
        const BoxOutline outline = outline_of(box, camera, size);
        ASSERT_EQ(outline.before.size() + outline.behind.size(), 12U);
        const ScreenTransform transform(camera, size);
        const auto on_screen = [&](const glm::dvec3& p) { return transform.to_screen(transform.to_eye(p)); };
        for (const bool before : {true, false})
            for (const Segment& line : before ? outline.before : outline.behind) {
                // The edge of this line, by its ends.
                int found = 0;
                for (int along = 0; along < 3; ++along)
                    for (int k = 0; k < 4; ++k) {
                        glm::dvec3 a = box.low, b = box.high;
                        const int u = (along + 1) % 3, v = (along + 2) % 3;
                        a[u] = b[u] = k % 2 ? box.high[u] : box.low[u];
                        a[v] = b[v] = k / 2 ? box.high[v] : box.low[v];
                        if (glm::distance(on_screen(a), line.first) > 1e-6 || glm::distance(on_screen(b), line.second) > 1e-6) continue;
                        ++found;
                        const glm::dvec3 middle = 0.5 * (a + b);
                        const glm::dvec3 to = camera.projection == Camera::Projection::parallel ? camera.center - camera.eye : middle - camera.eye;
                        double enter = -1e9, leave = 1e9;
                        for (int axis = 0; axis < 3; ++axis) {
                            const double t0 = (box.low[axis] - middle[axis]) / to[axis], t1 = (box.high[axis] - middle[axis]) / to[axis];
                            // The two planes that the edge lies in: whatever rounding says, they are met here.
                            const bool at_low = middle[axis] == box.low[axis], at_high = middle[axis] == box.high[axis];
                            enter = std::max(enter, std::min(at_low ? 0 : t0, at_high ? 0 : t1));
                            leave = std::min(leave, std::max(at_low ? 0 : t0, at_high ? 0 : t1));
                        }
                        EXPECT_EQ(before, enter >= 0 || leave < 0 || enter > leave || (enter == 0 && leave == 0)) << enter << " " << leave;
                    }
                EXPECT_GE(found, 1);
            }
        before_count += static_cast<int>(outline.before.size());
        behind_count += static_cast<int>(outline.behind.size());
    }
    // A box shows 9 edges, 7 or 4 where an eye near by sees two faces or one.
    EXPECT_GT(before_count, 300 * 7);
    EXPECT_GT(behind_count, 300);
}

TEST(AnnotationOutline, FromInsideAllEdgesAreBehindAndCutAtTheEye) {
    Camera camera;
    camera.eye = {0.5, 0.5, 0.5};
    camera.center = {0.9, 0.6, 0.5};
    camera.up = {0, 0, 1};
    const BoxOutline outline = outline_of({glm::dvec3(0), glm::dvec3(1)}, camera, {100, 100});
    EXPECT_TRUE(outline.before.empty());
    EXPECT_GE(outline.behind.size(), 4U);
    EXPECT_LT(outline.behind.size(), 12U);
    for (const auto& [a, b] : outline.behind) EXPECT_TRUE(std::isfinite(a.x + a.y + b.x + b.y));
    // In the plane of a face nothing of that face is seen; a flat box, and one point, are boxes.
    camera.eye = {-3, 0.5, 1};
    camera.center = {0.5, 0.5, 1};
    EXPECT_EQ(outline_of({glm::dvec3(0), glm::dvec3(1)}, camera, {100, 100}).before.size(), 4U);
    for (const glm::dvec3 high : {glm::dvec3(1, 1, 0), glm::dvec3(0)})
        for (const auto& [a, b] : outline_of({glm::dvec3(0), high}, camera, {100, 100}).before) EXPECT_TRUE(std::isfinite(a.x + a.y + b.x + b.y));
}

// The same at 1e6 and at scales of 1e±12: to a thousandth of a pixel at 1e6, where points are multiples of 1e-10.
TEST(AnnotationOutline, AnyScaleAndPlace) {
    std::mt19937_64 random(2);
    const Camera camera = random_camera(random, Camera::Projection::perspective);
    const Bounds box{camera.center - 1.0, camera.center + 1.0};
    const BoxOutline plain = outline_of(box, camera, {400, 300});
    for (const auto& [scale, offset] : {std::pair{1e12, 0.0}, {1e-12, 0.0}, {1.0, 1e6}}) {
        Camera moved = camera;
        moved.eye = scale * camera.eye + offset;
        moved.center = scale * camera.center + offset;
        const BoxOutline outline = outline_of({scale * box.low + offset, scale * box.high + offset}, moved, {400, 300});
        ASSERT_EQ(outline.before.size(), plain.before.size());
        for (std::size_t i = 0; i < plain.before.size(); ++i) EXPECT_LT(glm::distance(outline.before[i].first, plain.before[i].first), 1e-3);
    }
}

}  // namespace
}  // namespace cellproj
