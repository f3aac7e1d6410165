// SPDX-License-Identifier: BSD-3-Clause
//
// What drawing a regular grid costs and how wrong it is: the CPU renderer's methods, the same grid as tetrahedra, and,
// where this is built with VTK (CELLPROJ_BENCH_VTK=ON), its fixed-point ray caster at two sample distances, in one run.
//
//   cellproj_grids [CELLS [SIDE [FRAMES]]]     default: 100 512 5
//
// A cube of CELLS³ cells, SIDE² pixels, medians of FRAMES views that all draw in turn. CPU: user time of all threads. Errors of RGB against
// GridReference at every 17th pixel of one view; VTK's picture has 8 bits (.0011 RMS at best).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/cpu_time.hpp"
#include "apps/scenes/measured_scenes.hpp"
#include "render/judge/grid_reference.hpp"
#include "render/grid_renderer.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"
#if CELLPROJ_BENCH_VTK
#include "apps/bench/frames_process.hpp"
#include "apps/bench/vtk_grid.hpp"
#endif

namespace {

using namespace cellproj;
using Draw = std::function<void(const Camera&)>;

struct Run {
    std::shared_ptr<const Grid> grid;
    std::shared_ptr<const TransferFunction> transfer;
    Camera::Projection projection;
    ImageSize size;
    int frames;
    std::vector<PixelTruth> truths;  // of view 0
};

std::vector<PixelId> judged_pixels(ImageSize size) {
    std::vector<PixelId> pixels;
    for (const PixelId& pixel : all_pixels(size))
        if ((pixel.x + size.width * pixel.y) % 17 == 0) pixels.push_back(pixel);
    return pixels;
}

Camera view(const Run& run, int i) { return scenes::measured_view(i, {glm::dvec3(0), glm::dvec3(1)}, run.projection); }

// Who draws.
struct Contender {
    std::string name;
    Draw draw;
    std::function<Image()> picture;  // the last one
    std::vector<double> cpu, wall;
};

Contender grid_contender(const Run& run, const std::string& method) {
    const auto image = std::make_shared<Image>();
    return {method,
            [image, renderer = std::shared_ptr(make_grid_renderer(Backend::cpu)), scene = GridScene{run.grid, run.transfer}, size = run.size,
             quality = GridQuality{.method = parse_method(method)}](const Camera& camera) { *image = renderer->render(scene, camera, size, quality); },
            [image] { return *image; }, {}, {}};
}

Contender tets_contender(const Run& run) {
    const auto image = std::make_shared<Image>();
    const Scene scene = testing_support::scene_of(testing_support::grid_mesh(static_cast<int>(run.grid->axes[0].cells())), scenes::waves, *run.transfer);
    return {"as tetrahedra",
            [image, scene, renderer = std::shared_ptr(make_renderer(Backend::cpu)), size = run.size](const Camera& camera) { *image = renderer->render(scene, camera, size); },
            [image] { return *image; }, {}, {}};
}

#if CELLPROJ_BENCH_VTK
Contender vtk_contender(const Run& run, double step) {
    const auto vtk = std::make_shared<bench::VtkFixedPoint>(*run.grid, *run.transfer, run.size, step);
    char name[40];
    std::snprintf(name, sizeof name, "VTK fixed point, %.2g", step);
    return {name, [vtk](const Camera& camera) { vtk->draw(camera); }, [vtk] { return vtk->picture(); }, {}, {}};
}
#endif

// In each round everybody draws the same new view, so that a busy machine is unkind to all.
void measure(const Run& run, std::vector<Contender> contenders) {
    std::vector<ErrorMeasure> errors;
    for (Contender& c : contenders) {
        c.draw(view(run, 0));
        errors.push_back(compare(c.picture(), run.truths).color);
    }
    for (int frame = 1; frame <= run.frames; ++frame) {
        for (Contender& c : contenders) {
            const Stopwatch watch;
            const double before = bench::user_ms();
            c.draw(view(run, frame));
            c.cpu.push_back(bench::user_ms() - before);
            c.wall.push_back(watch.ms());
        }
    }
    for (std::size_t i = 0; i < contenders.size(); ++i)
        std::printf("  %-22s %9.1f %9.1f %10.1e %10.1e\n", contenders[i].name.c_str(), median(contenders[i].cpu), median(contenders[i].wall),
                    errors[i].rms, errors[i].maximum);
    std::fflush(stdout);
}

void run_all(std::size_t cells, int side, int frames) {
    const auto grid = std::make_shared<const Grid>(testing_support::unit_cube(cells, scenes::waves));
    std::printf("%zu^3 cells, %dx%d, a new view every frame\n  %-22s %9s %9s %10s %10s\n", cells, side, side, "", "CPU ms", "wall ms",
                "RMS", "max");
    for (const bool ramp : {true, false}) {
        const auto transfer = std::make_shared<const TransferFunction>(ramp ? scenes::ramp() : scenes::table_peaks());
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            Run run{grid, transfer, projection, {side, side}, frames, {}};
            run.truths = GridReference(grid, transfer).pixels(view(run, 0), run.size, judged_pixels(run.size));
            std::printf("%s, %s\n", ramp ? "ramp" : "peaks", projection == Camera::Projection::parallel ? "parallel" : "perspective");
            std::vector<Contender> contenders;
            for (const char* method : {"integral", "exact:1e-3", "exact:1e-5", "homogeneous"}) contenders.push_back(grid_contender(run, method));
#if CELLPROJ_BENCH_VTK
            for (const double step : {1.0, 0.5}) contenders.push_back(vtk_contender(run, step));
#endif
            if (cells <= 64) contenders.push_back(tets_contender(run));
            measure(run, std::move(contenders));
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto number = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
        const int cells = number(1, 100), side = number(2, 512), frames = number(3, 5);
        if (cells < 1 || side < 1 || side > 16384 || frames < 1) throw std::invalid_argument("CELLS, SIDE and FRAMES are numbers above 0");
#if CELLPROJ_BENCH_VTK
        const bench::VirtualDisplay display(true);
#endif
        run_all(static_cast<std::size_t>(cells), side, frames);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj_grids: %s\n", error.what());
        return 1;
    }
}
