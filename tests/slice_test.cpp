// SPDX-License-Identifier: BSD-3-Clause
//
// Slices and caps: exact colours of linear fields, the judge, trilinear grids, holes, media before them, both backends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/annotation/color_bar.hpp"
#include "render/grid_renderer.hpp"
#include "render/plan.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/cut_scenes.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace slice_test {

using namespace testing_support;

using Planes = std::vector<HalfSpace>;

// Colours with a step, an edge and a slope that differ in each channel.
const auto colors = std::make_shared<const TransferFunction>(
    OpticalModel::density, std::vector<ColorNode>{{0, {0.1, 0.9, 0.3}}, {0.4, {0.9, 0.2, 0.3}}, {0.4, {0.2, 0.2, 0.9}}, {1, {1.0, 0.8, 0.1}}}, std::vector<ExtinctionNode>{{0, 0}});

Scene sliced(Scene scene, const Planes& planes, bool caps = false) {
    scene.slices = std::make_shared<const SliceScene>(
        cut_slices(*scene.mesh, *scene.field, scene.opacity_field.get(), slices_and_caps(planes, caps ? scene.clip.get() : nullptr), colors));
    return scene;
}

Scene clipped(Scene scene, const Planes& planes) {
    scene.clip = std::make_shared<const ClipRegion>(ClipRegion{planes});
    return scene;
}

Scene capped(const Scene& scene, const Planes& planes) { return sliced(clipped(scene, planes), {}, true); }

// In general place; along faces of the meshes; through points and edges of them, in a diagonal; across the view of the unit cube's cameras.
const Planes planes_of_tests{{{0.4, 0.5, 0.6}, {1, 2, -0.5}}, {{0.5, 0, 0}, {3, 0, 0}}, {{0.5, 0.5, 0.5}, {1e-200, 1e-200, 0}}, {{0.45, 0.5, 0.55}, {-1.3, 2.1, -0.9}}};

// How far along its ray a pixel sees the plane in the unit cube; nothing: not at all.
std::optional<double> to_slice(const ScreenTransform::Ray& ray, bool perspective, const HalfSpace& plane) {
    const Chord chord = chord_in_unit_cube(ray, perspective);
    const glm::dvec3 n = unit_normal(plane);
    const double t = glm::dot(n, plane.point - ray.origin) / glm::dot(n, ray.direction);
    return t >= chord.enter && t <= chord.leave ? std::optional(t) : std::nullopt;
}

// The light of a pixel's ray: a constant medium up to the slice, and the slice in the colour of the field there.
glm::dvec4 light_of(const ScreenTransform::Ray& ray, bool perspective, const HalfSpace& plane, double tau, const std::function<double(const glm::dvec3&)>& field) {
    const Chord chord = chord_in_unit_cube(ray, perspective);
    const auto slice = to_slice(ray, perspective, plane);
    const double length = slice ? *slice - chord.enter : chord.length(), a = -std::expm1(-tau * length);
    const glm::dvec3 medium(1.0, 0.5, 0.25);
    if (!slice) return {a * medium, a};
    return {a * medium + (1 - a) * *SliceColors(*colors).at(field(ray.origin + *slice * ray.direction)), 1};
}

double error_of(const Image& image, const Camera& camera, const HalfSpace& plane, double tau, const std::function<double(const glm::dvec3&)>& field) {
    const ScreenTransform transform(camera, {image.width, image.height});
    return error_but_for_snapping(image, [&](const glm::dvec2& p) { return light_of(transform.ray(p), transform.perspective(), plane, tau, field); });
}

GridScene grid_scene(Grid grid, const TransferFunction& transfer) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(transfer)};
}

GridScene sliced(GridScene scene, const Planes& planes, bool caps = false) {
    scene.slices = std::make_shared<const SliceScene>(SliceScene{slices_and_caps(planes, caps ? scene.clip.get() : nullptr), colors});
    return scene;
}

std::vector<GridRenderer*> grid_backends() {
    static const auto cpu = make_grid_renderer(Backend::cpu), gl = make_grid_renderer(Backend::gl_osmesa);
    return {cpu.get(), gl.get()};
}

std::size_t covered(const Image& image) {
    return static_cast<std::size_t>(std::ranges::count_if(image.pixels, [](const glm::vec4& p) { return p.a > 0; }));
}

class SlicesOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Slices, SlicesOfEither, either_projection, name_of_projection);

