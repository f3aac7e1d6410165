// SPDX-License-Identifier: BSD-3-Clause
//
// Which cells isosurfaces cross, for both backends: against the definition, and what is kept when only the isovalues change.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "render/prepared_scene.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace prepared_surfaces_test {

using namespace testing_support;

Scene waves_with(std::vector<IsoSurface> list, Shading shading) {
    auto mesh = std::make_shared<TetMesh>(grid_mesh(6, 0.2));
    auto field = std::make_shared<ScalarField>(point_field(*mesh, scenes::waves));
    return {std::move(mesh), std::move(field), std::make_shared<TransferFunction>(constant_medium(0)),
            std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), shading, {}})};
}

SceneUnits units_of(const Scene& scene) {
    const ScalarRange values = range(scene.field->values);
    return {bounds(scene.mesh->points).diagonal() / 2, values.low, values.high};
}

// Values that points have, and others; the smallest and the largest of the field, and beyond.
std::vector<IsoSurface> hard_values(const ScalarField& field) {
    const ScalarRange values = range(field.values);
    std::vector<IsoSurface> list{{values.low - 1}, {values.low}, {values.high}, {values.high + 1}, {0.4}, {0.6}};
    for (const std::size_t point : {17U, 99U, 200U}) list.push_back({field.values[point]});
    return list;
}

TEST(PreparedSurfaces, CrossedCellsHavePointsOnBothSides) {
    Scene scene = waves_with({{0.5}}, Shading::unlit);
    for (const double margin : {0.0, float32_margin}) {
        for (const IsoSurface& surface : hard_values(*scene.field)) {
            scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::vector{surface}), Shading::unlit, {}});
            const PreparedSurfaces prepared(scene, units_of(scene), {.margin = margin});
            // Scalars within a margin of an isovalue are told by float32; none but those that have it are so near here.
            std::vector<CellId> crossed;
            for (CellId cell = 0; cell < scene.mesh->tets.size(); ++cell) {
                const auto below = std::ranges::count_if(scene.mesh->tets[cell],
                                                         [&](VertexId v) { return scene.field->values[v] < surface.value; });
                if (below > 0 && below < 4) crossed.push_back(cell);
            }
            EXPECT_TRUE(std::ranges::equal(prepared.crossed(), crossed)) << surface.value << ", margin " << margin;
        }
    }
}

TEST(PreparedSurfaces, OtherIsovaluesKeepTheGradientsAndOtherShadingDoesNot) {
    const Scene scene = waves_with({{0.5}}, Shading::smooth);
    PreparedScene prepared(scene);
    const glm::vec3* gradients = prepared.surfaces()->gradients().data();
    const auto set = [&](double value, Shading shading) {
        prepared.set_surfaces(std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::vector<IsoSurface>{{value}}), shading, {}}));
    };
    set(0.3, Shading::smooth);
    EXPECT_EQ(prepared.surfaces()->gradients().data(), gradients);
    const Scene moved = waves_with({{0.3}}, Shading::smooth);
    EXPECT_TRUE(std::ranges::equal(prepared.surfaces()->crossed(), PreparedScene(moved).surfaces()->crossed()));
    set(0.3, Shading::flat);
    EXPECT_EQ(prepared.surfaces()->gradients().size(), scene.mesh->tets.size());
    set(0.3, Shading::unlit);
    EXPECT_TRUE(prepared.surfaces()->gradients().empty());
}

}  // namespace
}  // namespace cellproj
