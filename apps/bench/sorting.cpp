// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells: jittered grids of 0.2, 1.5 and 6 million tetrahedra as they come (row by row) and shuffled, a new view at every
// iteration. cellproj_bench --benchmark_filter=^Order prints what sort/README.md shows. "bytes" is what a sorter holds after its last view,
// per cell. Arguments: boxes along an edge, 1 for shuffled, threads.
#include <benchmark/benchmark.h>
#include <malloc.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/order_check.hpp"
#include "sort/cell_graph.hpp"
#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

// Boxes per axis: 5·34³ = 196,520, 5·67³ = 1,503,815 and 5·106³ = 5,955,080 tetrahedra.
constexpr int small_grid = 34, large_grid = 67, huge_grid = 106;

enum Input { in_rows, shuffled };

TetMesh in_order(TetMesh mesh, Input input) {
    if (input == in_rows) return mesh;
    std::mt19937_64 random(2);
    std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
    return testing_support::relabelled(mesh, random);
}

// One at a time: the largest takes 2 GB with its sorter.
const TetMesh& grid(int boxes, Input input) {
    static std::pair<int, Input> made{0, in_rows};
    static TetMesh mesh;
    if (made != std::pair{boxes, input}) mesh = in_order(testing_support::grid_mesh(boxes, 0.2, 1), input);
    made = {boxes, input};
    return mesh;
}

Eye eye_at(double angle) {
    return Eye::at({0.5 + 3 * std::cos(angle), 0.5 + 3 * std::sin(angle), 0.9 + 0.5 * std::sin(1.7 * angle)});
}

// On the heap.
std::size_t bytes_in_use() {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

oneapi::tbb::global_control threads(benchmark::State& state) {
    return {oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(2))};
}

void order_views(benchmark::State& state, const TetMesh& mesh, OrderMethod method, double degrees) {
    const auto limit = threads(state);
    const std::size_t before = bytes_in_use();
    VisibilitySorter sorter(mesh);
    const double step = degrees * std::numbers::pi / 180;
    double angle = 0.7;
    OrderReport report;
    sorter.order(eye_at(angle), &report, method);  // makes what the method keeps
    for (auto _ : state) benchmark::DoNotOptimize(sorter.order(eye_at(angle += step), &report, method));
    const auto cells = static_cast<double>(mesh.tets.size());
    state.counters["tets"] = cells;
    state.counters["bytes"] = static_cast<double>(bytes_in_use() - before) / cells;
    state.counters["exact"] = report.exact ? 1 : 0;
}

void OrderGrid(benchmark::State& state, OrderMethod method, double degrees) {
    const TetMesh& mesh = grid(static_cast<int>(state.range(0)), static_cast<Input>(state.range(1)));
    order_views(state, mesh, method, degrees);
}

// A mesh that powers order exactly: keys, sort, pairs in doubt. Points of the mesh, 1 for shuffled, threads.
void OrderDelaunay(benchmark::State& state, OrderMethod method) {
    try {
        static const TetMesh mesh = testing_support::delaunay_mesh(static_cast<int>(state.range(0)));
        const TetMesh ordered = in_order(mesh, static_cast<Input>(state.range(1)));
        order_views(state, ordered, method, 21);
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
}

// The blunt fin at 512², as it comes.
void OrderBluntFin(benchmark::State& state, OrderMethod method) {
    const std::filesystem::path data = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(data)) {
        state.SkipWithError("no bluntfin in the shared data");
        return;
    }
    const TetMesh mesh = tetrahedralize(read(data / "bluntfinxyz.bin", {.solution = data / "bluntfinq.bin"}));
    const auto limit = threads(state);
    VisibilitySorter sorter(mesh);
    double angle = 0.7;
    OrderReport report;
    for (auto _ : state) {
        angle += 0.37;
        const Camera camera = frame_bounds(bounds(mesh.points), Camera::Projection::perspective,
                                           {std::cos(angle), std::sin(angle), 0.4 + 0.3 * std::sin(1.7 * angle)}, {0, 0, 1}, 1.0);
        const PixelGrid pixels = pixel_grid(camera, {512, 512});
        benchmark::DoNotOptimize(sorter.order(pixels.eye, &report, method, &pixels));
    }
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
    state.counters["exact"] = report.exact ? 1 : 0;
}