// Every pixel has the colour of the field at its ray's point, to the rounding of float32; those at the silhouette and at the colours' step
// one of both sides. In front of it the closed form of a constant medium: bounds as of clipped media.
TEST_P(SlicesOfEither, OfALinearFieldAreExact) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{20, 20} : ImageSize{48, 48};
    const Camera camera = view_of_unit_cube(GetParam());
    for (const HalfSpace& plane : planes_of_tests)
        for (const double tau : {0.0, 2.0})
            for (const double jitter : {0.0, 0.2}) {
                const Scene scene = sliced(scene_of(grid_mesh(4, jitter), linear, constant_medium(tau)), {plane});
                const double alone = 2e-7, cpu_error = tau > 0 ? 2e-6 : alone, gl_error = tau > 0 ? 2e-4 : alone;
                EXPECT_LT(error_of(to_image(Reference(scene).picture(camera, size), size), camera, plane, tau, linear), 2e-7);
                EXPECT_LT(error_of(cpu_backend().render(scene, camera, size), camera, plane, tau, linear), cpu_error);
                EXPECT_LT(error_of(cpu_backend().render(scene, camera, size, {.order_per_pixel = true}), camera, plane, tau, linear), cpu_error);
                EXPECT_LT(error_of(gl_backend().render(scene, camera, size), camera, plane, tau, linear), gl_error);
            }
}

// Two ways to one number: triangles of the cut against the cells along each ray. Fields on points and on cells, several planes, media,
// isosurfaces and bodies, an eye in the mesh.
TEST_P(SlicesOfEither, AgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{10, 10} : ImageSize{24, 24};
    const TetMesh mesh = delaunay_mesh(300);
    ScalarField of_cells{"c", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) of_cells.values.push_back(scenes::waves(mesh.points[tet[0]]));
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())})
        for (const bool medium : {false, true}) {
            const TransferFunction transfer = medium ? ramp() : nothing();
            Scene busy = with_bodies(scene_of(grid_mesh(6, 0.2), scenes::waves, transfer), {sphere({0.5, 0.3, 0.8}, 0.3, 12, {0.1, 0.8, 0.3})});
            busy.surfaces = three_surfaces(0.4, Shading::smooth);
            for (const Scene& scene : {scene_of(mesh, scenes::waves, transfer), scene_of(mesh, of_cells, transfer), busy}) {
                const Scene cut = sliced(scene, {planes_of_tests[0], planes_of_tests[3]});
                const Reference judge(cut);
                const auto truths = judge.picture(camera, size, scene.surfaces ? cpu_slack : 0);
                const double bound = 2 * cpu_bound(camera);  // an eye in a coarse mesh is in a large cell
                EXPECT_LT(largest(compare(cpu_backend().render(cut, camera, size), truths)), bound) << medium;
                EXPECT_LT(largest(compare(cpu_backend().render(cut, camera, size, {.order_per_pixel = true}), truths)), bound) << medium;
                EXPECT_TRUE(ViewJudge(judge, camera, size, rasterizer_slack).within(gl_backend().render(cut, camera, size), 2e-3)) << medium;
            }
        }
}

// Each face that a box cuts shows the field on it, as the slice by that plane does from where it was cut away; planes in sides of the mesh, too.
TEST_P(SlicesOfEither, CapsAreTheFacesOfWhatIsKept) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene whole = scene_of(grid_mesh(5, 0.2), linear, constant_medium(2));
    for (const Bounds& box : {Bounds{{0.2, 0.25, 0.1}, {0.7, 0.55, 0.9}}, Bounds{{0, 0, 0}, {1, 1, 1}}}) {
        const Scene scene = capped(whole, box_region(box).half_spaces);
        const ScreenTransform transform(camera, size);
        const auto truth = [&](const glm::dvec2& p) {
            const auto ray = transform.ray(p);
            // Of the box as of the unit cube.
            const glm::dvec3 edges = box.high - box.low;
            const Chord chord = chord_in_unit_cube({(ray.origin - box.low) / edges, ray.direction / edges}, transform.perspective());
            if (!(chord.length() > 0)) return glm::dvec4(0);
            return glm::dvec4(*SliceColors(*colors).at(linear(ray.origin + chord.enter * ray.direction)), 1);
        };
        EXPECT_LT(error_but_for_snapping(to_image(Reference(scene).picture(camera, size), size), truth), 2e-7);
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) EXPECT_LT(error_but_for_snapping(renderer->render(scene, camera, size), truth), 2e-7);
    }
    for (const HalfSpace& plane : {HalfSpace{{0.4, 0.5, 0.6}, {-1.3, 2.1, -0.9}}, HalfSpace{{0.5, 0.4, 0.5}, {0, 1, 0}}}) {  // the camera is where it was cut
        const Image cap = cpu_backend().render(capped(whole, {plane}), camera, size);
        const Image slice = cpu_backend().render(sliced(scene_of(grid_mesh(5, 0.2), linear, nothing()), {plane}), camera, size);
        EXPECT_GT(covered(slice), 200U);
        for (std::size_t i = 0; i < slice.pixels.size(); ++i) {
            if (slice.pixels[i].a == 0) continue;
            EXPECT_EQ(cap.pixels[i], slice.pixels[i]);
        }
    }
}

