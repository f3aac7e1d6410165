// SPDX-License-Identifier: BSD-3-Clause
//
// Pictures of the CPU backend: against closed forms, against the judge (render/judge), against the OpenGL backend, and against
// themselves with other threads, instruction sets and cameras.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/piece_table.hpp"
#include "classify/segment_method.hpp"
#include "mesh/error.hpp"
#include "render/cpu/kernels.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace cpu_renderer_test {

using testing_support::chord_in_unit_cube;
using testing_support::constant_medium;
using testing_support::delaunay_mesh;
using testing_support::grid_mesh;
using testing_support::linear;
using testing_support::max_difference;
using testing_support::point_field;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::unit_tet;
using testing_support::view_of_unit_cube;
using scenes::waves;

using Projection = Camera::Projection;
constexpr ImageSize small{96, 96};
constexpr bool sanitized = CELLPROJ_SANITIZED;

Renderer& cpu() {
    static const auto shared = make_renderer(Backend::cpu);
    return *shared;
}

// Six coloured peaks of half width .01: most cells hold a node, many hold several.
TransferFunction peaks(double extinction = 20.0) { return scenes::peaks(0, 1, 20 / extinction); }

// The worst channel over a sample of the picture.
ImageError error_of(const Scene& scene, const Reference& judge, const Camera& camera, ImageSize size, const Quality& quality,
                    std::size_t pixels) {
    const Image image = cpu().render(scene, camera, size, quality);
    return compare(image, judge.pixels(camera, size, judge.sample(camera, size, pixels)));
}

TEST(CpuRenderer, AConstantMediumFollowsItsClosedForm) {
    const double extinction = 1.7;
    for (const bool on_cells : {false, true}) {
        TetMesh mesh = grid_mesh(6, 0.2);
        ScalarField field = point_field(mesh, [](const glm::dvec3&) { return 0.5; });
        if (on_cells) {
            field.location = FieldLocation::cells;
            field.values.assign(mesh.tets.size(), 0.5);
        }
        const Scene scene = scene_of(std::move(mesh), std::move(field), constant_medium(extinction));
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            const Camera camera = view_of_unit_cube(projection);
            const ScreenTransform transform(camera, small);
            Statistics statistics;
            const Image image = cpu().render(scene, camera, small, {}, &statistics);
            EXPECT_EQ(statistics.backend, "cpu");
            EXPECT_GT(statistics.counts.fragments, 10000U);
            double largest = 0;
            for (int y = 0; y < small.height; ++y)
                for (int x = 0; x < small.width; ++x) {
                    const auto ray = transform.ray({x + 0.5, y + 0.5});
                    const double chord = chord_in_unit_cube(ray, projection == Projection::perspective).length();
                    const double alpha = 1 - std::exp(-extinction * chord);
                    const glm::vec4 pixel = image.at(x, y);
                    for (const double error : {pixel.a - alpha, pixel.r - alpha, pixel.g - 0.5 * alpha, pixel.b - 0.25 * alpha})
                        largest = std::max(largest, std::isnan(error) ? 1e9 : std::abs(error));
                }
            // Some 30 roundings of float32 along a ray; points rounded to 1e-7 of the mesh: 2e-6 with this extinction.
            EXPECT_LT(largest, 5e-6) << on_cells;
        }
    }
}

// Rays along edges and in faces: a front view of a structured mesh has many. Each belongs to one cell, no more and no less.
TEST(CpuRenderer, RaysAlongEdgesAreInOneCell) {
    const std::pair<int, double (*)(const glm::dvec3&)> fields[]{{2, [](const glm::dvec3& p) { return p.z; }}, {4, waves}};
    const ImageSize size{33, 33};  // the middle column and row, and diagonals, are seen along edges
    for (const auto& [boxes, field] : fields) {
        const Scene scene = scene_of(grid_mesh(boxes), field, ramp());
        const Reference judge(scene);
        for (const Projection projection : {Projection::parallel, Projection::perspective})
            for (const glm::dvec3& from : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 1), glm::dvec3(-1, 0, 0), glm::dvec3(-1, 1, 1)}) {
                const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, projection, from, {0, 1, 0}, 1.0);
                for (const bool by_pixel : {false, true}) {
                    const Image image = cpu().render(scene, camera, size, {.order_per_pixel = by_pixel});
                    const ImageError error = compare(image, judge.pixels(camera, size, all_pixels(size)));
                    // As in other views.
                    EXPECT_LT(error.color.maximum, 1e-5) << boxes << " " << from.x << " " << from.y << " " << from.z << " " << by_pixel;
                    EXPECT_LT(error.opacity.maximum, 1e-5);
                }
            }
    }
}

