// SPDX-License-Identifier: BSD-3-Clause
//
// The plan: what is decided for a scene, and that no rule changes a picture. Rules that can be switched off are; where the general way is
// another scene, that scene is drawn: cells with points of their own, light that is ambient only, an eye far away.
#include "render/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "tests/support/cut_scenes.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace plan_test {

using scenes::peaks;
using scenes::waves;
using testing_support::constant_medium;
using testing_support::grid_mesh;
using testing_support::max_difference;
using testing_support::nothing;
using testing_support::point_field;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::sphere;
using testing_support::view_of_unit_cube;
using testing_support::with_bodies;
using testing_support::with_surfaces;

using Projection = Camera::Projection;
using Drawing = Plan::Drawing;
constexpr bool sanitized = CELLPROJ_SANITIZED;
constexpr ImageSize small = sanitized ? ImageSize{40, 32} : ImageSize{96, 80};
constexpr int boxes = sanitized ? 4 : 7;

// Shines and absorbs nothing; brightness about 1 through the cube.
TransferFunction glow() { return {OpticalModel::emitter, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0}}}; }

const std::vector<IsoSurface> opaque_three{{0.3, {0.2, 0.9, 0.4}, 1, {}}, {0.5, {1, 0, 0}, 1, glm::dvec3(0, 0, 1)}, {0.7, {0.5, 0.5, 0.5}, 1, {}}};

Scene waves_in(const TransferFunction& transfer) { return scene_of(grid_mesh(boxes, 0.2), waves, transfer); }

// Every cell with four points of its own. `scalar`: of the cell's corner.
Scene exploded(const Scene& scene, const std::function<double(CellId, int corner)>& scalar) {
    TetMesh mesh;
    ScalarField field{"f", FieldLocation::points, {}};
    for (CellId cell = 0; cell < scene.mesh->tets.size(); ++cell) {
        const auto first = static_cast<VertexId>(mesh.points.size());
        for (int corner = 0; corner < 4; ++corner) {
            mesh.points.push_back(scene.mesh->points[scene.mesh->tets[cell][static_cast<std::size_t>(corner)]]);
            field.values.push_back(scalar(cell, corner));
        }
        mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    }
    Scene result = scene_of(std::move(mesh), std::move(field), *scene.transfer);
    result.surfaces = scene.surfaces;
    return result;
}

std::string chosen(const std::vector<Decision>& decisions, const std::string& rule) {
    const auto found = std::ranges::find(decisions, rule, &Decision::rule);
    return found == decisions.end() ? "" : found->chosen;
}

bool starts(const std::string& text, const std::string& beginning) { return text.substr(0, beginning.size()) == beginning; }

class PlanOfEither : public testing::TestWithParam<std::tuple<Backend, Projection>> {
protected:
    Backend backend() const { return std::get<0>(GetParam()); }
    Camera camera() const { return view_of_unit_cube(std::get<1>(GetParam())); }

    struct Drawn {
        Image image;
        Statistics statistics;
    };
    Drawn draw(const Scene& scene, const Quality& quality = {}, const PlanRules& rules = {}) const { return draw(scene, camera(), quality, rules); }
    Drawn draw(const Scene& scene, const Camera& camera, const Quality& quality = {}, const PlanRules& rules = {}) const {
        Drawn drawn;
        drawn.image = make_renderer(backend(), {.rules = rules})->render(scene, camera, small, quality, &drawn.statistics);
        return drawn;
    }
    // Brightest channel of a picture that shows something.
    static double brightest(const Image& image) {
        double largest = 0;
        for (const glm::vec4& p : image.pixels) largest = std::max({largest, double(p.x), double(p.y), double(p.z), double(p.w)});
        return largest;
    }
};

INSTANTIATE_TEST_SUITE_P(Plan, PlanOfEither,
                         testing::Combine(testing::Values(Backend::cpu, Backend::gl_osmesa), testing_support::either_projection),
                         [](const auto& chosen) {
                             return std::string(std::get<0>(chosen.param) == Backend::cpu ? "cpu_" : "gl_") +
                                    testing_support::name_of(std::get<1>(chosen.param));
                         });

