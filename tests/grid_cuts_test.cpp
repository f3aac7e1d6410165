// SPDX-License-Identifier: BSD-3-Clause
//
// The judge of regular grids under clip regions, bodies and slices: against the judge of meshes where the field is linear, against itself where
// what a plane parts must add up again, slices against the field itself; then both backends against it, in a field of noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "render/grid_renderer.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/cut_scenes.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace grid_cuts_test {

using namespace testing_support;

const HalfSpace oblique{{0.4, 0.5, 0.6}, {1, 2, -0.5}};

// With a step, an edge and a slope.
const auto colors = std::make_shared<const TransferFunction>(
    OpticalModel::density, std::vector<ColorNode>{{0, {0.1, 0.9, 0.3}}, {0.4, {0.9, 0.2, 0.3}}, {0.4, {0.2, 0.2, 0.9}}, {1, {1.0, 0.8, 0.1}}}, std::vector<ExtinctionNode>{{0, 0}});

enum class Cut { planes, box, bodies, slice, caps };
constexpr Cut all_cuts[]{Cut::planes, Cut::box, Cut::bodies, Cut::slice, Cut::caps};

// Of a mesh or of a grid; slices of a mesh are cut there.
template <class AnyScene>
void add(Cut cut, AnyScene& scene) {
    const std::vector<HalfSpace> two{oblique, {{0.2, 0, 0}, {1, 0, 0.1}}};
    if (cut == Cut::planes || cut == Cut::caps) scene.clip = std::make_shared<const ClipRegion>(ClipRegion{two});
    if (cut == Cut::box) scene.clip = std::make_shared<const ClipRegion>(box_region({{0.2, -3, 0.1}, {0.7, 0.55, 0.9}}));
    if (cut == Cut::bodies) scene.bodies = std::make_shared<const BodyScene>(BodyScene{{sphere({0.5, 0.3, 0.8}, 0.3, 12, {0.1, 0.8, 0.3})}, {}});
    if (cut != Cut::slice && cut != Cut::caps) return;
    std::vector<Slice> slices = slices_and_caps(cut == Cut::slice ? two : std::vector<HalfSpace>{}, cut == Cut::caps ? scene.clip.get() : nullptr);
    if constexpr (std::is_same_v<AnyScene, Scene>)
        scene.slices = std::make_shared<const SliceScene>(cut_slices(*scene.mesh, *scene.field, nullptr, std::move(slices), colors));
    else
        scene.slices = std::make_shared<const SliceScene>(SliceScene{std::move(slices), colors});
}

GridScene grid_scene(Grid grid, const TransferFunction& transfer) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(transfer)};
}

// Noise at the points of uneven axes.
Grid noise(unsigned seed) {
    GridAxis axis;
    axis.coordinates = {0, 0.1, 0.45, 0.5, 1};
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> value(0, 1);
    return grid_of({axis, uniform_axis(0, 0.25, 5), axis}, [&](const glm::dvec3&) { return value(random); });
}

class GridCutsOfEither : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(GridCuts, GridCutsOfEither, either_projection, name_of_projection);

// A linear field on boxes is the same on the tetrahedra they are cut into, and so are its cuts and surfaces.
TEST_P(GridCutsOfEither, OfALinearFieldAreThoseOfTheTetrahedra) {
    const ImageSize size{25, 21};
    const auto pixels = all_pixels(size);
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())})
        for (const Cut cut : all_cuts)
            for (const bool surfaces : {false, true}) {
                Scene of_mesh = scene_of(grid_mesh(4), linear, ramp());
                GridScene of_grid = grid_scene(unit_cube(4, linear), ramp());
                add(cut, of_mesh);
                add(cut, of_grid);
                if (surfaces) of_mesh.surfaces = of_grid.surfaces = three_surfaces(0.4, Shading::smooth);
                const auto expected = Reference(of_mesh).pixels(camera, size, pixels), found = GridReference(of_grid).pixels(camera, size, pixels);
                for (std::size_t p = 0; p < pixels.size(); ++p)
                    ASSERT_LT(distance(expected[p].light, found[p].light), 1e-8) << static_cast<int>(cut) << surfaces << " " << p;  // normals of tiny steps
            }
}

