// SPDX-License-Identifier: BSD-3-Clause
//
// What each rule of the plan (render/plan.hpp) saves: whole frames of the CPU backend by it and without it, where the rule has a switch, or of the
// general scene. Argument: boxes along an edge of a jittered grid (34: 0.2M tetrahedra, 67: 1.5M). 512² pixels, a new view each frame.
// cellproj_bench --benchmark_filter=Plan
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace {

const TransferFunction nothing(OpticalModel::density, {{0, glm::dvec3(0)}}, {{0, 0}});

// One grid at a time: they are large.
Scene waves_in(std::int64_t boxes, const TransferFunction& transfer) {
    static std::int64_t made = 0;
    static Scene scene;
    if (made != boxes) {
        scene = {};
        auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(static_cast<int>(boxes), 0.2));
        scene.field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
        scene.mesh = std::move(mesh);
        made = boxes;
    }
    Scene result = scene;
    result.transfer = std::make_shared<TransferFunction>(transfer);
    return result;
}

const std::vector<double> one{0.5}, three{0.3, 0.5, 0.7};

Scene with_opaque_surfaces(Scene scene, const std::vector<double>& values, Shading shading) {
    std::vector<IsoSurface> list;
    for (const double value : values) list.push_back({value, {1, 0.5, 0}, 1, {}});
    scene.surfaces = std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), shading});
    return scene;
}

using View = Camera (*)(int);
Camera view(int i) { return scenes::measured_view(i); }
Camera parallel_view(int i) { return scenes::measured_view(i, {glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::parallel); }
Camera view_beside(int i) {
    Camera camera = view(i);
    camera.eye += glm::dvec3(9, 0, 0);
    camera.center += glm::dvec3(9, 0, 0);
    return camera;
}

void frames(benchmark::State& state, const Scene& scene, const PlanRules& rules, View camera = view, const Quality& quality = {}) {
    const auto renderer = make_renderer(Backend::cpu, {.rules = rules});
    renderer->prepare(scene, quality);
    Statistics statistics;
    int i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(renderer->render(scene, camera(i++ % 8), {512, 512}, quality, &statistics).pixels.data());
    state.counters["tets"] = static_cast<double>(scene.mesh->tets.size());
    state.counters["drawn"] = static_cast<double>(statistics.counts.drawn);
    state.counters["sort"] = statistics.ms.sort;
    state.counters["project"] = statistics.ms.project;
    state.counters["draw"] = statistics.ms.draw;
}

// Opaque surfaces alone. By the rule; sorted: the crossed cells, in an order; mixed: in a medium that nobody sees, all cells, in an order; in_ramp: in a
// medium that is seen, which is another picture.
void PlanOpaqueSurfaces(benchmark::State& state, const std::vector<double>& values, const TransferFunction& medium, bool nearest) {
    frames(state, with_opaque_surfaces(waves_in(state.range(0), medium), values, Shading::smooth), {.nearest_surfaces = nearest});
}
const TransferFunction thin(OpticalModel::density, {{0, glm::dvec3(1)}}, {{0, 1e-30}, {1, 2e-30}});

// A transfer function that shows about 5 % of the cells.
void PlanCulling(benchmark::State& state, bool culling, bool few_cells) {
    Scene scene = waves_in(state.range(0), nothing);
    const double low = quantile(scene.field->values, 0.962);
    const TransferFunction top(OpticalModel::density, {{0, {0.9, 0.4, 0.1}}}, {{low, 0}, {1, 40}});
    scene.transfer = std::make_shared<TransferFunction>(top);
    frames(state, scene, {.culling = culling, .few_cells = few_cells});
    const SceneFacts facts = PreparedScene(scene).facts();
    state.counters["seen_percent"] = 100.0 * static_cast<double>(facts.medium) / static_cast<double>(facts.cells);
}

void PlanSum(benchmark::State& state, bool sum) {
    const TransferFunction glow(OpticalModel::emitter, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0}});
    frames(state, waves_in(state.range(0), glow), {.sum = sum});
}

void PlanConstantLight(benchmark::State& state, const char* method, bool closed_form) {
    const TransferFunction constant(OpticalModel::density, {{0, {0.9, 0.4, 0.1}}}, {{0, 2}});
    frames(state, waves_in(state.range(0), constant), {.constant_light = closed_form}, view, {.method = parse_method(method)});
}

void PlanEmptyView(benchmark::State& state, bool at_once) { frames(state, waves_in(state.range(0), scenes::ramp()), {.empty_view = at_once}, view_beside); }

void PlanNothingSeen(benchmark::State& state, bool at_once) { frames(state, waves_in(state.range(0), nothing), {.nothing_seen = at_once, .sum = at_once}); }

// Everything that is made once for surfaces of a shading.
void PlanGradients(benchmark::State& state, Shading shading) {
    const Scene scene = with_opaque_surfaces(waves_in(state.range(0), nothing), three, shading);
    for (auto _ : state) {
        const auto renderer = make_renderer(Backend::cpu);
        renderer->prepare(scene);
        benchmark::DoNotOptimize(renderer.get());
    }
}

void PlanFieldOnCells(benchmark::State& state, bool on_cells) {
    Scene scene = waves_in(state.range(0), scenes::ramp());
    if (on_cells) {
        ScalarField field{"c", FieldLocation::cells, {}};
        for (CellId cell = 0; cell < scene.mesh->tets.size(); ++cell) field.values.push_back(scene.field->at(*scene.mesh, cell, 0));
        scene.field = std::make_shared<ScalarField>(std::move(field));
    }
    frames(state, scene, {});
}

void PlanProjection(benchmark::State& state, View camera) { frames(state, waves_in(state.range(0), scenes::ramp()), {}, camera); }

void in_frames(benchmark::internal::Benchmark* benchmark) {
    benchmark->Arg(34)->Arg(67)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, one_nearest, one, nothing, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, one_mixed, one, thin, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, three_nearest, three, nothing, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, three_sorted, three, nothing, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, three_mixed, three, thin, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanOpaqueSurfaces, three_in_ramp, three, scenes::ramp(), false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanCulling, on, true, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanCulling, sorted, true, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanCulling, off, false, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanSum, on, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanSum, off, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, exact_on, "exact:1e-5", true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, exact_off, "exact:1e-5", false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, linear_on, "linear:8", true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, linear_off, "linear:8", false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, table_on, "preint2d-exp:256", true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanConstantLight, table_off, "preint2d-exp:256", false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanEmptyView, on, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanEmptyView, off, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanNothingSeen, on, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanNothingSeen, off, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanFieldOnCells, on_cells, true)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanFieldOnCells, on_points, false)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanProjection, parallel, parallel_view)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanProjection, perspective, view)->Apply(in_frames);
BENCHMARK_CAPTURE(PlanGradients, unlit, Shading::unlit)->Arg(67)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(PlanGradients, flat, Shading::flat)->Arg(67)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(PlanGradients, smooth, Shading::smooth)->Arg(67)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace cellproj
