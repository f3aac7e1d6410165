// SPDX-License-Identifier: BSD-3-Clause
//
// Media of regular grids that are lit by their gradient, in OpenGL: cells and slabs against the judge and the unlit picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/grid_renderer.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/lit_grids.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace gl_grid_medium_light_test {

using namespace testing_support;
using scenes::waves;
using Projection = Camera::Projection;

constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{20, 16} : ImageSize{48, 40}, few{20, 16};

GridRenderer& gl() {
    static const auto one = make_grid_renderer(Backend::gl_osmesa);
    return *one;
}

GridQuality by(const std::string& sampling, const std::string& method = "integral") {
    return {.method = parse_method(method), .sampling = parse_grid_sampling(sampling)};
}

double error_of(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality = {}, double tolerance = 2e-5) {
    return error_against_judge(gl().render(scene, camera, size, quality), scene, camera, tolerance);
}

Camera camera_inside() {
    Camera inside = view_of_unit_cube(Projection::perspective);
    inside.eye = {0.31, 0.42, 0.53};
    inside.center = {0.9, 0.8, 0.6};
    inside.fov_y_degrees = 70;
    return inside;
}

// Trilinear in the whole unit cube: the gradient has no jumps on any grid.
double trilinear(const glm::dvec3& p) { return (1 + p.x) * (1 + p.y) * (1 + p.z) / 8; }

class GlGridMediumLight : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Projections, GlGridMediumLight, either_projection, name_of_projection);

// ---- Cells

// Homogeneous media are exact in the stated model; what is left is float32. Noise, even and uneven axes, blanked cells, surfaces in the medium.
TEST_P(GlGridMediumLight, CellsAgreeWithTheJudge) {
    std::mt19937_64 random(611);
    double most[2]{};
    for (int trial = 0; trial < (sanitized ? 8 : 12); ++trial) {
        const auto [scene, camera, surfaces] = lit_noise(trial, GetParam(), random);
        // Of surfaces' normals, and rays that graze surfaces: grid_surfaces_test.
        const double bound = surfaces ? 2e-4 : 2e-5, error = error_of(scene, camera, few, {}, bound);
        EXPECT_LT(error, bound) << trial;
        most[surfaces ? 1 : 0] = std::max(most[surfaces ? 1 : 0], error);
    }
    std::printf("[ MEASURED ] noise, homogeneous: %.1e; with surfaces %.1e\n", most[0], most[1]);
}

TEST_P(GlGridMediumLight, CellsAgreeByEveryMethod) {
    const Camera camera = view_of_unit_cube(GetParam());
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.1, 0.2, 0.4}}}, {{0, 0}});
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        for (const char* method : {"integral", "linear:8", "homogeneous", "preint2d-exp:256", "preint3d:64"}) {
            const GridScene scene = lit(unit_cube(6, waves), constant_medium(2), shading, two_lights, glass);
            const double bound = method == std::string("preint3d:64") ? 2e-3 : 2e-4;  // its steps in depth
            EXPECT_LT(error_of(scene, camera, few, by("cells", method), bound), bound) << method;
        }
        EXPECT_LT(error_of(lit(unit_cube(6, waves), glow, shading), camera, few), 2e-5);
    }
}

// Where colour and extinction change in a cell, the place of its light is that of a homogeneous one: second order in its size.
TEST_P(GlGridMediumLight, CellsOfARampErrBySecondOrder) {
    const Camera camera = view_of_unit_cube(GetParam());
    std::vector<double> rms;
    for (const std::size_t n : {4U, 8U, 16U}) {
        const GridScene scene = lit(unit_cube(n, waves), ramp(), Shading::smooth);
        const ImageError error = compare(gl().render(scene, camera, small), judge(scene).pixels(camera, small, all_pixels(small)));
        std::printf("[ MEASURED ] ramp, %zu³ cells: rms %.1e, largest %.1e\n", n, error.color.rms, error.color.maximum);
        rms.push_back(error.color.rms);
    }
    EXPECT_LT(rms[1], rms[0] / 2.5);
    EXPECT_LT(rms[2], rms[1] / 2.5);
}

