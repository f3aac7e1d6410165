// SPDX-License-Identifier: BSD-3-Clause
//
// How wrong whole pictures are: methods of both backends against the float64 judge at every pixel of 512×512, on a Delaunay mesh of some
// 200,000 cells, slivers included, with a smooth ramp and six narrow peaks, parallel and perspective.
//
//   cellproj_accuracy [METHOD…]     default: preint3d:128 integral exact:1e-5
//
// Needs cellproj-mesher. The truth of a picture is found once, by five rays a pixel: about a minute of one core each.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "apps/scenes/measured_scenes.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace {

using namespace cellproj;

constexpr ImageSize size{512, 512};

std::size_t pixels_above(const Image& image, const std::vector<PixelTruth>& truths, double bound) {
    std::size_t count = 0;
    for (const PixelTruth& truth : truths) {
        const glm::dvec4 error = error_of_pixel(image, truth);
        count += std::max({error.r, error.g, error.b, error.a}) > bound;
    }
    return count;
}

void measure(const std::vector<std::string>& methods) {
    const auto mesh = std::make_shared<const TetMesh>(testing_support::delaunay_mesh(30800, 1));
    const auto field = std::make_shared<const ScalarField>(testing_support::point_field(*mesh, scenes::waves));
    std::printf("%zu cells, %dx%d, every pixel judged within 1/512 of a pixel; errors of RGB, pixels by RGBA\n", mesh->tets.size(), size.width, size.height);
    std::printf("%-6s %-12s %-4s %-18s %9s %9s %9s %13s\n", "", "", "", "method", "RMS", "99 %", "max", "above 1e-4");
    std::shared_ptr<const RayIndex> index;
    for (const bool ramp : {true, false}) {
        const Scene scene{mesh, field, std::make_shared<TransferFunction>(ramp ? scenes::ramp() : scenes::table_peaks())};
        const Reference reference(scene, index);
        index = reference.shared_index();
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Camera camera = testing_support::view_of_unit_cube(projection);
            const std::vector<PixelTruth> truths = reference.picture(camera, size, rasterizer_slack);
            for (const Backend backend : {Backend::gl_osmesa, Backend::cpu}) {
                const auto renderer = make_renderer(backend);
                for (const std::string& method : methods) {
                    const Quality quality{.method = parse_method(method)};
                    if (!draws(backend, quality)) continue;
                    const Image image = renderer->render(scene, camera, size, quality);
                    const ErrorMeasure error = compare(image, truths).color;
                    std::printf("%-6s %-12s %-4s %-18s %9.1e %9.1e %9.1e %13zu\n", ramp ? "ramp" : "peaks",
                                projection == Camera::Projection::parallel ? "parallel" : "perspective",
                                backend == Backend::cpu ? "cpu" : "gl", to_string(quality.method).c_str(), error.rms,
                                error.percentile_99, error.maximum, pixels_above(image, truths, 1e-4));
                    std::fflush(stdout);
                }
            }
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        std::vector<std::string> methods(argv + 1, argv + argc);
        if (methods.empty()) methods = {"preint3d:128", "integral", "exact:1e-5"};
        for (const std::string& method : methods) parse_method(method);
        measure(methods);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "cellproj_accuracy: %s\n", error.what());
        return 1;
    }
}
