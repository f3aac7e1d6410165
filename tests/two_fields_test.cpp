// SPDX-License-Identifier: BSD-3-Clause
//
// Colour over one field, extinction over another: closed forms, the float64 judge, and what must not change where both are one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "mesh/error.hpp"
#include "render/prepared_scene.hpp"
#include "render/judge/ray_light.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace two_fields_test {

using testing_support::chord_in_unit_cube;
using testing_support::distance;
using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::max_difference;
using testing_support::point_field;
using testing_support::view_of_unit_cube;

constexpr int side = CELLPROJ_SANITIZED ? 32 : 64;
constexpr ImageSize small{side, side};
constexpr std::array projections{Camera::Projection::parallel, Camera::Projection::perspective};

Renderer& renderer() {
    static const auto shared = make_renderer(Backend::gl_osmesa);
    return *shared;
}

// Grows across the first one, over 10 .. 30.
double other(const glm::dvec3& p) { return 10.0 + 20.0 * (0.2 * (1.0 - p.x) + 0.3 * p.y + 0.5 * (1.0 - p.z)); }

// Colours over 0..1, extinction over 10..30, both with nodes inside; a step of the extinction.
TransferFunction over_two(OpticalModel model = OpticalModel::density) {
    return {model,
            {{0, {0.1, 0.2, 0.9}}, {0.4, {0.1, 1.0, 0.2}}, {0.45, {0.9, 0.2, 0.1}}, {1, {1.0, 0.6, 0.0}}},
            {{10, 0.2}, {16, 4.0}, {16, 1.0}, {21, 0.0}, {24, 6.0}, {30, 2.0}}};
}

Scene scene_of_two(TetMesh mesh, TransferFunction transfer, const std::function<double(const glm::dvec3&)>& color = linear,
                   const std::function<double(const glm::dvec3&)>& opacity = other) {
    auto field = std::make_shared<ScalarField>(point_field(mesh, color));
    auto opacity_field = std::make_shared<ScalarField>(point_field(mesh, opacity));
    return {.mesh = std::make_shared<TetMesh>(std::move(mesh)),
            .field = std::move(field),
            .transfer = std::make_shared<TransferFunction>(std::move(transfer)),
            .opacity_field = std::move(opacity_field)};
}

// ---- The judge.

// Extinction τ everywhere, colour from a to b over the length L: C = a(1 − e^(−τL)) + (b − a)((1 − e^(−τL))/τL − e^(−τL)).
Light ramp_in_a_constant_medium(const glm::dvec3& a, const glm::dvec3& b, double depth) {
    const double opacity = -std::expm1(-depth);
    return {a * opacity + (b - a) * (opacity / depth - std::exp(-depth)), opacity};
}

TEST(TwoFieldLight, ARampOfColourInAConstantMedium) {
    const glm::dvec3 blue(0, 0.2, 1), red(1, 0.4, 0);
    const TransferFunction transfer(OpticalModel::density, {{0, blue}, {1, red}}, {{10, 0}, {20, 6}});
    for (const double s : {11.0, 15.0, 20.0, 99.0}) {
        RayLight light(transfer);
        light.add(std::array{ScalarEnds{0, 0.75}}, std::array{ScalarEnds{s, s}}, 0.6);
        light.add(std::array{ScalarEnds{0.75, 1}}, std::array{ScalarEnds{s, s}}, 0.2);
        EXPECT_LT(distance(light.light(), ramp_in_a_constant_medium(blue, red, 0.8 * transfer.extinction(s))), 1e-13) << s;
    }
}

// τ from t₀ to t₁ over 0..1, one colour: opacity 1 − e^(−(t₀ + t₁)L/2), colour in proportion, whatever the colour field does where
// the colour is constant. And a Riemann sum where nothing is.
TEST(TwoFieldLight, LinearFieldsAgainstTheDefinition) {
    for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
        const TransferFunction transfer = over_two(model);
        for (const auto& [color, opacity] : {std::pair(ScalarEnds{0.1, 0.9}, ScalarEnds{29, 11}),
                                             std::pair(ScalarEnds{0.9, 0.2}, ScalarEnds{12, 26}),
                                             std::pair(ScalarEnds{0.4, 0.4}, ScalarEnds{16, 16})}) {
            RayLight light(transfer);
            light.add(std::array{color}, std::array{opacity}, 1.3);
            Light sum;
            double depth = 0;
            constexpr int steps = 200000;
            for (int i = 0; i < steps; ++i) {
                const double t = (i + 0.5) / steps, tau = transfer.extinction(std::lerp(opacity.front, opacity.back, t));
                const glm::dvec3 c = transfer.color(std::lerp(color.front, color.back, t));
                const double dx = 1.3 / steps;
                sum.color += (model == OpticalModel::density ? tau : 1.0) * dx * std::exp(-depth - 0.5 * tau * dx) * c;
                depth += tau * dx;
            }
            sum.opacity = -std::expm1(-depth);
            EXPECT_LT(distance(light.light(), sum), 3e-5);  // the step of the extinction, dx·Δτ at most
        }
    }
}

