// SPDX-License-Identifier: BSD-3-Clause
//
// Regular grids in OpenGL: what coherence pays, the ways to classify slabs, and WVG91's Table 3.
//
//   cellproj_grid_templates [SIDE [FRAMES [opaque]]]     default: 512 3
//
// "opaque": what it saves to draw front to back and stop behind opaque tiles, and nothing else.
//
// First EKE01's Fig. 9 and 10 in numbers, several slabs a polygon as RS00 draws them, and a cube of 64³ cells by its own cells and as
// tetrahedra, by the same backend and method. Then every way to integrate and interpolate on three volumes (a distance field of 20³
// cells, the blunt fin's density resampled to 40×32×32, a curved field of 100³), from the front, closer, and turned by 30° about two axes,
// SIDE² pixels. Median user CPU time of all threads over FRAMES pictures, after one that is
// not counted; errors of RGB against GridReference at every 61st pixel.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "apps/bench/cpu_time.hpp"
#include "apps/scenes/measured_scenes.hpp"
#include "mesh/read.hpp"
#include "mesh/tetrahedralize.hpp"
#include "render/judge/grid_reference.hpp"
#include "render/grid_renderer.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/grids.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/spherical_harmonic.hpp"

namespace {

using namespace cellproj;
using Projection = Camera::Projection;

double median_ms(int frames, const std::function<void()>& draw) {
    draw();
    std::vector<double> times;
    for (int i = 0; i < frames; ++i) {
        const double before = bench::user_ms();
        draw();
        times.push_back(bench::user_ms() - before);
    }
    return median(times);
}

std::vector<PixelId> some_pixels(ImageSize size) {
    std::vector<PixelId> pixels = all_pixels(size);
    std::size_t kept = 0;
    for (std::size_t i = 30; i < pixels.size(); i += 61) pixels[kept++] = pixels[i];
    pixels.resize(kept);
    return pixels;
}

// ---- The volumes ----

Grid radial(std::size_t cells) {
    return testing_support::unit_cube(cells, [](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(0.5)) / std::sqrt(0.75); });
}

// The field of the tetrahedra at the points of a grid over their box; cells that reach beyond them are blanked.
Grid resampled(const TetMesh& mesh, const ScalarField& field, const std::array<std::size_t, 3>& cells) {
    const Bounds box = bounds(mesh.points);
    const glm::dvec3 step = (box.high - box.low) / glm::dvec3(cells[0], cells[1], cells[2]);
    Grid grid{{uniform_axis(box.low.x, step.x, cells[0] + 1), uniform_axis(box.low.y, step.y, cells[1] + 1), uniform_axis(box.low.z, step.z, cells[2] + 1)},
              FieldLocation::points, {}, {}};
    const GridDimensions n = grid.dimensions();
    grid.values.assign(n.ni * n.nj * n.nk, std::nan(""));
    for (const auto& tet : mesh.tets) {
        const glm::dvec3 origin = mesh.points[tet[0]];
        const glm::dmat3 edges(mesh.points[tet[1]] - origin, mesh.points[tet[2]] - origin, mesh.points[tet[3]] - origin);
        if (glm::determinant(edges) == 0) continue;
        const glm::dmat3 inverse = glm::inverse(edges);
        glm::dvec3 low = origin, high = origin;
        for (const VertexId v : tet) {
            low = glm::min(low, mesh.points[v]);
            high = glm::max(high, mesh.points[v]);
        }
        const glm::uvec3 first = glm::max(glm::ceil((low - box.low) / step - 1e-6), 0.0), last = glm::floor((high - box.low) / step + 1e-6);
        for (std::size_t k = first.z; k <= last.z && k < n.nk; ++k)
            for (std::size_t j = first.y; j <= last.y && j < n.nj; ++j)
                for (std::size_t i = first.x; i <= last.x && i < n.ni; ++i) {
                    const glm::dvec3 w = inverse * (box.low + step * glm::dvec3(i, j, k) - origin);
                    if (std::min({w.x, w.y, w.z, 1 - w.x - w.y - w.z}) < -1e-6) continue;
                    const auto value = [&](std::size_t v) { return field.values[tet[v]]; };
                    grid.values[i + n.ni * (j + n.nj * k)] = (1 - w.x - w.y - w.z) * value(0) + w.x * value(1) + w.y * value(2) + w.z * value(3);
                }
    }
    grid.blanked.resize(grid.cell_count());
    for (std::size_t c = 0; c < grid.blanked.size(); ++c) {
        const auto corners = grid.corner_values({c % cells[0], c / cells[0] % cells[1], c / (cells[0] * cells[1])});
        grid.blanked[c] = std::all_of(corners.begin(), corners.end(), [](double s) { return std::isfinite(s); }) ? 0 : 1;
    }
    return grid;
}