TEST_P(PlanOfEither, OpaqueSurfacesNeedNoOrder) {
    for (const Shading shading : {Shading::flat, Shading::smooth, Shading::unlit}) {
        const Scene scene = with_surfaces(waves_in(nothing()), opaque_three, shading);
        const Drawn shortest = draw(scene), general = draw(scene, {}, {.nearest_surfaces = false});
        EXPECT_EQ(shortest.statistics.order, "none");
        EXPECT_NE(general.statistics.order, "none");
        EXPECT_GT(brightest(shortest.image), 0.1);
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
    }
}

// Sums of float32 in another order: 1e-6 of the brightest.
TEST_P(PlanOfEither, LightThatNothingAbsorbsNeedsNoOrder) {
    const Scene scene = waves_in(glow());
    for (const char* method : {"integral", "preint2d-exp:32"}) {
        const Quality quality{.method = parse_method(method)};
        const Drawn shortest = draw(scene, quality), general = draw(scene, quality, {.sum = false});
        EXPECT_EQ(shortest.statistics.order, "none");
        EXPECT_NE(general.statistics.order, "none");
        EXPECT_GT(brightest(shortest.image), 0.2);
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-6 * std::max(1.0, brightest(general.image))) << method;
    }
}

TEST_P(PlanOfEither, CellsThatShowNothingAreLeftOut) {
    const TransferFunction tent(OpticalModel::density, {{0, {0.9, 0.3, 0.1}}}, {{0.85, 0}, {0.9, 20}, {0.95, 0}});
    const TransferFunction shining(OpticalModel::emitter, {{0.85, {0, 0, 0}}, {0.9, {9, 3, 0}}, {0.95, {0, 0, 0}}}, {{0.1, 2}, {0.12, 0}});
    for (const TransferFunction& transfer : {tent, shining})
        for (const bool surfaces : {false, true}) {
            const Scene scene = surfaces ? with_surfaces(waves_in(transfer), {{0.5, {1, 0, 0}, 0.4, {}}}) : waves_in(transfer);
            const Drawn shortest = draw(scene), general = draw(scene, {}, {.culling = false});
            EXPECT_LT(shortest.statistics.counts.drawn, general.statistics.counts.drawn * 3 / 4);
            EXPECT_GT(brightest(shortest.image), 0.1);
            EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
        }
}

// Of a mesh with so many cells that few pixels see one of them. Few cells: a tent, translucent surfaces, both.
TEST_P(PlanOfEither, FewCellsAreSortedByPixels) {
    const TransferFunction tent(OpticalModel::density, {{0, {0.9, 0.3, 0.1}}}, {{0.93, 0}, {0.96, 40}, {0.99, 0}});
    const Scene fine = scene_of(grid_mesh(sanitized ? 10 : 20, 0.2), waves, tent);
    Scene surface = with_surfaces(fine, {{0.95, {1, 0, 0}, 0.4, {}}});
    const Scene both = surface;
    surface.transfer = std::make_shared<TransferFunction>(nothing());
    for (const Scene& scene : {fine, surface, both}) {
        const Drawn shortest = draw(scene), general = draw(scene, {}, {.few_cells = false});
        EXPECT_EQ(shortest.statistics.order == "pixel", backend() == Backend::cpu) << shortest.statistics.counts.drawn << " of " << scene.mesh->tets.size();
        EXPECT_NE(general.statistics.order, "pixel");
        EXPECT_GT(brightest(shortest.image), 0.1);
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
    }
}

// Fragments of a picture of all cells are as many as expected, within what cells differ by.
TEST(Plan, ExpectsAsManyFragmentsAsThereAre) {
    const Scene scene = scene_of(grid_mesh(boxes, 0.2), waves, ramp());
    for (const Projection projection : {Projection::parallel, Projection::perspective})
        for (const int side : {100, 300}) {
            const Camera camera = view_of_unit_cube(projection);
            Statistics statistics;
            make_renderer(Backend::cpu)->render(scene, camera, {side, side}, {}, &statistics);
            const std::size_t cells = scene.mesh->tets.size();
            const double expected = expected_fragments({.box = bounds(scene.mesh->points), .cells = cells}, cells, camera, {side, side});
            EXPECT_GT(static_cast<double>(statistics.counts.fragments), 0.7 * expected);
            EXPECT_LT(static_cast<double>(statistics.counts.fragments), 1.6 * expected);  // Kuhn's tetrahedra have more surface than regular ones
        }
}

