// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in OpenGL against the judge, which finds them in float64 (ray_surfaces.hpp): planes, layers, surfaces in a medium; isovalues
// that points, faces and cells have; and that no ray loses a surface or meets one twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <random>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "apps/scenes/sphere_flow.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "render/surface_vertex.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace gl_surfaces_test {

using namespace testing_support;

// Rasterizers move points to a grid of 1/256 of a pixel: in smaller pictures that is more of the scene.
constexpr ImageSize usual_size{64, 64};
constexpr double slack = 1.0 / 512;

// A layer of opacity .1 too many or too few in front of white changes a pixel by 1e-1; behind 50 of them, by 5e-4.
constexpr double one_layer = 1e-3;

Renderer& gl() {
    static const auto renderer = make_renderer(Backend::gl_osmesa);
    return *renderer;
}

Scene unlit(Scene scene, std::vector<IsoSurface> list) { return with_surfaces(std::move(scene), std::move(list), Shading::unlit); }

std::vector<IsoSurface> layers(int count, double opacity, ScalarRange values = {0, 1}) {
    std::vector<IsoSurface> list;
    for (int i = 0; i < count; ++i)
        list.push_back({values.low + (values.high - values.low) * (i + 0.5) / count, {1, 0.5, 0.25}, opacity, {}});
    return list;
}

// Three of them, two-coloured, under two lights.
Scene three_in(Scene scene, double opacity, Shading shading) {
    const Lighting lighting{.lights = {{.towards = glm::dvec3(1, -2, 2)}, {.diffuse = 0.3, .specular = 0.5}}};
    return with_surfaces(std::move(scene),
                         {{0.3, {0.2, 0.9, 0.4}, opacity, {}},
                          {0.5, {1, 0, 0}, opacity / 2 + (opacity == 1 ? 0.5 : 0.0), glm::dvec3(0, 0, 1)},
                          {0.75, {0.5, 0.5, 0.5}, opacity, {}}},
                         shading, lighting);
}

// The picture, and how far it lies outside of what its pixels may be.
struct Judged {
    std::size_t pixels = 0, wrong = 0;  // by more than one_layer
    double largest = 0;                 // of all channels
    Statistics statistics;
};

// Of all pixels; sanitizers slow the judge down: of every ninth.
ViewJudge<Reference> view_of(const Scene& scene, const Camera& camera, ImageSize size) {
    std::vector<PixelId> pixels = all_pixels(size);
    if (CELLPROJ_SANITIZED) std::erase_if(pixels, [&](const PixelId& pixel) { return (pixel.x + size.width * pixel.y) % 9 != 4; });
    return {Reference(scene), camera, size, slack, pixels};
}

Judged judge(const Scene& scene, const ViewJudge<Reference>& view, const Camera& camera, ImageSize size, const Quality& quality) {
    Judged result;
    const Image image = gl().render(scene, camera, size, quality, &result.statistics);
    for (const PixelTruth& pixel : view.truths_for(image, 1e-6)) {  // below all bounds asked for
        const glm::dvec4 error = error_of_pixel(image, pixel);
        const double worst = std::max({error.r, error.g, error.b, error.a});
        ++result.pixels;
        result.wrong += worst > one_layer;
        result.largest = std::max(result.largest, worst);
    }
    return result;
}

Judged judge(const Scene& drawn, const Scene& truth, const Camera& camera, ImageSize size = usual_size) {
    return judge(drawn, view_of(truth, camera, size), camera, size, {});
}

Judged judge(const Scene& scene, const Camera& camera, ImageSize size = usual_size) { return judge(scene, scene, camera, size); }

Camera from_above(double height = 1) {
    return {.projection = Camera::Projection::parallel, .eye = {0.5, 0.5, 9}, .center = {0.5, 0.5, 0}, .up = {0, 1, 0}, .height = height};
}

