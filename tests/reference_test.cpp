// SPDX-License-Identifier: BSD-3-Clause
//
// The judge against closed forms: boxes, slabs, overlapping and cyclic cells, gaps; and the renderer against the judge.
#include "apps/scenes/measured_scenes.hpp"
#include "render/judge/reference.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include <glm/geometric.hpp>

#include "classify/segment_integral.hpp"
#include "mesh/error.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace reference_test {

using testing_support::delaunay_mesh;
using testing_support::grid_mesh;
using testing_support::point_field;
using testing_support::chord_in_unit_cube;
using testing_support::Chord;
using testing_support::constant_medium;
using testing_support::distance;
using testing_support::linear;
using testing_support::ramp;
using testing_support::relabelled;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;

// The bound that the judge states.
constexpr double stated = 1e-9;

constexpr ImageSize small{48, 48};

Camera from_above(double height = 1.0) {
    return {.projection = Camera::Projection::parallel,
            .eye = {0.5, 0.5, 9},
            .center = {0.5, 0.5, 0},
            .up = {0, 1, 0},
            .height = height};
}

double max_distance(const std::vector<PixelTruth>& a, const std::vector<PixelTruth>& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, distance(a[i].light, b[i].light));
    return largest;
}

// The largest distance from one segment through the whole cube, where the scalar is linear.
double error_in_unit_cube(const Scene& scene, const Camera& camera, ImageSize size,
                          const std::function<double(const glm::dvec3&)>& f) {
    const ScreenTransform transform(camera, size);
    double largest = 0;
    for (const PixelTruth& truth : Reference(scene).picture(camera, size)) {
        const auto ray = transform.ray({truth.pixel.x + 0.5, truth.pixel.y + 0.5});
        const Chord chord = chord_in_unit_cube(ray, transform.perspective());
        const auto at = [&](double t) { return f(ray.origin + t * ray.direction); };
        const Light light = chord.length() > 0
                                ? integrate_segment(*scene.transfer, at(chord.enter), at(chord.leave), chord.length(), 1e-14)
                                : Light{};
        largest = std::max(largest, distance(truth.light, light));
    }
    return largest;
}

class ReferenceOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Reference, ReferenceOfEither, testing_support::either_projection, testing_support::name_of_projection);

TEST_P(ReferenceOfEither, AConstantMediumInABox) {
    for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(-0.4, 0.3, 2), glm::dvec3(1, 0.02, 0.01)}) {
        const Camera camera = view_of_unit_cube(GetParam(), from);
        const ScreenTransform transform(camera, small);
        const Scene scene = scene_of(
            grid_mesh(5), [](const glm::dvec3&) { return 3.0; }, constant_medium(1.7));
        for (const PixelTruth& truth : Reference(scene).picture(camera, small)) {
            const Chord chord =
                chord_in_unit_cube(transform.ray({truth.pixel.x + 0.5, truth.pixel.y + 0.5}), transform.perspective());
            const double opacity = -std::expm1(-1.7 * chord.length());
            EXPECT_LT(distance(truth.light, {opacity * glm::dvec3(1, 0.5, 0.25), opacity}), stated);
        }
    }
}

TEST_P(ReferenceOfEither, ALinearFieldIsOneSegmentWhateverTheMesh) {
    for (const int cells : {1, 6, 13}) {
        EXPECT_LT(error_in_unit_cube(scene_of(grid_mesh(cells, 0.2, 5), linear, ramp()), view_of_unit_cube(GetParam()), small,
                                     linear),
                  stated);
    }
    EXPECT_LT(
        error_in_unit_cube(scene_of(delaunay_mesh(2000, 3), linear, ramp()), view_of_unit_cube(GetParam()), small, linear),
        stated);
}

TEST_P(ReferenceOfEither, AnEyeInsideACellAndAtAVertex) {
    for (const glm::dvec3& eye :
         {glm::dvec3(0.52, 0.47, 0.55), glm::dvec3(0.5, 0.5, 0.5), glm::dvec3(0.25, 0.6, 0.6), glm::dvec3(0.25, 0.25, 0.6)}) {
        Camera camera{.projection = GetParam(), .eye = eye, .center = {0.97, 0.9, 0.8}, .up = {0, 0, 1}};
        camera.fov_y_degrees = 70;
        EXPECT_LT(error_in_unit_cube(scene_of(grid_mesh(4), linear, ramp()), camera, small, linear), stated);
    }
}