TEST_P(PlanOfEither, NothingToSeeIsAnEmptyPicture) {
    const Scene missed = with_surfaces(waves_in(nothing()), {{7.0, {1, 0, 0}, 1, {}}});
    for (const Scene& scene : {waves_in(nothing()), missed}) {
        const Drawn shortest = draw(scene), general = draw(scene, {}, {.nothing_seen = false, .culling = false, .nearest_surfaces = false, .sum = false});
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-30);  // what is left of guards against 0/0
        EXPECT_EQ(brightest(shortest.image), 0.0);
        EXPECT_EQ(shortest.statistics.counts.drawn, 0U);
        EXPECT_EQ(shortest.statistics.counts.culled, scene.mesh->tets.size());
        EXPECT_TRUE(starts(chosen(shortest.statistics.plan, "order"), "none: an empty picture"));
        EXPECT_TRUE(shortest.statistics.order_exact);
    }
}

TEST_P(PlanOfEither, OutsideTheViewIsAnEmptyPicture) {
    const Scene scene = waves_in(ramp());
    Camera away = camera();
    away.center += glm::dvec3(5, 0, 0);
    away.eye += glm::dvec3(5, 0, 0);
    Camera behind = camera();
    behind.center = behind.eye + (behind.eye - behind.center);  // looks away; parallel views have no behind
    for (const Camera& view : {away, behind}) {
        const Drawn shortest = draw(scene, view), general = draw(scene, view, {}, {.empty_view = false});
        EXPECT_EQ(max_difference(shortest.image, general.image), 0.0);
        const bool empty = view.projection == Projection::perspective || view.center == away.center;
        EXPECT_EQ(starts(chosen(shortest.statistics.plan, "view"), "an empty picture"), empty);
        EXPECT_EQ(brightest(shortest.image) == 0.0, empty);
    }
}

// Bodies are seen where no cell is, and hide light that needs no order.
TEST_P(PlanOfEither, BodiesAreSeenWithoutCells) {
    const auto with_spheres = [](const Scene& scene) {
        return with_bodies(scene, {sphere({0.4, 0.5, 0.6}, 0.25, 6, {0.9, 0.5, 0.2}), sphere({5.5, 0.5, 0.5}, 0.25, 6, {0.2, 0.5, 0.9})});
    };
    Camera away = camera();
    away.center += glm::dvec3(5, 0, 0);
    away.eye += glm::dvec3(5, 0, 0);
    const PlanRules none{.empty_view = false, .nothing_seen = false, .culling = false, .nearest_surfaces = false, .sum = false, .few_cells = false, .constant_light = false};
    for (const auto& [scene, view] : {std::pair(waves_in(nothing()), camera()), std::pair(waves_in(ramp()), away), std::pair(waves_in(glow()), camera()),
                                      std::pair(with_surfaces(waves_in(nothing()), opaque_three), camera())}) {
        const Drawn shortest = draw(with_spheres(scene), view), general = draw(with_spheres(scene), view, {}, none);
        EXPECT_GT(brightest(shortest.image), 0.99);  // a body is opaque
        EXPECT_EQ(chosen(shortest.statistics.plan, "rays"), "cut");
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-6 * std::max(1.0, brightest(general.image)));
    }
}

TEST_P(PlanOfEither, ConstantLightNeedsNoTable) {
    const TransferFunction shining(OpticalModel::emitter, {{0, {0.3, 0.6, 0.9}}}, {{0, 2.5}});
    // At an optical depth of 30 a cell, llvmpipe's two ways to the exponential are 1.3e-6 apart.
    const double bound = backend() == Backend::cpu ? 1e-6 : 2e-6;
    for (const TransferFunction& transfer : {constant_medium(3), constant_medium(1e-4), constant_medium(400), shining})
        for (const char* method : {"integral", "exact:1e-6", "linear:9", "preint2d-exp:32"}) {
            const Quality quality{.method = parse_method(method)};
            const Scene scene = waves_in(transfer);
            const Drawn shortest = draw(scene, quality), general = draw(scene, quality, {.constant_light = false});
            const std::string asked = to_string(quality.method), closed_form = backend() == Backend::cpu ? "integral" : "homogeneous";
            EXPECT_EQ(chosen(shortest.statistics.plan, "method"), closed_form + (asked == closed_form ? "" : " instead of " + asked));
            EXPECT_EQ(shortest.statistics.method, general.statistics.method);
            EXPECT_LE(max_difference(shortest.image, general.image), bound) << method;
        }
    // Not what was asked for, which is wrong there in its own way.
    for (const char* method : {"preint2d:32", "preint3d:16", "average", "stein"})
        EXPECT_EQ(chosen(draw(waves_in(constant_medium(3)), {.method = parse_method(method)}).statistics.plan, "method"), to_string(parse_method(method)));
}

