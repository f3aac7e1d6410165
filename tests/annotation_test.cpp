// SPDX-License-Identifier: BSD-3-Clause
//
// Colour bar, axes, outline and layout: against the transfer function, the camera's projection and rays through a box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/annotation.hpp"
#include "render/annotation_outline.hpp"
#include "render/annotation_triad.hpp"
#include "render/renderer.hpp"
#include "tests/support/folder_test.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace {

using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;

std::shared_ptr<const Font> font() {
    static const auto shared = std::make_shared<const Font>();
    return shared;
}

// A field 0..1 (`scale` times it, plus `offset`) in the unit cube.
Scene scene_with(TransferFunction transfer, double scale = 1, double offset = 0, const std::string& name = "p") {
    const TetMesh mesh = grid_mesh(3);
    ScalarField field = testing_support::point_field(mesh, [&](const glm::dvec3& p) { return offset + scale * linear(p); });
    field.name = name;
    return scene_of(mesh, std::move(field), std::move(transfer));
}

// Every channel of every pixel differs from any other one, and none is empty.
Image numbered_picture(ImageSize size, float alpha = 0.5F) {
    Image image(size.width, size.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = {1e-6F * static_cast<float>(i % 100000), 0.125F, 0.25F, alpha};
    return image;
}

bool same(const glm::vec4& a, const glm::vec4& b) { return a == b; }

AnnotationStyle plain_style(double em = 13.5) { return {em, 0.8 * em, 1, {glm::dvec3(0)}, {glm::dvec3(1)}}; }

ColorBarPlan plan_of(const Scene& scene, BarSide side, const PixelBox& within = {0, 0, 512, 512}, double em = 13.5) {
    return plan_color_bar(describe_color_bar(scene, "Pa"), side, within, *font(), plain_style(em));
}

const TransferFunction peaks{OpticalModel::density, {{0.1, {0.1, 0.2, 0.9}}, {0.5, {1.0, 0.6, 0.0}}, {0.5, {0.0, 0.6, 0.2}}, {0.9, {1, 1, 1}}},
                             {{0.2, 0}, {0.4, 3}, {0.6, 0}, {0.6, 1}, {0.9, 2}}};

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
    for (int trial = 0; trial < (CELLPROJ_SANITIZED ? 16 : 64); ++trial) {
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

// ---- the whole picture

const Annotations everything{.color_bar = BarSide::right, .units = "Pa", .axes = true, .outline = true, .title = "Title"};

TEST(Annotator, WithoutAnnotationsNothingChanges) {
    const Annotator annotator({}, scene_with(ramp()), {64, 48}, nullptr);
    EXPECT_EQ(annotator.view_size().width, 64);
    EXPECT_EQ(annotator.view_size().height, 48);
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    EXPECT_EQ(to_json(annotator.view_camera(camera)), to_json(camera));
    const Image before = numbered_picture({64, 48});
    const Image after = annotator.compose(before, camera);
    EXPECT_TRUE(before.pixels == after.pixels);
}

// The view is the renderer's picture bit for bit; beside it is what stands there for the reader, and no pixel of text is cut off.
TEST(Annotator, KeepsThePictureOfTheView) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    for (const BarSide side : {BarSide::left, BarSide::right, BarSide::bottom})
        for (const ImageSize size : {ImageSize{512, 512}, side == BarSide::bottom ? ImageSize{320, 240} : ImageSize{200, 150}, {1280, 720}}) {
            Annotations annotations = everything;
            annotations.color_bar = side;
            annotations.axes = annotations.outline = false;
            const Annotator annotator(annotations, scene_with(peaks), size, font());
            const Image view = numbered_picture(annotator.view_size());
            const Image picture = annotator.compose(view, camera);
            ASSERT_EQ(picture.width, size.width);
            ASSERT_EQ(picture.height, size.height);
            for (int y = 0; y < view.height; ++y)
                for (int x = 0; x < view.width; ++x)
                    ASSERT_TRUE(same(view.at(x, y), picture.at(annotator.view().x0 + x, annotator.view().y0 + y)));
            // The picture's own border is free.
            for (int x = 0; x < size.width; ++x) ASSERT_EQ(picture.at(x, 0).a + picture.at(x, size.height - 1).a, annotator.view().y1 == size.height && annotator.view().x0 <= x && x < annotator.view().x1 ? 0.5F : 0.0F);
        }
}

// All that the camera shows in the whole picture lies in the view, which it fills in one direction.
TEST(Annotator, ShowsInTheViewWhatThePictureShowed) {
    for (const ImageSize size : {ImageSize{512, 512}, {1920, 1080}, {300, 700}})
        for (const BarSide side : {BarSide::left, BarSide::bottom})
            for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
                Annotations annotations = everything;
                annotations.color_bar = side;
                const Annotator annotator(annotations, scene_with(peaks), size, font());
                Camera camera = view_of_unit_cube(projection);
                camera.fov_y_degrees = 70;
                const ScreenTransform whole_picture(camera, size), view(annotator.view_camera(camera), annotator.view_size());
                const double w = annotator.view().width(), h = annotator.view().height();
                const double scale = std::min(w / size.width, h / size.height);
                for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(size.width, size.height), glm::dvec2(0.3 * size.width, size.height)}) {
                    const ScreenTransform::Ray ray = whole_picture.ray(corner);
                    const glm::dvec2 seen = view.to_screen(view.to_eye(ray.origin + 5.0 * ray.direction));
                    const glm::dvec2 expected = 0.5 * glm::dvec2(w, h) + scale * (corner - 0.5 * glm::dvec2(size.width, size.height));
                    EXPECT_LT(glm::distance(seen, expected), 1e-8 * size.width);
                }
            }
}