// κ and τ rise along z through a slab of thickness 1, seen along z: error functions. From behind, the other way round.
TEST(Reference, ALinearRampThroughASlab) {
    const glm::dvec3 low(0.1, 0.2, 0.9), high(1.0, 0.6, 0.0);
    const double a = 0.5, b = 4.0;  // τ = a + b·x, x from 0 to 1
    const double transmittance = std::exp(-(a + b / 2)), scale = std::sqrt(2 * b);
    const double rising =
        std::sqrt(std::numbers::pi / (2 * b)) * std::exp(a * a / (2 * b)) * (std::erf((a + b) / scale) - std::erf(a / scale));
    const TransferFunction density(OpticalModel::density, {{0, low}, {1, high}}, {{0, a}, {1, a + b}});
    const TransferFunction emitter(OpticalModel::emitter, {{0, low}}, {{0, a}, {1, a + b}});
    // Rays go downwards: x = 1 − z along them. ∫τκT = κ(0) − κ(1)·T(1) + ∫κ'T, by parts.
    const auto down = [](const glm::dvec3& p) { return 1 - p.z; };
    for (const TetMesh& mesh : {grid_mesh(1), grid_mesh(4, 0.2, 2), delaunay_mesh(500, 4)}) {
        for (const PixelTruth& t : Reference(scene_of(mesh, down, density)).picture(from_above(), {15, 15})) {
            EXPECT_LT(distance(t.light, {low - transmittance * high + rising * (high - low), 1 - transmittance}), stated);
        }
        for (const PixelTruth& t : Reference(scene_of(mesh, down, emitter)).picture(from_above(), {15, 15})) {
            EXPECT_LT(distance(t.light, {rising * low, 1 - transmittance}), stated);
        }
    }
}

// On a picture of 16² the pixel centres look at multiples of 1/32: with 16 boxes a side through the middles of faces'
// diagonals, with 32 boxes through vertices and along edges and faces, the whole way.
TEST(Reference, RaysThroughVerticesEdgesAndFaces) {
    for (const int cells : {1, 2, 16, 32}) {
        EXPECT_LT(error_in_unit_cube(scene_of(grid_mesh(cells), linear, ramp()), from_above(), {16, 16},
                                     [](const glm::dvec3& p) { return linear(p); }),
                  stated);
    }
}

TEST(Reference, RelabelledAndPermuted) {
    const TetMesh mesh = grid_mesh(6, 0.2, 9);
    std::mt19937_64 random(71);
    TetMesh other = relabelled(mesh, random);
    for (auto& tet : other.tets)
        std::shuffle(tet.begin(), tet.end(), random);
    std::shuffle(other.tets.begin(), other.tets.end(), random);
    const auto f = [](const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(9 * p.x + 5 * p.y) * std::cos(7 * p.z); };
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    EXPECT_LT(max_distance(Reference(scene_of(mesh, f, ramp())).picture(camera, small),
                           Reference(scene_of(other, f, ramp())).picture(camera, small)),
              1e-13);
}

// Two cells in one place: their media add up, whichever comes first.
TEST(Reference, OverlappingCellsAddUp) {
    TetMesh mesh = grid_mesh(1);
    const std::size_t box = mesh.tets.size();
    // A second cube from z = 1/2 to z = 3/2.
    const TetMesh second = grid_mesh(1);
    for (const auto& p : second.points)
        mesh.points.push_back(p + glm::dvec3(0, 0, 0.5));
    const auto shift = static_cast<VertexId>(second.points.size());
    for (const auto& tet : second.tets)
        mesh.tets.push_back({tet[0] + shift, tet[1] + shift, tet[2] + shift, tet[3] + shift});
    ScalarField field{"which", FieldLocation::cells, {}};
    for (std::size_t c = 0; c < mesh.tets.size(); ++c)
        field.values.push_back(c < box ? 0 : 1);
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 0}}}, {{0, 2.0}, {1, 3.0}});
    // Downwards: half a length of green, half a length of both, half a length of red.
    const double green = -std::expm1(-1.5), both = -std::expm1(-2.5), red = -std::expm1(-1.0);
    const Light expected =
        composite({{0, green, 0}, green}, composite({{both * 2 / 5, both * 3 / 5, 0}, both}, {{red, 0, 0}, red}));
    for (const PixelTruth& t : Reference(scene_of(mesh, field, transfer)).picture(from_above(), {9, 9}))
        EXPECT_LT(distance(t.light, expected), stated);
}