class AgainstTheJudge : public testing::Test {
protected:
    // The Delaunay mesh of the issue, smaller under the sanitizers.
    static const TetMesh& mesh() {
        static const TetMesh shared = delaunay_mesh(sanitized ? 3000 : 31000);
        return shared;
    }
    static Scene scene(TransferFunction transfer) {
        static const auto shared = std::make_shared<TetMesh>(mesh());
        static const auto field = std::make_shared<ScalarField>(point_field(*shared, waves));
        return {shared, field, std::make_shared<TransferFunction>(std::move(transfer))};
    }
    static std::shared_ptr<const RayIndex> index(const Scene& scene) {
        static const auto shared = Reference(scene).shared_index();
        return shared;
    }
    static ImageSize size() { return sanitized ? ImageSize{128, 128} : ImageSize{512, 512}; }
    static std::size_t samples() { return sanitized ? 300 : 1500; }
    static Camera inside() {
        Camera camera = view_of_unit_cube(Projection::perspective);
        camera.eye = {0.31, 0.42, 0.53};
        camera.center = {0.9, 0.8, 0.6};
        camera.fov_y_degrees = 70;
        return camera;
    }
};

// One test, for the mesh takes longest. The bars are those that the backend was asked to keep.
TEST_F(AgainstTheJudge, RampPeaksAndExactStayWithinTheirBars) {
    struct Bar {
        const char* method;
        TransferFunction transfer;
        double rms, largest;
    };
    const TransferFunction a_ramp(OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.4}, {1, 4.0}});
    for (const Bar& bar : {Bar{"integral", a_ramp, 3e-4, 3e-3}, Bar{"integral", peaks(), 8e-4, 1.5e-2}, Bar{"exact:1e-5", peaks(), 1e-4, 1e-4}}) {
        const Scene s = scene(bar.transfer);
        const Reference judge(s, index(s));
        for (const Camera& camera : {view_of_unit_cube(Projection::parallel), view_of_unit_cube(Projection::perspective), inside()}) {
            const ImageError error = error_of(s, judge, camera, size(), {.method = parse_method(bar.method)}, samples());
            std::printf("%s: RMS %.1e, max %.1e\n", bar.method, error.color.rms, largest(error));
            EXPECT_LT(error.color.rms, bar.rms) << bar.method;
            EXPECT_LT(largest(error), bar.largest) << bar.method;
        }
    }
}

TEST(CpuRendererOrder, PixelsThatSortThemselvesAreRightOnAnyMesh) {
    // Three slats in a cycle, each in front of the next one: no order of the cells is right.
    TetMesh mesh;
    const double pi = std::acos(-1.0);
    for (int i = 0; i < 3; ++i) {
        const auto turned = [&](const glm::dvec3& p) {
            const double a = 2 * pi * i / 3;
            return glm::dvec3(p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z);
        };
        const auto first = static_cast<VertexId>(mesh.points.size());
        for (const glm::dvec3& p : {glm::dvec3(-1, 0.3, -0.3), glm::dvec3(-1, 0.5, -0.3), glm::dvec3(1, 0.4, 0.3), glm::dvec3(1, 0.4, 0.5)})
            mesh.points.push_back(turned(p));
        mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    orient_cells(mesh);
    const Scene slats = scene_of(mesh, [](const glm::dvec3& p) { return 0.5 + 0.3 * p.x + 0.2 * p.y; }, peaks(60));

    // A non-convex mesh: a jittered grid with most of its boxes taken out.
    TetMesh holes = grid_mesh(7, 0.2);
    std::mt19937 random(3);
    std::vector<std::array<VertexId, 4>> kept;
    for (std::size_t i = 0; i < holes.tets.size(); i += 5)
        if (random() % 3 == 0) kept.insert(kept.end(), holes.tets.begin() + static_cast<std::ptrdiff_t>(i), holes.tets.begin() + static_cast<std::ptrdiff_t>(i) + 5);
    holes.tets = kept;
    const Scene sponge = scene_of(holes, waves, peaks(60));

    const ImageSize size = sanitized ? ImageSize{56, 56} : ImageSize{128, 128};
    for (const Scene& scene : {slats, sponge}) {
        const Reference judge(scene);
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            const Camera camera = frame_bounds(bounds(scene.mesh->points), projection, {0.2, 0.1, 1}, {0, 1, 0}, 1.0);
            Statistics statistics;
            const Image image = cpu().render(scene, camera, size, {.order_per_pixel = true}, &statistics);
            EXPECT_EQ(statistics.order, "pixel");
            // With a slack of 1/512 pixel for silhouettes, where a chord may jump. `integral` errs by up to 2e-4 a segment.
            const ImageError error = compare(image, judge.picture(camera, size, rasterizer_slack));
            EXPECT_GT(error.pixels, 100U);
            EXPECT_LT(largest(error), 1e-3);
        }
    }
}

