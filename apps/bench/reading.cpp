// SPDX-License-Identifier: BSD-3-Clause
//
// From a file to tetrahedra: time, and the peak of memory against the size of what comes out. ReadTets reads a .vtu of
// 10 million tetrahedra, which it writes to the temporary folder first (200 MB); SplitHexahedra cuts a million.
#include <benchmark/benchmark.h>

#include <unistd.h>

#include <filesystem>
#include <utility>

#include "apps/bench/memory_watch.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "mesh/write_vtu.hpp"
#include "tests/support/meshes.hpp"

namespace {

using namespace cellproj;
namespace fs = std::filesystem;

std::size_t bytes_of(const std::vector<Field>& fields) {
    std::size_t bytes = 0;
    for (const Field& field : fields)
        bytes += field.values.size() * sizeof(double);
    return bytes;
}

std::size_t bytes_of(const TetMesh& mesh) {
    return mesh.points.size() * sizeof(mesh.points[0]) + mesh.tets.size() * sizeof(mesh.tets[0]) +
           bytes_of(mesh.point_fields) + bytes_of(mesh.cell_fields);
}

// 5·126³ = 10,001,880 tetrahedra with a point and a cell field.
fs::path write_tets(int boxes) {
    TetMesh mesh = testing_support::grid_mesh(boxes, 0.2, 1);
    mesh.point_fields.push_back({"p", 1, std::vector<double>(mesh.points.size())});
    mesh.cell_fields.push_back({"c", 1, std::vector<double>(mesh.tets.size())});
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
        mesh.point_fields[0].values[i] = mesh.points[i].x;
    for (std::size_t i = 0; i < mesh.tets.size(); ++i)
        mesh.cell_fields[0].values[i] = static_cast<double>(i % 1000);
    const fs::path file = fs::temp_directory_path() / ("cellproj_bench_" + std::to_string(getpid()) + ".vtu");
    write_vtu(mesh, file);
    return file;
}

void count(benchmark::State& state, const TetMesh& mesh, std::size_t peak) {
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
    state.counters["result_MB"] = static_cast<double>(bytes_of(mesh)) / 1e6;
    state.counters["peak_MB"] = static_cast<double>(peak) / 1e6;
    state.counters["peak/result"] = static_cast<double>(peak) / static_cast<double>(bytes_of(mesh));
}

void ReadTets(benchmark::State& state) {
    const fs::path file = write_tets(static_cast<int>(state.range(0)));
    for (auto _ : state) {
        const bench::MemoryWatch watch;
        const Dataset dataset = read(file);
        state.counters["read_MB"] = static_cast<double>(watch.peak()) / 1e6;
        const TetMesh mesh = tetrahedralize(dataset);
        count(state, mesh, watch.peak());
    }
    fs::remove(file);
}

// Jittered, so that faces are not planar.
Dataset hexahedra(std::size_t n) {
    Dataset data;
    for (std::size_t p = 0; p < (n + 1) * (n + 1) * (n + 1); ++p) {
        const glm::dvec3 corner(p % (n + 1), p / (n + 1) % (n + 1), p / ((n + 1) * (n + 1)));
        data.points.push_back(corner + 0.1 * glm::dvec3(p * 7 % 13, p * 11 % 17, p * 5 % 19) / 19.0);
    }
    data.cells.offsets.push_back(0);
    const auto id = [&](std::size_t i, std::size_t j, std::size_t k) {
        return static_cast<VertexId>(i + (n + 1) * (j + (n + 1) * k));
    };
    for (std::size_t c = 0; c < n * n * n; ++c) {
        const std::size_t i = c % n, j = c / n % n, k = c / (n * n);
        for (const VertexId v : {id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k), id(i, j, k + 1),
                                 id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1), id(i, j + 1, k + 1)})
            data.cells.vertices.push_back(v);
        data.cells.kinds.push_back(CellKind::hexahedron);
        data.cells.offsets.push_back(data.cells.vertices.size());
    }
    return data;
}

void SplitHexahedra(benchmark::State& state) {
    const Dataset data = hexahedra(static_cast<std::size_t>(state.range(0)));
    for (auto _ : state) {
        const bench::MemoryWatch watch;
        const TetMesh mesh = tetrahedralize(data);
        count(state, mesh, watch.peak());
    }
}

BENCHMARK(ReadTets)->Arg(126)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(SplitHexahedra)->Arg(100)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
