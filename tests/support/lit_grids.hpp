// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids whose medium is lit by its gradient (SurfaceScene::lit_medium), and how far a picture of one is from the judge.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "render/grid_scene.hpp"
#include "render/judge/grid_reference.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj::testing_support {

inline const Lighting two_lights{.ambient = {0.1, 0.2, 0.05},
                                 .lights = {{.towards = glm::dvec3(1, -2, 2), .color = {1, 0.8, 0.6}}, {.diffuse = 0.3, .specular = 0.5}}};

inline std::shared_ptr<const SurfaceScene> lit_by(const Lighting& lighting, Shading shading, std::vector<IsoSurface> list = {}) {
    return std::make_shared<SurfaceScene>(
        SurfaceScene{.isosurfaces = IsoSurfaces(std::move(list)), .shading = shading, .lighting = lighting, .lit_medium = true});
}

inline GridScene lit(Grid grid, TransferFunction transfer, Shading shading, const Lighting& lighting = two_lights, std::vector<IsoSurface> list = {}) {
    return {std::make_shared<const Grid>(std::move(grid)), std::make_shared<const TransferFunction>(std::move(transfer)), lit_by(lighting, shading, std::move(list))};
}

inline GridReference judge(const GridScene& scene) { return {scene.grid, scene.transfer, scene.surfaces}; }

// Translucent ones among the medium.
inline const std::vector<IsoSurface> glass{
    {.value = 0.3, .color = {0.2, 0.9, 0.4}, .opacity = 0.5}, {.value = 0.5, .color = {1, 0, 0}, .opacity = 0.25}, {.value = 0.7, .color = {0.5, 0.5, 0.5}, .opacity = 0.8}};

inline GridAxis uneven_axis(std::mt19937_64& random, std::size_t points) {
    std::uniform_real_distribution<double> both(-1, 1);
    GridAxis axis;
    for (double x = 0; axis.points() < points; x += std::pow(10, 0.5 * both(random)) / static_cast<double>(points)) axis.coordinates.push_back(x);
    return axis;
}

struct LitView {
    GridScene scene;
    Camera camera;
    bool surfaces;
};

// A homogeneous medium in noise, whose gradient turns from cell to cell; by the number of the trial flat or smooth, on even or uneven axes,
// with glass in it or without, some cells blanked or none.
inline LitView lit_noise(int trial, Camera::Projection projection, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const Shading shading = trial % 2 == 0 ? Shading::flat : Shading::smooth;
    const bool uneven = trial / 2 % 2 == 1, surfaces = trial / 4 % 2 == 1;
    const auto value = [&](const glm::dvec3&) { return unit(random); };
    const GridAxis even = uniform_axis(0, 0.2, 6);
    Grid grid = uneven ? grid_of({uneven_axis(random, 5), uneven_axis(random, 6), uneven_axis(random, 4)}, value) : grid_of({even, even, even}, value);
    if (trial % 3 == 0) {
        grid.blanked.assign(grid.cell_count(), 0);
        for (auto& blanked : grid.blanked) blanked = unit(random) < 0.3 ? 1 : 0;
    }
    const Camera camera = frame_bounds(grid.bounds(), projection, {unit(random), -unit(random), unit(random)}, {0.1, 0.2, 1}, 1.2);
    const double depth = 2 / glm::length(grid.bounds().high - grid.bounds().low);
    return {lit(std::move(grid), constant_medium(depth), shading, two_lights, surfaces ? glass : std::vector<IsoSurface>{}), camera, surfaces};
}

// The largest error of all pixels. `tolerance`: where more is off, against what the judge sees within a thousandth of a pixel, too: a ray that just
// touches a surface or a step sees it or not, by float32.
inline double error_against_judge(const Image& image, const GridScene& scene, const Camera& camera, double tolerance) {
    return error_but_for_silhouettes(image, judge(scene), camera, tolerance, 1e-3);
}

}  // namespace cellproj::testing_support