// A volume that lets nothing through hides what is behind it: from inside of the box all edges are.
TEST(Annotator, OpaqueVolumeHidesEdgesBehindIt) {
    Annotations annotations{.outline = true};
    const Annotator annotator(annotations, scene_with(ramp()), {80, 60}, nullptr);
    Camera camera;
    camera.eye = {0.5, 0.5, 0.5};
    camera.center = {0.9, 0.6, 0.5};
    camera.up = {0, 0, 1};
    camera.fov_y_degrees = 100;
    const Image opaque = numbered_picture({80, 60}, 1.0F), empty(80, 60);
    EXPECT_TRUE(annotator.compose(opaque, camera).pixels == opaque.pixels);
    EXPECT_FALSE(annotator.compose(empty, camera).pixels == empty.pixels);

    // Half of the light of an edge behind passes a volume of opacity ½; edges before it are not dimmed.
    const Image half = numbered_picture({80, 60}, 0.5F);
    const Image dimmed = annotator.compose(half, camera), full = annotator.compose(empty, camera);
    for (std::size_t i = 0; i < half.pixels.size(); ++i)
        ASSERT_NEAR(dimmed.pixels[i].a - 0.5F, 0.5F * full.pixels[i].a, 1e-6F);
    camera = view_of_unit_cube(Camera::Projection::parallel);
    const Image before = annotator.compose(opaque, camera);
    const BoxOutline outline = outline_of({glm::dvec3(0), glm::dvec3(1)}, camera, {80, 60});
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 80; ++x) {
            double nearest = 1e9;
            for (const auto& [a, b] : outline.before) {
                const glm::dvec2 p(x + 0.5, y + 0.5), d = b - a;
                nearest = std::min(nearest, glm::distance(p, a + std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0) * d));
            }
            // Lines are a pixel thick, and anti-aliasing takes half a pixel more on both sides.
            const bool changed = !same(before.at(x, y), opaque.at(x, y));
            if (nearest < 0.9) {
                ASSERT_TRUE(changed) << x << " " << y;
            } else if (nearest > 1.01) {
                ASSERT_FALSE(changed) << x << " " << y;
            }
        }
}