std::optional<Grid> blunt_fin() {
    const std::filesystem::path folder = std::filesystem::path(CELLPROJ_SHARED_DATA) / "bluntfin";
    if (!std::filesystem::exists(folder)) return std::nullopt;
    const TetMesh mesh = tetrahedralize(read(folder / "bluntfinxyz.bin", {.solution = folder / "bluntfinq.bin"}));
    return resampled(mesh, select_scalar(mesh, "Density", "bluntfin"), {40, 32, 32});
}

struct Volume {
    std::string name;
    GridScene scene;
};

std::vector<Volume> volumes() {
    std::vector<Volume> all;
    const auto add = [&](const std::string& name, Grid grid) {
        const GridUnits units = units_of(grid);
        auto transfer = std::make_shared<TransferFunction>(scenes::ramp(units.scalar_low, units.scalar_high, 2 * units.length / std::sqrt(3.0)));
        all.push_back({name, {std::make_shared<Grid>(std::move(grid)), std::move(transfer)}});
    };
    add("radial, 20^3", radial(20));
    if (auto fin = blunt_fin()) add("blunt fin, 40x32x32", std::move(*fin));
    else std::printf("no blunt fin: the shared data is not there\n");
    add("waves, 100^3", testing_support::unit_cube(100, scenes::waves));
    return all;
}

// ---- WVG91 Table 3 ----

struct View {
    const char* name;
    glm::dvec3 from;
    double zoom;
};
const View views[] = {{"front", {0, -1, 0}, 1}, {"zoomed", {0, -1, 0}, 2}, {"turned 30/30", {std::sin(M_PI / 6) * std::cos(M_PI / 6), -std::cos(M_PI / 6) * std::cos(M_PI / 6), std::sin(M_PI / 6)}, 1}};

Camera camera_of(const View& view, const Bounds& box, Projection projection) {
    Camera camera = frame_bounds(box, projection, view.from, {0, 0, 1}, 1.0);
    camera.height /= view.zoom;
    camera.fov_y_degrees = 360 / M_PI * std::atan(std::tan(camera.fov_y_degrees * M_PI / 360) / view.zoom);
    return camera;
}

// The first of each interpolation is what the others are compared with.
const std::vector<std::vector<const char*>> methods{
    {"average:vertices", "average:half:vertices", "homogeneous:vertices", "linear:4:vertices"},
    {"average", "average:half", "homogeneous", "linear:4", "stein", "preint2d:256", "preint2d-exp:256", "preint3d:64", "integral"}};

void table(GridRenderer& renderer, const Volume& volume, ImageSize size, int frames) {
    const std::vector<PixelId> pixels = some_pixels(size);
    for (const View& view : views) {
        const Camera cameras[] = {camera_of(view, volume.scene.grid->bounds(), Projection::parallel),
                                  camera_of(view, volume.scene.grid->bounds(), Projection::perspective)};
        const GridReference judge(volume.scene.grid, volume.scene.transfer);
        const std::vector<PixelTruth> truths[] = {judge.pixels(cameras[0], size, pixels), judge.pixels(cameras[1], size, pixels)};
        std::printf("%s, %s\n  %-24s %9s %7s %9s %9s  %9s %7s %9s %9s  %s\n", volume.name.c_str(), view.name, "", "parallel", "to C.D", "RMS", "max",
                    "persp.", "to C.D", "RMS", "max", "persp. : parallel");
        for (const auto& family : methods) {
            double first[2] = {0, 0};
            for (const char* method : family) {
                double ms[2];
                std::printf("  %-24s", method);
                for (int p = 0; p < 2; ++p) {
                    Image image;
                    ms[p] = median_ms(frames, [&] { image = renderer.render(volume.scene, cameras[p], size, {.method = parse_method(method)}); });
                    if (method == family.front()) first[p] = ms[p];
                    const ErrorMeasure error = compare(image, truths[p]).color;
                    std::printf(" %9.1f %7.2f %9.1e %9.1e ", ms[p], ms[p] / first[p], error.rms, error.maximum);
                }
                std::printf(" %.2f\n", ms[1] / ms[0]);
                std::fflush(stdout);
            }
        }
    }
}

