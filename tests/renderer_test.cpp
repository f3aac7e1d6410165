// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures against the truth: closed forms, float64 quadrature along the pixel's ray, and changes that must not matter.
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include <glm/geometric.hpp>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>

#include "classify/segment_integral.hpp"
#include "mesh/error.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace renderer_test {

using testing_support::delaunay_mesh;
using testing_support::grid_mesh;
using testing_support::point_field;
using testing_support::chord_in_first_cell;
using testing_support::chord_in_unit_cube;
using testing_support::Chord;
using testing_support::constant_medium;
using testing_support::linear;
using testing_support::max_difference;
using testing_support::ramp;
using testing_support::relabelled;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;
using testing_support::unit_tet;

constexpr ImageSize small{96, 96};

Renderer& renderer() {
    static const auto shared = make_renderer(Backend::gl_osmesa);
    return *shared;
}

// The light along the ray through a position on the screen, in float64.
using Truth = std::function<Light(const glm::dvec2&)>;

double error_against(const Truth& truth, const Image& image) {
    return testing_support::error_but_for_snapping(image, [&](const glm::dvec2& at) {
        const Light light = truth(at);
        return glm::dvec4(light.color, light.opacity);
    });
}

// Light through the unit cube where the scalar is linear: one segment, integrated to 1e-10.
Truth truth_in_unit_cube(const Camera& camera, ImageSize size, const TransferFunction& transfer,
                         const std::function<double(const glm::dvec3&)>& f) {
    return [=, transform = ScreenTransform(camera, size)](const glm::dvec2& screen) {
        const auto ray = transform.ray(screen);
        const Chord chord = chord_in_unit_cube(ray, transform.perspective());
        if (chord.length() <= 0) return Light{};
        const auto at = [&](double t) { return f(ray.origin + t * ray.direction); };
        return integrate_segment(transfer, at(chord.enter), at(chord.leave), chord.length());
    };
}

class EitherProjection : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Renderer, EitherProjection, testing_support::either_projection, testing_support::name_of_projection);

// 1 − exp(−τ·chord) whatever the mesh. 1e-4: float32 terms and blending of up to 100 layers, 3e-6 each (measured).
TEST_P(EitherProjection, ConstantMediumInABox) {
    const double extinction = 1.7;
    for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(-0.4, 0.3, 2), glm::dvec3(1, 0.02, 0.01)}) {
        const Camera camera = view_of_unit_cube(GetParam(), from);
        const Scene scene = scene_of(grid_mesh(7), [](const glm::dvec3&) { return 3.0; }, constant_medium(extinction));
        const Truth truth = truth_in_unit_cube(camera, small, *scene.transfer, [](const glm::dvec3&) { return 3.0; });
        EXPECT_LT(error_against(truth, renderer().render(scene, camera, small)), 1e-4);
    }
}

TEST_P(EitherProjection, ConstantMediumInADelaunayMesh) {
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene scene = scene_of(delaunay_mesh(3000, 3), linear, constant_medium(2.3));
    const Truth truth = truth_in_unit_cube(camera, small, *scene.transfer, linear);
    EXPECT_LT(error_against(truth, renderer().render(scene, camera, small)), 1e-4);
}

// 4e-3 with the table of 64³: its trilinear interpolation, accumulated over the cells of a ray. 2e-3 holds by GCC's rounding; by clang's,
// at 24 cells, a pixel has 3.2e-3.
TEST_P(EitherProjection, LinearFieldWithARamp) {
    for (const int cells : {1, 6, 24}) {
        const Camera camera = view_of_unit_cube(GetParam());
        const Scene scene = scene_of(grid_mesh(cells, 0.2, 5), linear, ramp());
        const Truth truth = truth_in_unit_cube(camera, small, *scene.transfer, linear);
        EXPECT_LT(error_against(truth, renderer().render(scene, camera, small, {.method = {.kind = MethodKind::preint3d, .size = 64}})), 4e-3) << cells;
    }
}

