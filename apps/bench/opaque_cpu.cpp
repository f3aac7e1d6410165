// SPDX-License-Identifier: BSD-3-Clause
//
// What early termination of the CPU backend saves: a medium that is opaque after a tenth of the mesh's depth, whole frames in an
// exact order, with and without it. Argument: boxes along an edge of a jittered grid (67: 1.5M tetrahedra). 512² pixels.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "apps/scenes/measured_scenes.hpp"
#include "classify/piece_table.hpp"
#include "classify/segment_method.hpp"
#include "render/cpu/kernels.hpp"
#include "render/cpu/screen_mesh.hpp"
#include "render/cpu/tile_bins.hpp"
#include "render/image.hpp"
#include "render/prepared_scene.hpp"
#include "tests/support/meshes.hpp"

namespace cellproj {
namespace {

constexpr int side = 512;

Scene scene(int boxes) {
    auto mesh = std::make_shared<TetMesh>(testing_support::grid_mesh(boxes, 0.2));
    auto field = std::make_shared<ScalarField>(testing_support::point_field(*mesh, scenes::waves));
    // 1e-4 shines through 0.12 of the cube's edge, a tenth of its mean depth in these views.
    auto transfer = std::make_shared<TransferFunction>(OpticalModel::density, std::vector<ColorNode>{{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}},
                                                       std::vector<ExtinctionNode>{{0, 77}, {1, 77}});
    return {mesh, field, transfer};
}

void CpuOpaque(benchmark::State& state, bool terminates) {
    const Scene s = scene(static_cast<int>(state.range(0)));
    PreparedScene prepared(s);
    const SceneUnits& units = prepared.units();
    const PieceTable table = make_piece_table(in_scene_units(*s.transfer, units.scalar_low, units.scalar_high, units.length));
    const cpu::PieceArrays pieces({}, table, walk_limits({}, table, 2.0));
    const cpu::Shading shading{.pieces = &pieces, .opaque = terminates ? 0.9999F : 2.0F};
    cpu::ScreenMesh mesh;
    mesh.set_scene(prepared);
    cpu::TileBins bins;
    int i = 0;
    std::size_t drawn = 0;
    for (auto _ : state) {
        const Camera camera = scenes::measured_view(i++);
        const ViewOrder order = prepared.sorter().order(camera.viewpoint());
        mesh.set_view(camera, {side, side});
        Image image(side, side);
        bins.begin(mesh.cells(), {0, 0, side, side}, mesh.cut(order), {}, terminates);
        while (bins.next())
            for (int y = 0; y < side; y += cpu::tile_side)
                for (int x = 0; x < side; x += cpu::tile_side) {
                    const int column = x / cpu::tile_side, row = y / cpu::tile_side;
                    if (bins.tile(column, row).empty()) continue;
                    const cpu::Tile tile{x, y, cpu::tile_side, cpu::tile_side, &image.at(x, y), side, &bins.full(column, row)};
                    cpu::draw_tile(mesh.cells(), shading, tile, bins.tile(column, row));
                }
        drawn += bins.drawn();
        benchmark::DoNotOptimize(image.pixels.data());
    }
    state.counters["tets"] = static_cast<double>(s.mesh->tets.size());
    state.counters["drawn"] = static_cast<double>(drawn) / static_cast<double>(i);
}

BENCHMARK_CAPTURE(CpuOpaque, whole, false)->Arg(34)->Arg(67)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(CpuOpaque, terminated, true)->Arg(34)->Arg(67)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace cellproj