// Seen through what is kept; where a field on cells jumps in the plane, the cap has the kept side's.
TEST_P(SlicesOfEither, CapsFromBehindAndInJumps) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{12, 12} : ImageSize{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    const TetMesh mesh = grid_mesh(4);
    ScalarField of_cells{"c", FieldLocation::cells, {}};
    for (const auto& tet : mesh.tets) {
        double y = 0;
        for (const VertexId v : tet) y += 0.25 * mesh.points[v].y;
        of_cells.values.push_back(y < 0.5 ? 0.1 : 0.8);
    }
    for (const double direction : {1.0, -1.0})
        for (const TransferFunction& transfer : {nothing(), ramp()}) {
            const Scene scene = capped(scene_of(mesh, of_cells, transfer), {{{0, 0.5, 0}, {0, direction, 0}}});
            const auto truths = Reference(scene).picture(camera, size);
            EXPECT_LT(largest(compare(cpu_backend().render(scene, camera, size), truths)), cpu_bound(camera)) << direction;
            EXPECT_TRUE(ViewJudge(Reference(scene), camera, size, rasterizer_slack).within(gl_backend().render(scene, camera, size), 2e-3)) << direction;
            if (transfer.max_extinction(0, 1) > 0) continue;
            const glm::dvec3 kept = *SliceColors(*colors).at(direction > 0 ? 0.8 : 0.1);
            for (const PixelTruth& truth : truths) {
                if (truth.light.opacity == 0) continue;
                EXPECT_LT(glm::distance(truth.light.color, kept), 1e-14);
            }
        }
}

