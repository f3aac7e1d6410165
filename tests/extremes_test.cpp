// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures at the limits, for every method that both backends draw: units of any size, fields of one value, degenerate cells, media
// thinner than a framebuffer of 8 bits sees. What a method errs by elsewhere (segment_method_test) must not grow by them: each picture is held
// against the same method's in ordinary units, or against a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <glm/common.hpp>

#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace extremes_test {

using testing_support::constant_medium;
using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::point_field;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;

constexpr ImageSize small{40, 40};

const std::vector<std::string> all_methods{
    "shirley-tuchman", "average",          "average:half",         "average:vertices", "homogeneous", "homogeneous:vertices",
    "linear:4",        "linear:4:vertices", "stein",               "preint2d:16",      "preint2d-exp:16", "preint2d-exp:16:float16",
    "preint2d-exp:16:uint8", "preint3d:16", "preint3d:16:linear", "preint3d:16:uint8", "integral", "exact:1e-5"};

// Calls body(renderer, quality, name) for every method of every backend that draws it.
template <class Body>
void for_every_method(Body body) {
    for (const Backend backend : {Backend::gl_osmesa, Backend::cpu}) {
        const auto renderer = make_renderer(backend);
        for (const std::string& name : all_methods) {
            const Quality quality{.method = parse_method(name)};
            if (draws(backend, quality)) body(*renderer, quality, name + (backend == Backend::cpu ? ", cpu" : ", gl"));
        }
    }
}

void expect_physical(const Image& image, const std::string& what) {
    for (const glm::vec4& p : image.pixels) {
        ASSERT_TRUE(p.a >= 0.0F && p.a <= 1.0F) << what << " " << p.a;
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(p[c] >= 0.0F && std::isfinite(p[c])) << what;
    }
}

// In 8 bits the driver filters in 8 bits, and where in a texel a scalar falls decides the rounding.
double tolerance(const std::string& what) { return what.find("uint8") != std::string::npos ? 2e-2 : 1e-3; }

void expect_same(const Image& found, const Image& expected, const std::string& what) {
    expect_physical(found, what);
    double widest = 0;
    for (std::size_t i = 0; i < found.pixels.size(); ++i) {
        const glm::vec4 d = glm::abs(found.pixels[i] - expected.pixels[i]);
        widest = std::max<double>(widest, std::max({d.x, d.y, d.z, d.w}));
    }
    EXPECT_LT(widest, tolerance(what)) << what;
}

// A mesh, its camera and its ramp in other units of length, and elsewhere; scalars in other units.
struct Units {
    double length, place, scalar;
};

struct View {
    Scene scene;
    Camera camera;
};

View in_units(const TetMesh& mesh, const Units& units) {
    TetMesh moved = mesh;
    for (glm::dvec3& p : moved.points) p = units.length * p + units.place;
    ScalarField field = point_field(mesh, linear);
    for (double& s : field.values) s *= units.scalar;
    auto colors = ramp().color_nodes();
    auto extinctions = ramp().extinction_nodes();
    for (ColorNode& node : colors) node.scalar *= units.scalar;
    for (ExtinctionNode& node : extinctions) node = {node.scalar * units.scalar, node.extinction / units.length};
    Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    camera.eye = units.length * camera.eye + units.place;
    camera.center = units.length * camera.center + units.place;
    return {scene_of(std::move(moved), std::move(field), {OpticalModel::density, colors, extinctions}), camera};
}

TEST(Extremes, AnyUnitsAndPlace) {
    const TetMesh mesh = grid_mesh(3, 0.2, 9);
    const View usual = in_units(mesh, {1, 0, 1});
    for_every_method([&](Renderer& renderer, const Quality& quality, const std::string& name) {
        const Image expected = renderer.render(usual.scene, usual.camera, small, quality);
        for (const Units& units : {Units{1e-12, 0, 1}, {1e12, 0, 1}, {1, 1e6, 1}, {1, 0, 1e-30}, {1, 0, 1e30}}) {
            const View view = in_units(mesh, units);
            expect_same(renderer.render(view.scene, view.camera, small, quality), expected,
                        name + " " + std::to_string(std::log10(units.length)) + " " + std::to_string(units.scalar));
        }
    });
}

// One scalar everywhere: its medium, though the range of the field is 0.
TEST(Extremes, AllScalarsEqual) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const TetMesh mesh = grid_mesh(2, 0.2, 9);
    const TransferFunction there = constant_medium(ramp().extinction(0.5));
    for_every_method([&](Renderer& renderer, const Quality& quality, const std::string& name) {
        const auto half = [](const glm::dvec3&) { return 0.5; };
        const Scene constant = scene_of(mesh, half, {OpticalModel::density, there.color_nodes(), ramp().extinction_nodes()});
        const Image expected = renderer.render(scene_of(mesh, half, there), camera, small, quality);
        const Image image = renderer.render(constant, camera, small, quality);
        expect_same(image, expected, name);
        EXPECT_GT(image.at(20, 20).a, 0.5F) << name;
    });
}