Camera inside_of_cube() { return {.eye = {0.4, 0.45, 0.5}, .center = {0.9, 0.8, 0.6}, .up = {0, 0, 1}, .fov_y_degrees = 70}; }

class GlSurfacesOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(GlSurfaces, GlSurfacesOfEither, testing_support::either_projection, testing_support::name_of_projection);

// k layers of opacity a: 1 − (1 − a)^k. The judge's own count is proven elsewhere (ray_surfaces_test); float32 composes 20 within 1e-6.
// Values between the points', and those of the points of a regular grid.
TEST_P(GlSurfacesOfEither, TwentyLayersOfATenth) {
    const Camera camera = view_of_unit_cube(GetParam(), {-2, -0.8, -0.7});
    for (const double jitter : {0.0, 0.2}) {
        for (const double shift : {0.0, 0.5 / 20}) {
            std::vector<IsoSurface> list = layers(20, 0.1);
            for (IsoSurface& surface : list) surface.value += shift;
            const Scene scene = unlit(scene_of(grid_mesh(7, jitter, 5), linear, nothing()), list);
            EXPECT_LT(judge(scene, camera).largest, 2e-6) << jitter << " " << shift;
        }
    }
}

// Of a linear field both shadings have the exact normal; what is left is float32 in the light, specular with exponent 20 included.
TEST_P(GlSurfacesOfEither, OfALinearFieldAreLitPlanes) {
    for (const double opacity : {1.0, 0.5}) {
        for (const Shading shading : {Shading::flat, Shading::smooth}) {
            const Scene scene = three_in(scene_of(grid_mesh(5, 0.2, 3), linear, nothing()), opacity, shading);
            for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(-1, -0.4, 2)})
                EXPECT_LT(judge(scene, view_of_unit_cube(GetParam(), from)).largest, 2e-5);
        }
    }
}

// Depth, to 1e-5 of the box: a medium so dense that 1e-5 of its length changes the light by 1e-5, in front of planes.
TEST_P(GlSurfacesOfEither, LieWhereTheJudgeHasThem) {
    const TransferFunction fog(OpticalModel::density, {{0, {1.0, 0.5, 0.25}}}, {{0, 1.0}});
    const Scene scene = unlit(scene_of(grid_mesh(5, 0.2, 8), linear, fog), layers(6, 1));
    for (const glm::dvec3& from : {glm::dvec3(1.3, -2.1, 0.9), glm::dvec3(-1, -0.4, 2)})
        EXPECT_LT(judge(scene, view_of_unit_cube(GetParam(), from)).largest, 2e-5);
}

// A method's own error in the medium alone is what it has here, too: segments that are cut are shorter. On top come the sides of the
// mesh, which are where the rasterizer has their points. Issue 7 asks for 2e-3.
TEST_P(GlSurfacesOfEither, InAMediumByEveryMethod) {
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene medium = scene_of(grid_mesh(5, 0.2, 4), linear, ramp());
    const auto alone = view_of(medium, camera, usual_size);
    for (const double opacity : {1.0, 0.5}) {
        const Scene scene = three_in(medium, opacity, Shading::smooth);
        const auto view = view_of(scene, camera, usual_size);
        for (const char* name : {"integral", "exact:1e-5", "linear:8", "homogeneous", "stein", "average", "preint2d:128", "preint2d-exp:256",
                                 "preint3d:64", "preint3d:64:linear"}) {
            const Quality quality{.method = parse_method(name)};
            const double own = judge(medium, alone, camera, usual_size, quality).largest;
            EXPECT_LT(judge(scene, view, camera, usual_size, quality).largest, 1.1 * own + 2e-4) << name;
        }
    }
}

