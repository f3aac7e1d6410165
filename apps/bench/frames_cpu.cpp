// SPDX-License-Identifier: BSD-3-Clause
//
// The CPU backend: whole frames and their stages, a new view each. "CPU" is that of all threads together; half of it is what two
// quiet cores need. Arguments: boxes along an edge of a jittered grid (34: 0.2M, 65: 1.4M, 106: 6.0M tetrahedra), and pixels
// along an edge of the picture.
#include <benchmark/benchmark.h>

#include <map>
#include <memory>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/piece_table.hpp"
#include "classify/segment_method.hpp"
#include "render/cpu/kernels.hpp"
#include "render/cpu/screen_mesh.hpp"
#include "render/cpu/tile_bins.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace {

enum class Colors { ramp, peaks };

Scene scene(int boxes, Colors colors) {
    static std::map<int, Scene> scenes;
    Scene& s = scenes[boxes];
    if (!s.mesh) {
        auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(boxes, 0.2));
        s.field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
        s.mesh = std::move(mesh);
    }
    Scene chosen = s;
    chosen.transfer = std::make_shared<TransferFunction>(colors == Colors::ramp ? scenes::ramp() : scenes::peaks());
    return chosen;
}

ImageSize square(benchmark::State& state) { return {static_cast<int>(state.range(1)), static_cast<int>(state.range(1))}; }

void per_cell(benchmark::State& state, const Scene& s) { state.counters["tets"] = static_cast<double>(s.mesh->tets.size()); }

void CpuFrame(benchmark::State& state, Colors colors) {  // camera to pixels in memory
    const Scene s = scene(static_cast<int>(state.range(0)), colors);
    const auto renderer = make_renderer(Backend::cpu);
    renderer->render(s, scenes::measured_view(0), square(state));
    int i = 1;
    for (auto _ : state) benchmark::DoNotOptimize(renderer->render(s, scenes::measured_view(i++), square(state)).pixels.data());
    per_cell(state, s);
}

// The stages behind the order, of which one is measured.
enum class Stage { transform, bin, raster };

void CpuStage(benchmark::State& state, Stage stage, Colors colors) {
    const Scene s = scene(static_cast<int>(state.range(0)), colors);
    const ImageSize size = square(state);
    PreparedScene prepared(s);
    const SceneUnits& units = prepared.units();
    const PieceTable table = make_piece_table(in_scene_units(*s.transfer, units.scalar_low, units.scalar_high, units.length));
    const WalkLimits limits = walk_limits({}, table, 2.0);
    const cpu::PieceArrays pieces({}, table, limits);
    cpu::ScreenMesh mesh;
    mesh.set_scene(prepared);
    cpu::TileBins bins;
    std::size_t fragments = 0, frames = 0;
    const auto on = [&](Stage which) { if (which == stage) state.ResumeTiming(); };
    const auto off = [&](Stage which) { if (which == stage) state.PauseTiming(); };
    for (auto _ : state) {
        state.PauseTiming();
        const Camera camera = scenes::measured_view(static_cast<int>(++frames));
        const ViewOrder order = prepared.sorter().order(camera.viewpoint());
        on(Stage::transform);
        mesh.set_view(camera, size);
        off(Stage::transform);
        const auto items = mesh.cut(order);
        on(Stage::bin);
        bins.begin(mesh.cells(), {0, 0, size.width, size.height}, items, {}, false);
        bins.next_tiles();
        off(Stage::bin);
        Image image(size.width, size.height);
        on(Stage::raster);
        for (int y = 0; y < size.height; y += cpu::tile_side)
            for (int x = 0; x < size.width; x += cpu::tile_side) {
                const cpu::Tile tile{x, y, cpu::tile_side, cpu::tile_side, &image.at(x, y), static_cast<std::size_t>(size.width)};
                fragments += cpu::draw_tile(mesh.cells(), {.pieces = &pieces, .opaque = 0.9999F}, tile,
                                            bins.tile(x / cpu::tile_side, y / cpu::tile_side));
            }
        off(Stage::raster);
        state.ResumeTiming();
    }
    per_cell(state, s);
    state.counters["fragments"] = static_cast<double>(fragments) / static_cast<double>(frames);
}

void sizes(benchmark::internal::Benchmark* b) {
    for (const int boxes : {34, 65, 106}) b->Args({boxes, 512});
    b->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}

BENCHMARK_CAPTURE(CpuFrame, ramp, Colors::ramp)->Apply(sizes)->Args({34, 1024})->Args({65, 1024});
BENCHMARK_CAPTURE(CpuFrame, peaks, Colors::peaks)->Apply(sizes)->Args({34, 1024})->Args({65, 1024});
BENCHMARK_CAPTURE(CpuStage, transform, Stage::transform, Colors::ramp)->Apply(sizes);
BENCHMARK_CAPTURE(CpuStage, bin, Stage::bin, Colors::ramp)->Apply(sizes);
BENCHMARK_CAPTURE(CpuStage, raster_ramp, Stage::raster, Colors::ramp)->Apply(sizes);
BENCHMARK_CAPTURE(CpuStage, raster_peaks, Stage::raster, Colors::peaks)->Apply(sizes);

}  // namespace
}  // namespace cellproj
