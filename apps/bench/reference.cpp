// SPDX-License-Identifier: BSD-3-Clause
//
// The judge: its index, whole pictures of 512×512 and samples of them, on a jittered grid of 0.2 million tetrahedra and, where
// the real files lie beside the project, on the blunt fin as the README shows it. The column CPU counts all threads.
// cellproj_bench --benchmark_filter=Reference
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/judge/reference.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;

constexpr ImageSize size{512, 512};

// A scene and the camera that looks at it. No mesh: its files are not here.
struct View {
    Scene scene;
    Camera camera;
};

const View& grid() {
    static const View view = [] {
        auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(34, 0.2, 1));
        auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
        auto transfer = std::make_shared<TransferFunction>(OpticalModel::density,
                                                           std::vector<ColorNode>{{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}},
                                                           std::vector<ExtinctionNode>{{0, 0.1}, {1, 3.0}});
        const Camera camera =
            frame_bounds(bounds(mesh->points), Camera::Projection::perspective, {1.3, -2.1, 0.9}, {0, 0, 1}, 1.0);
        return View{{mesh, field, transfer}, camera};
    }();
    return view;
}

const View& bluntfin() {
    static const View view = [] {
        const std::filesystem::path data = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin", scenes = CELLPROJ_SCENES;
        if (!std::filesystem::exists(data)) return View{};
        auto mesh =
            std::make_shared<TetMesh>(tetrahedralize(read(data / "bluntfinxyz.bin", {.solution = data / "bluntfinq.bin"})));
        auto field = std::make_shared<ScalarField>(select_scalar(*mesh, "", "blunt fin"));
        auto transfer = std::make_shared<TransferFunction>(read_transfer_function(scenes / "bluntfin_transfer.json"));
        return View{{mesh, field, transfer}, read_cameras(scenes / "bluntfin_camera.json").at(0)};
    }();
    return view;
}

// Whether there is a scene; the others are shown as skipped.
bool present(benchmark::State& state, const View& view) {
    if (view.scene.mesh) state.counters["tets"] = static_cast<double>(view.scene.mesh->tets.size());
    else state.SkipWithError("no such file beside the project");
    return view.scene.mesh != nullptr;
}

void ReferenceIndex(benchmark::State& state, const View& (*view)()) {
    if (!present(state, view())) return;
    for (auto _ : state)
        benchmark::DoNotOptimize(RayIndex(*view().scene.mesh).middle());
}

void ReferencePicture(benchmark::State& state, const View& (*view)()) {
    if (!present(state, view())) return;
    const Reference reference(view().scene);
    for (auto _ : state)
        benchmark::DoNotOptimize(reference.picture(view().camera, size).data());
}

void ReferenceSample(benchmark::State& state, const View& (*view)()) {  // 4096 pixels: their choice and their truth
    if (!present(state, view())) return;
    const Reference reference(view().scene);
    const Camera& camera = view().camera;
    for (auto _ : state)
        benchmark::DoNotOptimize(reference.pixels(camera, size, reference.sample(camera, size, 4096)).data());
}

BENCHMARK_CAPTURE(ReferenceIndex, grid, grid)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(ReferenceIndex, bluntfin, bluntfin)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(ReferencePicture, grid, grid)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(ReferencePicture, bluntfin, bluntfin)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(ReferenceSample, grid, grid)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
BENCHMARK_CAPTURE(ReferenceSample, bluntfin, bluntfin)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