// Three long cells, each in front of the next and the last in front of the first: no order serves all pixels.
TEST(Reference, CellsInACycle) {
    TetMesh mesh;
    ScalarField field{"which", FieldLocation::cells, {}};
    for (int i = 0; i < 3; ++i) {
        // A beam along the side of a triangle, 0.1 thick, that rises from one end (z = 0) to the other (z = 1).
        const double angle = 2 * std::numbers::pi * i / 3;
        const glm::dvec3 along(std::cos(angle), std::sin(angle), 0), across(-along.y, along.x, 0);
        const glm::dvec3 low = -0.3 * across - along + glm::dvec3(0.5, 0.5, 0),
                         high = -0.3 * across + along + glm::dvec3(0.5, 0.5, 1);
        const auto v = static_cast<VertexId>(mesh.points.size());
        for (const glm::dvec3& p :
             {low - 0.05 * across, low + 0.05 * across, high + glm::dvec3(0, 0, -0.05), high + glm::dvec3(0, 0, 0.05)})
            mesh.points.push_back(p);
        mesh.tets.push_back({v, v + 1, v + 2, v + 3});
        field.values.push_back(i);
    }
    const TransferFunction transfer(OpticalModel::density, {{0, {1, 0, 0}}, {1, {0, 1, 0}}, {2, {0, 0, 1}}}, {{0, 300.0}});
    const Scene scene = scene_of(mesh, field, transfer);
    const Reference reference(scene);
    std::set<std::pair<CellId, CellId>> in_front;
    int covered = 0;
    const ImageSize size{128, 128};
    for (const PixelTruth& truth : reference.picture(from_above(2.0), size)) {
        const auto cells = reference.index().cells_along(
            reference.index().ray(from_above(2.0), size, {truth.pixel.x + 0.5, truth.pixel.y + 0.5}));
        covered += !cells.empty();
        Light light;
        for (const Crossing& c : cells) {
            const double opacity = -std::expm1(-300 * c.length());
            glm::dvec3 color(0);
            color[static_cast<int>(c.cell)] = opacity;
            light = composite(light, {color, opacity});
        }
        EXPECT_LT(distance(truth.light, light), stated);
        for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
            EXPECT_LT(cells[i].leave, cells[i + 1].enter);  // they do not touch
            in_front.emplace(cells[i].cell, cells[i + 1].cell);
        }
    }
    EXPECT_GT(covered, 100);
    EXPECT_EQ(in_front.size(), 3U);  // one sense of each pair
    EXPECT_EQ(in_front.count({0, 1}) + in_front.count({1, 2}) + in_front.count({2, 0}), in_front.count({0, 1}) ? 3U : 0U);
}

// The middle layer of five is missing: the ray goes on behind the gap.
TEST_P(ReferenceOfEither, GapsAreEmpty) {
    TetMesh mesh = grid_mesh(5);
    std::erase_if(mesh.tets, [&](const auto& tet) {
        double z = 0;
        for (const VertexId v : tet)
            z += mesh.points[v].z / 4;
        return z > 0.4 && z < 0.6;
    });
    Camera camera = from_above();
    camera.projection = GetParam();
    const ScreenTransform transform(camera, small);
    for (const PixelTruth& t : Reference(scene_of(mesh, linear, constant_medium(2))).picture(camera, small)) {
        const auto ray = transform.ray({t.pixel.x + 0.5, t.pixel.y + 0.5});
        double length = 0;
        for (const auto& [low, high] : {std::pair(0.0, 0.4), {0.6, 1.0}}) {
            double enter = 0, leave = 1e9;
            for (int axis = 0; axis < 3; ++axis) {
                const double begin = axis == 2 ? low : 0, end = axis == 2 ? high : 1;
                if (ray.direction[axis] == 0) {
                    if (ray.origin[axis] <= begin || ray.origin[axis] >= end) leave = -1;
                    continue;
                }
                const double a = (begin - ray.origin[axis]) / ray.direction[axis],
                             b = (end - ray.origin[axis]) / ray.direction[axis];
                enter = std::max(enter, std::min(a, b));
                leave = std::min(leave, std::max(a, b));
            }
            length += std::max(0.0, leave - enter);
        }
        EXPECT_NEAR(t.light.opacity, -std::expm1(-2 * length), stated);
    }
}