void OrderRelations(benchmark::State& state) {  // the parallel half of mpvo
    const TetMesh& mesh = grid(static_cast<int>(state.range(0)), static_cast<Input>(state.range(1)));
    const auto limit = threads(state);
    const CellGraph graph(mesh, build_adjacency(mesh));
    std::vector<CellGraph::Relations> relations(graph.size() + 1);
    double angle = 0.7;
    for (auto _ : state) {
        graph.find_relations(eye_at(angle += 0.37), relations);
        benchmark::DoNotOptimize(relations.data());
    }
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void OrderPrepare(benchmark::State& state) {  // with the adjacency
    const TetMesh& mesh = grid(static_cast<int>(state.range(0)), static_cast<Input>(state.range(1)));
    const auto limit = threads(state);
    for (auto _ : state) benchmark::DoNotOptimize(VisibilitySorter(mesh).convex());
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void in_real_time(benchmark::internal::Benchmark* benchmark) {
    benchmark->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}

void by_size_and_threads(benchmark::internal::Benchmark* benchmark) {
    for (const int boxes : {small_grid, large_grid, huge_grid}) {
        for (const Input input : {in_rows, shuffled}) {
            for (const int count : {1, 2}) benchmark->Args({boxes, input, count});
        }
    }
    in_real_time(benchmark);
}

void at_large(benchmark::internal::Benchmark* benchmark) {
    for (const Input input : {in_rows, shuffled}) benchmark->Args({large_grid, input, 2});
    in_real_time(benchmark);
}

void delaunay(benchmark::internal::Benchmark* benchmark) {
    for (const Input input : {in_rows, shuffled}) benchmark->Args({30000, input, 2});
    in_real_time(benchmark);
}

BENCHMARK_CAPTURE(OrderGrid, centroid, OrderMethod::centroid, 21)->Apply(by_size_and_threads);
BENCHMARK_CAPTURE(OrderGrid, power, OrderMethod::power, 21)->Apply(by_size_and_threads);
BENCHMARK_CAPTURE(OrderGrid, mpvo, OrderMethod::mpvo, 21)->Apply(by_size_and_threads);
BENCHMARK_CAPTURE(OrderGrid, mpvo_by_1_degree, OrderMethod::mpvo, 1)->Apply(at_large)->Iterations(70);  // from its start
BENCHMARK_CAPTURE(OrderGrid, mpvo_by_a_tenth, OrderMethod::mpvo, 0.1)->Apply(at_large)->Iterations(70);
BENCHMARK_CAPTURE(OrderGrid, bsp, OrderMethod::bsp, 21)->Apply(at_large);
BENCHMARK(OrderRelations)->Apply(by_size_and_threads);
BENCHMARK_CAPTURE(OrderDelaunay, power, OrderMethod::power)->Apply(delaunay);
BENCHMARK_CAPTURE(OrderDelaunay, mpvo, OrderMethod::mpvo)->Apply(delaunay);
BENCHMARK_CAPTURE(OrderBluntFin, sxmpvo, OrderMethod::sxmpvo)->Args({0, in_rows, 2})->Apply(in_real_time);
BENCHMARK_CAPTURE(OrderBluntFin, bsp, OrderMethod::bsp)->Args({0, in_rows, 2})->Apply(in_real_time);
BENCHMARK_CAPTURE(OrderBluntFin, mpvo, OrderMethod::mpvo)->Args({0, in_rows, 2})->Apply(in_real_time);
BENCHMARK(OrderPrepare)->Args({large_grid, in_rows, 2})->Args({large_grid, shuffled, 2})->Args({huge_grid, shuffled, 2})->Apply(in_real_time);

}  // namespace