// Six tents of half width .01, narrower than the texels of a table. 1e-4 for the bare cube: float32 terms; the scalar is good to 1e-7, where
// the extinction changes by 2000 per unit. 1e-3 with points inside: each is moved its own way by up to 1/512 of a pixel, and the
// peaks with it.
TEST_P(EitherProjection, NarrowPeaksAreExact) {
    std::vector<ExtinctionNode> peaks;
    for (int i = 0; i < 6; ++i) {
        const double center = (i + 0.5) / 6;
        peaks.insert(peaks.end(), {{center - 0.01, 0}, {center, 20}, {center + 0.01, 0}});
    }
    const TransferFunction transfer(OpticalModel::density, ramp().color_nodes(), peaks);
    const Camera camera = view_of_unit_cube(GetParam());
    for (const int cells : {1, 12}) {
        const Scene scene = scene_of(grid_mesh(cells, 0.2, 5), linear, transfer);
        const Truth truth = truth_in_unit_cube(camera, small, transfer, linear);
        for (const char* method : {"integral", "exact:1e-5"}) {
            EXPECT_LT(error_against(truth, renderer().render(scene, camera, small, {.method = parse_method(method)})), cells == 1 ? 1e-4 : 1e-3)
                << cells << " " << method;
        }
    }
}

// One cell seen from nearby, its far end 20 times as far as its near end: affine interpolation is wrong by up to .56 here.
TEST(Renderer, PerspectiveIsExactOnALongCell) {
    TetMesh mesh;
    mesh.points = {{0.5, 0.5, 0}, {0, 0, 1}, {1, 0, 1}, {0.5, 1, 1}};
    for (auto& p : mesh.points) p.z *= 19;
    mesh.tets = {{0, 1, 2, 3}};
    orient_cells(mesh);
    Camera camera{.eye = {0.45, 0.4, -1}, .center = {0.5, 0.45, 19}, .up = {0, 1, 0}};
    camera.fov_y_degrees = 10;
    const auto f = [](const glm::dvec3& p) { return p.z / 19; };
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 0, 1}}}, {{0, 0.02}, {1, 0.2}});
    const Scene scene = scene_of(mesh, f, transfer);
    const Image image = renderer().render(scene, camera, small);
    const ScreenTransform transform(camera, small);
    int inside = 0;
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
            const auto ray = transform.ray({x + 0.5, y + 0.5});
            const Chord chord = chord_in_first_cell(mesh, ray, true);
            if (chord.length() < 0.05) continue;  // away from the silhouette
            ++inside;
            const auto at = [&](double t) { return f(ray.origin + t * ray.direction); };
            const Light light = integrate_segment(transfer, at(chord.enter), at(chord.leave), chord.length());
            EXPECT_LT(max_difference(image.at(x, y), glm::dvec4(light.color, light.opacity)), 2e-3) << x << ", " << y;
        }
    }
    EXPECT_GT(inside, 100);
}

// ---- Changes that must not matter. 1e-3: a few texels of different rounding, and what follows from another order of
// cells that do not hide each other.

struct Fixture {
    TetMesh mesh = grid_mesh(8, 0.2, 9);
    Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    Image picture = renderer().render(scene_of(mesh, linear, ramp()), camera, small);
};

TEST(Renderer, RelabelledVerticesAndPermutedCells) {
    const Fixture fixture;
    std::mt19937_64 random(71);
    TetMesh mesh = relabelled(fixture.mesh, random);
    for (auto& tet : mesh.tets)
        std::rotate(tet.begin(), tet.begin() + 1, tet.begin() + 3);  // an even permutation keeps the orientation
    std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
    const Image picture = renderer().render(scene_of(mesh, linear, ramp()), fixture.camera, small);
    EXPECT_LT(max_difference(picture, fixture.picture), 1e-3);
}

TEST(Renderer, RotatedTogetherWithTheCamera) {
    const Fixture fixture;
    const double c = std::cos(0.7), s = std::sin(0.7);
    const glm::dmat3 rotation = glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1) * glm::dmat3(1, 0, 0, 0, c, s, 0, -s, c);
    TetMesh mesh = fixture.mesh;
    const ScalarField field = point_field(mesh, linear);
    for (auto& p : mesh.points) p = rotation * p;
    Camera camera = fixture.camera;
    camera.eye = rotation * camera.eye;
    camera.center = rotation * camera.center;
    camera.up = rotation * camera.up;
    EXPECT_LT(max_difference(renderer().render(scene_of(mesh, field, ramp()), camera, small), fixture.picture), 1e-3);
}

TransferFunction scaled_ramp(double scale) {
    auto nodes = ramp().extinction_nodes();
    for (auto& node : nodes) node.extinction /= scale;
    return {OpticalModel::density, ramp().color_nodes(), nodes};
}