// A field of one value over a function that is not constant, and a function that is constant over the field only.
TEST_P(PlanOfEither, ConstantLightIsThatOfTheFieldsRange) {
    const TransferFunction plateau(OpticalModel::density, {{-5, {0, 0, 0}}, {-1, {0.4, 0.5, 0.6}}, {2, {0.4, 0.5, 0.6}}}, {{-1, 2}, {2, 2}, {3, 90}});
    const Scene on_plateau = waves_in(plateau);
    const Scene one_value = scene_of(grid_mesh(3, 0.2), [](const glm::dvec3&) { return 0.37; }, ramp());
    const Quality quality{.method = parse_method("linear:9")};
    for (const Scene& scene : {on_plateau, one_value}) {
        const Drawn shortest = draw(scene, quality), general = draw(scene, quality, {.constant_light = false});
        EXPECT_NE(chosen(shortest.statistics.plan, "method"), "linear:9");
        EXPECT_GT(brightest(shortest.image), 0.1);
        EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
    }
}

// A renderer that goes from scene to scene draws what a new one draws.
TEST_P(PlanOfEither, ChangesWithTheScene) {
    const auto renderer = make_renderer(backend());
    const Scene first = waves_in(ramp());
    std::vector<Scene> scenes(7, first);
    const auto set = [&](std::size_t i, const TransferFunction& transfer) { scenes[i].transfer = std::make_shared<TransferFunction>(transfer); };
    set(1, constant_medium(2));
    set(2, nothing());
    set(3, glow());
    set(4, nothing());
    scenes[4] = with_surfaces(scenes[4], opaque_three);
    set(5, glow());
    scenes[5] = with_surfaces(scenes[5], opaque_three);
    for (const std::size_t i : {0, 1, 0, 2, 1, 3, 2, 4, 5, 4, 6, 2, 5}) {
        const Image image = renderer->render(scenes[i], camera(), small, {});
        EXPECT_EQ(max_difference(image, draw(scenes[i]).image), 0.0) << i;
    }
}

// Flat shading is smooth shading where every point has the gradient of its one cell.
TEST_P(PlanOfEither, FlatShadingNeedsNoGradientsAtPoints) {
    const Scene flat = with_surfaces(waves_in(nothing()), opaque_three, Shading::flat);
    Scene smooth = exploded(flat, [&](CellId cell, int corner) { return flat.field->at(*flat.mesh, cell, corner); });
    smooth.surfaces = with_surfaces(flat, opaque_three, Shading::smooth).surfaces;
    const Drawn shortest = draw(flat), general = draw(smooth);
    EXPECT_EQ(chosen(shortest.statistics.plan, "gradients"), "one for a cell");
    EXPECT_EQ(chosen(general.statistics.plan, "gradients"), "at points");
    EXPECT_GT(brightest(shortest.image), 0.1);
    EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
}

// Light that is ambient only, of strength 1, is none.
TEST_P(PlanOfEither, UnlitSurfacesNeedNoGradients) {
    const Lighting ambient{.ambient = glm::dvec3(1), .lights = {}};
    const Drawn shortest = draw(with_surfaces(waves_in(nothing()), opaque_three, Shading::unlit));
    const Drawn general = draw(with_surfaces(waves_in(nothing()), opaque_three, Shading::smooth, ambient));
    EXPECT_EQ(chosen(shortest.statistics.plan, "gradients"), "none");
    EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
}

// A field on cells is one on points that no cells share. Pixels sort themselves, as points that are not shared tell no order; OpenGL sorts by centroids.
TEST_P(PlanOfEither, AFieldOnCellsNeedsNoInterpolation) {
    Scene cells = waves_in(ramp());
    ScalarField field{"f", FieldLocation::cells, {}};
    for (CellId cell = 0; cell < cells.mesh->tets.size(); ++cell) field.values.push_back(cells.field->at(*cells.mesh, cell, 0));
    cells.field = std::make_shared<ScalarField>(field);
    const Scene points = exploded(cells, [&](CellId cell, int) { return field.values[cell]; });
    const Quality quality = backend() == Backend::cpu ? Quality{.order_per_pixel = true} : Quality{.order = OrderMethod::centroid};
    const Drawn shortest = draw(cells, quality), general = draw(points, quality);
    EXPECT_EQ(chosen(shortest.statistics.plan, "field"), "one value for a cell");
    EXPECT_LE(max_difference(shortest.image, general.image), 1e-6);
}