TEST(TwoFieldLight, TheSameFieldTwiceIsOneField) {
    const Scene one = testing_support::scene_of(grid_mesh(5, 0.2, 4), linear, testing_support::ramp());
    Scene two = one;
    two.opacity_field = one.field;
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const auto a = Reference(one).picture(camera, small), b = Reference(two).picture(camera, small);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_LT(distance(a[i].light, b[i].light), 1e-12);
}

TEST(TwoFieldReference, ARampOfColourInABoxOfConstantMedium) {
    const glm::dvec3 blue(0, 0.2, 1), red(1, 0.4, 0);
    const Scene scene =
        scene_of_two(grid_mesh(4, 0.2, 3), {OpticalModel::density, {{0, blue}, {1, red}}, {{10, 0}, {20, 6}}}, linear,
                     [](const glm::dvec3&) { return 15.0; });
    for (const auto projection : projections) {
        const Camera camera = view_of_unit_cube(projection);
        const ScreenTransform transform(camera, small);
        for (const PixelTruth& truth : Reference(scene).picture(camera, small)) {
            const auto ray = transform.ray({truth.pixel.x + 0.5, truth.pixel.y + 0.5});
            const auto chord = chord_in_unit_cube(ray, transform.perspective());
            if (chord.length() <= 0) continue;
            const auto color = [&](double t) { return glm::mix(blue, red, linear(ray.origin + t * ray.direction)); };
            EXPECT_LT(distance(truth.light, ramp_in_a_constant_medium(color(chord.enter), color(chord.leave), 3 * chord.length())),
                      1e-9);
        }
    }
}

// ---- Pictures.

double error_of(const Scene& scene, const Camera& camera, const char* method) {
    const Image image = renderer().render(scene, camera, small, {.method = parse_method(method)});
    return largest(compare(image, Reference(scene).picture(camera, small, rasterizer_slack)));
}

TEST(TwoFieldPicture, TheJudgeAgrees) {
    for (const auto projection : projections) {
        const Camera camera = view_of_unit_cube(projection);
        for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
            const Scene scene = scene_of_two(grid_mesh(6, 0.2, 5), over_two(model));
            // float32 terms of some 20 cells a ray; integral: up to 2e-4 a segment of depth near 1 a piece.
            EXPECT_LT(error_of(scene, camera, "exact:1e-5"), 1e-4);
            EXPECT_LT(error_of(scene, camera, "integral"), 5e-4);
            // The step of the extinction by 3 lies anywhere in a step of 1/64 of a cell's 0.3.
            EXPECT_LT(error_of(scene, camera, "linear:64"), 1e-2);
        }
    }
}

// Where both fields are linear in a cell without nodes between, the old methods converge with the cells.
TEST(TwoFieldPicture, OldMethodsConverge) {
    const TransferFunction smooth(OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1, 0.6, 0}}}, {{10, 0.5}, {30, 4}});
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    for (const char* method : {"average", "homogeneous", "linear:2", "stein"}) {
        const double coarse = error_of(scene_of_two(grid_mesh(4), smooth), camera, method);
        const double fine = error_of(scene_of_two(grid_mesh(12), smooth), camera, method);
        EXPECT_LT(fine, 0.5 * coarse) << method;
        EXPECT_LT(fine, std::string(method) == "average" ? 0.1 : 2e-3) << method;
    }
}