// Extinction over another field; where that has no value, there is nothing, and no surface.
TEST_P(GlSurfacesOfEither, InAMediumOfTwoFields) {
    const Camera camera = view_of_unit_cube(GetParam());
    Scene scene = three_in(scene_of(grid_mesh(5, 0.2, 4), linear, ramp()), 0.5, Shading::smooth);
    for (const double hole : {0.5, std::nan("")}) {
        ScalarField other = point_field(*scene.mesh, [](const glm::dvec3& p) { return p.z * (1 - p.x) + 0.1 * p.y; });
        other.values[100] = hole;
        scene.opacity_field = std::make_shared<ScalarField>(other);
        for (const char* name : {"integral", "linear:16"}) {
            const auto view = view_of(scene, camera, usual_size);
            EXPECT_LT(judge(scene, view, camera, usual_size, {.method = parse_method(name)}).largest, 1e-3) << name << hole;
        }
    }
}

// Many pieces: the method that walks through them in blocks is asked several times in a fragment.
TEST_P(GlSurfacesOfEither, InAMediumOfManyPieces) {
    std::vector<ExtinctionNode> extinction;
    std::vector<ColorNode> color;
    for (int i = 0; i <= 200; ++i) {
        extinction.push_back({i / 200.0, i % 2 ? 3.0 : 0.5});
        color.push_back({i / 200.0, {0.5 + 0.5 * std::sin(0.3 * i), 0.5, 0.2}});
    }
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene scene = three_in(scene_of(grid_mesh(4, 0.2, 6), linear, {OpticalModel::density, color, extinction}), 0.5, Shading::unlit);
    const auto view = view_of(scene, camera, usual_size);
    for (const char* name : {"integral", "exact:1e-5"})
        EXPECT_LT(judge(scene, view, camera, usual_size, {.method = parse_method(name)}).largest, 1e-3) << name;
}

// Any scalars: what the cells' faces say decides, and no linear field hides a mistake. Where surfaces fold, the moved points show in
// single pixels (OfTheBluntFin).
TEST_P(GlSurfacesOfEither, OfNoise) {
    std::mt19937_64 random(5);
    const Scene noise = scene_of(grid_mesh(8, 0.2, 3), [&](const glm::dvec3&) { return static_cast<double>(random() % 1000) / 1000; }, nothing());
    Scene medium = noise;
    medium.transfer = std::make_shared<TransferFunction>(ramp());
    for (const Scene& scene : {unlit(noise, layers(20, 0.1)), with_surfaces(noise, layers(3, 1), Shading::flat),
                               with_surfaces(noise, layers(3, 1), Shading::smooth), with_surfaces(medium, layers(3, 0.5), Shading::smooth)}) {
        const Judged judged = judge(scene, view_of_unit_cube(GetParam()));
        EXPECT_LE(judged.wrong, judged.pixels / 500);
    }
}

// A coarse Delaunay mesh: at its sides lie cells a thousandth as thick as they are long, where a place 1/512 of a pixel beside another one is
// of quite other weights of the cell's points: gradients that are told at a scalar's place in the mesh and taken from the moved one
// are off by up to .3 here, a fifth of all pixels by 1e-3. Of the camera inside, the near plane cuts a cell.
TEST_P(GlSurfacesOfEither, InSlivers) {
#ifdef CELLPROJ_MESHER_PROGRAM
    const Scene bare = scene_of(delaunay_mesh(300), scenes::waves, nothing());
    const ImageSize size{48, 48};
    Camera inside = inside_of_cube();
    inside.projection = GetParam();
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside}) {
        const auto error = [&](double opacity, Shading shading) { return judge(three_in(bare, opacity, shading), camera, size).largest; };
        EXPECT_LT(error(0.4, Shading::unlit), 2e-6);
        // One gradient for a cell: float32 in the light, its exponent of 20 included. Cells of a thousandth's thickness cost it two digits.
        EXPECT_LT(error(0.4, Shading::flat), 1e-4);
        // Points are moved each its own way, which the judge's four rays do not tell: in cells of some pixels, 1/512 of one is up to 1e-3 of the
        // way from gradient to gradient. Measured: 5e-4.
        EXPECT_LT(error(0.4, Shading::smooth), 1e-3);
        EXPECT_LT(error(1, Shading::smooth), 1e-3);
        Scene medium = bare;
        medium.transfer = std::make_shared<TransferFunction>(ramp());
        EXPECT_LT(judge(three_in(medium, 0.4, Shading::smooth), camera, size).largest, 1e-3);
    }