// Facts of a scene, whatever draws it.
TEST(Plan, ParallelViewsArePerspectiveFromFarAway) {
    const Scene scene = waves_in(ramp());
    const Camera near = view_of_unit_cube(Projection::parallel);
    Camera far = near;
    const double distance = 1e8;
    far.projection = Projection::perspective;
    far.eye = near.center + distance * glm::normalize(near.eye - near.center);
    far.fov_y_degrees = glm::degrees(2 * std::atan(near.height / 2 / distance));
    for (const Backend backend : {Backend::cpu, Backend::gl_osmesa}) {
        const auto renderer = make_renderer(backend);
        const double difference = max_difference(renderer->render(scene, near, small, {}), renderer->render(scene, far, small, {}));
        // OpenGL's silhouettes lie on a grid of 1/256 of a pixel, to which rounding may send a point either way.
        EXPECT_LE(difference, backend == Backend::cpu ? 1e-6 : 2e-3) << (backend == Backend::cpu);
    }
}

struct Case {
    const char* name;
    Scene scene;
    Quality quality;
    Backend backend;
    Drawing drawing;
    const char *cells, *order, *method, *gradients;  // how the words begin
};

TEST(Plan, TenScenesAreExplained) {
    const Scene base = waves_in(ramp());
    const std::string all = std::to_string(base.mesh->tets.size());
    const auto of = [&](const TransferFunction& transfer) {
        Scene scene = base;
        scene.transfer = std::make_shared<TransferFunction>(transfer);
        return scene;
    };
    Scene on_cells = base, two_fields = base;
    on_cells.field = std::make_shared<ScalarField>(ScalarField{"c", FieldLocation::cells, std::vector<double>(base.mesh->tets.size(), 0.5)});
    two_fields.opacity_field = std::make_shared<ScalarField>(point_field(*base.mesh, testing_support::linear));
    std::vector<IsoSurface> translucent = opaque_three;
    translucent[1].opacity = 0.5;
    const Quality usual;
    const std::string everything = all + " of " + all + " with a visible medium";
    const std::string none = "0 of " + all + " with a visible medium";
    const std::vector<Case> cases{
        {"a ramp", base, usual, Backend::cpu, Drawing::by_cells, everything.c_str(), "cells, exactly", "integral", "none"},
        {"pixels sort", base, {.order_per_pixel = true}, Backend::cpu, Drawing::by_pixels, everything.c_str(), "by each pixel", "integral", "none"},
        {"an order that was asked for", base, {.order = OrderMethod::centroid}, Backend::gl_osmesa, Drawing::by_cells, everything.c_str(), "cells by centroid", "integral", "none"},
        {"opaque surfaces alone", with_surfaces(of(nothing()), opaque_three), usual, Backend::cpu, Drawing::nearest_surfaces, none.c_str(), "none: the nearest", "none", "at points"},
        {"flat ones", with_surfaces(of(nothing()), opaque_three, Shading::flat), usual, Backend::gl_osmesa, Drawing::nearest_surfaces, none.c_str(), "none: the nearest", "none", "one for a cell"},
        {"translucent surfaces", with_surfaces(of(nothing()), translucent, Shading::unlit), usual, Backend::cpu, Drawing::by_cells, none.c_str(), "cells, exactly", "none", "none"},
        {"opaque surfaces in a medium", with_surfaces(base, opaque_three), usual, Backend::gl_osmesa, Drawing::by_cells, everything.c_str(), "cells, exactly", "integral", "at points"},
        {"light alone", of(glow()), usual, Backend::cpu, Drawing::sum, everything.c_str(), "none: light adds up", "integral", "none"},
        {"nothing", of(nothing()), usual, Backend::gl_osmesa, Drawing::nothing, none.c_str(), "none: an empty picture", "none", "none"},
        {"a constant medium", of(constant_medium(2)), usual, Backend::cpu, Drawing::by_cells, everything.c_str(), "cells, exactly", "integral", "none"},
        {"a field on cells", on_cells, usual, Backend::gl_osmesa, Drawing::by_cells, everything.c_str(), "cells, exactly", "homogeneous instead of", "none"},
        {"two fields", two_fields, usual, Backend::gl_osmesa, Drawing::by_cells, everything.c_str(), "cells, exactly", "integral", "none"},
    };
    for (const Case& c : cases) {
        const Plan made = plan(c.scene, view_of_unit_cube(Projection::perspective), small, c.quality, c.backend);
        EXPECT_EQ(made.drawing, c.drawing) << c.name;
        EXPECT_PRED2(starts, chosen(made.decisions, "cells"), c.cells) << c.name;
        EXPECT_PRED2(starts, chosen(made.decisions, "order"), c.order) << c.name;
        EXPECT_PRED2(starts, chosen(made.decisions, "method"), c.method) << c.name;
        EXPECT_PRED2(starts, chosen(made.decisions, "gradients"), c.gradients) << c.name;
        EXPECT_EQ(chosen(made.decisions, "projection"), "perspective") << c.name;
        EXPECT_EQ(chosen(made.decisions, "rays"), "whole") << c.name;
        EXPECT_EQ(chosen(made.decisions, "view"), "what the view holds") << c.name;
        for (const Decision& d : made.decisions) EXPECT_FALSE(d.why.empty()) << c.name << ": " << d.rule;
        // The renderer draws by the same plan; the sorter's choice comes on top.
        Statistics statistics;
        make_renderer(c.backend)->render(c.scene, view_of_unit_cube(Projection::perspective), small, c.quality, &statistics);
        ASSERT_EQ(statistics.plan.size(), made.decisions.size()) << c.name;
        for (const Decision& d : made.decisions) {
            const bool sorted = made.drawing == Drawing::by_cells && d.rule == "order";
            EXPECT_EQ(chosen(statistics.plan, d.rule), sorted ? "cells by " + statistics.order : d.chosen) << c.name;
        }
    }
    EXPECT_EQ(chosen(plan(on_cells, view_of_unit_cube(Projection::parallel), small, {}, Backend::cpu).decisions, "field"), "one value for a cell");
    EXPECT_EQ(chosen(plan(two_fields, view_of_unit_cube(Projection::parallel), small, {}, Backend::gl_egl).decisions, "field"), "linear in a cell, two fields");
}

