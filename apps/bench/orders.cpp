// SPDX-License-Identifier: BSD-3-Clause
//
// cellproj_orders [EYES [RAYS]]: how many of RAYS (4096) random rays from each of EYES (20) eyes meet the cells in another order than the
// one that each method gives, on meshes with holes, pieces and cycles; and the time that it takes. Rays go through pixel centres of
// a picture of 512×512, where sxmpvo is exact.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/cpu_time.hpp"
#include "mesh/error.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "sort/boundary.hpp"
#include "sort/boundary_scan.hpp"
#include "sort/visibility_sorter.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/order_judge.hpp"
#include "tests/support/order_meshes.hpp"

namespace {

using namespace cellproj;
using namespace cellproj::testing_support;
using bench::user_ms;

struct Row {
    std::size_t wrong = 0, inexact_reports = 0, cycles = 0, split = 0;
    double ms = 0;  // CPU time of all threads
};

void judge(const std::string& name, const TetMesh& mesh, int eyes, int rays) {
    VisibilitySorter sorter(mesh);
    const RayIndex index(mesh);
    constexpr OrderMethod methods[] = {OrderMethod::centroid, OrderMethod::mpvo, OrderMethod::bsp, OrderMethod::sxmpvo};
    Row rows[4];
    double scan_ms = 0;
    const auto boundary = order_boundary(CellGraph(mesh, build_adjacency(mesh)));
    std::mt19937_64 random(7);
    for (int i = 0; i < eyes; ++i) {
        const PixelGrid grid = pixel_grid(judging_camera(bounds(mesh.points), i, random), {512, 512});
        const auto through = random_pixel_rays(index, grid, rays, random);
        for (int m = 0; m < 4; ++m) {
            OrderReport report;
            const double start = user_ms();
            const ViewOrder order = sorter.order(grid.eye, &report, methods[m], &grid);
            rows[m].ms += (user_ms() - start) / eyes;
            rows[m].wrong += wrong_rays(mesh, index, order, through);
            rows[m].inexact_reports += report.exact ? 0 : 1;
            rows[m].cycles += report.cycles;
            rows[m].split += report.split_cells;
        }
        const double start = user_ms();
        (void)scan_boundary(mesh, boundary, grid);
        scan_ms += (user_ms() - start) / eyes;
    }
    std::printf("%-14s %8zu %7zu |", name.c_str(), mesh.tets.size(), boundary.size());
    for (const Row& row : rows) std::printf(" %7zu %6.1f |", row.wrong, row.ms);
    std::printf(" %6.1f | %6zu %6zu | %zu %zu\n", scan_ms, rows[3].cycles, rows[3].split, rows[2].inexact_reports, rows[3].inexact_reports);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const int eyes = argc > 1 ? std::atoi(argv[1]) : 20, rays = argc > 2 ? std::atoi(argv[2]) : 4096;
    const std::string data = CELLPROJ_SHARED_DATA;
    std::printf("%d rays from each of %d eyes; wrong rays and CPU ms per order (all threads)\n", rays, eyes);
    std::printf("%-14s %8s %7s | %14s | %14s | %14s | %14s | %6s | %6s %6s | not proven\n", "mesh", "cells", "faces", "centroid", "mpvo",
                "bsp", "sxmpvo", "scan", "cycles", "split");
    judge("torus", torus_mesh(40), eyes, rays);
    judge("cavities", cavity_mesh(20, 50), eyes, rays);
    judge("springs", springs_mesh(90), eyes, rays);
    judge("pieces", pieces_mesh(100, 4), eyes, rays);
    judge("sticks", overlapping_sticks(), eyes, rays);
    judge("stair", spiral_stair(1000), eyes, rays);
    judge("twisted", twisted_mesh(12, 20), eyes, rays);
    judge("damaged", damaged_mesh(12, 60), eyes, rays);
    try {
        judge("delaunay", delaunay_mesh(30000), eyes, rays);
    } catch (const Error&) {
        std::printf("delaunay: no mesher\n");
    }
    const std::vector<std::pair<std::string, std::string>> files{{"bluntfin/bluntfinxyz.bin", "bluntfin/bluntfinq.bin"},
                                                                 {"aneurysm_tets_openfoam/aneurysm_tets_internal.vtu", ""},
                                                                 {"rotordisk_openfoam/rotorDisk_internal.vtu", ""}};
    for (const auto& [file, solution] : files) {
        if (!std::filesystem::exists(data + "/" + file)) continue;
        ReadOptions options;
        if (!solution.empty()) options.solution = data + "/" + solution;
        judge(file.substr(0, file.find_first_of("_/")), tetrahedralize(read(data + "/" + file, options)), eyes, rays);
    }
}