TEST(CpuRendererOrder, BothOrdersGiveTheSamePicture) {
    const Scene scene = scene_of(grid_mesh(12, 0.2), waves, peaks());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image by_cells = cpu().render(scene, camera, {200, 150}, {});
    const Image by_pixels = cpu().render(scene, camera, {200, 150}, {.order_per_pixel = true});
    // Segments thinner than the rounding of float32 may change places.
    EXPECT_LT(max_difference(by_cells, by_pixels), 1e-5);
}

TEST(CpuRenderer, AnyNumberOfThreadsGivesTheSameBits) {
    const Scene scene = scene_of(grid_mesh(sanitized ? 8 : 16, 0.2), waves, peaks());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    for (const bool by_pixels : {false, true}) {
        const Quality quality{.order_per_pixel = by_pixels};
        const Image one = make_renderer(Backend::cpu, {.threads = 1})->render(scene, camera, {300, 200}, quality);
        for (const int threads : {2, 5}) {
            const Image many = make_renderer(Backend::cpu, {.threads = threads})->render(scene, camera, {300, 200}, quality);
            EXPECT_TRUE(one.pixels == many.pixels) << threads;
        }
    }
}

TEST(CpuRenderer, CountsWrongNeighboursUnlessToldNotTo) {
    const Scene scene = scene_of(grid_mesh(4, 0.2), waves, ramp());
    for (const bool asked : {true, false}) {
        Statistics statistics;
        cpu().render(scene, view_of_unit_cube(Projection::perspective), small, {.check_neighbours = asked}, &statistics);
        EXPECT_EQ(statistics.counts.order_violations, asked ? std::optional<std::size_t>(0) : std::nullopt);
        EXPECT_TRUE(statistics.order_exact);  // as the sorter says
    }
}

TEST(CpuRenderer, EveryInstructionSetGivesTheSamePicture) {
    const std::vector<std::string> sets = cpu::instruction_sets();
    ASSERT_FALSE(sets.empty());
    for (const Quality& quality : {Quality{}, Quality{.method = parse_method("exact:1e-5")}, Quality{.order_per_pixel = true}})
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            const Scene scene = scene_of(grid_mesh(6, 0.2), waves, peaks());
            cpu::use_instruction_set(sets.front());
            const Image best = cpu().render(scene, view_of_unit_cube(projection), small, quality);
            for (const std::string& set : sets) {
                cpu::use_instruction_set(set);
                EXPECT_EQ(cpu::instruction_set(), set);
                // Fragments are the same bits: a rounding of a scalar, 6e-8, would change the extinction of these peaks by 1e-4. Their light
                // is summed in another order, and rounded otherwise where nothing is fused: 3e-7.
                EXPECT_LT(max_difference(cpu().render(scene, view_of_unit_cube(projection), small, quality), best), 1e-6) << set;
            }
            cpu::use_instruction_set(sets.front());
        }
}