// 300 cells without volume, among 10,000: points, needles and flat ones hold no piece of any ray.
TEST(Extremes, CellsWithoutVolume) {
    TetMesh mesh = grid_mesh(CELLPROJ_SANITIZED ? 5 : 12, 0.2, 9);
    const Scene clean = scene_of(mesh, linear, ramp());
    std::mt19937_64 random(81);
    std::uniform_int_distribution<VertexId> any(0, static_cast<VertexId>(mesh.points.size() - 1));
    for (int i = 0; i < 300; ++i) {
        const VertexId a = any(random), b = any(random), c = any(random);
        mesh.tets.push_back(i % 3 == 0 ? std::array{a, a, a, a} : i % 3 == 1 ? std::array{a, b, a, b} : std::array{a, b, c, c});
    }
    const Scene dirty = scene_of(mesh, linear, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    for_every_method([&](Renderer& renderer, const Quality& quality, const std::string& name) {
        if (quality.method.kind == MethodKind::preint2d) return;  // its mean length is that of all cells, by their surface
        const Image expected = renderer.render(clean, camera, small, quality);
        expect_same(renderer.render(dirty, camera, small, quality), expected, name);
    });
}

// A bar of boxes, one behind the other, each as six tetrahedra around a diagonal.
TetMesh bar(int slabs, double width, double length) {
    TetMesh mesh;
    for (int k = 0; k <= slabs; ++k) {
        for (int corner = 0; corner < 4; ++corner)
            mesh.points.emplace_back(width * (corner & 1), width * (corner >> 1), length * k / slabs);
    }
    for (int k = 0; k < slabs; ++k) {
        const auto v = static_cast<VertexId>(4 * k);
        for (const auto& [b, c] : {std::pair{1U, 3U}, {3U, 2U}, {2U, 6U}, {6U, 4U}, {4U, 5U}, {5U, 1U}})
            mesh.tets.push_back({v, v + b, v + c, v + 7});
    }
    orient_cells(mesh);
    return mesh;
}

float opacity_through(Renderer& renderer, const Quality& quality, const TetMesh& mesh, double width, double length, double extinction) {
    const Camera camera{.projection = Camera::Projection::parallel, .eye = {width / 2, width / 2, 3 * length},
                        .center = {width / 2, width / 2, length / 2}, .up = {0, 1, 0}, .height = 1.2 * width};
    const auto along = [&](const glm::dvec3& p) { return p.z / length; };
    const Image image = renderer.render(scene_of(mesh, along, constant_medium(extinction)), camera, {8, 8}, quality);
    expect_physical(image, to_string(quality.method));
    return image.at(5, 3).a;
}

// How far layers of a constant medium may be off in all. Most methods are exact in l, so that layers multiply: float32, and float16
// keeps the extinction to 2⁻¹¹ of itself. The linear scale of 16 texels interpolates opacity in l, and takes a thin layer for
// (1 − e^(−τh))/τh of its depth, τh up to .2 here. Extinctions filtered in 8 bits are off by up to 1/255.
double bound_of(const Method& method) {
    if (method.kind == MethodKind::preint3d && method.scale == TableScale::linear) return 5e-2;
    if (method.storage == TableStorage::uint8) return 5e-3;
    return method.storage == TableStorage::float16 ? 1e-3 : 2e-4;
}

// `average`, light at vertices and `preint2d` are wrong by about D²/2 for each cell of depth D.
bool errs_once_per_cell(const Method& method) {
    return method.kind == MethodKind::average || method.kind == MethodKind::preint2d || light_at_vertices(method);
}

// 1000 and 2000 slabs of opacity .001: .6323… and .8648…
TEST(Extremes, ThinSlabsAddUp) {
    for (const int slabs : {1000, 2000}) {
        if (CELLPROJ_SANITIZED && slabs > 1000) continue;
        const TetMesh mesh = bar(slabs, 1, 1);
        for_every_method([&](Renderer& renderer, const Quality& quality, const std::string& name) {
            const float found = opacity_through(renderer, quality, mesh, 1, 1, -std::log1p(-0.001) * slabs);
            // D²/2 of 2000 layers of .001: 1e-3 of depth, behind which .1353 are left.
            const double bound = bound_of(quality.method) + (errs_once_per_cell(quality.method) ? 2e-4 : 0.0);
            EXPECT_NEAR(found, 1 - std::pow(0.999, slabs), bound) << name;
        });
    }
}

// Opacity .003 per unit over 1000 units.
TEST(Extremes, AThinMediumOverALongWay) {
    const TetMesh mesh = bar(200, 10, 1000);
    for_every_method([&](Renderer& renderer, const Quality& quality, const std::string& name) {
        // D²/2 of 200 layers of .015: .0225 of depth, behind which .0498 are left.
        const double bound = bound_of(quality.method) + (errs_once_per_cell(quality.method) ? 1.2e-3 : 0.0);
        EXPECT_NEAR(opacity_through(renderer, quality, mesh, 10, 1000, -std::log1p(-0.003)), 1 - std::pow(0.997, 1000), bound)
            << name;
    });
}

}  // namespace
}  // namespace cellproj