TEST(Plan, CountsWhatIsNotFinite) {
    Scene scene = waves_in(ramp());
    ScalarField field = *scene.field;
    field.values[0] = std::numeric_limits<double>::quiet_NaN();
    std::size_t touched = 0;
    for (const auto& tet : scene.mesh->tets) touched += std::ranges::count(tet, VertexId{0}) > 0;
    scene.field = std::make_shared<ScalarField>(field);
    const std::size_t cells = scene.mesh->tets.size();
    const Plan made = plan(scene, view_of_unit_cube(Projection::parallel), small, {}, Backend::cpu);
    EXPECT_EQ(chosen(made.decisions, "cells"), std::to_string(cells - touched) + " of " + std::to_string(cells) + " with a visible medium");
    EXPECT_NE(made.decisions[0].why.find(std::to_string(touched) + " cell"), std::string::npos) << made.decisions[0].why;
}

TEST(Plan, RefusesWhatRenderersRefuse) {
    const Scene scene = waves_in(ramp());
    const Camera camera = view_of_unit_cube(Projection::parallel);
    EXPECT_THROW(plan(scene, camera, small, {.target = TargetFormat::rgba8}, Backend::cpu), Error);
    EXPECT_THROW(plan(scene, camera, {0, 5}, {}, Backend::cpu), Error);
    EXPECT_THROW(plan(scene, Camera{.height = -1}, small, {.order_per_pixel = true}, Backend::gl_egl), Error);
}