// The same pictures as the OpenGL backend's, where a shift by its grid of 1/512 pixel changes nothing: the mask leaves out pixels
// whose neighbours differ by more than a tenth, the silhouettes and the edges of peaks.
TEST(CpuRenderer, AgreesWithOpenGl) {
    const auto gl = make_renderer(Backend::gl_osmesa);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::size_t compared = 0;
    for (int i = 0; i < (sanitized ? 4 : 20); ++i) {
        const Scene scene = scene_of(grid_mesh(3 + i % 5, 0.2, static_cast<std::uint64_t>(i) + 1), waves, i % 2 ? ramp() : peaks(4));
        const auto projection = i % 3 ? Projection::perspective : Projection::parallel;
        const Camera camera = view_of_unit_cube(projection, {uniform(random), uniform(random), 0.5 * uniform(random)});
        const Image a = cpu().render(scene, camera, small, {}), b = gl->render(scene, camera, small, {});
        for (int y = 1; y + 1 < small.height; ++y)
            for (int x = 1; x + 1 < small.width; ++x) {
                glm::vec4 low = b.at(x, y), high = low;
                for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
                    low = glm::min(low, b.at(x + dx, y + dy));
                    high = glm::max(high, b.at(x + dx, y + dy));
                }
                const glm::vec4 spread = high - low;
                if (std::max({spread.x, spread.y, spread.z, spread.w}) > 0.1F) continue;
                ++compared;
                for (int k = 0; k < 4; ++k) ASSERT_NEAR(a.at(x, y)[k], b.at(x, y)[k], 2e-3) << i << ": " << x << ", " << y;
            }
    }
    EXPECT_GT(compared, sanitized ? 5000U : 40000U);
}

// Every method that finds light per pixel, against OpenGL on one cell, where no order and no shared silhouettes matter.
TEST(CpuRenderer, DrawsEveryMethodPerPixel) {
    const auto gl = make_renderer(Backend::gl_osmesa);
    const Scene scene = scene_of(unit_tet(), [](const glm::dvec3& p) { return 0.1 + p.x - 0.3 * p.y + 0.6 * p.z; }, ramp());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    for (const char* name : {"average", "average:half", "homogeneous", "linear:9", "stein", "preint2d:32", "preint2d-exp:32", "preint3d:16",
                             "preint3d:16:linear", "integral", "exact:1e-5"}) {
        const Quality quality{.method = parse_method(name)};
        ASSERT_TRUE(draws(Backend::cpu, quality));
        const Image a = cpu().render(scene, camera, small, quality), b = gl->render(scene, camera, small, quality);
        double sum = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            for (int k = 0; k < 4; ++k) sum += std::pow(a.pixels[i][k] - b.pixels[i][k], 2);
        // OpenGL's grid of 1/256 of a pixel moves silhouettes; all pixels together hardly change.
        EXPECT_LT(std::sqrt(sum / static_cast<double>(4 * a.pixels.size())), 5e-4) << name;
        EXPECT_GT(std::count_if(a.pixels.begin(), a.pixels.end(), [](const glm::vec4& p) { return p.a > 0.05F; }), 300) << name;
    }
}