// Of rays that begin or end in cells, shares are those of the gradients there: those of the part that is left, whose cells end there.
TEST_P(GlGridMediumLight, CellsGoOnThroughCuts) {
    const Camera camera = view_of_unit_cube(GetParam());
    const GridAxis whole = uniform_axis(0, 0.2, 6);
    GridAxis rest;
    rest.coordinates = {0.27, 0.4, 0.6, 0.8, 1};
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        GridScene scene = lit(grid_of({whole, whole, whole}, trilinear), constant_medium(2), shading, two_lights, glass);
        scene.clip = std::make_shared<ClipRegion>(ClipRegion{.half_spaces = {{.point = {0.27, 0, 0}, .normal = {1, 0, 0}}}});
        const GridReference part = judge(lit(grid_of({rest, whole, whole}, trilinear), constant_medium(2), shading, two_lights, glass));
        // float32 places on surfaces, as above.
        EXPECT_LT(largest(compare(gl().render(scene, camera, small), part.pixels(camera, small, all_pixels(small), 1e-3))), 2e-4);
        EXPECT_LT(error_of(lit(unit_cube(5, waves), constant_medium(2), shading), camera_inside(), few), 2e-5);
    }
}

// ---- Slabs

const std::vector<const char*> slabs{"object:7", "view:9", "object:24:x4", "view:13:x3", "object:9:post", "view:12:pre:x2"};

// One gradient everywhere: the unlit picture times what the lights make of it in each pixel's direction, in any number of slabs.
TEST_P(GlGridMediumLight, SlabsOfALinearFieldAreTheUnlitPictureTimesAShare) {
    for (const Camera& camera : {view_of_unit_cube(GetParam()), view_of_unit_cube(GetParam(), {0, -1, 0}), camera_inside()}) {
        const ScreenTransform transform(camera, few);
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            const GridScene scene = lit(unit_cube(5, linear), ramp(), shading);
            for (const char* sampling : slabs) {
                const Image found = gl().render(scene, camera, few, by(sampling)), plain = gl().render({scene.grid, scene.transfer}, camera, few, by(sampling));
                for (int y = 0; y < few.height; ++y) {
                    for (int x = 0; x < few.width; ++x) {
                        const ScreenTransform::Ray ray = transform.ray({x + 0.5, y + 0.5});
                        const glm::dvec4 share(lit_share(two_lights, glm::dvec3(1, 0.5, 0.25) / (1.75 * weak_gradient) * (std::sqrt(3.0) / 2), -ray.direction), 1);
                        // A gradient of float32 differences across a fifth of the cube: 1e-6 of it, through a power of 20.
                        ASSERT_LT(max_difference(glm::dvec4(found.at(x, y)), share * glm::dvec4(plain.at(x, y))), 3e-5) << sampling;
                    }
                }
            }
        }
    }
}

// Shares are linear between slices: second order in the thickness of slabs, towards the judge, whose cells are thinner than any of these
// slabs. Eye and lights where all gradients point to: nothing turns its other side, or into shadow.
TEST_P(GlGridMediumLight, SlabsConvergeWithTheirNumber) {
    const Lighting facing{.ambient = {0.1, 0.2, 0.05}, .lights = {{.towards = glm::dvec3(1, 2, 2), .color = {1, 0.8, 0.6}}, {.diffuse = 0.3, .specular = 0.5}}};
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, 2.1, 0.9});
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const GridScene scene = lit(unit_cube(64, trilinear), constant_medium(2), shading, facing);
        const auto truths = judge(scene).pixels(camera, few, all_pixels(few));
        for (const std::string cut : {"object:", "view:"}) {
            std::vector<double> errors;
            for (const char* count : {"4", "8", "16"}) {
                errors.push_back(largest(compare(gl().render(scene, camera, few, by(cut + count)), truths)));
                std::printf("[ MEASURED ] %s%s: %.1e\n", cut.c_str(), count, errors.back());
            }
            EXPECT_LT(errors[2], errors[0] / 8);  // 16 in the limit
        }
    }
}

// Mixed with isosurfaces in one pass, each with its light.
TEST_P(GlGridMediumLight, SlabsWithSurfacesAgreeWithTheJudge) {
    for (const Shading shading : {Shading::flat, Shading::smooth}) {
        const GridScene scene = lit(unit_cube(5, linear), constant_medium(2), shading, two_lights, glass);
        for (const char* sampling : {"object:7", "view:9", "object:24:x4"}) {
            for (const Camera& camera : {view_of_unit_cube(GetParam()), camera_inside()}) EXPECT_LT(error_of(scene, camera, few, by(sampling), 1e-4), 1e-4) << sampling;
        }
    }
}