// Slices are of the field: what a region cuts away is cut away of them. Nearer ones hide others.
TEST_P(SlicesOfEither, AreClippedAndHideEachOther) {
    const ImageSize size{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene scene = scene_of(grid_mesh(4, 0.2), linear, ramp());
    for (const Scene& cut : {sliced(clipped(scene, {{{0.5, 0.5, 0.5}, {1, 0.3, 0}}}), planes_of_tests), sliced(clipped(scene, {{{0.5, 0.5, 0.5}, {1, 0.3, 0}}}), planes_of_tests, true)}) {
        EXPECT_LT(largest(compare(cpu_backend().render(cut, camera, size), Reference(cut).picture(camera, size))), cpu_bound(camera));
        EXPECT_TRUE(ViewJudge(Reference(cut), camera, size, rasterizer_slack).within(gl_backend().render(cut, camera, size), 2e-3));
    }
}

// A cell that touches a value which is not finite is a hole, of slices as of the medium.
TEST_P(SlicesOfEither, HaveHolesWhereTheFieldHas) {
    const ImageSize size{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    const TetMesh mesh = grid_mesh(4, 0.2);
    ScalarField field = point_field(mesh, linear);
    field.values[field.values.size() / 2] = std::numeric_limits<double>::quiet_NaN();  // in the middle
    for (const HalfSpace& plane : planes_of_tests) {
        const Scene scene = sliced(scene_of(mesh, field, nothing()), {plane}), whole = sliced(scene_of(mesh, linear, nothing()), {plane});
        const Image image = cpu_backend().render(scene, camera, size);
        EXPECT_LT(covered(image), covered(cpu_backend().render(whole, camera, size)));
        EXPECT_LT(largest(compare(image, Reference(scene).picture(camera, size))), 2e-7);
    }
}

// Beside the mesh, along the rays, through the eye, behind it: nothing, and no harm.
TEST_P(SlicesOfEither, WherePlanesAreHardest) {
    const ImageSize size{20, 20};
    const Camera camera = frame_bounds({glm::dvec3(0), glm::dvec3(1)}, GetParam(), {0, 0, 1}, {0, 1, 0}, 1.0);
    const glm::dvec3 eye = camera.eye;
    const Scene scene = scene_of(grid_mesh(3), linear, nothing());
    const GridScene grid = grid_scene(unit_cube(3, linear), nothing());
    const Planes unseen{{{0, 0, 1.5}, {0, 0, 1}}, {{0.5, 0.5, 0.5}, {1, 0, 0}}, {eye, {0, 0, 1}}, {eye + glm::dvec3(0, 0, 1), {0, 0, 1}}, {{1e300, 0, 0}, {1, 0, 0}}};
    for (const HalfSpace& plane : unseen) {
        for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) EXPECT_EQ(covered(renderer->render(sliced(scene, {plane}), camera, size)), 0U);
        for (GridRenderer* renderer : grid_backends()) EXPECT_EQ(covered(renderer->render(sliced(grid, {plane}), camera, size)), 0U);
    }
    // Sides of the mesh, from either.
    for (const double direction : {1.0, -1.0})
        for (const double z : {0.0, 1.0}) {
            const Planes side{{{0, 0, z}, {0, 0, direction}}};
            const std::size_t seen = covered(cpu_backend().render(sliced(scene, side), camera, size));
            EXPECT_GT(seen, 100U);
            EXPECT_EQ(covered(grid_backends()[0]->render(sliced(grid, side), camera, size)), seen);
        }
}

TEST_P(SlicesOfEither, AtAnyScaleAndPlace) {
    const ImageSize size{24, 24};
    const auto picture = [&](Renderer& renderer, double scale, const glm::dvec3& place) {
        TetMesh mesh = grid_mesh(4, 0.2);
        const ScalarField field = point_field(mesh, linear);
        for (glm::dvec3& p : mesh.points) p = scale * p + place;
        Camera camera = view_of_unit_cube(GetParam());
        for (glm::dvec3* p : {&camera.eye, &camera.center}) *p = scale * *p + place;
        camera.height *= scale;
        const HalfSpace plane{scale * planes_of_tests[0].point + place, planes_of_tests[0].normal};
        return renderer.render(sliced(scene_of(mesh, field, with_scaled_extinction(ramp(), 1 / scale)), {plane}), camera, size);
    };
    for (Renderer* renderer : {&cpu_backend(), &gl_backend()}) {
        const Image usual = picture(*renderer, 1, {0, 0, 0});
        for (const double scale : {1e-12, 1e12}) EXPECT_LT(max_difference(usual, picture(*renderer, scale, {0, 0, 0})), 2e-6) << scale;
        EXPECT_LT(max_difference(usual, picture(*renderer, 1, {1e6, -1e6, 1e6})), 1e-4);  // points there are multiples of 1e-10
    }
}

// ---- Regular grids

Grid uneven_grid(const std::function<double(const glm::dvec3&)>& f) {
    const auto axis = [](std::vector<double> x) { return GridAxis{std::move(x), std::nullopt}; };
    return grid_of({axis({0, 0.3, 0.5, 1}), axis({0, 0.5, 0.6, 0.9, 1}), axis({0, 0.1, 0.5, 1})}, f);
}

// The trilinear scalar, cells found one by one.
double trilinear(const Grid& grid, const glm::dvec3& p) {
    const GridDimensions n = grid.dimensions();
    for (std::size_t k = 0; k + 1 < n.nk; ++k)
        for (std::size_t j = 0; j + 1 < n.nj; ++j)
            for (std::size_t i = 0; i + 1 < n.ni; ++i) {
                const Bounds box = grid.cell_bounds({i, j, k});
                const glm::dvec3 u = (p - box.low) / (box.high - box.low);
                if (std::min({u.x, u.y, u.z}) >= -1e-12 && std::max({u.x, u.y, u.z}) <= 1 + 1e-12) return interpolate(grid.corner_values({i, j, k}), u);
            }
    return std::numeric_limits<double>::quiet_NaN();
}

TEST_P(SlicesOfEither, OfGridsAreTrilinearAtEveryPixel) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    const Grid grid = uneven_grid(scenes::waves);
    for (const HalfSpace& plane : planes_of_tests)
        for (const double tau : {0.0, 2.0}) {
            const GridScene scene = sliced(grid_scene(grid, constant_medium(tau)), {plane});
            for (GridRenderer* renderer : grid_backends())
                EXPECT_LT(error_of(renderer->render(scene, camera, size), camera, plane, tau, [&](const glm::dvec3& p) { return trilinear(grid, p); }), tau > 0 ? 5e-6 : 3e-7);
        }
}

