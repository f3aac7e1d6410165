// SPDX-License-Identifier: BSD-3-Clause
//
// Each stage of a picture by itself, on jittered grids of 0.2 and 1.5 million tetrahedra, at 512×512, a new view at every
// iteration. cellproj_bench --benchmark_filter=Project runs one of them; medians of several runs:
// --benchmark_repetitions=5 --benchmark_report_aggregates_only=true.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/preintegration_table.hpp"
#include "render/cell_stream.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

constexpr ImageSize size{512, 512};

// Boxes per axis: 5·34³ = 196,520 and 5·67³ = 1,503,815 tetrahedra.
constexpr int small_grid = 34, large_grid = 67;

TransferFunction ramp() {
    return {OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.1}, {1, 3.0}}};
}

// Built once for all benchmarks that use it.
const Scene& scene(int boxes) {
    static std::map<int, Scene> scenes;
    Scene& s = scenes[boxes];
    if (!s.mesh) {
        auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(boxes, 0.2, 1));
        s.field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
        s.mesh = std::move(mesh);
        s.transfer = std::make_shared<TransferFunction>(ramp());
    }
    return s;
}

void per_cell(benchmark::State& state, const Scene& s) {
    state.counters["tets"] = static_cast<double>(s.mesh->tets.size());
    state.counters["tets/s"] =
        benchmark::Counter(static_cast<double>(s.mesh->tets.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void Adjacency(benchmark::State& state) {
    const Scene& s = scene(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(build_adjacency(*s.mesh));
    per_cell(state, s);
}

void Prepare(benchmark::State& state) {  // adjacency, units, visibility
    const Scene& s = scene(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(std::make_unique<PreparedScene>(s));
    per_cell(state, s);
}

void Table(benchmark::State& state) {
    const TransferFunction transfer = ramp();
    for (auto _ : state) {
        benchmark::DoNotOptimize(PreintegrationTable(transfer, {0, 1, 2}, static_cast<int>(state.range(0))));
    }
}

void Update(benchmark::State& state, Backend backend) {  // another transfer function for a scene that is prepared
    Scene s = scene(static_cast<int>(state.range(0)));
    const auto renderer = make_renderer(backend);
    const Quality quality{.method = parse_method("integral")};
    renderer->prepare(s, quality);
    for (auto _ : state) {
        s.transfer = std::make_shared<TransferFunction>(ramp());
        renderer->prepare(s, quality);
    }
    per_cell(state, s);
}

void Project(benchmark::State& state) {  // transform, classes, silhouettes; without drawing
    const Scene& s = scene(static_cast<int>(state.range(0)));
    PreparedScene prepared(s);
    TriangleBatch batch;
    int i = 0;
    for (auto _ : state) {
        state.PauseTiming();
        const Camera camera = scenes::measured_view(i++);
        const auto order = prepared.sorter().order(camera.viewpoint());
        batch.clear();
        state.ResumeTiming();
        const CellStream cells(prepared, camera, size);
        cells.project(order, batch);
        benchmark::DoNotOptimize(batch.indices.data());
    }
    per_cell(state, s);
}

void Frame(benchmark::State& state) {  // camera to pixels in memory
    const Scene& s = scene(static_cast<int>(state.range(0)));
    const auto renderer = make_renderer(Backend::gl_osmesa);
    renderer->render(s, scenes::measured_view(0), size);
    int i = 1;
    for (auto _ : state) benchmark::DoNotOptimize(renderer->render(s, scenes::measured_view(i++), size).pixels.data());
    per_cell(state, s);
}

// RKE00: the time of a frame by a table does not depend on the transfer function (tests/paper_tables_test.cpp counts why).
// Nodes: 2, 10,000; the table is made before.
void FrameByNodes(benchmark::State& state) {
    Scene s = scene(small_grid);
    std::vector<ExtinctionNode> nodes;
    const auto last = static_cast<int>(state.range(0)) - 1;
    for (int i = 0; i <= last; ++i) nodes.push_back({static_cast<double>(i) / last, i % 2 == 0 ? 0.1 : 3.0});
    s.transfer = std::make_shared<TransferFunction>(OpticalModel::density, ramp().color_nodes(), nodes);
    const Quality table{.method = {.kind = MethodKind::preint3d}};
    const auto renderer = make_renderer(Backend::gl_osmesa);
    renderer->render(s, scenes::measured_view(0), size, table);
    int i = 1;
    for (auto _ : state) benchmark::DoNotOptimize(renderer->render(s, scenes::measured_view(i++), size, table).pixels.data());
    per_cell(state, s);
}

BENCHMARK(Adjacency)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Prepare)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Table)->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(Update, cpu, Backend::cpu)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(Update, gl, Backend::gl_osmesa)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Project)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(FrameByNodes)->Arg(2)->Arg(10000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(Frame)->Arg(small_grid)->Arg(large_grid)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