// The kernels' light of segments against the float64 model of the same method (classify/segment_method.hpp), by every instruction
// set, over smooth transfer functions: where a function bends within 1/4095, rounding a scalar to float32 tells more. Optical depths
// up to 30.
TEST(CpuLight, EveryMethodAgreesWithItsFloat64Model) {
    constexpr double longest = 2.0, mean = 0.3;
    const TransferFunction density(OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {0.4, {0.9, 0.1, 0.3}}, {1, {1.0, 0.6, 0.0}}},
                                   {{0, 0.1}, {0.5, 3.0}, {0.8, 15.0}, {1, 0.5}});
    const TransferFunction emitter(OpticalModel::emitter, {{0, {0.1, 0.0, 0.9}}, {1, {0.4, 0.6, 0.0}}}, {{0, 0.0}, {0.6, 0.0}, {1, 9.0}});
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<float> s_f, s_b, length;
    for (int i = 0; i < 2003; ++i) {
        s_f.push_back(i < 2 ? static_cast<float>(i) : uniform(random));
        s_b.push_back(i % 5 == 0 ? s_f.back() : i % 7 == 0 ? 1.0F : uniform(random));
        length.push_back(i % 11 == 0 ? 0.0F : static_cast<float>(longest * std::pow(10.0, -4.0 * uniform(random))));
    }
    std::vector<glm::vec4> light(s_f.size());
    for (const std::string& set : cpu::instruction_sets()) {
        cpu::use_instruction_set(set);
        for (const char* name : {"average", "average:half", "homogeneous", "stein", "linear:1", "linear:9", "preint2d:64", "preint2d:32:uint8",
                                 "preint2d-exp:64", "preint2d-exp:33:float16", "preint3d:32", "preint3d:16:linear", "preint3d:16:uint8"})
            for (const TransferFunction* transfer : {&density, &emitter}) {
                const Method method = parse_method(name);
                const auto model = make_segment_method(method, *transfer, longest, mean);
                cpu::MethodTables tables(method, *transfer, longest, mean);
                EXPECT_EQ(tables.bytes, model->table_bytes()) << name;
                const cpu::Shading shading{.tables = &tables, .half_opacity = method.blending == Blending::half};
                cpu::light_of_segments(shading, false, s_f, s_b, length, light);
                double largest = 0;
                for (std::size_t i = 0; i < light.size(); ++i) {
                    const Light truth = model->light(s_f[i], s_b[i], length[i]);
                    for (int k = 0; k < 4; ++k) {
                        const double error = std::abs(light[i][k] - (k < 3 ? truth.color[k] : truth.opacity));
                        largest = std::max(largest, std::isnan(error) ? 1e9 : error);
                    }
                }
                EXPECT_LT(largest, 1e-5) << name << ", " << set;
            }
        for (const TransferFunction* transfer : {&density, &emitter}) {  // one scalar: the short path
            const Method method = parse_method("exact:1e-6");
            const auto model = make_segment_method(method, *transfer, longest, mean);
            const PieceTable table = make_piece_table(*transfer);
            const cpu::PieceArrays pieces(method, table, walk_limits(method, table, longest));
            cpu::light_of_segments({.pieces = &pieces}, true, s_f, s_f, length, light);
            for (std::size_t i = 0; i < light.size(); ++i) {
                const Light truth = model->light(s_f[i], s_f[i], length[i]);
                for (int k = 0; k < 4; ++k) ASSERT_NEAR(light[i][k], k < 3 ? truth.color[k] : truth.opacity, 3e-6) << i << ", " << set;
            }
        }
    }
    cpu::use_instruction_set(cpu::instruction_sets().front());
}

// Nothing infinite, nothing negative, opacity within 0..1, whatever the extinction.
TEST(CpuLight, ExtremesStayFinite) {
    std::vector<float> s_f, s_b, length;
    for (const float s : {0.0F, 0.49999F, 0.5F, 0.50001F, 1.0F})
        for (const float t : {0.0F, 0.5F, 1.0F})
            for (const float l : {0.0F, 1e-38F, 1e-12F, 1.0F, 2.0F, 1e30F}) {
                s_f.push_back(s);
                s_b.push_back(t);
                length.push_back(l);
            }
    std::vector<glm::vec4> light(s_f.size());
    for (const double extinction : {0.0, 1e-30, 1.0, 1e15, 1e38})
        for (const OpticalModel model : {OpticalModel::density, OpticalModel::emitter}) {
            const TransferFunction transfer(model, {{0, {0, 1, 1}}, {1, {1, 0, 1}}}, {{0, 0}, {0.5, 0}, {0.5, extinction}, {1, extinction}});
            for (const char* name : {"average", "average:half", "homogeneous", "stein", "linear:5", "preint2d:16", "preint2d-exp:16", "preint3d:8",
                                     "preint3d:8:linear"}) {
                const Method method = parse_method(name);
                const cpu::MethodTables tables(method, transfer, 2.0, 0.3);
                cpu::light_of_segments({.tables = &tables, .half_opacity = method.blending == Blending::half}, false, s_f, s_b, length, light);
                for (const glm::vec4& l : light) {
                    for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(l[k]) && l[k] >= 0.0F) << name << ", " << extinction;
                    ASSERT_LE(l.w, 1.0F) << name;
                }
            }
            const PieceTable table = make_piece_table(transfer);
            const cpu::PieceArrays pieces({}, table, walk_limits({}, table, 2.0));
            cpu::light_of_segments({.pieces = &pieces}, true, s_f, s_f, length, light);
            for (const glm::vec4& l : light)
                for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(l[k]) && l[k] >= 0.0F) << "constant, " << extinction;
        }
}

