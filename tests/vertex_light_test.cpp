// SPDX-License-Identifier: BSD-3-Clause
//
// Light at the vertices of the classical split: exact where it is computed, and as wrong in between as linear
// interpolation is.
#include "classify/vertex_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <random>
#include <string>

#include "classify/half_opacity.hpp"
#include "classify/segment_integral.hpp"
#include "classify/segment_method.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/layers.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace vertex_light_test {

using testing_support::Chord;
using testing_support::chord_in_first_cell;
using testing_support::chord_in_unit_cube;
using testing_support::constant_medium;
using testing_support::distance;
using testing_support::grid_mesh;
using testing_support::point_field;
using testing_support::view_along_z;

constexpr ImageSize odd{97, 97};
const Method shirley_tuchman{.kind = MethodKind::shirley_tuchman};

Renderer& renderer() {
    static const auto shared = make_renderer(Backend::gl_osmesa);
    return *shared;
}

TransferFunction ramp(double steepness = 1) {
    return {OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.2}, {1, 4.0 * steepness}}};
}

// ---- The light at the thick vertex, in float64.

TEST(ShirleyTuchman, IsExactInAConstantMedium) {
    for (const double extinction : {0.0, 1e-9, 0.3, 7.0, 1e8}) {
        for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
            const TransferFunction transfer(model, {{0, {1, 0.5, 0.25}}}, {{0, extinction}});
            const auto method = make_segment_method(shirley_tuchman, transfer, 2, 1);
            for (const double length : {0.0, 1e-12, 0.01, 2.0}) {
                const Light exact = integrate_segment(transfer, 0.2, 0.7, length);
                EXPECT_LT(distance(method->light(0.2, 0.7, length), exact), 1e-12) << extinction << " " << length;
            }
        }
    }
}

// τ linear: the opacity is exact; κ linear: the colour lacks self-attenuation, which is of second order in the depth.
TEST(ShirleyTuchman, OnALinearFunctionOnlyTheColourIsWrong) {
    const auto method = make_segment_method(shirley_tuchman, ramp(), 2, 1);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 2000; ++i) {
        const double s_f = unit(random), s_b = unit(random), length = unit(random);
        const Light exact = integrate_segment(ramp(), s_f, s_b, length), found = method->light(s_f, s_b, length);
        ASSERT_NEAR(found.opacity, exact.opacity, 1e-9);
        // Front and back are weighted by what shines through: the weights differ by a share D/2 of themselves, colours and
        // extinctions by |Δs|·(.9, 3.8): the first moment gives D·(D/12 + .3)·|Δs|.
        const double depth = mean_extinction(ramp(), s_f, s_b) * length;
        ASSERT_LT(distance(found, exact), depth * (depth / 12 + 0.35) * std::abs(s_f - s_b) + 1e-12);
    }
}

// What lies between the ends is not seen: that is its error, all of it.
TEST(ShirleyTuchman, MissesAPeakBetweenTheEnds) {
    const TransferFunction peak(OpticalModel::density, {{0, {1, 1, 1}}}, {{0.4, 0}, {0.5, 20}, {0.6, 0}});
    EXPECT_EQ(make_segment_method(shirley_tuchman, peak, 2, 1)->light(0.3, 0.7, 1).opacity, 0.0);
    EXPECT_NEAR(integrate_segment(peak, 0.3, 0.7, 1).opacity, 1 - std::exp(-5), 1e-9);
}

void expect_drawable(const Light& light) {
    EXPECT_TRUE(light.opacity >= 0 && light.opacity <= 1);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(std::isfinite(light.color[k]) && light.color[k] >= 0);
}