TEST_P(EitherProjection, ScaledByABillionthAndABillion) {
    const TetMesh mesh = grid_mesh(8, 0.2, 9);
    const ScalarField field = point_field(mesh, linear);
    const Camera camera = view_of_unit_cube(GetParam());
    const Image reference = renderer().render(scene_of(mesh, field, ramp()), camera, small);
    for (const double scale : {1e-9, 1e9}) {
        TetMesh scaled = mesh;
        for (auto& p : scaled.points) p *= scale;
        Camera seen = camera;
        seen.eye *= scale;
        seen.center *= scale;
        seen.height *= scale;
        const Image picture = renderer().render(scene_of(scaled, field, scaled_ramp(scale)), seen, small);
        EXPECT_LT(max_difference(picture, reference), 1e-3) << scale;
    }
}

TEST_P(EitherProjection, ShiftedByAMillion) {
    const TetMesh mesh = grid_mesh(8, 0.2, 9);
    const ScalarField field = point_field(mesh, linear);
    const Camera camera = view_of_unit_cube(GetParam());
    const Image reference = renderer().render(scene_of(mesh, field, ramp()), camera, small);
    TetMesh shifted = mesh;
    for (auto& p : shifted.points) p += 1e6;
    Camera seen = camera;
    seen.eye += 1e6;
    seen.center += 1e6;
    EXPECT_LT(max_difference(renderer().render(scene_of(shifted, field, ramp()), seen, small), reference), 1e-3);
}

// Scalars of any size: the table is over the field's own range.
TEST(Renderer, ScalarsOfAnyScale) {
    const Fixture fixture;
    for (const auto& [scale, offset] : {std::pair{1e-30, 0.0}, {1e30, 0.0}, {1e-3, 1e6}}) {
        const auto f = [&, scale = scale, offset = offset](const glm::dvec3& p) { return offset + scale * linear(p); };
        auto color = ramp().color_nodes();
        auto extinction = ramp().extinction_nodes();
        for (auto& node : color) node.scalar = offset + scale * node.scalar;
        for (auto& node : extinction) node.scalar = offset + scale * node.scalar;
        const Scene scene = scene_of(fixture.mesh, f, {OpticalModel::density, color, extinction});
        EXPECT_LT(max_difference(renderer().render(scene, fixture.camera, small), fixture.picture), 1e-3) << scale;
    }
}

TEST(Renderer, AFarAwayHugeCellChangesNothing) {
    const Fixture fixture;
    TetMesh mesh = fixture.mesh;
    const auto first = static_cast<VertexId>(mesh.points.size());
    ScalarField field = point_field(mesh, linear);
    // Behind the camera, a hundred thousand times the cube.
    for (const glm::dvec3& corner : {glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
        mesh.points.push_back(fixture.camera.eye + 1e5 * (fixture.camera.eye - fixture.camera.center) + 1e5 * corner);
        field.values.push_back(0.5);
    }
    mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    EXPECT_LT(max_difference(renderer().render(scene_of(mesh, field, ramp()), fixture.camera, small), fixture.picture), 1e-3);
}

TEST(Renderer, ACameraInsideACellSeesIt) {
    for (const int cells : {1, 5}) {
        Camera camera{.eye = {0.52, 0.47, 0.55}, .center = {0.9, 0.2, 0.7}, .up = {0, 0, 1}};
        camera.fov_y_degrees = 80;
        const Scene scene = scene_of(grid_mesh(cells), linear, ramp());
        const Truth truth = truth_in_unit_cube(camera, small, *scene.transfer, linear);
        EXPECT_LT(error_against(truth, renderer().render(scene, camera, small)), 2e-3) << cells;
    }
}

TEST(Renderer, ACameraInAFaceAndAtAVertexSeesTheMesh) {
    const Scene scene = scene_of(grid_mesh(4), linear, ramp());
    for (const glm::dvec3& eye : {glm::dvec3(0.25, 0.6, 0.6), glm::dvec3(0.5, 0.5, 0.5), glm::dvec3(0.25, 0.25, 0.6)}) {
        Camera camera{.eye = eye, .center = {0.97, 0.9, 0.8}, .up = {0, 0, 1}};
        const Truth truth = truth_in_unit_cube(camera, small, *scene.transfer, linear);
        EXPECT_LT(error_against(truth, renderer().render(scene, camera, small)), 2e-3);
    }
}

// ---- Fields, transfer functions, states.

TEST(Renderer, CellFieldsAreConstantInACell) {
    // Two layers of one medium each: the front one, z > 1/2, hides the back one.
    const TetMesh mesh = grid_mesh(2);
    ScalarField field{"layer", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) {
        double z = 0;
        for (const VertexId v : tet) z += mesh.points[v].z / 4;
        field.values.push_back(z > 0.5 ? 1 : 0);
    }
    const TransferFunction transfer(OpticalModel::density, {{0, {0, 0, 1}}, {0.5, {0, 0, 1}}, {0.5, {1, 0, 0}}}, {{0, 1}, {1, 3}});
    const Camera from_above =
        frame_bounds({glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::parallel, {0, 0, 1}, {0, 1, 0}, 1.0);
    const Image image = renderer().render(scene_of(mesh, field, transfer), from_above, small);
    const double front = 1 - std::exp(-1.5), back = 1 - std::exp(-0.5);
    EXPECT_LT(max_difference(image.at(48, 48), {front, 0, (1 - front) * back, front + (1 - front) * back}), 1e-4);
}

TEST(Renderer, EmissionWithoutExtinctionAdds) {
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.2, 0.1, 0.05}}}, {{0, 0}});
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    const Scene scene = scene_of(grid_mesh(5), linear, glow);
    const Truth truth = truth_in_unit_cube(camera, small, glow, linear);
    EXPECT_LT(error_against(truth, renderer().render(scene, camera, small)), 1e-4);
}