// In slabs far thinner than cells shares are those of every place: as in cells far smaller, which hold the same trilinear scalar.
TEST_P(GlGridMediumLight, ThinSlabsAreLitAtEveryPlace) {
    std::mt19937_64 random(612);
    std::uniform_real_distribution<double> unit(0, 1);
    const Grid noise = unit_cube(3, [&](const glm::dvec3&) { return unit(random); });
    const Grid refined = unit_cube(48, [&](const glm::dvec3& p) {
        const glm::dvec3 at = glm::min(3.0 * p, 3.0 - 1e-12), low = glm::floor(at), u = at - low;
        const auto c = noise.corner_values({static_cast<std::size_t>(low.x), static_cast<std::size_t>(low.y), static_cast<std::size_t>(low.z)});
        const auto along_x = [&](std::size_t i) { return glm::mix(c[i], c[i + 1], u.x); };
        return glm::mix(glm::mix(along_x(0), along_x(2), u.y), glm::mix(along_x(4), along_x(6), u.y), u.z);
    });
    const Camera camera = view_of_unit_cube(GetParam());
    const auto truths = judge(lit(refined, constant_medium(2), Shading::flat)).pixels(camera, few, all_pixels(few));
    std::vector<double> rms;
    for (const char* sampling : {"object:12", "object:48", "object:192:x4"}) {
        rms.push_back(compare(gl().render(lit(noise, constant_medium(2), Shading::flat), camera, few, by(sampling)), truths).color.rms);
        std::printf("[ MEASURED ] noise of 3³ cells, %s: rms %.1e\n", sampling, rms.back());
    }
    EXPECT_LT(rms[1], rms[0] / 2);  // where gradients jump, in proportion to the thickness
    EXPECT_LT(rms[2], 2e-3);
}

// ---- All

// The side of higher scalars is lit like that of lower ones, or by ambient light alone.
TEST_P(GlGridMediumLight, HasTwoSidesOrOne) {
    const Camera from_low = view_of_unit_cube(GetParam(), {-5, -2, -1});
    const auto reversed = [](const glm::dvec3& p) { return 1 - linear(p); };
    for (const char* sampling : {"cells", "object:8", "view:8"}) {
        Lighting lighting;  // a headlight
        lighting.ambient = glm::dvec3(0.1, 0.2, 0.3);
        const auto picture = [&](const auto& field) { return gl().render(lit(unit_cube(4, field), constant_medium(2), Shading::flat, lighting), from_low, few, by(sampling)); };
        EXPECT_LT(max_difference(picture(linear), picture(reversed)), 1e-5);
        lighting.two_sided = false;
        const glm::vec4 center = picture(reversed).at(few.width / 2, few.height / 2);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(center[k], center.a * glm::dvec3(1, 0.5, 0.25)[k] * lighting.ambient[k], 1e-5);
    }
}

TEST(GlGridMediumLightOfAny, ExtremesStayFinite) {
    std::mt19937_64 random(613);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < (sanitized ? 18 : 48); ++trial) {
        const double range = std::pow(10, 20 * unit(random));
        std::array<GridAxis, 3> axes;
        for (GridAxis& axis : axes) axis = uniform_axis(1e6 * (trial % 2), std::pow(10, 3 * unit(random)), 2 + random() % 9);
        const bool cells = trial % 3 != 1;
        if (cells && trial % 4 == 0) axes[0].coordinates.back() += 1e6, axes[0].spacing.reset();
        if (cells && trial % 6 == 2) axes[1].coordinates = {0, 1e-12, 1e-3, 1, 2}, axes[1].spacing.reset();
        if (cells && trial % 12 == 8) axes[2].coordinates = {0, 1e-41, 1}, axes[2].spacing.reset();
        const Grid grid = grid_of(axes, [&](const glm::dvec3&) { return trial % 7 == 0 ? range : range * std::round(2 * unit(random)) / 2; });
        const Camera camera = frame_bounds(grid.bounds(), trial % 2 == 0 ? Projection::parallel : Projection::perspective,
                                           {unit(random), unit(random), trial % 5 == 0 ? 0 : unit(random)}, {0.1, 0.1, 1}, 1.2);
        const GridScene scene = lit(grid, constant_medium(1 / grid.bounds().diagonal()), trial / 3 % 2 == 0 ? Shading::smooth : Shading::flat);
        const GridQuality quality = by(cells ? "cells" : trial % 2 == 0 ? "object:12:x3" : "view:17");
        const Image image = gl().render(scene, camera, few, quality), plain = gl().render({scene.grid, scene.transfer}, camera, few, quality);
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(image.pixels[i][k]) && image.pixels[i][k] >= 0 && image.pixels[i][k] <= 2) << trial;
            ASSERT_NEAR(image.pixels[i].a, plain.pixels[i].a, 1e-5) << trial;
            if (trial % 7 == 0) {  // no gradient
                ASSERT_NEAR(image.pixels[i].r, plain.pixels[i].r, 1e-5) << trial;
            }
        }
    }
}

