// SPDX-License-Identifier: BSD-3-Clause
//
// What the methods that follow the transfer function's own pieces promise of a whole picture, on a Delaunay mesh of some 200,000 cells
// (its slivers included), against the float64 judge.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "render/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace {

using testing_support::delaunay_mesh;
using testing_support::point_field;
using testing_support::view_of_unit_cube;

double waves(const glm::dvec3& p) { return 0.5 + 0.25 * std::sin(9 * p.x) * std::cos(7 * p.y) + 0.25 * std::sin(5 * p.z); }

TransferFunction smooth_ramp() {
    return {OpticalModel::density, {{0, {0.1, 0.2, 0.9}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.4}, {1, 4.0}}};
}

// Six peaks of half width .01 of the range, peak optical depth 20 per unit length.
TransferFunction narrow_peaks() {
    std::vector<ColorNode> colors;
    std::vector<ExtinctionNode> extinctions{{0, 0}};
    for (int k = 0; k < 6; ++k) {
        const double s = 0.1 + 0.16 * k;
        colors.push_back({s, {k % 2 == 0 ? 1.0 : 0.2, 0.15 * k, k % 3 == 0 ? 1.0 : 0.1}});
        extinctions.insert(extinctions.end(), {{s - 0.01, 0}, {s, 20}, {s + 0.01, 0}});
    }
    return {OpticalModel::density, colors, extinctions};
}

// Opaque pixels count as much as thin ones; 2000 of them are a fair sample of a picture's errors, not of its worst pixel:
// classify/README.md has the figures of whole pictures.
TEST(Accuracy, OfPiecesOnADelaunayMesh) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{128, 128} : ImageSize{512, 512};
    const auto mesh = std::make_shared<const TetMesh>(delaunay_mesh(CELLPROJ_SANITIZED ? 1500 : 30800, 1));
    const auto field = std::make_shared<const ScalarField>(point_field(*mesh, waves));
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::shared_ptr<const RayIndex> index;
    for (const bool ramp : {true, false}) {
        const Scene scene{mesh, field, std::make_shared<TransferFunction>(ramp ? smooth_ramp() : narrow_peaks())};
        const Reference reference(scene, index);
        index = reference.shared_index();
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Camera camera = view_of_unit_cube(projection);
            const auto truths = reference.pixels(camera, size, reference.sample(camera, size, 2000), 1.0 / 512);
            const auto error = [&](const char* method) {
                return compare(renderer->render(scene, camera, size, {.method = parse_method(method)}), truths).color;
            };
            const ErrorMeasure exact = error("exact:1e-5");
            EXPECT_LE(exact.maximum, 1e-4) << (ramp ? "ramp" : "peaks");
            EXPECT_LE(exact.rms, 2e-6) << (ramp ? "ramp" : "peaks");  // measured below 5e-7
            if (projection == Camera::Projection::parallel) continue;
            const ErrorMeasure integral = error("integral");
            EXPECT_LE(integral.rms, ramp ? 0.0005 : 0.001);
            EXPECT_LE(integral.maximum, ramp ? 0.004 : 0.02);
        }
    }
}

}  // namespace
}  // namespace cellproj