// Every function and segment of the extremes gives light that can be drawn.
TEST(VertexLight, ExtremesStayFinite) {
    std::vector<ExtinctionNode> spikes;
    for (int i = 0; i < 10000; ++i) spikes.push_back({i / 9999.0, i % 2 == 0 ? 0.0 : 1e8});
    const double half = 0.5, next = std::nextafter(0.5, 1.0);
    for (const auto& nodes : {std::vector<ExtinctionNode>{{0, 1e60}}, {{0, 0}, {1, 1e8}}, {{half, 0}, {half, 1e8}},
                              {{half, 0}, {next, 1e8}, {std::nextafter(next, 1.0), 0}}, spikes}) {
        for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
            const TransferFunction transfer(model, {{0, {1, 0, 1e60}}, {0.5, {0, 1, 0}}}, nodes);
            for (const char* name : {"shirley-tuchman", "average:vertices", "homogeneous:vertices", "linear:8:vertices"}) {
                const auto lighting = make_vertex_lighting(parse_method(name), transfer, 2, 0.1);
                for (const auto& [s_f, s_b] : {std::pair{half, half}, {half, next}, {next, half}, {0.0, 1.0}, {1.0, 0.0}, {-7.0, 1e30}}) {
                    for (const double length : {0.0, 1e-300, 1e-8, 1.0, 2.0, 1e9}) {
                        const VertexLight thick = lighting->at_thick_vertex(s_f, s_b, length);
                        expect_drawable(thick.light());
                        expect_drawable({lighting->color_at_silhouette(s_f, thick), 0});
                    }
                }
            }
        }
    }
}

// ---- Pictures of one cell.