#else
    GTEST_SKIP() << "no mesher";
#endif
}

TEST(GlSurfaces, AroundACameraInside) {
    const auto quadratic = [](const glm::dvec3& p) { return glm::dot(p - 0.5, p - 0.5); };
    Scene scene = scene_of(grid_mesh(9, 0.2, 3), quadratic, nothing());
    EXPECT_LT(judge(unlit(scene, layers(20, 0.1, {0.02, 0.75})), inside_of_cube()).largest, 1e-4);
    EXPECT_LT(judge(with_surfaces(scene, layers(5, 1, {0.02, 0.75}), Shading::flat), inside_of_cube()).largest, 1e-3);
    scene.transfer = std::make_shared<TransferFunction>(constant_medium(2));
    EXPECT_LT(judge(with_surfaces(scene, layers(5, 0.5, {0.02, 0.75}), Shading::smooth), inside_of_cube()).largest, 1e-3);
}

TEST(GlSurfaces, OfTheFlowAroundASphere) {
#ifdef CELLPROJ_MESHER_PROGRAM
    const TetMesh mesh = make_sphere_flow_mesh();
    const Scene flow = scene_of(mesh, point_field(mesh, sphere_pressure_coefficient), sphere_flow_transfer_function());
    const Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::perspective, {-0.6, -1.5, 0.9}, {0, 0, 1}, 1);
    for (const double opacity : {1.0, 0.4}) {
        const Scene scene = with_surfaces(flow,
                                          {{-0.6, {1, 0.2, 0.1}, opacity, {}},
                                           {-0.2, {0.2, 1, 0.1}, opacity, glm::dvec3(0.9, 0.9, 0)},
                                           {0.3, {0.2, 0.3, 1}, opacity, {}}},
                                          Shading::smooth);
        EXPECT_LT(judge(scene, camera, {80, 80}).largest, 2e-3) << opacity;
    }
#else
    GTEST_SKIP() << "no mesher";
#endif
}

// Isovalues that points have, and thereby edges and faces; rays from above run along edges of the boxes' diagonals. A surface counts as
// lying 2⁻²¹ of the range below its isovalue (prepared_surfaces.hpp), so the truth is that of such surfaces: where a ray touches a scalar and
// turns back, and where it enters the mesh at one, the rule of classify/isosurface.hpp leaves either open to rounding.
TEST(GlSurfaces, AtTheValuesOfPoints) {
    std::mt19937_64 random(31);
    std::size_t pixels = 0, wrong = 0;
    for (int trial = 0; trial < 6; ++trial) {
        const double scale = std::vector{1.0, 1e-12, 1e12}[static_cast<std::size_t>(trial) / 2];
        const Scene bare = scene_of(grid_mesh(6, trial % 2 ? 0.2 : 0, random()),
                                    [&](const glm::dvec3&) { return scale * static_cast<double>(random() % 4); }, nothing());
        const auto at = [&](double shift) {
            std::vector<IsoSurface> list;
            for (const double v : {0.0, 1.0, 1.5, 2.0, 3.0}) list.push_back({scale * (v - shift), {1, 1, 1}, 0.1, {}});
            return unlit(bare, list);
        };
        for (const auto& [camera, size] : {std::pair(from_above(), ImageSize{24, 24}),
                                           {from_above(), {23, 23}},
                                           {view_of_unit_cube(Camera::Projection::perspective, {1, 1, 1}), {33, 33}},
                                           {view_of_unit_cube(Camera::Projection::parallel), {48, 48}}}) {
            const Judged judged = judge(at(0), at(3 * 0x1p-21), camera, size);
            pixels += judged.pixels;
            wrong += judged.wrong;
        }
    }
    // From (1, 1, 1) the grid's planes are seen edge-on: their points, moved to the rasterizer's grid, lie in no plane.
    EXPECT_LE(wrong, pixels / 5000) << pixels;
}

