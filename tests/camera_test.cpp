// SPDX-License-Identifier: BSD-3-Clause
#include "project/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"

namespace cellproj {
namespace camera_test {

Camera camera_of(Camera::Projection projection) {
    Camera camera;
    camera.projection = projection;
    camera.eye = {3, -4, 2};
    camera.center = {0.5, 0.25, -0.5};
    camera.up = {0, 0.1, 1};
    camera.height = 3;
    camera.fov_y_degrees = 40;
    return camera;
}

class BothProjections : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Camera, BothProjections,
                         testing::Values(Camera::Projection::parallel, Camera::Projection::perspective));

TEST_P(BothProjections, TheCenterAppearsInTheMiddle) {
    const ScreenTransform transform(camera_of(GetParam()), {640, 480});
    const glm::dvec3 p = transform.to_eye({0.5, 0.25, -0.5});
    EXPECT_NEAR(glm::distance(transform.to_screen(p), glm::dvec2(320, 240)), 0, 1e-10);
    EXPECT_NEAR(p.z, glm::distance(glm::dvec3(3, -4, 2), glm::dvec3(0.5, 0.25, -0.5)), 1e-12);
}

TEST_P(BothProjections, UpIsUpAndRightIsRight) {
    Camera camera = camera_of(GetParam());
    camera.eye = {0, -5, 0};
    camera.center = {0, 0, 0};
    camera.up = {0, 0, 1};
    const ScreenTransform transform(camera, {100, 100});
    EXPECT_LT(transform.to_screen(transform.to_eye({0, 0, 0.5})).y, 50);  // row 0 is the top row
    EXPECT_GT(transform.to_screen(transform.to_eye({0.5, 0, 0})).x, 50);
}

TEST_P(BothProjections, ARayGoesThroughItsPixel) {
    const ScreenTransform transform(camera_of(GetParam()), {640, 480});
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec2 pixel{640 * share(random), 480 * share(random)};
        const auto ray = transform.ray(pixel);
        EXPECT_NEAR(glm::length(ray.direction), 1, 1e-14);
        const glm::dvec3 p = ray.origin + (0.5 + 10 * share(random)) * ray.direction;
        EXPECT_NEAR(glm::distance(transform.to_screen(transform.to_eye(p)), pixel), 0, 1e-9);  // pixels
    }
}

TEST(Camera, ParallelHeightAndPerspectiveAngleFillThePicture) {
    Camera camera;
    camera.eye = {0, 0, 10};
    camera.center = {0, 0, 0};
    camera.up = {0, 1, 0};
    camera.projection = Camera::Projection::parallel;
    camera.height = 4;
    const ScreenTransform parallel(camera, {300, 200});
    EXPECT_NEAR(parallel.to_screen(parallel.to_eye({0, 2, 0})).y, 0, 1e-12);
    camera.projection = Camera::Projection::perspective;
    camera.fov_y_degrees = 90;
    const ScreenTransform perspective(camera, {300, 200});
    EXPECT_NEAR(perspective.to_screen(perspective.to_eye({0, 10, 0})).y, 0, 1e-12);
}

// All corners are in the picture, and with frame_bounds one of them is at the margin: 5 % of the half size from the border.
TEST_P(BothProjections, FramesSeeTheWholeBox) {
    std::mt19937_64 random(2);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 from(normal(random), normal(random), normal(random));
        const Bounds box{{-1, 2, 5}, {3, 2.5, 11}};
        const ImageSize size{i % 2 ? 300 : 200, i % 2 ? 200 : 300};
        const double aspect = double(size.width) / size.height;
        for (const bool tight : {true, false}) {
            const Camera camera = (tight ? frame_bounds : frame_sphere)(box, GetParam(), from, {0.1, 0.2, 1}, aspect);
            const ScreenTransform transform(camera, size);
            double reach = 0;  // 1: on the border
            for (int corner = 0; corner < 8; ++corner) {
                const glm::dvec3 p = transform.to_eye({corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                                       corner & 4 ? box.high.z : box.low.z});
                ASSERT_GT(p.z, 0);
                const glm::dvec2 pixel = transform.to_screen(p);
                reach = std::max({reach, std::abs(2 * pixel.x / size.width - 1), std::abs(2 * pixel.y / size.height - 1)});
            }
            if (tight) {
                EXPECT_NEAR(reach, 1 / 1.05, 1e-9);
            } else {
                EXPECT_LT(reach, 1 / 1.05 + 1e-12);
            }
        }
    }
}