// Two cells, thick at (.1, .05) in the first (a corner inside a triangle) and at (0, 0) in the second (edges cross).
TetMesh one_cell(bool edges_cross) {
    TetMesh mesh;
    mesh.points = edges_cross ? std::vector<glm::dvec3>{{-1, 0, 0}, {1, 0, 0}, {0, -1, 1}, {0, 1, 1}}
                              : std::vector<glm::dvec3>{{-1, -1, 0}, {1, -0.9, 0}, {0, 1, 0}, {0.1, 0.05, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    orient_cells(mesh);
    return mesh;
}

double linear(const glm::dvec3& p) { return 0.5 + 0.2 * p.x - 0.1 * p.y + 0.2 * p.z; }

Scene scene_of(TetMesh mesh, TransferFunction transfer) {
    auto field = std::make_shared<ScalarField>(point_field(mesh, linear));
    return {std::make_shared<TetMesh>(std::move(mesh)), std::move(field), std::make_shared<TransferFunction>(std::move(transfer))};
}

struct Ray {
    double length, s_front, s_back;
};

// The pixel's ray through the cell, against its four planes in float64.
std::optional<Ray> cast(const TetMesh& mesh, const ScreenTransform::Ray& ray) {
    const Chord chord = chord_in_first_cell(mesh, ray, false);
    if (chord.length() == 0) return std::nullopt;
    return Ray{chord.length(), linear(ray.origin + chord.enter * ray.direction), linear(ray.origin + chord.leave * ray.direction)};
}

// In a parallel view the length is linear between the vertices, from 0 on the silhouette to 1 at the thick vertex of these
// cells: so it is the share, and `expected(ray)` is known in closed form. Largest difference over the pixels.
template <class Expected>
double error_of_one_cell(bool edges_cross, const TransferFunction& transfer, const Quality& quality, double height,
                         Expected expected) {
    const TetMesh mesh = one_cell(edges_cross);
    Camera camera = view_along_z();
    camera.height = height;
    const Image image = renderer().render(scene_of(mesh, transfer), camera, odd, quality);
    const ScreenTransform transform(camera, odd);
    double largest = 0;
    int inside = 0;
    for (int y = 0; y < odd.height; ++y) {
        for (int x = 0; x < odd.width; ++x) {
            const auto ray = cast(mesh, transform.ray({x + 0.5, y + 0.5}));
            const Light light = ray ? expected(*ray) : Light{};
            const glm::vec4 p = image.at(x, y);
            largest = std::max(largest, distance({{p.x, p.y, p.z}, p.w}, light));
            inside += ray.has_value();
        }
    }
    EXPECT_GT(inside, 1000);
    return largest;
}

// The snapping of corners to 1/256 of a pixel moves a pixel by 1/512 of one, while the share grows by at most 1 over the
// 15 pixels or more between the silhouette and the thick vertex of the larger view.
constexpr double snapping = rasterizer_slack / 15 + 1e-5;

class EitherClass : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(VertexLight, EitherClass, testing::Values(false, true),
                         [](const auto& cross) { return cross.param ? "edges_cross" : "vertex_in_triangle"; });

TEST_P(EitherClass, OpacityIsLinearOnTheScreen) {
    const double extinction = 2, whole = 1 - std::exp(-extinction);
    for (const double height : {2.5, 0.03}) {  // the second one: triangles that reach far beyond the picture
        const double error = error_of_one_cell(GetParam(), constant_medium(extinction), {.method = shirley_tuchman}, height,
                                               [&](const Ray& ray) {
                                                   return Light{whole * ray.length * glm::dvec3(1, 0.5, 0.25), whole * ray.length};
                                               });
        EXPECT_LT(error, snapping) << height;
    }
}

// Against the truth 1 − e^(−Dt), the chord t·(1 − e^(−D)) is farthest off where e^(−Dt) = φ(D).
TEST_P(EitherClass, TheErrorIsThatOfTheChordOfTheExponential) {
    for (const double depth : {0.1, 0.5, 2.0, 10.0}) {
        const double whole = 1 - std::exp(-depth), t = -std::log(whole / depth) / depth;
        const double expected = 1 - std::exp(-depth * t) - whole * t;
        const double error = error_of_one_cell(GetParam(), constant_medium(depth), {.method = shirley_tuchman}, 2.5,
                                               [&](const Ray& ray) {
                                                   const double opacity = 1 - std::exp(-depth * ray.length);
                                                   return Light{opacity * glm::dvec3(1, 0.5, 0.25), opacity};
                                               });
        // Pixels meet the worst share to within 1/20 of it, where the error has its (flat) top.
        EXPECT_NEAR(error, expected, 0.02 * expected + depth * snapping) << depth;
    }
}

// Colour and opacity by themselves: where κ is linear, the interpolated colour is κ at the middle of the segment.
TEST_P(EitherClass, ShirleyTuchmanInterpolatesTheColourByItself) {
    const TransferFunction transfer(OpticalModel::density, {{0, {0, 0.2, 1}}, {1, {1, 0.4, 0}}}, {{0, 2}});
    const double whole = 1 - std::exp(-2.0);
    const double error = error_of_one_cell(GetParam(), transfer, {.method = shirley_tuchman}, 2.5, [&](const Ray& ray) {
        const double opacity = whole * ray.length;
        return Light{opacity * transfer.color((ray.s_front + ray.s_back) / 2), opacity};
    });
    EXPECT_LT(error, snapping);
}

// Gouraud: the associated colour of the thick vertex, by the method's own model, fades linearly.
TEST_P(EitherClass, GouraudInterpolatesTheAssociatedColour) {
    const Ray thick = *cast(one_cell(GetParam()), {glm::dvec3(GetParam() ? 0.0 : 0.1, GetParam() ? 0.0 : 0.05, 3), {0, 0, -1}});
    ASSERT_NEAR(thick.length, 1, 1e-12);
    for (const std::string name : {"average", "homogeneous", "linear:8"}) {
        const Light light = make_segment_method(parse_method(name), ramp(), 2, 1)->light(thick.s_front, thick.s_back, 1);
        const double error = error_of_one_cell(GetParam(), ramp(), {.method = parse_method(name + ":vertices")}, 2.5, [&](const Ray& ray) {
            return Light{light.color * ray.length, light.opacity * ray.length};
        });
        // Besides the snapping: these methods sample the function in float32 nodes of the field's own range.
        EXPECT_LT(error, snapping + 1e-4) << name;
    }
}

// Without extinction the light is proportional to the length, which is linear: nothing is approximated.
TEST_P(EitherClass, EmissionAloneIsExact) {
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.2, 0.1, 0.05}}}, {{0, 0}});
    const double error = error_of_one_cell(GetParam(), glow, {.method = shirley_tuchman}, 2.5, [&](const Ray& ray) {
        return Light{ray.length * glm::dvec3(0.2, 0.1, 0.05), 0};
    });
    EXPECT_LT(error, snapping);
}