TEST(Reference, CellFieldsAreConstantInACell) {
    const TetMesh mesh = grid_mesh(2);
    ScalarField field{"layer", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) {
        double z = 0;
        for (const VertexId v : tet)
            z += mesh.points[v].z / 4;
        field.values.push_back(z > 0.5 ? 1 : 0);
    }
    const TransferFunction transfer(OpticalModel::density, {{0, {0, 0, 1}}, {0.5, {0, 0, 1}}, {0.5, {1, 0, 0}}},
                                    {{0, 1}, {1, 3}});
    const double front = 1 - std::exp(-1.5), back = 1 - std::exp(-0.5);
    for (const PixelTruth& t : Reference(scene_of(mesh, field, transfer)).picture(from_above(), {7, 7})) {
        EXPECT_LT(distance(t.light, {{front, 0, (1 - front) * back}, front + (1 - front) * back}), stated);
    }
}

TEST(Reference, CellsWithValuesThatAreNotFiniteAreLeftOut) {
    const TetMesh mesh = grid_mesh(5);
    ScalarField field = point_field(mesh, linear);
    field.values[90] = std::numeric_limits<double>::quiet_NaN();
    field.values[120] = std::numeric_limits<double>::infinity();
    TetMesh without = mesh;
    std::erase_if(without.tets, [](const auto& tet) {
        return std::find(tet.begin(), tet.end(), 90U) != tet.end() || std::find(tet.begin(), tet.end(), 120U) != tet.end();
    });
    ASSERT_LT(without.tets.size(), mesh.tets.size());
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    const auto a = Reference(scene_of(mesh, field, ramp())).picture(camera, small),
               b = Reference(scene_of(without, linear, ramp())).picture(camera, small);
    EXPECT_LT(max_distance(a, b), 1e-13);
    field.values.assign(field.values.size(), std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(Reference(scene_of(mesh, field, ramp())), Error);
    field.values.pop_back();
    EXPECT_THROW(Reference(scene_of(mesh, field, ramp())), Error);
}

TEST_P(ReferenceOfEither, AnyScaleAndPlace) {
    const TetMesh mesh = grid_mesh(6, 0.2, 9);
    const ScalarField field = point_field(mesh, linear);
    const Camera camera = view_of_unit_cube(GetParam());
    const auto expected = Reference(scene_of(mesh, field, ramp())).picture(camera, small);
    for (const double scale : {1e-12, 1e-9, 1e9, 1e12}) {
        TetMesh scaled = mesh;
        for (auto& p : scaled.points)
            p *= scale;
        Camera seen = camera;
        seen.eye *= scale;
        seen.center *= scale;
        seen.height *= scale;
        auto nodes = ramp().extinction_nodes();
        for (auto& node : nodes)
            node.extinction /= scale;
        EXPECT_LT(
            max_distance(
                Reference(scene_of(scaled, field, {OpticalModel::density, ramp().color_nodes(), nodes})).picture(seen, small),
                expected),
            stated)
            << scale;
    }
    // Near 1e6 a point is a multiple of 1e-10: the moved mesh is another one by as much. Silhouettes, where the chord jumps,
    // included.
    TetMesh shifted = mesh;
    for (auto& p : shifted.points)
        p += 1e6;
    Camera seen = camera;
    seen.eye += 1e6;
    seen.center += 1e6;
    EXPECT_LT(max_distance(Reference(scene_of(shifted, field, ramp())).picture(seen, small), expected), 3e-8);
}

// τ·l up to 1e8 and beyond, transparent to opaque within a cell, scalars of any size.
TEST(Reference, Extremes) {
    for (const double extinction : {1e2, 1e5, 1e8, 1e30}) {
        for (const PixelTruth& t :
             Reference(scene_of(grid_mesh(3), linear, constant_medium(extinction))).picture(from_above(), {8, 8})) {
            EXPECT_LT(distance(t.light, {{1, 0.5, 0.25}, 1}), stated);
        }
    }
    for (const double scale : {1e-30, 1e30}) {
        auto color = ramp().color_nodes();
        auto extinction = ramp().extinction_nodes();
        for (auto& node : color)
            node.scalar *= scale;
        for (auto& node : extinction)
            node.scalar *= scale;
        const auto scaled = [&](const glm::dvec3& p) { return scale * linear(p); };
        const Scene scene = scene_of(grid_mesh(4, 0.2, 2), scaled, {OpticalModel::density, color, extinction});
        EXPECT_LT(error_in_unit_cube(scene, view_of_unit_cube(Camera::Projection::perspective), small, scaled), stated);
    }
    // Equal scalars on a step: its right side, everywhere.
    const TransferFunction step(OpticalModel::density, {{0, {1, 1, 1}}}, {{0.3, 0.0}, {0.3, 1.0}});
    for (const PixelTruth& t : Reference(scene_of(
                                             grid_mesh(3, 0.2, 2), [](const glm::dvec3&) { return 0.3; }, step))
                                   .picture(from_above(), {8, 8})) {
        EXPECT_NEAR(t.light.opacity, -std::expm1(-1.0), stated);
    }
}

// 1000 slabs of opacity .001, six cells each: .6323….
TEST(Reference, ManyThinCells) {
    const int slabs = 1000;
    TetMesh mesh;
    for (int k = 0; k <= slabs; ++k) {
        for (int corner = 0; corner < 4; ++corner)
            mesh.points.emplace_back(corner & 1, corner >> 1, double(k) / slabs);
    }
    for (int k = 0; k < slabs; ++k) {
        const auto v = static_cast<VertexId>(4 * k);
        for (const auto& [b, c] : {std::pair{1U, 3U}, {3U, 2U}, {2U, 6U}, {6U, 4U}, {4U, 5U}, {5U, 1U}})
            mesh.tets.push_back({v, v + b, v + c, v + 7});
    }
    const Scene scene = scene_of(mesh, linear, constant_medium(-std::log1p(-0.001) * slabs));
    for (const PixelTruth& t : Reference(scene).picture(from_above(), {5, 5}))
        EXPECT_NEAR(t.light.opacity, 1 - std::pow(0.999, slabs), stated);
}

// The renderer, on a curved field over an irregular mesh: 2e-3, its table's error, for a picture moved by 1/512 of a pixel.
TEST_P(ReferenceOfEither, TheRendererAgrees) {
    const Scene scene = scene_of(delaunay_mesh(1500, 8), scenes::waves, ramp());
    const Camera camera = view_of_unit_cube(GetParam());
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{24, 24} : ImageSize{64, 64};
    const Image image = make_renderer(Backend::gl_osmesa)->render(scene, camera, size);
    const Reference reference(scene);
    const ImageError moved = compare(image, reference.picture(camera, size, rasterizer_slack));
    EXPECT_LT(moved.color.maximum, 2e-3);
    EXPECT_LT(moved.opacity.maximum, 2e-3);
    const ImageError strict = compare(image, reference.picture(camera, size));
    EXPECT_LT(strict.color.rms, 1e-3);
    EXPECT_GE(strict.color.maximum, moved.color.maximum);
    EXPECT_GT(strict.color.rms, 0);
}

TEST(Reference, PixelsArePicturesParts) {
    const Scene scene = scene_of(grid_mesh(4, 0.2, 1), linear, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const ImageSize size{40, 30};
    const auto picture = Reference(scene).picture(camera, size);
    const std::vector<PixelId> some{{39, 29}, {0, 0}, {20, 15}, {20, 15}};
    const auto truths = reference_pixels(scene, camera, size, some);
    ASSERT_EQ(truths.size(), some.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
        EXPECT_EQ(truths[i].pixel, some[i]);
        EXPECT_EQ(distance(truths[i].light, picture[static_cast<std::size_t>(some[i].y * 40 + some[i].x)].light), 0.0);
    }
    EXPECT_GT(truths[2].light.opacity, 0.5);
    const Image image = to_image(picture, size);
    EXPECT_LT(compare(image, picture).color.maximum, 1e-7);  // float32
    EXPECT_THROW(reference_pixels(scene, camera, size, std::vector<PixelId>{{40, 0}}), Error);
    EXPECT_THROW(reference_pixels(scene, camera, {0, 5}, some), Error);
    Camera nowhere = camera;
    nowhere.eye = nowhere.center;
    EXPECT_THROW(reference_pixels(scene, nowhere, size, some), Error);
}

TEST(Reference, TheSameForAnyNumberOfThreads) {
    const Scene scene = scene_of(grid_mesh(8, 0.2, 1), linear, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const auto parallel = Reference(scene).picture(camera, small, rasterizer_slack);
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const auto serial = Reference(scene).picture(camera, small, rasterizer_slack);
    EXPECT_EQ(max_distance(parallel, serial), 0.0);
    for (std::size_t i = 0; i < serial.size(); ++i)
        EXPECT_EQ(distance(parallel[i].low, serial[i].low), 0.0);
}

TEST(Reference, ASampleIsSpreadOverTheMesh) {
    const Scene scene = scene_of(grid_mesh(3), linear, ramp());
    const Reference reference(scene);
    const Camera camera = from_above(2.0);  // the cube covers the middle quarter of the picture
    const ImageSize size{64, 64};
    const auto sample = reference.sample(camera, size, 64, 5);
    ASSERT_EQ(sample.size(), 64U);
    EXPECT_EQ(sample, reference.sample(camera, size, 64, 5));
    EXPECT_NE(sample, reference.sample(camera, size, 64, 6));
    // 32² pixels in 64 runs of a Morton curve: one pixel in each block of 4².
    std::set<std::pair<int, int>> blocks;
    for (const PixelId& p : sample) {
        EXPECT_TRUE(p.x >= 16 && p.x < 48 && p.y >= 16 && p.y < 48);
        blocks.emplace(p.x / 4, p.y / 4);
    }
    EXPECT_EQ(blocks.size(), 64U);
    EXPECT_EQ(reference.sample(camera, size, 100000).size(), 32U * 32U);
    // 2048² pixels are thinned to one of four first.
    EXPECT_EQ(reference.sample(camera, {2048, 2048}, 10000000).size(), 512U * 512U);
    Camera away = camera;
    away.eye += glm::dvec3(50, 0, 0);
    away.center += glm::dvec3(50, 0, 0);
    EXPECT_TRUE(reference.sample(away, size, 10).empty());
}

TEST(Reference, ErrorsAreMeasured) {
    std::vector<PixelTruth> truths;
    Image image(20, 10);
    for (int y = 0; y < 10; ++y) {
        for (int x = 0; x < 20; ++x) {
            const Light light{{0.25, 0.5, 0.75}, 0.5};
            truths.push_back({{x, y}, light, light, light});
            image.at(x, y) = {0.25F, 0.5F, 0.75F, 0.5F};
        }
    }
    EXPECT_EQ(compare(image, truths).color.maximum, 0.0);
    EXPECT_EQ(compare(image, {}).pixels, 0U);
    // 199 of 200 within 1/8, one with 1/2: the 99 % are 198 pixels.
    image.at(3, 3).y += 0.5F;
    image.at(4, 4).x -= 0.125F;
    image.at(5, 5).x += 0.125F;
    image.at(6, 6).w = 1.0F;
    ImageError error = compare(image, truths);
    EXPECT_EQ(error.pixels, 200U);
    EXPECT_EQ(error.color.maximum, 0.5);
    EXPECT_EQ(error.color.percentile_99, 0.125);
    EXPECT_NEAR(error.color.rms, std::sqrt((0.25 + 2.0 / 64) / 600), 1e-15);
    EXPECT_EQ(error.opacity.maximum, 0.5);
    EXPECT_EQ(error.opacity.percentile_99, 0.0);
    EXPECT_NEAR(error.opacity.rms, std::sqrt(0.25 / 200), 1e-15);
    // Between low and high nothing is wrong.
    truths[63].high.color.y = 1.0;
    EXPECT_EQ(compare(image, truths).color.maximum, 0.125);
    image.at(0, 0).z = std::numeric_limits<float>::quiet_NaN();
    error = compare(image, truths);
    EXPECT_EQ(error.color.maximum, std::numeric_limits<double>::infinity());
    EXPECT_EQ(error.color.rms, std::numeric_limits<double>::infinity());
    EXPECT_THROW(compare(Image(5, 5), truths), Error);
}

}  // namespace
}  // namespace cellproj