TEST(Camera, OrbitTurnsAboutTheUpAxisThroughTheCenter) {
    Camera camera = camera_of(Camera::Projection::perspective);
    camera.eye = {2, 0, 1};
    camera.center = {0, 0, 1};
    camera.up = {0, 0, 2};
    EXPECT_NEAR(glm::distance(orbit(camera, 90).eye, glm::dvec3(0, 2, 1)), 0, 1e-14);
    EXPECT_NEAR(glm::distance(orbit(camera, 360).eye, camera.eye), 0, 1e-14);
}

TEST(Camera, ViewpointIsHomogeneous) {
    const Eye near = camera_of(Camera::Projection::perspective).viewpoint();
    EXPECT_FALSE(near.at_infinity);
    EXPECT_EQ(near.xyz, glm::dvec3(3, -4, 2));
    const Eye far = camera_of(Camera::Projection::parallel).viewpoint();
    EXPECT_TRUE(far.at_infinity);
    EXPECT_NEAR(glm::dot(far.xyz, glm::normalize(glm::dvec3(2.5, -4.25, 2.5))), 1, 1e-15);
}

TEST(CameraJson, RoundTripAndArrays) {
    for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
        const Camera camera = camera_of(projection);
        const auto read = parse_cameras("[" + to_json(camera) + "," + to_json(camera) + "]", "cams");
        ASSERT_EQ(read.size(), 2U);
        EXPECT_EQ(to_json(read[1]), to_json(camera));
        EXPECT_EQ(parse_cameras(to_json(camera), "cam").size(), 1U);
    }
}

std::string refusal(const std::string& json) {
    try {
        parse_cameras(json, "cam.json");
    } catch (const Error& error) {
        EXPECT_EQ(error.place().substr(0, 8), "cam.json");
        return error.what();
    }
    return {};
}

TEST(CameraJson, EveryMistakeIsNamed) {
    const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    const std::string good = R"("projection": "parallel", "eye": [1,2,3], "center": [0,0,0], "up": [0,0,1])";
    EXPECT_EQ(refusal("{" + good + R"(, "height": 2})"), "");
    EXPECT_TRUE(contains(refusal("{" + good + R"(, "height": 2, "heigth": 3})"), "did you mean \"height\""));
    EXPECT_TRUE(contains(refusal("{" + good + R"(, "fov_y_degrees": 30})"), "fov_y_degrees"));
    EXPECT_TRUE(contains(refusal("{" + good + "}"), "\"height\""));
    EXPECT_TRUE(contains(refusal("{" + good + R"(, "height": -1})"), "height > 0"));
    EXPECT_TRUE(contains(refusal("{" + good + R"(, "height": 1e999})"), "JSON"));
    EXPECT_TRUE(contains(refusal(R"({"projection": "fisheye", "eye": [1,2,3]})"), "\"fisheye\""));
    EXPECT_TRUE(contains(refusal(R"({"projection": 3})"), "projection"));
    EXPECT_TRUE(contains(refusal(R"({"projection": "parallel", "eye": [1,2], "center": [0,0,0], "up": [0,0,1], "height": 1})"), "three numbers"));
    EXPECT_TRUE(contains(refusal("[]"), "at least one camera"));
    EXPECT_TRUE(contains(refusal("[3]"), "camera 0"));
    EXPECT_TRUE(contains(refusal("{"), "JSON"));
    EXPECT_TRUE(contains(refusal(""), "JSON"));
}

TEST(CameraValidate, RefusesWhatCannotBeSeen) {
    const auto refused = [](auto change) {
        Camera camera = camera_of(Camera::Projection::perspective);
        change(camera);
        EXPECT_THROW(validate(camera, "camera"), Error);
    };
    refused([](Camera& c) { c.eye = c.center; });
    refused([](Camera& c) { c.up = 3.0 * (c.eye - c.center); });
    refused([](Camera& c) { c.up = {0, 0, 0}; });
    refused([](Camera& c) { c.fov_y_degrees = 180; });
    refused([](Camera& c) { c.fov_y_degrees = 0; });
    refused([](Camera& c) { c.eye.x = std::numeric_limits<double>::quiet_NaN(); });
    EXPECT_THROW(validate(ImageSize{0, 0}, "size"), Error);
    EXPECT_THROW(validate(ImageSize{10, 16385}, "size"), Error);
    EXPECT_NO_THROW(validate(ImageSize{1, 16384}, "size"));
}

}  // namespace
}  // namespace cellproj
