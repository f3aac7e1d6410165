// SPDX-License-Identifier: BSD-3-Clause
//
// Annotated pictures as a whole: what they keep of the renderer's picture, what they show of the volume, what is refused; and the options of
// `cellproj render`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/annotation/annotation.hpp"
#include "render/annotation/outline.hpp"
#include "tests/support/annotation_fixtures.hpp"
#include "tests/support/folder_test.hpp"

namespace cellproj {
namespace annotator_test {

using testing_support::font;
using testing_support::numbered_picture;
using testing_support::peaks;
using testing_support::ramp;
using testing_support::same;
using testing_support::scene_with;
using testing_support::view_of_unit_cube;

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
