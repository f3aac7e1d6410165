// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces: finding the crossings of segments by list and by table for 1 to 1000 of them, gradients, the judge with and without
// them, and whole frames of the CPU backend. cellproj_bench --benchmark_filter='Iso|Gradients'
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/isosurface.hpp"
#include "mesh/gradient.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/prepared_surfaces.hpp"
#include "render/prepared_scene.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

struct Ends {
    double s_f, s_b;
};

// Segments as cells of a fine mesh have them: 1 % of the field's range each.
std::vector<Ends> segments() {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> any(0, 1);
    std::vector<Ends> ends(4096);
    for (Ends& e : ends) {
        e.s_f = any(random);
        e.s_b = e.s_f + 0.02 * (any(random) - 0.5);
    }
    return ends;
}

IsoSurfaces evenly(std::int64_t count, double opacity = 0.5) {
    std::vector<IsoSurface> surfaces;
    for (std::int64_t i = 0; i < count; ++i)
        surfaces.push_back({(static_cast<double>(i) + 0.5) / static_cast<double>(count), {1, 0.5, 0}, opacity, {}});
    return IsoSurfaces(surfaces);
}

void IsoCrossingsByList(benchmark::State& state) {
    const IsoSurfaces surfaces = evenly(state.range(0));
    const std::vector<Ends> ends = segments();
    std::size_t crossed = 0;
    for (auto _ : state) {
        double sum = 0;
        crossed = 0;
        for (const Ends& e : ends) {
            const IsoCrossings crossings = surfaces.crossings(e.s_f, e.s_b);
            crossed += crossings.size();
            for (std::size_t i = 0; i < crossings.size(); ++i)
                sum += crossings[i].t;
        }
        benchmark::DoNotOptimize(sum);
    }
    state.counters["crossed"] = static_cast<double>(crossed) / static_cast<double>(ends.size());
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ends.size()));
}
BENCHMARK(IsoCrossingsByList)->Arg(1)->Arg(10)->Arg(100)->Arg(1000);

void IsoCrossingsByTable(benchmark::State& state) {
    const IsoSurfaceTable table(evenly(state.range(0)), 0, 1, 512);
    const std::vector<Ends> ends = segments();
    for (auto _ : state) {
        double sum = 0;
        for (const Ends& e : ends) {
            const auto& texel = table.lookup(e.s_f, e.s_b);
            sum += texel.opacity + texel.t;
        }
        benchmark::DoNotOptimize(sum);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ends.size()));
}
BENCHMARK(IsoCrossingsByTable)->Arg(1)->Arg(10)->Arg(100)->Arg(1000);

void MakeIsoTable(benchmark::State& state) {
    const IsoSurfaces surfaces = evenly(20);
    for (auto _ : state) {
        const IsoSurfaceTable table(surfaces, 0, 1, static_cast<int>(state.range(0)));
        benchmark::DoNotOptimize(table.texels().data());
    }
}
BENCHMARK(MakeIsoTable)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);

void CellGradients(benchmark::State& state) {
    const TetMesh mesh = testing_support::grid_mesh(34, 0.2, 1);
    const ScalarField field = testing_support::point_field(mesh, scenes::waves);
    for (auto _ : state)
        benchmark::DoNotOptimize(cell_gradients(mesh, field).values.data());
}
BENCHMARK(CellGradients)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void VertexGradients(benchmark::State& state) {
    const TetMesh mesh = testing_support::grid_mesh(34, 0.2, 1);
    const ScalarField field = testing_support::point_field(mesh, scenes::waves);
    for (auto _ : state)
        benchmark::DoNotOptimize(vertex_gradients(mesh, field).values.data());
}
BENCHMARK(VertexGradients)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// Rays of a picture of 64×64 of 196,520 cells: 0, 1, 10, 100 translucent surfaces in a medium, smooth.
void ReferenceWithIsosurfaces(benchmark::State& state) {
    auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(34, 0.2, 1));
    auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
    const auto transfer = std::make_shared<TransferFunction>(
        OpticalModel::density, std::vector<ColorNode>{{0, {0.1, 0.2, 0.9}}, {1, {1, 0.6, 0}}},
        std::vector<ExtinctionNode>{{0, 0.1}, {1, 3}});
    const Reference reference(
        {std::move(mesh), std::move(field), transfer, std::make_shared<SurfaceScene>(SurfaceScene{evenly(state.range(0), 0.05)})});
    const Camera camera =
        frame_bounds({glm::dvec3(0), glm::dvec3(1)}, Camera::Projection::perspective, {1.3, -2.1, 0.9}, {0, 0, 1}, 1);
    for (auto _ : state)
        benchmark::DoNotOptimize(reference.picture(camera, {64, 64}).data());
}
BENCHMARK(ReferenceWithIsosurfaces)->Arg(0)->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// ---- Frames of the CPU backend, 512², a new view each. "crossed": cells.

const TransferFunction nothing(OpticalModel::density, {{0, glm::dvec3(0)}}, {{0, 0}});

struct Flow {
    std::shared_ptr<const TetMesh> mesh;
    std::shared_ptr<const ScalarField> field;
};

// Density around the blunt fin; nothing where the data is not there.
const Flow& blunt_fin() {
    static const Flow flow = [] {
        const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
        if (!std::filesystem::exists(folder)) return Flow{};
        auto mesh = std::make_shared<TetMesh>(tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"})));
        auto field = std::make_shared<ScalarField>(select_scalar(*mesh, "Density", "bluntfin"));
        return Flow{mesh, field};
    }();
    return flow;
}

const Flow& waves_in(std::int64_t boxes) {
    static std::int64_t made = 0;
    static Flow flow;
    if (made != boxes) {
        auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(static_cast<int>(boxes), 0.2));
        auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
        flow = {mesh, field};
        made = boxes;
    }
    return flow;
}