TEST(CpuRenderer, RefusesWhatItDoesNotDraw) {
    const Scene scene = scene_of(unit_tet(), linear, ramp());
    for (const Quality& quality : {Quality{.method = parse_method("shirley-tuchman")}, Quality{.method = parse_method("average:vertices")},
                                   Quality{.target = TargetFormat::rgba8}}) {
        EXPECT_FALSE(draws(Backend::cpu, quality));
        EXPECT_THROW(cpu().render(scene, view_of_unit_cube(Projection::parallel), small, quality), Error);
    }
}

// Constant cells against the same field on points of cells that share none.
TEST(CpuRenderer, CellFieldsAreConstantInTheirCells) {
    TetMesh apart;
    const TetMesh mesh = grid_mesh(5, 0.2);
    ScalarField on_cells{.name = "s", .location = FieldLocation::cells, .values = {}}, on_points{.name = "s", .location = FieldLocation::points, .values = {}};
    std::mt19937 random(2);
    for (const auto& tet : mesh.tets) {
        const double value = static_cast<double>(random() % 1000) / 999;
        on_cells.values.push_back(value);
        const auto first = static_cast<VertexId>(apart.points.size());
        for (const VertexId v : tet) {
            apart.points.push_back(mesh.points[v]);
            on_points.values.push_back(value);
        }
        apart.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
        const Camera camera = view_of_unit_cube(projection);
        const Image a = cpu().render(scene_of(mesh, on_cells, ramp()), camera, small, {.order_per_pixel = true});
        const Image b = cpu().render(scene_of(apart, on_points, ramp()), camera, small, {.order_per_pixel = true});
        EXPECT_LT(max_difference(a, b), 1e-5);
    }
}

TEST(CpuRenderer, ScaleAndPlaceDoNotMatter) {
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const Image plain = cpu().render(scene_of(grid_mesh(6, 0.2), waves, peaks()), camera, small, {});
    for (const double scale : {1e-12, 1e12}) {
        TetMesh mesh = grid_mesh(6, 0.2);
        const ScalarField field = point_field(mesh, waves);
        for (glm::dvec3& p : mesh.points) p *= scale;
        Camera scaled = camera;
        scaled.eye *= scale;
        scaled.center *= scale;
        const Image image = cpu().render(scene_of(mesh, field, peaks(20 / scale)), scaled, small, {});
        EXPECT_LT(max_difference(image, plain), 1e-4) << scale;  // points and extinctions are rounded anew
    }
    TetMesh mesh = grid_mesh(6, 0.2);
    const ScalarField field = point_field(mesh, waves);
    const glm::dvec3 far_away(1e6, -2e6, 3e6);
    for (glm::dvec3& p : mesh.points) p += far_away;
    Camera moved = camera;
    moved.eye += far_away;
    moved.center += far_away;
    // float64 points 3e6 away are multiples of 5e-10.
    EXPECT_LT(max_difference(cpu().render(scene_of(mesh, field, peaks()), moved, small, {}), plain), 1e-4);
}

TEST(CpuRenderer, SliversFlatCellsAndHugeExtinctionsStayFinite) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    TetMesh mesh;
    for (int i = 0; i < 400; ++i) {
        const auto first = static_cast<VertexId>(mesh.points.size());
        const glm::dvec3 a(uniform(random), uniform(random), uniform(random));
        const double flat = std::pow(10.0, -16 * uniform(random));
        for (int k = 0; k < 4; ++k)
            mesh.points.push_back(i % 7 == 0 ? a : a + glm::dvec3(uniform(random), uniform(random) * (i % 3 ? 1 : flat), uniform(random) * flat));
        mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    orient_cells(mesh);
    for (const double extinction : {1e-8, 1.0, 1e8, 1e15})
        for (const Projection projection : {Projection::parallel, Projection::perspective})
            for (const bool by_pixels : {false, true}) {
                Camera camera = frame_bounds(bounds(mesh.points), projection, {0.3, 0.2, 0}, {0, 0, 1}, 1.0);
                if (by_pixels) camera.eye = {1.0, 0.5, 0.02};  // amid the cells
                const Image image = cpu().render(scene_of(mesh, [](const glm::dvec3& p) { return p.x; }, peaks(extinction)), camera, small,
                                                 {.order_per_pixel = by_pixels});
                EXPECT_EQ(count_non_finite(image), 0U);
                for (const glm::vec4& p : image.pixels) {
                    ASSERT_GE(std::min({p.x, p.y, p.z, p.w}), 0.0F);
                    ASSERT_LE(std::max({p.x, p.y, p.z, p.w}), 1.00001F);
                }
            }
}

