// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids as slabs between slices, in OpenGL, against closed forms and the judge of grids.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/gl/grid_slab_outline.hpp"
#include "render/judge/grid_reference.hpp"
#include "render/grid_renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/spherical_harmonic.hpp"

namespace cellproj {
namespace gl_slabs_test {

using testing_support::unit_cube;
using Projection = Camera::Projection;

GridRenderer& renderer() {
    static const auto one = make_grid_renderer(Backend::gl_osmesa);
    return *one;
}

GridScene scene_of(Grid grid, TransferFunction transfer) {
    return {std::make_shared<Grid>(std::move(grid)), std::make_shared<TransferFunction>(std::move(transfer))};
}

Image draw(const GridScene& scene, const Camera& camera, ImageSize size, const std::string& sampling, const std::string& method = "integral") {
    return renderer().render(scene, camera, size, {.method = parse_method(method), .sampling = parse_grid_sampling(sampling)});
}

// The judge takes most of the time.
constexpr ImageSize small = CELLPROJ_SANITIZED ? ImageSize{21, 19} : ImageSize{41, 37};

struct Errors {
    double rms, largest;
};

// Of every channel, at some hundred pixels.
Errors errors_of(const Image& image, const std::vector<PixelTruth>& truths) {
    Errors errors{0, 0};
    for (const PixelTruth& truth : truths) {
        const double d = testing_support::max_difference(glm::dvec4(truth.light.color, truth.light.opacity),
                                                         glm::dvec4(image.at(truth.pixel.x, truth.pixel.y)));
        errors.rms += d * d / static_cast<double>(truths.size());
        errors.largest = std::max(errors.largest, d);
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

std::vector<PixelTruth> truths_of(const GridScene& scene, const Camera& camera, ImageSize size) {
    return GridReference(scene.grid, scene.transfer).pixels(camera, size, all_pixels(size));
}

// ---- By name ----

TEST(GridSampling, NamesAndTheirParts) {
    using Cut = GridSampling::Cut;
    using Light = GridSampling::Light;
    EXPECT_EQ(parse_grid_sampling("cells"), GridSampling{});
    EXPECT_EQ(parse_grid_sampling("object:64"), (GridSampling{Cut::object, 64, Light::segment, 1}));
    EXPECT_EQ(parse_grid_sampling("view:16384:x16:pre"), (GridSampling{Cut::view, 16384, Light::pre, 16}));
    for (const char* text : {"cells", "object:1", "view:15", "object:60:post", "view:8:pre:x2", "object:7:x3"})
        EXPECT_EQ(to_string(parse_grid_sampling(text)), text);
    for (const char* text : {"", "cell", "cells:4", "object", "object:", "object:0", "object:16385", "view:-1", "view:4.5", "view:8:x0",
                             "view:8:x17", "view:8:x", "view:8:posts", "view:8x", "view:99999999999"}) {
        try {
            parse_grid_sampling(text, "--sampling");
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("--sampling"), std::string::npos) << text;
        }
    }
}

// ---- What slabs cover ----

// The slabs of a box have together its volume's shadow: every ray through one meets its outline.
TEST(GridSlabOutline, CornersOfASlabSpanIt) {
    std::mt19937_64 random(511);
    std::uniform_real_distribution<double> both(-1, 1);
    const Bounds box{{-1, -0.5, -0.25}, {0.5, 1, 0.75}};
    for (int trial = 0; trial < 300; ++trial) {
        glm::dvec3 normal(both(random), both(random), both(random));
        if (trial % 3 == 0) normal = {trial % 9 == 0, trial % 9 == 3, trial % 9 == 6};
        const double low = both(random), high = low + 0.4 * std::abs(both(random));
        const auto corners = gl::slab_corners(box, normal, low, high);
        for (const glm::dvec3& p : corners) {
            EXPECT_GT(glm::dot(normal, p), low - 1e-12);
            EXPECT_LT(glm::dot(normal, p), high + 1e-12);
        }
        std::vector<glm::dvec2> shadow;
        for (const glm::dvec3& p : corners) shadow.emplace_back(p.x + 0.3 * p.z, p.y - 0.2 * p.z);
        const auto hull = gl::convex_hull(shadow);
        const auto outside = [&](const glm::dvec2& q) {
            double most = -1;
            for (std::size_t i = 0; i < hull.size(); ++i) {
                const glm::dvec2 a = hull[i], b = hull[(i + 1) % hull.size()], d = b - a;
                most = std::max(most, (d.y * (q.x - a.x) - d.x * (q.y - a.y)) / glm::length(d));
            }
            return most;
        };
        for (int point = 0; point < 50; ++point) {
            const glm::dvec3 p = 0.5 * (box.low + box.high) + 0.5 * (box.high - box.low) * glm::dvec3(both(random), both(random), both(random));
            const double at = glm::dot(normal, p);
            if (at < low || at > high) continue;
            ASSERT_GE(hull.size(), 3U);
            EXPECT_LT(outside({p.x + 0.3 * p.z, p.y - 0.2 * p.z}), 1e-12);
        }
    }
    EXPECT_TRUE(gl::slab_corners(box, {1, 0, 0}, 2, 3).empty());
    EXPECT_EQ(gl::convex_hull({{0, 0}, {1, 1}, {2, 2}, {1, 1}}).size(), 2U);
    EXPECT_EQ(gl::convex_hull({{0, 0}, {2, 0}, {1, 0}, {2, 2}, {0, 2}, {1, 1}}).size(), 4U);
}

// ---- Light ----

Camera camera_inside() {
    Camera camera;
    camera.eye = {0.4, 0.3, 0.6};
    camera.center = {0.9, 0.7, 0.2};
    camera.fov_y_degrees = 100;
    return camera;
}

const std::vector<Camera>& cameras() {
    static const std::vector<Camera> all{testing_support::view_of_unit_cube(Projection::parallel),
                                         testing_support::view_of_unit_cube(Projection::perspective),
                                         testing_support::view_of_unit_cube(Projection::parallel, {0, -1, 0}),
                                         testing_support::view_of_unit_cube(Projection::perspective, {1, 1, 0.01}), camera_inside()};
    return all;
}

TEST(GlSlabs, AConstantMediumHasNoSlices) {
    const GridScene scene = scene_of(unit_cube(5, testing_support::linear), testing_support::constant_medium(2));
    for (const Camera& camera : cameras()) {
        const auto truths = truths_of(scene, camera, small);
        for (const char* sampling : {"object:1", "object:7", "view:9", "object:40:x4", "view:37:x3:post", "object:12:pre", "view:64:x16"}) {
            // Rounding of places on up to 64 slices.
            EXPECT_LT(errors_of(draw(scene, camera, small, sampling), truths).largest, 2e-5) << sampling;
        }
    }
}

// Between two slices a linear field is linear: any number of them is exact.
TEST(GlSlabs, ALinearFieldIsExact) {
    const GridScene scene = scene_of(unit_cube(5, testing_support::linear), testing_support::ramp());
    for (const Camera& camera : cameras()) {
        const auto truths = truths_of(scene, camera, small);
        for (const char* sampling : {"object:3", "view:5", "object:40:x4", "view:37:x3"})
            EXPECT_LT(errors_of(draw(scene, camera, small, sampling), truths).largest, 2e-5) << sampling;
    }
}

// RS00: several slices a polygon are the same as one after the other, within rounding.
TEST(GlSlabs, SeveralAPolygonAreTheSame) {
    const auto field = [](const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(7 * p.x) * std::cos(5 * p.y + 4 * p.z); };
    const GridScene scene = scene_of(unit_cube(12, field), testing_support::ramp());
    for (const Camera& camera : cameras()) {
        for (const std::string sampling : {"object:24", "view:33", "object:24:post", "view:24:pre"}) {
            const Image single = draw(scene, camera, small, sampling);
            for (const char* several : {":x2", ":x5"}) {
                // float32, one rounding a slab.
                EXPECT_LT(testing_support::max_difference(single, draw(scene, camera, small, sampling + several)), 4e-6) << sampling << several;
            }
        }
    }
}

// EKE01 Fig. 9 and 10 in numbers (all of them: cellproj_grid_templates).
TEST(GlSlabs, FifteenPreintegratedSlabsBeatSixtyPostShadedOnes) {
    const GridScene scene = testing_support::with_random_transfer(testing_support::spherical_harmonic(16), 65, 1.5, 512);
    const ImageSize size = CELLPROJ_SANITIZED ? small : ImageSize{61, 59};
    const Camera camera = frame_bounds(scene.grid->bounds(), Projection::parallel, {0.2, -1, 0.1}, {0, 0, 1}, 1.0);
    const auto truths = truths_of(scene, camera, size);
    const auto rms = [&](const std::string& sampling, const std::string& method = "integral") {
        return errors_of(draw(scene, camera, size, sampling, method), truths).rms;
    };
    const double post = rms("object:15:post"), post4 = rms("object:60:post");
    for (const char* method : {"integral", "preint2d:256", "preint2d-exp:256"}) EXPECT_LT(rms("object:15", method), 0.6 * post4) << method;
    EXPECT_LT(post4, 0.5 * post);
    EXPECT_LT(rms("object:240:post"), 0.5 * post4);
    EXPECT_GT(rms("object:15:pre"), 0.5 * post);  // more slices would not help
    EXPECT_GT(rms("object:240:pre"), 0.5 * post);
}

TEST(GlSlabs, RefuseWhatSlicesCannotShow) {
    const Camera camera = cameras()[0];
    const auto linear = testing_support::linear;
    const auto refused = [&](const Grid& grid, const std::string& method = "integral") {
        EXPECT_NO_THROW(draw(scene_of(grid, testing_support::ramp()), camera, {8, 8}, "cells", method));
        EXPECT_THROW(draw(scene_of(grid, testing_support::ramp()), camera, {8, 8}, "view:8", method), Error);
    };
    Grid rectilinear = unit_cube(4, linear), blanked = unit_cube(4, linear), on_cells = unit_cube(4, linear);
    rectilinear.axes[1].spacing.reset();
    blanked.blanked.assign(64, 0);
    blanked.blanked[5] = 1;
    on_cells.location = FieldLocation::cells;
    on_cells.values.resize(64);
    refused(rectilinear);
    refused(blanked);
    refused(on_cells);
    refused(unit_cube(4, linear), "homogeneous:vertices");
    EXPECT_THROW(require_grid_drawn(Backend::cpu, {.sampling = parse_grid_sampling("object:8")}, {}), Error);
}

// Tables are those of the slabs at hand.
TEST(GlSlabs, SeeEveryChangeOfTheSampling) {
    const GridScene scene = scene_of(unit_cube(8, testing_support::linear), testing_support::ramp());
    for (const char* sampling : {"object:8", "view:31", "cells", "object:8:pre", "object:8"}) {
        const Image image = draw(scene, cameras()[0], {31, 29}, sampling, "preint2d:64");
        const Image fresh = make_grid_renderer(Backend::gl_osmesa)
                                ->render(scene, cameras()[0], {31, 29}, {.method = parse_method("preint2d:64"), .sampling = parse_grid_sampling(sampling)});
        EXPECT_EQ(testing_support::max_difference(image, fresh), 0) << sampling;
    }
}

}  // namespace
}  // namespace cellproj