// Flat colours of fields on cells, and holes of blanked cells; a plane in their faces shows those on the normal's side, or behind a hole the others.
TEST_P(SlicesOfEither, OfGridsOnCellsAndWithHoles) {
    const ImageSize size{40, 40};
    const Camera camera = view_of_unit_cube(GetParam());
    Grid grid = unit_cube(4, linear);
    grid.location = FieldLocation::cells;
    grid.values.assign(grid.cell_count(), 0);
    for (std::size_t c = 0; c < grid.values.size(); ++c) grid.values[c] = static_cast<double>(c) / static_cast<double>(grid.values.size());
    Grid holes = grid;
    holes.blanked.assign(grid.cell_count(), 0);
    holes.blanked[grid.cell_id({1, 1, 2})] = 1;
    for (const double direction : {1.0, -1.0}) {
        const HalfSpace plane{{0, 0.5, 0}, {0, direction, 0}};
        const auto side = [&](const Grid& of, const glm::dvec3& p) {
            const auto at = [](double x) { return std::min<std::size_t>(static_cast<std::size_t>(4 * x), 3); };
            const std::size_t near = direction > 0 ? 2 : 1, far = 3 - near;
            const GridCell cell{at(p.x), near, at(p.z)};
            return of.values[of.cell_id(of.is_blanked(cell) ? GridCell{cell[0], far, cell[2]} : cell)];
        };
        for (const Grid& of : {grid, holes})
            for (GridRenderer* renderer : grid_backends())
                EXPECT_LT(error_of(renderer->render(sliced(grid_scene(of, nothing()), {plane}), camera, size), camera, plane, 0, [&](const glm::dvec3& p) { return side(of, p); }), 2e-7);
    }
    const HalfSpace through{{0, 0.3, 0}, {0, 1, 0}};
    const std::size_t whole = covered(grid_backends()[0]->render(sliced(grid_scene(grid, nothing()), {through}), camera, size));
    const std::size_t rest = covered(grid_backends()[0]->render(sliced(grid_scene(holes, nothing()), {through}), camera, size));
    EXPECT_NEAR(static_cast<double>(whole - rest) / static_cast<double>(whole), 1.0 / 16, 0.02);
}

// Rays of grids are cut as those of meshes are: by planes, boxes with caps, and bodies.
TEST_P(SlicesOfEither, GridsAreClippedAndHoldBodies) {
    const ImageSize size{32, 32};
    const Camera camera = view_of_unit_cube(GetParam());
    const Scene mesh = scene_of(grid_mesh(4), linear, ramp());
    const GridScene grid = grid_scene(unit_cube(4, linear), ramp());
    const auto clip = std::make_shared<const ClipRegion>(box_region({{0.2, -3, 0.1}, {0.7, 0.55, 0.9}}));
    const auto bodies = with_bodies(mesh, {sphere({0.5, 0.3, 0.8}, 0.3, 12, {0.1, 0.8, 0.3})}).bodies;
    for (const int what : {0, 1, 2, 3}) {
        Scene of_mesh = mesh;
        GridScene of_grid = grid;
        if (what != 1) of_mesh.clip = of_grid.clip = clip;
        if (what == 1) of_mesh.bodies = of_grid.bodies = bodies;
        if (what == 3) of_mesh.surfaces = of_grid.surfaces = three_surfaces(0.4, Shading::flat);
        if (what == 2) {
            of_mesh = sliced(of_mesh, {}, true);
            of_grid = sliced(of_grid, {}, true);
        }
        const auto truths = Reference(of_mesh).picture(camera, size, what == 3 ? cpu_slack : 0);
        for (GridRenderer* renderer : grid_backends()) {
            if (what == 3 && renderer != grid_backends()[0]) continue;  // OpenGL draws no isosurfaces of cells
            EXPECT_LT(largest(compare(renderer->render(of_grid, camera, size), truths)), 1e-5) << what;
        }
    }
}

TEST(Slices, OfGridsRefuseWhatCannotBeCut) {
    const GridScene scene = sliced(grid_scene(unit_cube(3, linear), ramp()), {planes_of_tests[0]});
    const auto renderer = grid_backends()[1];
    EXPECT_THROW(renderer->prepare(scene, {.method = parse_method("homogeneous:vertices", "m")}), Error);
    EXPECT_THROW(renderer->prepare(scene, {.sampling = parse_grid_sampling("view:9")}), Error);
}

