// SPDX-License-Identifier: BSD-3-Clause
//
// The order of cells: jittered grids of 0.2, 1.5 and 6 million tetrahedra as they come (row by row) and shuffled, a new view at every
// iteration. cellproj_bench --benchmark_filter=Order prints what sort/README.md shows.
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

// Boxes per axis: 5·34³ = 196,520, 5·67³ = 1,503,815 and 5·106³ = 5,955,080 tetrahedra.
constexpr int small_grid = 34, large_grid = 67, huge_grid = 106;

enum Input { in_rows, shuffled };

// One at a time: the largest takes 2 GB with its sorter.
const TetMesh& grid(int boxes, Input input) {
    static std::pair<int, Input> made{0, in_rows};
    static TetMesh mesh;
    if (made != std::pair{boxes, input}) {
        mesh = testing_support::grid_mesh(boxes, 0.2, 1);
        std::mt19937_64 random(2);
        if (input == shuffled) {
            std::shuffle(mesh.tets.begin(), mesh.tets.end(), random);
            mesh = testing_support::relabelled(mesh, random);
        }
        made = {boxes, input};
    }
    return mesh;
}

Eye eye_at(double angle) {
    return Eye::at({0.5 + 3 * std::cos(angle), 0.5 + 3 * std::sin(angle), 0.9 + 0.5 * std::sin(1.7 * angle)});
}

void order_views(benchmark::State& state, OrderMethod method, double step) {
    const TetMesh& mesh = grid(static_cast<int>(state.range(0)), static_cast<Input>(state.range(1)));
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(state.range(2)));
    VisibilitySorter sorter(mesh);
    double angle = 0.7;
    sorter.order(eye_at(angle), nullptr, method);  // makes what the method keeps
    for (auto _ : state) benchmark::DoNotOptimize(sorter.order(eye_at(angle += step), nullptr, method));
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void OrderCentroid(benchmark::State& state) { order_views(state, OrderMethod::centroid, 0.37); }
void OrderPower(benchmark::State& state) { order_views(state, OrderMethod::power, 0.37); }
void OrderMpvo(benchmark::State& state) { order_views(state, OrderMethod::mpvo, 0.37); }
void OrderMpvoOrbit(benchmark::State& state) { order_views(state, OrderMethod::mpvo, std::numbers::pi / 180); }

void OrderPrepare(benchmark::State& state) {  // with the adjacency
    const TetMesh& mesh = grid(static_cast<int>(state.range(0)), static_cast<Input>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(VisibilitySorter(mesh).convex());
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

// grid, input, threads
void by_threads(benchmark::internal::Benchmark* benchmark) {
    for (const int boxes : {small_grid, large_grid, huge_grid}) {
        for (const Input input : {in_rows, shuffled}) {
            for (const int threads : {1, 2}) benchmark->Args({boxes, input, threads});
        }
    }
}

BENCHMARK(OrderCentroid)->Apply(by_threads)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(OrderPower)->Apply(by_threads)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(OrderMpvo)->Apply(by_threads)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(OrderMpvoOrbit)
    ->Args({large_grid, in_rows, 2})->Args({large_grid, shuffled, 2})
    ->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
BENCHMARK(OrderPrepare)
    ->Args({large_grid, in_rows})->Args({large_grid, shuffled})->Args({huge_grid, shuffled})
    ->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

}  // namespace