TEST(Annotator, InkIsSeenOnItsBackground) {
    for (const glm::dvec3 background : {glm::dvec3(0), glm::dvec3(1), glm::dvec3(0.5), glm::dvec3(0.1, 0.1, 0.5), glm::dvec3(1, 1, 0)}) {
        const Annotator annotator({.title = "■", .background = background}, scene_with(ramp()), {512, 512}, font());
        const Image picture = annotator.compose(Image(annotator.view_size().width, annotator.view_size().height), {});
        const auto darkest = std::max_element(picture.pixels.begin(), picture.pixels.end(), [](const auto& a, const auto& b) { return a.a < b.a; });
        ASSERT_EQ(darkest->a, 1);
        EXPECT_GT(glm::distance(glm::dvec3(*darkest), background), 0.4) << background.x;
    }
}

TEST(Annotator, PixelsThatAreNotFiniteCountAsEmpty) {
    Image image(1, 1);
    image.at(0, 0) = glm::vec4(std::numeric_limits<float>::quiet_NaN());
    blend(image, 0, 0, {{0, 0, 1}, 0.5}, 1);
    EXPECT_TRUE(same(image.at(0, 0), {0, 0, 0.5F, 0.5F}));
}

void expect_refused(const Annotations& annotations, ImageSize size, const std::string& words) {
    try {
        const Annotator refused(annotations, scene_with(peaks), size, font());
        FAIL() << size.width << "x" << size.height;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::option);
        EXPECT_EQ(error.place(), "--size");
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
}

TEST(Annotator, PicturesThatAreTooSmallAreRefused) {
    expect_refused(everything, {64, 64}, "at least 96x96");
    expect_refused({.axes = true}, {1000, 95}, "at least 96x96");
    expect_refused(everything, {100, 100}, "leaves half");
    std::string long_title;
    for (int i = 0; i < 200; ++i) long_title += "word ";
    expect_refused({.title = long_title}, {512, 512}, "leaves half");
    const Annotator outline_of_any({.outline = true}, scene_with(peaks), {1, 1}, nullptr);
    EXPECT_EQ(outline_of_any.view_size().width, 1);
}

// ---- the command

class AnnotationCommand : public testing_support::FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        write("cube.vtk",
              "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n"
              "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n"
              "POINT_DATA 8\nSCALARS p double 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n");
    }

    testing_support::Outcome run(const std::string& arguments) const { return testing_support::run_program(folder_, "render cube.vtk " + arguments); }
};

TEST_F(AnnotationCommand, DrawsAndSaysWhatIsClamped) {
    const auto outcome = run("-o all.png --size 200x150 --range 1,6 --color-bar left --axes --outline --title 'A title' --units Pa --background 0,0,0");
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_NE(outcome.text.find("cellproj: note: p: 12 % of the values lie below 1 and are not drawn; 12 % lie above 6 and are drawn as 6.\n"), std::string::npos)
        << outcome.text;
    EXPECT_NE(content("all.png").find("cellproj note"), std::string::npos);
    // Of several pictures it is said once.
    const auto orbit = run("-o orbit.png --size 200x150 --range 1,6 --color-bar --frames 3 --orbit 90");
    EXPECT_EQ(orbit.code, 0) << orbit.text;
    EXPECT_EQ(orbit.text.find("note:"), orbit.text.rfind("note:")) << orbit.text;
    EXPECT_EQ(run("-o inside.png --size 200x150 --range 0,7 --color-bar bottom").text.find("note:"), std::string::npos);
}

TEST_F(AnnotationCommand, RefusesBeforeReading) {
    const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
        const auto outcome = testing_support::run_program(folder_, "render missing.vtk " + arguments);
        EXPECT_EQ(outcome.code, code) << outcome.text;
        EXPECT_NE(outcome.text.find(words), std::string::npos) << outcome.text;
    };
    refused("-o a.exr --outline", 1, "an EXR holds what was computed and nothing else");
    refused("-o a.png --axes --size 64x64", 1, "--size: expected at least 96x96");
    refused("-o a.png --title T --font none.ttf", 1, "--font: expected a font file");
    refused("-o a.png --color-bar up", 2, "up is not left, right or bottom");
    refused("-o a.png --units Pa", 2, "--units requires --color-bar");
}

TEST_F(AnnotationCommand, NamesCharactersThatTheFontLacks) {
    const auto outcome = run("-o a.png --size 128x128 --title 中");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.text.find("U+4E2D"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace cellproj