TEST(CpuRenderer, ThousandsOfNodesAndBlocksOfPieces) {
    std::vector<ExtinctionNode> nodes;
    for (int i = 0; i <= 3000; ++i) nodes.push_back({i / 3000.0, i % 2 ? 6.0 : 0.5});
    const Scene scene = scene_of(grid_mesh(4, 0.2), waves, TransferFunction(OpticalModel::density, ramp().color_nodes(), nodes));
    const Reference judge(scene);
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const ImageError error = error_of(scene, judge, camera, small, {}, 500);
    EXPECT_LT(largest(error), 2e-3);  // classify/README.md: 5e-4 a segment
}

TEST(CpuRenderer, PicturesLargerThanARegionHaveNoSeams) {
    const Scene scene = scene_of(grid_mesh(3, 0.2), waves, ramp());
    Camera camera = view_of_unit_cube(Projection::parallel);
    const ImageSize large = sanitized ? ImageSize{1100, 40} : ImageSize{2100, 1100};
    Statistics statistics;
    const Image image = cpu().render(scene, camera, large, {}, &statistics);
    EXPECT_EQ(statistics.counts.drawn, scene.mesh->tets.size());  // each counted once
    const Reference judge(scene);
    EXPECT_LT(largest(compare(image, judge.pixels(camera, large, judge.sample(camera, large, 1000)))), 2e-5);
}

// A tenth of a degree: the corners of the cells lie 100,000 pixels away.
TEST(CpuRenderer, AStrongZoomKeepsItsDigits) {
    const Scene scene = scene_of(grid_mesh(3, 0.2), waves, ramp());
    const Reference judge(scene);
    Camera camera = view_of_unit_cube(Projection::perspective);
    camera.fov_y_degrees = 0.1;
    const ImageError error = error_of(scene, judge, camera, small, {}, 300);
    EXPECT_GT(error.pixels, 200U);
    EXPECT_LT(largest(error), 2e-5);  // positions are rounded to 1e-7 of the mesh
}

TEST(CpuRenderer, OpaqueScenesStopEarly) {
    const TetMesh mesh = grid_mesh(sanitized ? 14 : 20, 0.2);
    const Camera camera = view_of_unit_cube(Projection::perspective);
    Statistics thin, thick;
    cpu().render(scene_of(mesh, waves, constant_medium(0.01)), camera, {256, 256}, {}, &thin);
    cpu().render(scene_of(mesh, waves, constant_medium(200)), camera, {256, 256}, {}, &thick);
    EXPECT_LT(thick.counts.fragments, thin.counts.fragments / 2);
}

TEST(CpuRenderer, AnotherTransferFunctionIsSeenAtOnce) {
    const Scene first = scene_of(grid_mesh(5, 0.2), waves, peaks());
    Scene second = first;
    second.transfer = std::make_shared<TransferFunction>(ramp());
    const Camera camera = view_of_unit_cube(Projection::perspective);
    const auto renderer = make_renderer(Backend::cpu);
    renderer->render(first, camera, small, {});
    const Image changed = renderer->render(second, camera, small, {});
    const Image fresh = make_renderer(Backend::cpu)->render(second, camera, small, {});
    // The order may be another one of those that are right, as it follows the one before: sums differ by rounding.
    for (std::size_t i = 0; i < fresh.pixels.size(); ++i)
        for (int channel = 0; channel < 4; ++channel) ASSERT_NEAR(changed.pixels[i][channel], fresh.pixels[i][channel], 1e-6) << i;
}

}  // namespace
}  // namespace cellproj