// ---- Coherence ----

void coherence(GridRenderer& cells, ImageSize size, int frames) {
    constexpr int n = 64;
    const GridScene grid{std::make_shared<Grid>(testing_support::unit_cube(n, scenes::waves)), std::make_shared<TransferFunction>(scenes::ramp())};
    const Scene mesh = testing_support::scene_of(testing_support::grid_mesh(n), scenes::waves, scenes::ramp());
    const auto tets = make_renderer(Backend::gl_osmesa);
    std::printf("%d^3 cells, integral\n  %-24s %9s %9s %9s\n", n, "", "cells", "tets", "tets : cells");
    for (const Projection projection : {Projection::parallel, Projection::perspective}) {
        const Camera camera = scenes::measured_view(0, {glm::dvec3(0), glm::dvec3(1)}, projection);
        const double of_cells = median_ms(frames, [&] { cells.render(grid, camera, size); });
        const double of_tets = median_ms(frames, [&] { tets->render(mesh, camera, size); });
        std::printf("  %-24s %9.1f %9.1f %9.2f\n", projection == Projection::parallel ? "parallel" : "perspective", of_cells, of_tets, of_tets / of_cells);
        std::fflush(stdout);
    }
}

// ---- EKE01 Fig. 9 and 10, RS00 ----

void classifications(GridRenderer& renderer, ImageSize size) {
    const GridScene scene = testing_support::with_random_transfer(testing_support::spherical_harmonic(16), 65, 1.5, 512);
    const Camera camera = frame_bounds(scene.grid->bounds(), Projection::parallel, {0.2, -1, 0.1}, {0, 0, 1}, 1.0);
    const std::vector<PixelId> pixels = some_pixels(size);
    const std::vector<PixelTruth> truths = GridReference(scene.grid, scene.transfer).pixels(camera, size, pixels);
    std::printf("spherical harmonic, 16^3 points, random transfer function\n  %-16s %-18s %9s %9s\n", "", "", "RMS", "max");
    for (const auto& [sampling, method] : std::vector<std::pair<const char*, const char*>>{
             {"object:15:pre", "integral"}, {"object:15:post", "integral"}, {"object:60:post", "integral"}, {"object:240:post", "integral"},
             {"object:15", "preint2d:256"}, {"object:15", "preint2d-exp:256"}, {"object:15", "integral"}, {"object:60", "integral"},
             {"view:26", "integral"}, {"cells", "integral"}}) {
        const ErrorMeasure error =
            compare(renderer.render(scene, camera, size, {.method = parse_method(method), .sampling = parse_grid_sampling(sampling)}), truths).color;
        std::printf("  %-16s %-18s %9.1e %9.1e\n", sampling, method, error.rms, error.maximum);
    }
    std::fflush(stdout);
}

void several_a_polygon(GridRenderer& renderer, ImageSize size, int frames) {
    const GridScene scene{std::make_shared<Grid>(testing_support::unit_cube(64, scenes::waves)), std::make_shared<TransferFunction>(scenes::ramp())};
    const Camera camera = scenes::measured_view(0, {glm::dvec3(0), glm::dvec3(1)}, Projection::parallel);
    std::printf("64^3 cells, 128 slabs, preint2d:256, slabs a polygon\n  %-16s %9s %9s %9s %9s\n", "", "1", "2", "4", "1 : 2");
    for (const std::string sampling : {"object:128", "object:128:post", "object:128:pre", "view:128"}) {
        double ms[3];
        for (int i = 0; i < 3; ++i) {
            const GridQuality quality{.method = parse_method("preint2d:256"), .sampling = parse_grid_sampling(sampling + ":x" + std::to_string(1 << i))};
            ms[i] = median_ms(frames, [&] { renderer.render(scene, camera, size, quality); });
        }
        std::printf("  %-16s %9.1f %9.1f %9.1f %9.2f\n", sampling.c_str(), ms[0], ms[1], ms[2], ms[0] / ms[1]);
        std::fflush(stdout);
    }
}

// ---- Front to back ----

struct OpaqueScene {
    std::string name;
    GridScene scene;
    GridQuality quality;
};

