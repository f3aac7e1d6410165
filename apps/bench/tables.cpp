// SPDX-License-Identifier: BSD-3-Clause
//
// Tables of the methods: CPU time of one core to make and to update one, the ratios that EKE01 §3.3 and §3.5 speak of,
// and how wrong every method is. cellproj_tables --benchmark_filter=Make, Update, Ratio or Error runs a part; medians:
// --benchmark_repetitions=5 --benchmark_report_aggregates_only=true.
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <random>
#include <string>
#include <utility>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/mean_tables.hpp"
#include "classify/preintegration_table.hpp"
#include "classify/segment_integral.hpp"
#include "classify/segment_method.hpp"

namespace {

using namespace cellproj;

constexpr double longest = 2.0, usual = 0.15;

// Hills, and a node between them that changes.
TransferFunction hills(double changed = 4.0) {
    return {OpticalModel::density,
            {{0, {0.1, 0.2, 0.9}}, {0.3, {0.1, 0.9, 0.3}}, {0.6, {0.9, 0.9, 0.1}}, {1, {1.0, 0.3, 0.0}}},
            {{0, 0.1}, {0.2, 3.0}, {0.24, changed}, {0.28, 2.0}, {0.7, 0.0}, {1, 6.0}}};
}

// The two tables over (s_f, s_b), with and without self-attenuation, and the one over l as well.
MeanLengthTable preint2d(const TransferFunction& f, int size) {
    return {f, usual, size, TableStorage::float32};
}
MeanValueTable preint2d_exp(const TransferFunction& f, int size) {
    return {f, size, TableStorage::float32};
}
PreintegrationTable preint3d(const TransferFunction& f, int size) {
    return {f, {0, 1, longest}, size};
}

template <auto MakeTable>
void Make(benchmark::State& state) {
    const oneapi::tbb::global_control one_core(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    for (auto _ : state)
        benchmark::DoNotOptimize(MakeTable(hills(), static_cast<int>(state.range(0))).texels().data());
}

// One node of six goes up and down: the share of the pairs that are computed, and the time of it.
template <auto MakeTable>
void Update(benchmark::State& state) {
    const oneapi::tbb::global_control one_core(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const int size = static_cast<int>(state.range(0));
    const TransferFunction low = hills(3.5), high = hills(4.5);
    auto table = MakeTable(low, size);
    std::size_t computed = 0;
    bool up = false;
    for (auto _ : state) {
        up = !up;
        computed = table.update(up ? high : low);
    }
    state.counters["share"] = static_cast<double>(computed) / (static_cast<double>(size) * size);
}

// CPU milliseconds, median of five.
template <class Work>
double median_ms(Work work) {
    std::array<double, 5> ms{};
    for (double& time : ms) {
        const std::clock_t start = std::clock();
        work();
        time = 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    }
    std::sort(ms.begin(), ms.end());
    return ms[2];
}

// With self-attenuation against without, and a local update against the whole table.
void Ratio(benchmark::State& state) {
    const oneapi::tbb::global_control one_core(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const int size = static_cast<int>(state.range(0));
    const TransferFunction low = hills(3.5), high = hills(4.5);
    const auto times = [&](auto make_table) {
        auto table = make_table(low, size);
        const double make_ms = median_ms([&] { table = make_table(low, size); });
        bool up = false;
        const double update_ms = median_ms([&] { table.update((up = !up) ? high : low); });
        return std::pair(make_ms, update_ms);
    };
    for (auto _ : state) {
        const auto [with, with_update] = times(preint2d);
        const auto [without, without_update] = times(preint2d_exp);
        state.counters["make, with/without"] = with / without;
        state.counters["update, with/without"] = with_update / without_update;
        state.counters["with, update/make"] = with_update / with;
        state.counters["without, update/make"] = without_update / without;
    }
}

// Root mean square and largest error of the colour channels and the opacity over 20,000 random segments: ramp or peaks,
// ends up to .02 or .2 apart, lengths up to .03 or .3.
void Error(benchmark::State& state, const std::string& name) {
    const bool narrow = state.range(0) != 0;
    const double reach = state.range(1) != 0 ? 10.0 : 1.0;
    const TransferFunction f = narrow ? scenes::table_peaks() : scenes::ramp();
    const auto method = make_segment_method(parse_method(name), f, longest, usual);
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double squares = 0.0, largest = 0.0;
    constexpr int segments = 20000;
    for (auto _ : state) {
        for (int i = 0; i < segments; ++i) {
            const double s_f = unit(random), s_b = std::clamp(s_f + 0.02 * reach * (2 * unit(random) - 1), 0.0, 1.0);
            const double l = 0.03 * reach * unit(random);
            const Light light = method->light(s_f, s_b, l), exact = integrate_segment(f, s_f, s_b, l);
            for (const double e : {light.color.r - exact.color.r, light.color.g - exact.color.g,
                                   light.color.b - exact.color.b, light.opacity - exact.opacity}) {
                squares += e * e;
                largest = std::max(largest, std::abs(e));
            }
        }
    }
    state.counters["rms"] = std::sqrt(squares / (4.0 * segments));
    state.counters["max"] = largest;
    state.counters["bytes"] = static_cast<double>(method->table_bytes());
}

BENCHMARK(Make<preint2d>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(Make<preint2d_exp>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(Make<preint3d>)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(Update<preint2d>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(Update<preint2d_exp>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond);
BENCHMARK(Update<preint3d>)->Arg(64)->Unit(benchmark::kMillisecond);
BENCHMARK(Ratio)->Arg(256)->Arg(1024)->Iterations(1)->Unit(benchmark::kMillisecond);

const bool errors_registered = [] {
    for (const char* name :
         {"average", "homogeneous", "linear:1", "linear:8", "linear:64", "stein", "preint2d:256", "preint2d:256:uint8",
          "preint2d-exp:256", "preint2d-exp:1024", "preint2d-exp:256:uint8", "preint2d-exp:256:float16", "preint3d:64",
          "preint3d:128", "preint3d:64:uint8", "preint3d:64:float16", "preint3d:64:linear", "preint3d:64:linear:uint8"})
        benchmark::RegisterBenchmark((std::string("Error/") + name).c_str(), Error, name)
            ->ArgsProduct({{0, 1}, {0, 1}})
            ->ArgNames({"peaks", "large"})
            ->Iterations(1);
    return true;
}();

}  // namespace

BENCHMARK_MAIN();