TEST(Renderer, InvisibleCellsAreCulledAndThePictureIsTheSame) {
    // Visible only above 38/63, a texel of the table, so that its interpolation does not blur the edge; the second function
    // glows too faintly elsewhere to be seen, but is not zero.
    const auto shell = [](double elsewhere) {
        return TransferFunction(OpticalModel::density, {{0, {1, 1, 1}}}, {{0, elsewhere}, {38.0 / 63, elsewhere}, {0.8, 5}});
    };
    const Fixture fixture;
    Statistics culled, all;
    const Image a = renderer().render(scene_of(fixture.mesh, linear, shell(0)), fixture.camera, small, {}, &culled);
    const Image b = renderer().render(scene_of(fixture.mesh, linear, shell(1e-9)), fixture.camera, small, {}, &all);
    EXPECT_LT(max_difference(a, b), 1e-6);
    EXPECT_LT(culled.counts.drawn, all.counts.drawn * 7 / 10);
    EXPECT_EQ(culled.counts.drawn + culled.counts.culled, fixture.mesh.tets.size());
}

TEST(Renderer, CellsWithValuesThatAreNotFiniteAreLeftOut) {
    const TetMesh mesh = grid_mesh(6);
    ScalarField field = point_field(mesh, linear);
    field.values[150] = std::numeric_limits<double>::quiet_NaN();
    field.values[200] = std::numeric_limits<double>::infinity();
    const Image image = renderer().render(scene_of(mesh, field, ramp()), view_of_unit_cube(Camera::Projection::parallel), small);
    for (const glm::vec4& p : image.pixels) {
        for (int k = 0; k < 4; ++k) ASSERT_TRUE(p[k] >= 0 && p[k] <= 1.0001F);
    }
    field.values.assign(field.values.size(), std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(renderer().render(scene_of(mesh, field, ramp()), view_of_unit_cube(Camera::Projection::parallel), small), Error);
}

TEST(Renderer, FlatNeedleAndPointCellsAddNothing) {
    const Fixture fixture;
    TetMesh mesh = fixture.mesh;
    std::mt19937_64 random(81);
    std::uniform_int_distribution<VertexId> any(0, static_cast<VertexId>(mesh.points.size() - 1));
    for (int i = 0; i < 300; ++i) {
        const VertexId a = any(random), b = any(random), c = any(random);
        mesh.tets.push_back(i % 3 == 0 ? std::array{a, a, a, a} : i % 3 == 1 ? std::array{a, b, a, b} : std::array{a, b, c, c});
    }
    const Image picture = renderer().render(scene_of(mesh, linear, ramp()), fixture.camera, small);
    EXPECT_LT(max_difference(picture, fixture.picture), 1e-3);
}

// 2000 slabs of opacity .001 each, one behind the other: none is lost.
TEST(Renderer, ManyThinCells) {
    const int slabs = 2000;
    TetMesh mesh;
    for (int k = 0; k <= slabs; ++k) {
        for (int corner = 0; corner < 4; ++corner) mesh.points.emplace_back(corner & 1, corner >> 1, double(k) / slabs);
    }
    for (int k = 0; k < slabs; ++k) {  // each box as six tetrahedra around the diagonal 0–7
        const auto v = static_cast<VertexId>(4 * k);
        for (const auto& [b, c] : {std::pair{1U, 3U}, {3U, 2U}, {2U, 6U}, {6U, 4U}, {4U, 5U}, {5U, 1U}}) {
            mesh.tets.push_back({v, v + b, v + c, v + 7});
        }
    }
    orient_cells(mesh);
    const double extinction = -std::log(1 - 0.001) * slabs;
    const Camera camera{.projection = Camera::Projection::parallel, .eye = {0.5, 0.5, 3}, .center = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .height = 1.2};
    const Image image = renderer().render(scene_of(mesh, linear, constant_medium(extinction)), camera, {16, 16});
    // 1e-4: 12,000 blends in float32 at 6e-8 each would be 7e-4 if they all erred one way; they do not.
    EXPECT_NEAR(image.at(8, 8).w, 1 - std::pow(0.999, slabs), 1e-4);
}

TEST(Renderer, OpaqueAtAnyOpticalDepth) {
    for (const double extinction : {1e2, 1e5, 1e8}) {
        const Image image = renderer().render(scene_of(grid_mesh(3), linear, constant_medium(extinction)),
                                              view_of_unit_cube(Camera::Projection::perspective), small);
        EXPECT_LT(max_difference(image.at(48, 48), {1, 0.5, 0.25, 1}), 1e-5);
    }
}

TEST(Renderer, KeepsNothingOfAnotherScene) {
    const Fixture fixture;
    const Scene first = scene_of(fixture.mesh, linear, ramp());
    Scene second = first;
    second.transfer = std::make_shared<TransferFunction>(constant_medium(3));
    const auto fresh = [&](const Scene& scene, ImageSize size) {
        return make_renderer(Backend::gl_osmesa)->render(scene, fixture.camera, size);
    };
    for (const auto& [scene, size] : {std::pair{first, small}, {second, small}, {second, ImageSize{40, 70}}, {first, small}}) {
        EXPECT_EQ(max_difference(renderer().render(scene, fixture.camera, size), fresh(scene, size)), 0);
    }
}

TEST(Renderer, StatisticsAddUp) {
    const Fixture fixture;
    Statistics s;
    renderer().render(scene_of(fixture.mesh, linear, ramp()), fixture.camera, small, {.method = {.kind = MethodKind::preint3d, .size = 32}}, &s);
    EXPECT_EQ(s.counts.cells, fixture.mesh.tets.size());
    EXPECT_EQ(s.counts.drawn + s.counts.culled, s.counts.cells);
    EXPECT_GT(s.counts.triangles, s.counts.drawn);  // one or two each
    EXPECT_LT(s.counts.triangles, s.counts.drawn * 2);
    EXPECT_EQ(s.counts.order_violations, 0U);
    EXPECT_EQ(s.method, "preint3d:32");
    EXPECT_NE(s.backend_version.find("Mesa"), std::string::npos);
}

TEST(Renderer, RefusesWhatCannotBeDrawn) {
    const Scene scene = scene_of(unit_tet(), linear, ramp());
    Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    EXPECT_THROW(renderer().render(scene, camera, {0, 0}), Error);
    camera.height = -1;
    EXPECT_THROW(renderer().render(scene, camera, small), Error);
    Scene short_field = scene;
    short_field.field = std::make_shared<ScalarField>(ScalarField{"f", FieldLocation::points, {1, 2}});
    EXPECT_THROW(renderer().render(short_field, view_of_unit_cube(Camera::Projection::parallel), small), Error);
}

TEST(Renderer, WithoutOsmesaTheMessageNamesThePackage) {
    try {
        make_renderer(Backend::gl_osmesa, {.osmesa_library = "libOSMesa-not-there.so.8"});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::environment);
        EXPECT_NE(std::string(error.what()).find("libosmesa6"), std::string::npos);
    }
}

}  // namespace
}  // namespace cellproj
