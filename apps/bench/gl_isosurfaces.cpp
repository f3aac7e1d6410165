// SPDX-License-Identifier: BSD-3-Clause
//
// Whole frames of isosurfaces in OpenGL, 512², perspective, a new view each time: cellproj_bench --benchmark_filter=GlIso
// GlIsoSameCells: the blunt fin (187,395 cells, its density); the others: a jittered grid.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

Renderer& gl() {
    static const auto renderer = make_renderer(Backend::gl_osmesa);
    return *renderer;
}

Scene grid(int boxes) {
    auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(boxes, 0.2));
    auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
    return {std::move(mesh), std::move(field), std::make_shared<TransferFunction>(scenes::ramp())};
}

std::optional<Scene> fin() {
    const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(folder)) return std::nullopt;
    auto mesh = std::make_shared<TetMesh>(tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"})));
    auto field = std::make_shared<ScalarField>(select_scalar(*mesh, "Density", "bluntfin"));
    const ScalarRange values = range(field->values);
    return Scene{std::move(mesh), std::move(field), std::make_shared<TransferFunction>(scenes::ramp(values.low, values.high, 10))};
}

Scene without_medium(Scene scene) {
    scene.transfer = std::make_shared<TransferFunction>(OpticalModel::density, std::vector<ColorNode>{{0, glm::dvec3(1)}},
                                                        std::vector<ExtinctionNode>{{0, 0}});
    return scene;
}

// `count` values, evenly between two.
Scene with_surfaces(Scene scene, std::int64_t count, ScalarRange between, double opacity, Shading shading) {
    std::vector<IsoSurface> list;
    for (std::int64_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        list.push_back({(1 - share) * between.low + share * between.high, {1, 0.5, 0.1}, opacity, {}});
    }
    scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(list), shading, {}});
    return scene;
}

void frames(benchmark::State& state, const Scene& scene) {
    gl().prepare(scene);
    const Bounds box = bounds(scene.mesh->points);
    Statistics statistics;
    double drawn = 0;
    int i = 0;
    for (auto _ : state) {
        const double angle = 0.7 + 0.37 * i++;
        const Camera camera = frame_bounds(box, Camera::Projection::perspective,
                                           {std::cos(angle), std::sin(angle), 0.4 + 0.3 * std::sin(1.7 * angle)}, {0, 0, 1}, 1.0);
        benchmark::DoNotOptimize(gl().render(scene, camera, {512, 512}, {}, &statistics).pixels.data());
        drawn += static_cast<double>(statistics.counts.drawn);
    }
    state.counters["tets"] = static_cast<double>(scene.mesh->tets.size());
    state.counters["drawn"] = drawn / i;
}

// Surfaces all over the field's range, nothing else. Arguments: boxes along an edge, surfaces, opacity in percent.
void GlIsoCount(benchmark::State& state) {
    frames(state, with_surfaces(without_medium(grid(static_cast<int>(state.range(0)))), state.range(1), {0, 1},
                                static_cast<double>(state.range(2)) / 100, Shading::smooth));
}
BENCHMARK(GlIsoCount)
    ->ArgsProduct({{34}, {1, 2, 10, 100, 1000}, {5, 100}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

// Three surfaces in a medium, or only the medium. Arguments: boxes along an edge, Shading (−1: no surfaces).
void GlIsoMixed(benchmark::State& state) {
    Scene scene = grid(static_cast<int>(state.range(0)));
    if (state.range(1) >= 0) scene = with_surfaces(scene, 3, {0, 1}, 0.5, static_cast<Shading>(state.range(1)));
    frames(state, scene);
}
BENCHMARK(GlIsoMixed)->ArgsProduct({{34}, {-1, 2, 0, 1}})->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// What it saves that opaque surfaces alone need no order, no medium and only the cells they cross. Arguments: boxes along an edge, with
// a medium (1) or without (0).
void GlIsoOpaque(benchmark::State& state) {
    const Scene scene = with_surfaces(grid(static_cast<int>(state.range(0))), 1, {0.45, 0.65}, 1, Shading::smooth);
    frames(state, state.range(1) ? scene : without_medium(scene));
}
BENCHMARK(GlIsoOpaque)->ArgsProduct({{34, 67}, {1, 0}})->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// Values so close that they cross the same cells, in the blunt fin. Arguments: surfaces, Shading, opacity in percent.
void GlIsoSameCells(benchmark::State& state) {
    static const std::optional<Scene> scene = fin();
    if (!scene) {
        state.SkipWithError("no blunt fin");
        return;
    }
    frames(state, with_surfaces(without_medium(*scene), state.range(0), {2, 2.001}, static_cast<double>(state.range(2)) / 100,
                                static_cast<Shading>(state.range(1))));
}
BENCHMARK(GlIsoSameCells)->ArgsProduct({{2, 10}, {0, 1}, {10, 100}})->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