// What a plane parts is the whole again, one behind the other; surfaces in it, too. Lit media are not: a cell that is cut is another cell.
TEST_P(GridCutsOfEither, HalvesMakeTheWhole) {
    const Camera camera = view_of_unit_cube(GetParam());
    const ScreenTransform transform(camera, {23, 19});
    for (const bool surfaces : {false, true}) {
        GridScene whole = grid_scene(noise(3), ramp());
        if (surfaces) whole.surfaces = three_surfaces(0.4, Shading::flat);
        GridScene kept = whole, rest = whole;
        kept.clip = std::make_shared<const ClipRegion>(ClipRegion{{oblique}});
        rest.clip = std::make_shared<const ClipRegion>(ClipRegion{{{oblique.point, -oblique.normal}}});
        const GridReference of_whole(whole), of_kept(kept), of_rest(rest);
        for (const PixelId& pixel : all_pixels({23, 19})) {
            const auto ray = transform.ray({pixel.x + 0.5, pixel.y + 0.5});
            Light front = of_kept.light(ray, transform.perspective()), back = of_rest.light(ray, transform.perspective());
            if (glm::dot(oblique.normal, ray.direction) > 0) std::swap(front, back);  // the kept half lies behind
            const Light both{front.color + (1 - front.opacity) * back.color, front.opacity + (1 - front.opacity) * back.opacity};
            ASSERT_LT(distance(both, of_whole.light(ray, transform.perspective())), 1e-11) << pixel.x << " " << pixel.y;
        }
    }
}

// Slices are the field itself, in general place and along planes of the grid, where fields on cells jump.
TEST_P(GridCutsOfEither, SlicesShowTheField) {
    const Camera camera = view_of_unit_cube(GetParam());
    const ImageSize size{23, 19};
    const ScreenTransform transform(camera, size);
    Grid cells = noise(7);
    cells.location = FieldLocation::cells;
    cells.values.resize(4 * 4 * 4);
    cells.blanked.assign(64, 0);
    cells.blanked[21] = cells.blanked[37] = 1;
    for (const Grid& grid : {noise(5), cells})
        for (const HalfSpace& plane : {oblique, HalfSpace{{0, 0.5, 0}, {0, 3, 0}}, HalfSpace{{0, 0.5, 0}, {0, -1, 0}}, HalfSpace{{1, 0, 0}, {1, 0, 0}}})
            for (const bool cap : {false, true}) {
                GridScene scene = grid_scene(grid, constant_medium(0));
                const Slice slice{plane, cap};
                scene.slices = std::make_shared<const SliceScene>(SliceScene{{slice}, colors});
                const GridReference reference(scene);
                for (const PixelId& pixel : all_pixels(size)) {
                    const auto ray = transform.ray({pixel.x + 0.37, pixel.y + 0.61});  // through no edge of the grid
                    const glm::dvec3 n = unit_normal(plane);
                    const double t = glm::dot(n, plane.point - ray.origin) / glm::dot(n, ray.direction);
                    const auto scalar = scalar_at(grid, slice, ray.origin + t * ray.direction);
                    const auto color = scalar ? SliceColors(*colors).at(*scalar) : std::nullopt;
                    const Light expected = color ? layer(*color, 1) : Light{};
                    ASSERT_LT(distance(reference.light(ray, transform.perspective()), expected), 1e-12)
                        << pixel.x << " " << pixel.y << ", cap " << cap << ", normal " << n.x << " " << n.y << " " << n.z << ", scalar " << scalar.value_or(-1);
                }
            }
}

// Noise bends most in a cell: `exact` within its tolerance and float32. OpenGL takes scalars as linear from face to face, and is near only.
TEST_P(GridCutsOfEither, BackendsAgreeWithTheJudge) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{12, 12} : ImageSize{32, 32};
    static const auto cpu = make_grid_renderer(Backend::cpu), gl = make_grid_renderer(Backend::gl_osmesa);
    for (const Camera& camera : {view_of_unit_cube(GetParam()), inside_of_unit_cube(GetParam())})
        for (const Cut cut : all_cuts)
            for (const bool surfaces : {false, true}) {
                GridScene scene = grid_scene(noise(11), ramp());
                add(cut, scene);
                if (surfaces) scene.surfaces = three_surfaces(0.4, Shading::smooth);
                // Where a surface touches a ray, or a slice ends, rounding decides: within a thousandth of a pixel.
                const ViewJudge view(GridReference(scene), camera, size, 1e-3);
                EXPECT_TRUE(view.within(cpu->render(scene, camera, size, {.method = parse_method("exact:1e-5")}, nullptr), 2e-4)) << static_cast<int>(cut) << surfaces;
                EXPECT_TRUE(view.within(gl->render(scene, camera, size, {}, nullptr), 0.2)) << static_cast<int>(cut) << surfaces;
            }
}

}  // namespace grid_cuts_test
}  // namespace cellproj
