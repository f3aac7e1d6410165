// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces: finding the crossings of segments by list and by table for 1 to 1000 of them, gradients, and the judge with and without
// them. cellproj_bench --benchmark_filter='Iso|Gradients'
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/isosurface.hpp"
#include "mesh/gradient.hpp"
#include "render/reference.hpp"
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

}  // namespace