TEST(GlSurfaces, AtTheValuesOfFacesAndCells) {
    const Camera top{.eye = {0.5, 0.5, 2.5}, .center = {0.5, 0.5, 0.5}, .up = {0, 1, 0}};
    std::vector<IsoSurface> planes;
    for (int i = 0; i <= 6; ++i) planes.push_back({i / 6.0, {1, 1, 1}, 0.1, {}});
    const Scene faces = unlit(scene_of(grid_mesh(6), [](const glm::dvec3& p) { return p.z; }, nothing()), planes);
    for (const Camera& camera : {from_above(), top, view_of_unit_cube(Camera::Projection::perspective)})
        EXPECT_LT(judge(faces, camera).largest, 2e-6);
    EXPECT_LT(judge(faces, from_above(), {24, 24}).largest, 2e-6);
    // Half of the boxes at .5, the others below, or above; a layer of .5 in what is below.
    for (const auto f : {+[](const glm::dvec3& p) { return std::min(p.z, 0.5); }, +[](const glm::dvec3& p) { return std::max(p.z, 0.5); },
                         +[](const glm::dvec3& p) { return p.z == 0.5 || p.z == 0.25 ? 0.5 : 0.0; }}) {
        const Scene cells = unlit(scene_of(grid_mesh(4), f, nothing()), {{0.5, {1, 1, 1}, 0.1, {}}});
        for (const Camera& camera : {from_above(), top, view_of_unit_cube(Camera::Projection::perspective)})
            EXPECT_LT(judge(cells, camera).largest, 2e-6);
    }
}

// Between the two diagonals of a square lies a flat cell: the scalar jumps there, and the surface is drawn with it.
TEST(GlSurfaces, LieInFlatCells) {
    TetMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}, {0.5, 0.5, -1}};
    mesh.tets = {{0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 3, 5}, {1, 2, 3, 5}, {0, 1, 2, 3}};
    orient_cells(mesh);
    const Scene scene =
        unlit(scene_of(mesh, ScalarField{"s", FieldLocation::points, {1, 0, 1, 0, 1, 0}}, nothing()), {{0.5, {1, 1, 1}, 0.1, {}}});
    for (const Camera& camera : {from_above(), from_above(1.3), view_of_unit_cube(Camera::Projection::perspective)})
        EXPECT_LT(judge(scene, camera, {31, 31}).largest, 2e-6);
}

// Cells in a cycle are drawn as pieces, whose new corners are moved by themselves.
TEST(GlSurfaces, InACyclicMesh) {
    const TetMesh mesh = cyclic_ring(7);
    const ScalarField field = point_field(mesh, [](const glm::dvec3& p) { return p.x + 0.3 * p.y - 0.6 * p.z; });
    const Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::parallel, {0, 0, 1}, {0, 1, 0}, 1);
    const Judged judged = judge(unlit(scene_of(mesh, field, constant_medium(0.5)), layers(20, 0.1, range(field.values))), camera);
    EXPECT_LE(judged.wrong, judged.pixels / 1000);
    EXPECT_GT(judged.statistics.counts.split_cells, 0U);
}