Scene scene_of(const Flow& flow, std::vector<IsoSurface> surfaces, Shading shading, const TransferFunction& transfer) {
    return {flow.mesh, flow.field, std::make_shared<TransferFunction>(transfer),
            std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(surfaces)), shading})};
}

void draw_frames(benchmark::State& state, const Scene& scene) {
    const auto renderer = make_renderer(Backend::cpu);
    renderer->prepare(scene);
    const Bounds box = bounds(scene.mesh->points);
    const auto camera = [&](int i) {
        const double angle = 0.7 + 0.37 * i;
        return frame_bounds(box, Camera::Projection::perspective, {std::cos(angle), std::sin(angle), 0.4 + 0.3 * std::sin(1.7 * angle)}, {0, 0, 1}, 1.0);
    };
    Statistics statistics;
    int i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(renderer->render(scene, camera(i++ % 8), {512, 512}, {}, &statistics).pixels.data());
    const ScalarRange values = range(scene.field->values);
    const PreparedSurfaces surfaces(scene, SceneUnits{bounds(scene.mesh->points).diagonal() / 2, values.low, values.high});
    state.counters["crossed"] = static_cast<double>(surfaces.crossed().size());
    state.counters["fragments"] = static_cast<double>(statistics.counts.fragments);
    state.counters["sort"] = statistics.ms.sort;
    state.counters["project"] = statistics.ms.project;
    state.counters["draw"] = statistics.ms.draw;
}

// At the quantiles of the field, so that each crosses cells.
std::vector<IsoSurface> at_quantiles(const ScalarField& field, std::int64_t count, double opacity) {
    std::vector<IsoSurface> surfaces;
    for (std::int64_t i = 1; i <= count; ++i) {
        const double value = quantile(field.values, static_cast<double>(i) / static_cast<double>(count + 1));
        if (surfaces.empty() || value > surfaces.back().value) surfaces.push_back({value, {1, 0.5, 0}, opacity, {}});
    }
    return surfaces;
}

// `count` values so close together that they cross the same cells, but for a few of them.
std::vector<IsoSurface> in_the_same_cells(const ScalarField& field, std::int64_t count, double opacity) {
    const double middle = quantile(field.values, 0.5), range = quantile(field.values, 0.99) - quantile(field.values, 0.01);
    std::vector<IsoSurface> surfaces;
    for (std::int64_t i = 0; i < count; ++i)
        surfaces.push_back({middle + 1e-4 * range * static_cast<double>(i) / static_cast<double>(count - 1), {1, 0.5, 0}, opacity, {}});
    return surfaces;
}

template <class Surfaces>
void draw_blunt_fin(benchmark::State& state, Shading shading, bool medium, const Surfaces& surfaces) {
    if (!blunt_fin().mesh) {
        state.SkipWithError("no bluntfin in the shared data");
        return;
    }
    draw_frames(state, scene_of(blunt_fin(), surfaces(*blunt_fin().field), shading, medium ? scenes::ramp(0.19, 5, 20) : nothing));
}

void CpuIsoCount(benchmark::State& state, Shading shading, double opacity, bool medium) {
    draw_blunt_fin(state, shading, medium, [&](const ScalarField& field) { return at_quantiles(field, state.range(0), opacity); });
}
BENCHMARK_CAPTURE(CpuIsoCount, opaque_flat, Shading::flat, 1, false)->Arg(1)->Arg(2)->Arg(10)->Arg(100)->Arg(1000)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoCount, opaque_smooth, Shading::smooth, 1, false)->Arg(1)->Arg(2)->Arg(10)->Arg(100)->Arg(1000)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoCount, translucent_flat, Shading::flat, 0.1, false)->Arg(1)->Arg(2)->Arg(10)->Arg(100)->Arg(1000)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoCount, translucent_smooth, Shading::smooth, 0.1, false)->Arg(1)->Arg(2)->Arg(10)->Arg(100)->Arg(1000)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoCount, medium_smooth, Shading::smooth, 0.1, true)->Arg(1)->Arg(2)->Arg(10)->Arg(100)->Arg(1000)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void CpuIsoSameCells(benchmark::State& state, double opacity, bool medium) {
    draw_blunt_fin(state, Shading::smooth, medium, [&](const ScalarField& field) { return in_the_same_cells(field, state.range(0), opacity); });
}
BENCHMARK_CAPTURE(CpuIsoSameCells, opaque, 1, false)->Arg(2)->Arg(10)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoSameCells, translucent, 0.1, false)->Arg(2)->Arg(10)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoSameCells, medium, 0.1, true)->Arg(2)->Arg(10)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

// Three opaque surfaces alone, by the nearest one of each pixel, against the path of mixed scenes: a medium that nobody sees. 67 boxes
// along an edge: 1.5M tetrahedra.
void CpuIsoOpaqueAlone(benchmark::State& state, bool mixed) {
    const std::vector<IsoSurface> surfaces{{0.3}, {0.5}, {0.7}};
    const TransferFunction thin(OpticalModel::density, {{0, glm::dvec3(1)}}, {{0, 1e-30}});
    draw_frames(state, scene_of(waves_in(state.range(0)), surfaces, Shading::smooth, mixed ? thin : nothing));
}
BENCHMARK_CAPTURE(CpuIsoOpaqueAlone, nearest, false)->Arg(34)->Arg(67)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuIsoOpaqueAlone, mixed, true)->Arg(34)->Arg(67)->Iterations(16)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