// From scene to scene in one renderer: with light and without, of a function that shows nothing, of another grid.
TEST(GlGridMediumLightOfAny, ComesAndGoes) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    for (const char* sampling : {"cells", "object:9", "view:9:pre"}) {
        const bool surfaces = by(sampling).sampling.light == GridSampling::Light::segment;
        GridScene scene = lit(unit_cube(8, waves), ramp(), Shading::flat);
        const auto same = [&] {
            const Image fresh = make_grid_renderer(Backend::gl_osmesa)->render(scene, camera, few, by(sampling));
            EXPECT_EQ(max_difference(gl().render(scene, camera, few, by(sampling)), fresh), 0);
            return fresh;
        };
        const Image flat = same();
        scene.surfaces = nullptr;
        const Image plain = same();
        EXPECT_GT(max_difference(flat, plain), 0.05);
        for (const Shading shading : {Shading::smooth, Shading::unlit, Shading::smooth}) {
            scene.surfaces = lit_by(two_lights, shading);
            EXPECT_EQ(max_difference(same(), plain) < 1e-5, shading == Shading::unlit);
        }
        scene.transfer = std::make_shared<const TransferFunction>(nothing());
        EXPECT_EQ(max_difference(same(), Image(few.width, few.height)), 0);
        if (surfaces) scene.surfaces = lit_by(two_lights, Shading::smooth, glass);
        same();
        scene.transfer = std::make_shared<const TransferFunction>(ramp());
        scene.grid = std::make_shared<const Grid>(unit_cube(7, linear));
        same();
    }
}

// Opaque media are drawn front to back: what lies behind is left out, whatever light falls on it.
TEST_P(GlGridMediumLight, IsTheSameFrontToBack) {
    const auto back_to_front = make_grid_renderer(Backend::gl_osmesa, {.rules = {.front_to_back = false}});
    const GridScene scene = lit(unit_cube(12, waves), with_scaled_extinction(ramp(), 40), Shading::smooth);
    for (const char* sampling : {"cells", "object:30", "view:33:x4"})  // 1e-4 is cut
        EXPECT_LT(max_difference(gl().render(scene, view_of_unit_cube(GetParam()), small, by(sampling)), back_to_front->render(scene, view_of_unit_cube(GetParam()), small, by(sampling))), 1.03e-4);
}

TEST(GlGridMediumLightOfAny, WhatCannotBeLitIsRefused) {
    const Camera camera = view_of_unit_cube(Projection::parallel);
    const GridScene scene = lit(unit_cube(3, waves), ramp(), Shading::flat);
    EXPECT_NO_THROW(gl().render(scene, camera, few));
    for (const char* method : {"homogeneous:vertices", "average:half"}) {
        try {
            gl().render(scene, camera, few, by("cells", method));
            ADD_FAILURE() << method;
        } catch (const Error& error) {
            for (const char* words : {"lit media", method}) EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(gl().render(scene, camera, few, by("object:9", "average:half")), Error);
    Grid cells = unit_cube(3, waves);
    cells.location = FieldLocation::cells;
    cells.values.resize(cells.cell_count());
    EXPECT_THROW(gl().render(lit(cells, ramp(), Shading::flat), camera, few), Error);
    EXPECT_NO_THROW(gl().render(lit(cells, ramp(), Shading::unlit), camera, few));
    EXPECT_NO_THROW(gl().render(scene, camera, few));
}

}  // namespace gl_grid_medium_light_test
}  // namespace cellproj