std::vector<OpaqueScene> opaque_scenes() {
    constexpr std::size_t n = 100;
    const auto waves = std::make_shared<Grid>(testing_support::unit_cube(n, scenes::waves));
    const auto medium = [](double least, double most) {
        return std::make_shared<TransferFunction>(OpticalModel::density, std::vector<ColorNode>{{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}},
                                                  std::vector<ExtinctionNode>{{0, least}, {1, most}});
    };
    const auto surfaces = [](std::vector<IsoSurface> list) {
        return std::make_shared<SurfaceScene>(SurfaceScene{IsoSurfaces(std::move(list)), Shading::smooth});
    };
    const auto dense = medium(20, 80), clear = medium(0, 0), thin = medium(0.2, 4), patchy = medium(0, 40);
    const GridScene in_dense{waves, dense};
    std::vector<OpaqueScene> all{{"dense, integral", in_dense, {}}};
    for (const char* method : {"preint2d:256", "homogeneous:vertices"}) all.push_back({std::string("dense, ") + method, in_dense, {.method = parse_method(method)}});
    for (const char* sampling : {"object:200", "view:200:x4"})
        all.push_back({std::string("dense, ") + sampling, in_dense, {.method = parse_method("preint2d:256"), .sampling = parse_grid_sampling(sampling)}});
    all.push_back({"patchy, integral", {waves, patchy}, {}});
    all.push_back({"thin, integral (back to front)", {waves, thin}, {}});
    all.push_back({"surface at .5", {waves, clear, surfaces({{0.5, {1, 0.5, 0}, 1, {}}})}, {}});
    all.push_back({"surface at .5 in thin", {waves, thin, surfaces({{0.5, {1, 0.5, 0}, 1, {}}})}, {}});
    all.push_back({"the same, view:200", {waves, thin, surfaces({{0.5, {1, 0.5, 0}, 1, {}}})}, {.method = parse_method("preint2d:256"), .sampling = parse_grid_sampling("view:200")}});
    all.push_back({"surface at .9 in thin", {waves, thin, surfaces({{0.9, {1, 0.5, 0}, 1, {}}})}, {}});
    return all;
}

void front_to_back(ImageSize size, int frames) {
    const auto stopped = make_grid_renderer(Backend::gl_osmesa);
    const auto back_to_front = make_grid_renderer(Backend::gl_osmesa, {.rules = {.front_to_back = false}});
    std::printf("100^3 cells, ms back to front : front to back\n  %-32s %9s %9s %7s %9s %9s\n", "", "b. to f.", "f. to b.", "ratio", "of cells", "apart");
    for (const auto& [name, scene, quality] : opaque_scenes()) {
        for (const Projection projection : {Projection::parallel, Projection::perspective}) {
            const Camera camera = scenes::measured_view(0, {glm::dvec3(0), glm::dvec3(1)}, projection);
            Image all, some;
            Statistics of_all, of_some;
            const double ms_all = median_ms(frames, [&] { all = back_to_front->render(scene, camera, size, quality, &of_all); });
            const double ms_some = median_ms(frames, [&] { some = stopped->render(scene, camera, size, quality, &of_some); });
            std::printf("  %-32s %9.1f %9.1f %7.2f %9.3f %9.1e\n", name.c_str(), ms_all, ms_some, ms_all / ms_some,
                        static_cast<double>(of_some.counts.triangles) / static_cast<double>(of_all.counts.triangles), testing_support::max_difference(all, some));
            std::fflush(stdout);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto number = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
        const int side = number(1, 512), frames = number(2, 3);
        if (side < 1 || side > 16384 || frames < 1) throw std::invalid_argument("SIDE and FRAMES are numbers above 0");
        if (argc > 3) {
            if (argc > 4 || std::string(argv[3]) != "opaque") throw std::invalid_argument("the third argument is \"opaque\" or left out");
            front_to_back({side, side}, frames);
            return 0;
        }
        const auto renderer = make_grid_renderer(Backend::gl_osmesa);
        classifications(*renderer, {side, side});
        several_a_polygon(*renderer, {side, side}, frames);
        coherence(*renderer, {side, side}, frames);
        for (const Volume& volume : volumes()) table(*renderer, volume, {side, side}, frames);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj_grid_templates: %s\n", error.what());
        return 1;
    }
}