// 20 surfaces through 187,395 cells of a real flow: a pixel is what some ray sees through points that lie up to 1/512 of a pixel
// beside their places, each its own way. Where a surface folds, the four rays of the judge's slack are too few to tell.
TEST(GlSurfaces, OfTheBluntFin) {
    const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    TetMesh mesh = tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"}));
    const ScalarField field = select_scalar(mesh, "Density", "bluntfin");
    std::vector<IsoSurface> list;
    for (int i = 1; i <= 20; ++i) list.push_back({quantile(field.values, i / 21.0), {1, 0.5, 0}, 0.1, {}});
    const Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::perspective, {-0.6, -1.5, 0.9}, {0, 0, 1}, 1);
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{16, 16} : ImageSize{160, 160};
    const Scene scene = unlit(scene_of(std::move(mesh), field, nothing()), list);
    const Image image = gl().render(scene, camera, size);
    const Reference reference(scene);
    const auto seen_around = [&](const PixelTruth& truth) {
        const double opacity = image.at(truth.pixel.x, truth.pixel.y).a;
        for (int i = 0; i < 24; ++i) {
            const double angle = glm::radians(45.0 * i), distance = i < 8 ? 1.0 / 512 : i < 16 ? 1.0 / 400 : 1.0 / 300;
            const glm::dvec2 place = glm::dvec2(truth.pixel.x, truth.pixel.y) + 0.5 + distance * glm::dvec2(std::cos(angle), std::sin(angle));
            if (std::abs(reference.light(reference.index().ray(camera, size, place)).opacity - opacity) < 1e-6) return true;
        }
        return false;
    };
    std::size_t folds = 0;
    for (const PixelTruth& truth : reference.picture(camera, size, slack)) {
        if (error_of_pixel(image, truth).a < 1e-6) continue;
        ++folds;
        EXPECT_TRUE(seen_around(truth)) << truth.pixel.x << " " << truth.pixel.y;
    }
    EXPECT_LE(folds, 5U);
}

TEST(GlSurfaces, KeepTheirPlaceAtAnyScaleAndFarAway) {
    for (const auto& [scale, offset] : {std::pair(1e-12, 0.0), {1e12, 0.0}, {1.0, 1e6}}) {
        TetMesh mesh = grid_mesh(4, 0.2, 6);
        for (glm::dvec3& p : mesh.points) p = scale * p + glm::dvec3(offset);
        const Bounds box = bounds(mesh.points);
        const auto f = [scale = scale, offset = offset](const glm::dvec3& p) { return scale * linear((p - offset) / scale); };
        std::vector<IsoSurface> list = layers(9, 0.3);
        for (IsoSurface& surface : list) surface.value *= scale;
        Scene scene = scene_of(std::move(mesh), f, constant_medium(1.0 / scale));
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            Camera camera = frame_bounds(box, projection, {1.3, -2.1, 0.9}, {0, 0, 1}, 1);
            EXPECT_LT(judge(with_surfaces(scene, list, Shading::smooth), camera).largest, 1e-4) << scale << " " << offset;
            // From a thousand sizes away, through a narrow lens.
            camera.eye = camera.center + 500.0 * (camera.eye - camera.center);
            camera.fov_y_degrees /= 500.0;
            EXPECT_LT(judge(with_surfaces(scene, list, Shading::smooth), camera).largest, 1e-4) << scale << " " << offset << " far";
        }
    }
}

double max_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (int k = 0; k < 4; ++k) largest = std::max(largest, static_cast<double>(std::abs(a.pixels[i][k] - b.pixels[i][k])));
    }
    return largest;
}

// Without a medium opaque surfaces need no order. The picture is that of the sorted way, which a medium too thin to see brings about.
TEST(GlSurfaces, OpaqueOnesAloneAreNotSorted) {
    const auto waves = [](const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(9 * p.x) * std::sin(8 * p.y) * std::sin(7 * p.z); };
    const Scene alone = three_in(scene_of(grid_mesh(9, 0.2, 2), waves, nothing()), 1, Shading::smooth);
    Scene in_medium = alone;
    in_medium.transfer = std::make_shared<TransferFunction>(constant_medium(1e-12));
    for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
        const Camera camera = view_of_unit_cube(projection);
        Statistics statistics, sorted;
        const Image image = gl().render(alone, camera, {96, 96}, {}, &statistics);
        const Image same = gl().render(in_medium, camera, {96, 96}, {}, &sorted);
        EXPECT_LT(max_difference(image, same), 1e-6);
        EXPECT_EQ(statistics.order, "none");
        EXPECT_NE(sorted.order, "none");
        EXPECT_EQ(sorted.counts.drawn, 3645U);
        EXPECT_LT(statistics.counts.drawn, 3300U);  // only cells that are crossed
    }
}