TEST(TwoFieldPicture, TheSameFieldTwiceIsOneField) {
    const Scene one = testing_support::scene_of(grid_mesh(5, 0.2, 4), linear, testing_support::ramp());
    Scene two = one;
    two.opacity_field = one.field;
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    for (const char* method : {"integral", "exact:1e-6", "linear:16", "homogeneous", "stein", "average", "average:half"}) {
        const Quality quality{.method = parse_method(method)};
        // Samples of emission or of chromaticity: κτ between two of 4096 is off by h²/8 · slopes, 1e-7.
        EXPECT_LT(max_difference(renderer().render(one, camera, small, quality), renderer().render(two, camera, small, quality)),
                  2e-5)
            << method;
    }
}

TEST(TwoFieldPicture, ACameraInsideAndFieldsOnCells) {
    Scene scene = scene_of_two(grid_mesh(4, 0.2, 5), over_two());
    Camera inside = view_of_unit_cube(Camera::Projection::perspective);
    inside.eye = {0.52, 0.47, 0.55};
    inside.center = {0.97, 0.9, 0.8};
    EXPECT_LT(error_of(scene, inside, "exact:1e-5"), 2e-4);

    ScalarField constant{"constant", FieldLocation::cells, {}};
    for (std::size_t cell = 0; cell < scene.mesh->tets.size(); ++cell) constant.values.push_back(10.0 + 0.05 * static_cast<double>(cell % 400));
    scene.opacity_field = std::make_shared<ScalarField>(constant);
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    EXPECT_LT(error_of(scene, camera, "exact:1e-5"), 1e-4);
    std::swap(scene.field, scene.opacity_field);
    scene.transfer = std::make_shared<TransferFunction>(
        OpticalModel::density, std::vector<ColorNode>{{10, {0, 0, 1}}, {30, {1, 1, 0}}}, std::vector<ExtinctionNode>{{0, 0}, {1, 5}});
    EXPECT_LT(error_of(scene, camera, "exact:1e-5"), 1e-4);
}

// Only what can be seen over the ranges of both fields is drawn, and another function finds it anew.
TEST(TwoFieldPicture, CellsAreCulledByBothFields) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    Scene scene = scene_of_two(grid_mesh(8), {OpticalModel::density, {{0, {1, 1, 1}}}, {{20, 0}, {25, 5}, {30, 5}}});
    Statistics statistics;
    const Image image = renderer().render(scene, camera, small, {.method = parse_method("exact:1e-5")}, &statistics);
    EXPECT_LT(largest(compare(image, Reference(scene).picture(camera, small, rasterizer_slack))), 1e-4);
    EXPECT_GT(statistics.counts.culled, statistics.counts.cells / 4);

    // An emitter that shines over the first field where nothing absorbs.
    scene.transfer = std::make_shared<TransferFunction>(OpticalModel::emitter, std::vector<ColorNode>{{0.7, {0, 0, 0}}, {1, {2, 1, 0}}},
                                                        std::vector<ExtinctionNode>{{25, 0}, {30, 5}});
    EXPECT_LT(error_of(scene, camera, "exact:1e-5"), 1e-4);
    const PreparedScene prepared(scene);
    const auto seen = std::count(prepared.visible().begin(), prepared.visible().end(), std::uint8_t{1});
    EXPECT_GT(seen, 0);
    EXPECT_LT(static_cast<std::size_t>(seen), scene.mesh->tets.size());
    for (std::size_t cell = 0; cell < prepared.visible().size(); ++cell) {
        double bright = -1e9, dense = -1e9;
        for (int corner = 0; corner < 4; ++corner) {
            bright = std::max(bright, scene.field->at(*scene.mesh, static_cast<CellId>(cell), corner));
            dense = std::max(dense, scene.opacity_field->at(*scene.mesh, static_cast<CellId>(cell), corner));
        }
        ASSERT_EQ(prepared.visible()[cell] != 0, bright > 0.7 || dense > 25) << cell;
    }
}

TEST(TwoFieldPicture, CellsWithValuesThatAreNotFiniteAreLeftOut) {
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    const Scene whole = scene_of_two(grid_mesh(4), over_two());
    for (const bool in_color : {true, false}) {
        Scene scene = whole;
        ScalarField broken = in_color ? *scene.field : *scene.opacity_field;
        broken.values[31] = std::numeric_limits<double>::quiet_NaN();
        broken.values[62] = std::numeric_limits<double>::infinity();
        (in_color ? scene.field : scene.opacity_field) = std::make_shared<ScalarField>(broken);
        EXPECT_LT(error_of(scene, camera, "exact:1e-5"), 1e-4) << in_color;
        EXPECT_GT(max_difference(renderer().render(scene, camera, small), renderer().render(whole, camera, small)), 0.01);
    }
}