// ---- The rest of the way

TEST(Slices, AreAloneWithoutAnOrder) {
    const Scene alone = sliced(scene_of(grid_mesh(3), linear, nothing()), {planes_of_tests[0], planes_of_tests[1]});
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const Plan none = plan(alone, camera, {40, 40}, {}, Backend::cpu);
    EXPECT_EQ(none.drawing, Plan::Drawing::nothing);
    EXPECT_FALSE(none.sorts());
    EXPECT_NE(in_words(none.decisions).find("none: 2 slices alone"), std::string::npos) << in_words(none.decisions);
    const Scene mixed = capped(scene_of(grid_mesh(3), linear, ramp()), {planes_of_tests[0]});
    const Plan sorted = plan(mixed, camera, {40, 40}, {}, Backend::cpu);
    EXPECT_TRUE(sorted.sorts());
    EXPECT_NE(in_words(sorted.decisions).find("1 clipping plane, 1 cap"), std::string::npos) << in_words(sorted.decisions);
}

TEST(Slices, ComeAndGoAndAreTheSameForAnyNumberOfThreads) {
    const Scene without = scene_of(grid_mesh(4, 0.2), linear, ramp()), with = sliced(without, planes_of_tests);
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    for (const Backend backend : {Backend::cpu, Backend::gl_osmesa}) {
        const auto renderer = make_renderer(backend);
        const Image first = renderer->render(without, camera, {70, 70}), second = renderer->render(with, camera, {70, 70});
        EXPECT_GT(max_difference(first, second), 0.1);
        EXPECT_EQ(max_difference(first, renderer->render(without, camera, {70, 70})), 0.0);
        EXPECT_EQ(max_difference(second, make_renderer(backend, {.threads = 3})->render(with, camera, {70, 70})), 0.0);
    }
}

TEST(Slices, BadPlanesAreRefused) {
    const Scene scene = scene_of(grid_mesh(2), linear, nothing());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const HalfSpace& bad : {HalfSpace{{0, 0, 0}, {0, 0, 0}}, HalfSpace{{nan, 0, 0}, {1, 0, 0}}, HalfSpace{{0, 0, 0}, {1, nan, 0}}}) EXPECT_THROW(sliced(scene, {bad}), Error);
}

// Colours as the bar has them: an emitter's relative to its brightest; outside of a function that is transparent there, a hole.
TEST(Slices, HaveTheColorsOfTheBar) {
    const auto emitter = std::make_shared<const TransferFunction>(OpticalModel::emitter, std::vector<ColorNode>{{0.2, {2, 1, 0}}, {0.8, {0, 4, 1}}}, std::vector<ExtinctionNode>{{0, 0}}, Outside::transparent);
    Scene scene = scene_of(grid_mesh(3), linear, nothing());
    scene.slices = std::make_shared<const SliceScene>(cut_slices(*scene.mesh, *scene.field, nullptr, slices_and_caps({planes_of_tests[3]}, nullptr), emitter));
    const ColorBar bar = describe_color_bar(scene);
    EXPECT_EQ(bar.low, 0.2);
    EXPECT_EQ(bar.high, 0.8);
    EXPECT_TRUE(bar.medium);
    EXPECT_FALSE(bar.path);
    EXPECT_EQ(bar.below, Beyond::hidden);
    const ImageSize size{30, 30};
    const Camera camera = view_of_unit_cube(Camera::Projection::parallel);
    const ScreenTransform transform(camera, size);
    const Image image = cpu_backend().render(scene, camera, size);
    std::size_t seen = 0, holes = 0;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const auto ray = transform.ray({x + 0.5, y + 0.5});
            const auto t = to_slice(ray, false, planes_of_tests[3]);
            if (!t) continue;
            const double s = linear(ray.origin + *t * ray.direction);
            const bool inside = s >= 0.2 && s <= 0.8;
            ++(inside ? seen : holes);
            const glm::vec4 expected = inside ? glm::vec4(bar.color(s), 1) : glm::vec4(0);
            EXPECT_LT(max_difference(glm::dvec4(image.at(x, y)), glm::dvec4(expected)), 2e-7);
        }
    EXPECT_GT(seen, 100U);
    EXPECT_GT(holes, 10U);
}

}  // namespace
}  // namespace cellproj