// Cells of a medium that is not seen are left out unless a surface crosses them.
TEST(GlSurfaces, OnlyWhatIsCrossedOrSeenIsDrawn) {
    const TransferFunction upper(OpticalModel::density, {{0, {1.0, 0.5, 0.25}}}, {{0.8, 0}, {0.81, 3}});
    const Scene medium = scene_of(grid_mesh(8, 0.2, 2), linear, upper);
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    Statistics plain, with_one;
    gl().render(medium, camera, usual_size, {}, &plain);
    const Judged judged = judge(unlit(medium, {{0.4, {1, 1, 1}, 0.5, {}}}), camera);
    EXPECT_LT(judged.largest, 1e-4);
    EXPECT_GT(judged.statistics.counts.drawn, plain.counts.drawn);
    EXPECT_LT(judged.statistics.counts.drawn, 2000U);  // of 2560
}

TEST(GlSurfaces, OutsideTheRangeChangeNothing) {
    const Scene scene = scene_of(grid_mesh(4), linear, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    EXPECT_LT(judge(unlit(scene, {{-1}, {0.0}, {1.5}, {1e300}, {-1e300}}), scene, camera).largest, 1e-4);
    const Scene nothing_there = unlit(scene_of(grid_mesh(4), linear, nothing()), {{-1}, {1.5}});
    Statistics statistics;
    const Image image = gl().render(nothing_there, camera, {16, 16}, {}, &statistics);
    EXPECT_EQ(statistics.counts.drawn, 0U);
    for (const glm::vec4& pixel : image.pixels) EXPECT_EQ(pixel, glm::vec4(0.0F));
}

TEST(GlSurfaces, LeaveOutCellsThatAreNotFinite) {
    TetMesh mesh = grid_mesh(5);
    ScalarField field = point_field(mesh, linear);
    field.values[40] = std::nan("");
    const Scene scene = unlit(scene_of(mesh, field, nothing()), layers(9, 0.2));
    EXPECT_LT(judge(scene, view_of_unit_cube(Camera::Projection::parallel)).largest, 2e-6);
}

// What was prepared for one scene must not show in the next.
TEST(GlSurfaces, ChangeBetweenPictures) {
    const Scene scene = scene_of(grid_mesh(4, 0.2, 1), linear, ramp());
    Scene thin = scene;
    thin.transfer = std::make_shared<TransferFunction>(nothing());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const Image plain = gl().render(scene, camera, {48, 48});
    for (const Scene& next : {three_in(scene, 0.5, Shading::smooth), three_in(thin, 1, Shading::smooth), three_in(thin, 1, Shading::unlit),
                              three_in(scene, 1, Shading::flat), three_in(thin, 0.5, Shading::flat)})
        EXPECT_LT(judge(next, camera, {48, 48}).largest, 5e-4);
    EXPECT_EQ(max_difference(gl().render(scene, camera, {48, 48}), plain), 0);
}

TEST(GlSurfaces, LightsOfEveryKind) {
    const auto waves = [](const glm::dvec3& p) { return 0.5 + 0.5 * std::sin(5 * p.x) * std::sin(4 * p.y + p.z); };
    for (const Lighting& lighting : {Lighting{},
                                     {.lights = {}},
                                     {.ambient = {0, 0.3, 0}, .exponent = 3, .two_sided = false},
                                     {.two_sided = false, .lights = {{.towards = glm::dvec3(1e200, 0, 1e200), .color = {0, 1, 2}}}},
                                     {.exponent = 100, .lights = {{.towards = glm::dvec3(-1, 0, 0)}, {.towards = glm::dvec3(0, 1e-200, 0)}, {}}}}) {
        const Scene scene = with_surfaces(scene_of(grid_mesh(6, 0.2, 3), waves, nothing()), layers(4, 0.5), Shading::smooth, lighting);
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective})
            EXPECT_LT(judge(scene, view_of_unit_cube(projection)).largest, 1e-3);
    }
}