TEST(TwoFieldPicture, ExtremesStayFiniteAndPhysical) {
    const double half = 0.5, next = std::nextafter(0.5, 1.0), after = std::nextafter(next, 1.0);
    const std::vector<ColorNode> colors{{0, {0, 0, 1}}, {half, {1, 0, 0}}, {half, {0, 1, 0}}, {1, {1, 0.5, 0}}};
    std::vector<ExtinctionNode> saw;
    for (int i = 0; i < 3000; ++i) saw.push_back({i / 2999.0, i % 2 == 0 ? 0.0 : 50.0});
    const auto constant = [](const glm::dvec3&) { return 0.5; };
    for (const TransferFunction& f : {
             TransferFunction(OpticalModel::density, colors, {{0, 0}, {1, 1e8}}),
             TransferFunction(OpticalModel::density, colors, {{0, 0}, {half, 0}, {next, 1e6}, {after, 0}, {1, 0}}),
             TransferFunction(OpticalModel::density, colors, saw),
             TransferFunction(OpticalModel::emitter, {{0, {1e6, 0, 0}}, {1, {0, 0, 1e6}}}, {{0, 0}, {0.5, 1e-30}, {1, 1e6}}),
             TransferFunction(OpticalModel::emitter, colors, {{0.5, 3}}, Outside::transparent),
         })
        for (const auto& opacity : {std::function<double(const glm::dvec3&)>(linear), std::function<double(const glm::dvec3&)>(constant)})
            for (const char* method : {"integral", "exact:1e-5", "linear:9", "homogeneous", "stein", "average"}) {
                const Scene scene = scene_of_two(grid_mesh(2), f, constant, opacity);
                const Image image = renderer().render(scene, view_of_unit_cube(Camera::Projection::perspective), {32, 32},
                                                      {.method = parse_method(method)});
                for (const auto& pixel : image.pixels) {
                    ASSERT_TRUE(pixel.a >= 0.0F && pixel.a <= 1.0F) << method << " " << pixel.a;
                    for (int c = 0; c < 3; ++c) ASSERT_TRUE(pixel[c] >= 0.0F && std::isfinite(pixel[c])) << method;
                }
            }
}

TEST(TwoFieldPicture, AnotherFunctionOrFieldReachesTheNextPicture) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    Scene scene = scene_of_two(grid_mesh(3), over_two());
    for (const char* method : {"integral", "homogeneous"}) {
        const Quality quality{.method = parse_method(method)};
        const auto shared = make_renderer(Backend::gl_osmesa);
        const auto before = shared->render(scene, camera, small, quality).pixels;
        Scene changed = scene;
        changed.transfer = std::make_shared<TransferFunction>(over_two(OpticalModel::emitter));
        Scene one_field = scene;
        one_field.opacity_field = nullptr;
        for (const Scene& next : {changed, one_field, scene}) {
            const auto picture = shared->render(next, camera, small, quality).pixels;
            EXPECT_EQ(picture, make_renderer(Backend::gl_osmesa)->render(next, camera, small, quality).pixels);
            EXPECT_EQ(picture == before, next.transfer == scene.transfer && next.opacity_field == scene.opacity_field);
        }
    }
}

TEST(TwoFieldPicture, TablesAndVerticesAreRefused) {
    const Scene scene = scene_of_two(grid_mesh(1), over_two());
    for (const char* method : {"preint2d:32", "preint2d-exp:32", "preint3d:16", "shirley-tuchman", "homogeneous:vertices"}) {
        try {
            renderer().prepare(scene, {.method = parse_method(method)});
            ADD_FAILURE() << method;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::option);
            EXPECT_NE(std::string(error.what()).find("another field"), std::string::npos) << error.what();
        }
    }
    EXPECT_THROW(make_renderer(Backend::cpu)->prepare(scene), Error);
    EXPECT_FALSE(draws(Backend::cpu, {}, FieldsRead::two));
    EXPECT_TRUE(draws(Backend::gl_osmesa, {}, FieldsRead::two));
    Scene unfit = scene;
    unfit.opacity_field = std::make_shared<ScalarField>(ScalarField{"short", FieldLocation::points, {1, 2}});
    EXPECT_THROW(renderer().prepare(unfit), Error);
    EXPECT_THROW(Reference{unfit}, Error);
}

}  // namespace
}  // namespace cellproj
