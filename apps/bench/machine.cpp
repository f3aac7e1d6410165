// SPDX-License-Identifier: BSD-3-Clause
//
// What the machine can do at most, to compare frames with: bytes copied through memory and multiply-adds in registers, on one core and on two.
// Argument: threads.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "apps/bench/machine.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cellproj::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Sixteen chains hide the latency of an instruction on every machine so far. Returns the floating-point operations of a round trip.
double MultiplyAdd(int rounds, float* sum) {
    constexpr int chains = 16;
    const hn::ScalableTag<float> d;
    using V = hn::Vec<decltype(d)>;
    const V factor = hn::Set(d, 0.999F), term = hn::Set(d, 1e-3F);
    V a = hn::Iota(d, 0), b = hn::Iota(d, 1), c = hn::Iota(d, 2), e = hn::Iota(d, 3), f = hn::Iota(d, 4), g = hn::Iota(d, 5);
    V h = hn::Iota(d, 6), i = hn::Iota(d, 7), j = hn::Iota(d, 8), k = hn::Iota(d, 9), l = hn::Iota(d, 10), m = hn::Iota(d, 11);
    V n = hn::Iota(d, 12), o = hn::Iota(d, 13), p = hn::Iota(d, 14), q = hn::Iota(d, 15);
    for (int round = 0; round < rounds; ++round)
        for (V* v : {&a, &b, &c, &e, &f, &g, &h, &i, &j, &k, &l, &m, &n, &o, &p, &q}) *v = hn::MulAdd(*v, factor, term);
    V all = hn::Zero(d);
    for (const V& v : {a, b, c, e, f, g, h, i, j, k, l, m, n, o, p, q}) all = hn::Add(all, v);
    *sum += hn::GetLane(hn::SumOfLanes(d, all));
    return 2.0 * chains * static_cast<double>(hn::Lanes(d)) * rounds;
}

}  // namespace cellproj::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <benchmark/benchmark.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace cellproj::bench {

HWY_EXPORT(MultiplyAdd);

namespace {

// Runs body(i) for each of the threads, at a time.
template <class Body>
void on_each(int threads, const Body& body) {
    oneapi::tbb::task_arena arena(threads);
    arena.execute([&] { oneapi::tbb::parallel_for(0, threads, body, oneapi::tbb::simple_partitioner()); });
}

void MachineCopy(benchmark::State& state) {
    constexpr std::size_t bytes = std::size_t{1} << 27;  // four times the largest cache
    const int threads = static_cast<int>(state.range(0));
    std::vector<std::vector<char>> from(2, std::vector<char>(bytes, 1)), to = from;
    for (auto _ : state) {
        on_each(threads, [&](int i) { std::memcpy(to[static_cast<std::size_t>(i)].data(), from[static_cast<std::size_t>(i)].data(), bytes); });
        benchmark::ClobberMemory();
    }
    // Read and written.
    state.counters["bytes/s"] = benchmark::Counter(2.0 * static_cast<double>(bytes) * threads, benchmark::Counter::kIsIterationInvariantRate);
}

void MachineMultiplyAdd(benchmark::State& state) {
    const int threads = static_cast<int>(state.range(0));
    double operations = 0;
    for (auto _ : state) {
        float sums[2] = {};
        on_each(threads, [&](int i) { operations = HWY_DYNAMIC_DISPATCH(MultiplyAdd)(1 << 22, &sums[i]); });
        benchmark::DoNotOptimize(sums);
    }
    state.counters["flop/s"] = benchmark::Counter(operations * threads, benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(MachineCopy)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(MachineMultiplyAdd)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cellproj::bench
#endif