TEST(GlSurfaces, AreRefusedWithWhatKnowsNoPlaceInASegment) {
    const Scene scene = unlit(scene_of(grid_mesh(2), linear, ramp()), {{0.5}});
    const auto refused = [&](const Scene& refused_scene, const char* method) {
        try {
            gl().prepare(refused_scene, {.method = parse_method(method)});
        } catch (const Error& error) {
            return error.kind() == ErrorKind::option;
        }
        return false;
    };
    for (const char* method : {"shirley-tuchman", "linear:4:vertices", "average:half"}) EXPECT_TRUE(refused(scene, method)) << method;
    Scene none = scene;
    none.surfaces = std::make_shared<SurfaceScene>();
    EXPECT_FALSE(refused(none, "average:half"));
    const Scene on_cells = unlit(scene_of(*scene.mesh, ScalarField{"c", FieldLocation::cells, std::vector<double>(scene.mesh->tets.size())}, ramp()),
                                         {{0.5}});
    EXPECT_TRUE(refused(on_cells, "integral"));
}

// The bits of a face depend on its corners alone.
TEST(GlSurfaces, FacesAreTheSameForBothCells) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int trial = 0; trial < 200; ++trial) {
        std::array<FaceCorner, 3> corners;
        const double extent = std::pow(10, 3 * any(random));
        for (FaceCorner& c : corners)
            c = {glm::round(256.0 * extent * glm::dvec2(any(random), any(random))) / 256.0, any(random), any(random)};
        if (trial % 10 == 0) corners[2].position = corners[1].position;
        const SurfaceFace face = make_surface_face(corners, {64, 64});
        for (const auto& order : {std::array{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
            std::array<FaceCorner, 3> other;
            for (std::size_t i = 0; i < 3; ++i) other[i] = corners[static_cast<std::size_t>(order[i])];
            const SurfaceFace same = make_surface_face(other, {64, 64});
            EXPECT_EQ(std::memcmp(&face, &same, sizeof face), 0);
        }
        for (const float x : {face.nearness[0], face.nearness[1], face.nearness[2], face.scalar[0], face.scalar[1], face.scalar[2]})
            EXPECT_TRUE(std::isfinite(x));
    }
}

// In float64 the map gives the corners' gradients back; flat cells have their mean.
TEST(GlSurfaces, GradientsAreLinearInACell) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto vector = [&] { return glm::dvec3(any(random), any(random), any(random)); };
    for (int trial = 0; trial < 100; ++trial) {
        const double scale = std::pow(10, 100 * any(random));
        std::array<glm::dvec3, 4> places{vector(), vector(), vector(), vector()}, gradients{vector(), vector(), vector(), vector()};
        for (glm::dvec3& g : gradients) g *= scale;
        const AffineMap<glm::dvec3> map = make_gradient_map(places, gradients);
        const double factor = glm::length(map.at(places[0])) / (glm::length(gradients[0] / scale) * scale);
        EXPECT_GT(factor, 0);
        for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(glm::length(map.at(places[i]) - factor * gradients[i]), 1e-6);  // thin cells
        places[3] = (places[0] + places[1] + places[2]) / 3.0;
        const AffineMap<glm::dvec3> flat = make_gradient_map(places, gradients);
        EXPECT_LT(glm::length(flat.at(vector()) - factor * 0.25 * (gradients[0] + gradients[1] + gradients[2] + gradients[3])), 1e-6);
    }
    EXPECT_EQ(glm::length(make_gradient_map({}, {}).at({1, 2, 3})), 0);
}

}  // namespace
}  // namespace cellproj