// True only where no point of the box is in the picture, and true where the box is far beside it; at any scale and place.
TEST(Plan, OutsideTheViewIsToldFromTheBox) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    const auto point = [&] { return glm::dvec3(any(random), any(random), any(random)); };
    std::size_t outside = 0, inside = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const double scale = std::pow(10.0, std::floor(12 * any(random)));
        const glm::dvec3 shift = trial % 3 ? glm::dvec3(0) : 1e6 * scale * point();
        const glm::dvec3 a = point(), b = a + 0.5 * glm::abs(point());
        const Bounds box{scale * a + shift, scale * b + shift};
        Camera camera{.projection = trial % 2 ? Projection::parallel : Projection::perspective, .eye = scale * (2.0 * point()) + shift, .center = scale * (2.0 * point()) + shift,
                      .up = point(), .height = scale * (0.2 + std::abs(any(random))), .fov_y_degrees = 5 + 60 * std::abs(any(random))};
        const ImageSize size{100, 60};
        const ScreenTransform transform(camera, size);
        bool seen = false;
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 share = 0.5 * (point() + 1.0);
            const glm::dvec3 e = transform.to_eye(box.low + share * (box.high - box.low));
            if (transform.perspective() && e.z < 2e-3 * glm::distance(camera.eye, camera.center)) continue;
            const glm::dvec2 at = transform.to_screen(e);
            seen = seen || (at.x >= 0 && at.y >= 0 && at.x <= size.width && at.y <= size.height);
        }
        const bool told = outside_view(box, camera, size);
        EXPECT_FALSE(seen && told) << trial;
        outside += told;
        inside += seen;
    }
    EXPECT_GT(outside, 400U);
    EXPECT_GT(inside, 400U);
}

TEST(Plan, ThePointOfAnEmptyBoxIsInView) {
    const Bounds point{glm::dvec3(3), glm::dvec3(3)};
    EXPECT_FALSE(outside_view(point, {.projection = Projection::parallel, .eye = {3, 3, 9}, .center = {3, 3, 3}}, small));
    EXPECT_TRUE(outside_view(point, {.projection = Projection::parallel, .eye = {9, 3, 9}, .center = {9, 3, 3}}, small));
}

TEST(Plan, ChoosesABackendAndSaysWhy) {
    const Gpu gpu{true, "A GPU 9000"}, none{false, "no GPU that EGL knows of"};
    const auto choose = [](const char* wish, const Quality& quality, const Gpu& found, FieldsRead fields = FieldsRead::one) {
        return choose_backend(parse_backend(wish), quality, fields, found);
    };
    EXPECT_EQ(choose("auto", {}, none).backend, Backend::cpu);
    EXPECT_NE(choose("auto", {}, none).decision.why.find(none.what), std::string::npos);
    EXPECT_EQ(choose("auto", {}, gpu).backend, Backend::gl_egl);
    EXPECT_NE(choose("auto", {}, gpu).decision.why.find(gpu.what), std::string::npos);
    EXPECT_EQ(choose("auto", {.order_per_pixel = true}, gpu).backend, Backend::cpu);
    EXPECT_EQ(choose("auto", {.target = TargetFormat::rgba8}, none).backend, Backend::gl_osmesa);
    EXPECT_NE(choose("auto", {.target = TargetFormat::rgba8}, none).decision.why.find("rgba8"), std::string::npos);
    EXPECT_NE(choose("auto", {.method = parse_method("shirley-tuchman")}, none).decision.why.find("light at vertices"), std::string::npos);
    EXPECT_NE(choose("auto", {}, none, FieldsRead::two).decision.why.find("another field"), std::string::npos);
    EXPECT_EQ(choose("gl", {}, gpu).backend, Backend::gl_egl);
    EXPECT_EQ(choose("gl", {}, none).backend, Backend::gl_osmesa);
    EXPECT_EQ(choose("egl", {}, {}).backend, Backend::gl_egl);
    EXPECT_EQ(choose("osmesa", {}, gpu).backend, Backend::gl_osmesa);
    EXPECT_EQ(choose("cpu", {}, gpu).decision.why, "asked for");
    EXPECT_THROW(choose("cpu", {.target = TargetFormat::rgba8}, gpu), Error);
    EXPECT_THROW(parse_backend("vulkan"), Error);
    for (const auto wish : {BackendWish::automatic, BackendWish::gl}) EXPECT_TRUE(depends_on_gpu(wish));
    for (const auto wish : {BackendWish::cpu, BackendWish::egl, BackendWish::osmesa}) EXPECT_FALSE(depends_on_gpu(wish));
}

TEST(Plan, IsPrintedInColumns) {
    const std::vector<Decision> decisions{{"order", "none", "why"}, {"a", "much longer", "so"}};
    EXPECT_EQ(in_words(decisions), "  order  none         why\n  a      much longer  so\n");
    EXPECT_EQ(in_words({}), "");
}

}  // namespace
}  // namespace cellproj