// Under perspective and off the axis, the light at the thick vertex is still exact: a corner that projects to the centre of
// a pixel, over a triangle that is not perpendicular to the ray.
TEST(VertexLight, IsExactAtTheThickVertexUnderPerspective) {
    Camera camera{.eye = {0.3, -2, 1}, .center = {0, 0, 0.2}, .up = {0, 0, 1}};
    camera.fov_y_degrees = 70;
    const auto ray = ScreenTransform(camera, odd).ray({20.5, 30.5});
    TetMesh mesh;
    mesh.points = {ray.origin + 2.0 * ray.direction, ray.origin + 2.5 * ray.direction + glm::dvec3(0.5, 0.1, 0.6),
                   ray.origin + 3.0 * ray.direction + glm::dvec3(-0.9, 0, 0.4), ray.origin + 3.5 * ray.direction + glm::dvec3(0.2, -0.1, -0.8)};
    mesh.tets = {{0, 1, 2, 3}};
    orient_cells(mesh);
    const Ray thick = *cast(mesh, ray);
    const TransferFunction transfer(OpticalModel::density, {{0, {0, 0.2, 1}}, {1, {1, 0.4, 0}}}, {{0, 1}, {1, 2}});
    const Light light = make_segment_method(shirley_tuchman, transfer, 10, 1)->light(thick.s_front, thick.s_back, thick.length);
    const glm::vec4 p = renderer().render(scene_of(mesh, transfer), camera, odd, {.method = shirley_tuchman}).at(20, 30);
    ASSERT_GT(light.opacity, 0.3);
    EXPECT_LT(distance({{p.x, p.y, p.z}, p.w}, light), 1e-3);  // the snapped corner is 1/512 of a pixel away
}

// ---- Meshes.

double largest_error(const Image& image, const Camera& camera, const TransferFunction& transfer) {
    const ScreenTransform transform(camera, {image.width, image.height});
    double largest = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto ray = transform.ray({x + 0.5, y + 0.5});
            const Chord chord = chord_in_unit_cube(ray, transform.perspective());
            const auto s = [&](double t) { return linear(ray.origin + t * ray.direction); };
            const Light light = chord.length() > 0 ? integrate_segment(transfer, s(chord.enter), s(chord.leave), chord.length()) : Light{};
            const glm::vec4 p = image.at(x, y);
            largest = std::max(largest, distance({{p.x, p.y, p.z}, p.w}, light));
        }
    }
    return largest;
}

struct Errors {
    double ramp, peaks;
};

Errors errors_on_a_grid(int boxes, const Method& method) {
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::perspective, {1.3, -2.1, 0.9}, {0, 0, 1}, 1.0);
    const TransferFunction peaks(OpticalModel::density, {{0, {1, 0.5, 0.25}}},
                                 {{0.49, 0}, {0.5, 20}, {0.51, 0}, {0.59, 0}, {0.6, 20}, {0.61, 0}});
    const TetMesh mesh = grid_mesh(boxes, 0.2, 5);
    const auto error = [&](const TransferFunction& transfer) {
        return largest_error(renderer().render(scene_of(mesh, transfer), camera, odd, {.method = method}), camera, transfer);
    };
    return {error(ramp()), error(peaks)};
}

// Where the function is smooth, the chord of the exponential errs by D²/8 per cell, and their sum falls with the cells'
// size; where a peak is narrower than a cell, it is lost. Measured on 6, 12 and 24 boxes a side (classify/README.md); the
// bounds leave a tenth to other rounding.
TEST(VertexLight, TheErrorFallsWithTheCellsAndIsLargeOnPeaks) {
    struct Row {
        const char* method;
        std::array<Errors, 3> measured;
    };
    // A jump at D = 1 decides `average`'s errors by single pixels: compilers differ by more than a tenth there.
    const auto slack = [](const std::string& name) { return name.starts_with("average") ? 0.2 : 0.1; };
    for (const auto& [name, measured] : {Row{"shirley-tuchman", {{{0.0694, 0.787}, {0.0291, 0.595}, {0.0134, 0.221}}}},
                                         Row{"average:vertices", {{{0.1276, 0.856}, {0.0382, 0.704}, {0.0168, 0.217}}}},
                                         Row{"average:vertices:half", {{{0.1331, 0.787}, {0.0394, 0.583}, {0.0179, 0.200}}}},
                                         Row{"homogeneous:vertices", {{{0.0694, 0.787}, {0.0291, 0.595}, {0.0134, 0.221}}}},
                                         Row{"linear:8:vertices", {{{0.0694, 0.362}, {0.0291, 0.234}, {0.0134, 0.115}}}}}) {
        for (std::size_t i = 0; i < (CELLPROJ_SANITIZED ? 2 : 3); ++i) {
            const Errors found = errors_on_a_grid(6 << i, parse_method(name));
            EXPECT_NEAR(found.ramp, measured[i].ramp, slack(name) * measured[i].ramp) << name << " " << i;
            EXPECT_NEAR(found.peaks, measured[i].peaks, slack(name) * measured[i].peaks) << name << " " << i;
        }
    }
}

// A camera inside: cells cut by the near plane, triangles far larger than the picture.
TEST(VertexLight, ACameraInsideTheMesh) {
    Camera camera{.eye = {0.52, 0.47, 0.55}, .center = {0.9, 0.2, 0.7}, .up = {0, 0, 1}};
    camera.fov_y_degrees = 80;
    for (const double extinction : {1.0, 1e8}) {
        const TransferFunction transfer = constant_medium(extinction);
        const Image image = renderer().render(scene_of(grid_mesh(24), transfer), camera, odd, {.method = shirley_tuchman});
        for (const glm::vec4& p : image.pixels) {
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(p[k] >= 0 && p[k] <= 1.0001F);
        }
        // Around the eye lengths are far from linear on the screen: as wrong as one box there is deep. Measured .0115.
        if (extinction == 1.0) { EXPECT_LT(largest_error(image, camera, transfer), extinction * std::sqrt(3.0) / 24); }
    }
}

// Slivers extrapolate at pixel centres just outside; whatever the cells and the function, pixels stay in range.
TEST(VertexLight, SliversAndExtremesStayInRange) {
    std::mt19937_64 random(17);
    std::uniform_real_distribution<double> unit(-1, 1);
    TetMesh mesh;
    for (int i = 0; i < 2000; ++i) {
        const auto v = static_cast<VertexId>(mesh.points.size());
        const glm::dvec3 a(unit(random), unit(random), unit(random)), edge(unit(random), unit(random), unit(random));
        const double thin = std::pow(10.0, -4 - 4 * std::abs(unit(random)));
        for (const double along : {0.0, 0.3, 0.6, 1.0}) {
            mesh.points.push_back(a + along * edge + thin * glm::dvec3(unit(random), unit(random), unit(random)));
        }
        mesh.tets.push_back({v, v + 1, v + 2, v + 3});
    }
    orient_cells(mesh);
    for (const double steepness : {1.0, 1e8}) {
        const Image image = renderer().render(scene_of(mesh, ramp(steepness)), view_along_z(), odd, {.method = shirley_tuchman});
        for (const glm::vec4& p : image.pixels) {
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(p[k] >= 0 && p[k] <= 1.0001F);
        }
    }
}

// The three passes of WVG91 §3.2, in the fragment: of light for each pixel and of light at vertices.
TEST(VertexLight, HalfOpacityComesAfterTheInterpolation) {
    for (Method method : {parse_method("average"), parse_method("average:vertices"), shirley_tuchman}) {
        const Scene scene = scene_of(one_cell(true), ramp());
        const Image once = renderer().render(scene, view_along_z(), odd, {.method = method});
        method.blending = Blending::half;
        const Image half = renderer().render(scene, view_along_z(), odd, {.method = method});
        for (std::size_t i = 0; i < once.pixels.size(); ++i) {
            const glm::vec4 p = once.pixels[i], q = half.pixels[i];
            ASSERT_LT(distance({{q.x, q.y, q.z}, q.w}, half_opacity({{p.x, p.y, p.z}, p.w})), 1e-6);
        }
        EXPECT_GT(once.at(48, 48).w - half.at(48, 48).w, 0.1);
    }
}

}  // namespace
}  // namespace cellproj
