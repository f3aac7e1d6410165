// SPDX-License-Identifier: BSD-3-Clause
//
// What the methods that follow the transfer function's own pieces promise of a whole picture, on a Delaunay mesh of some 200,000 cells
// (its slivers included), against the float64 judge.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "apps/scenes/measured_scenes.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace accuracy_test {

using testing_support::delaunay_mesh;
using testing_support::point_field;
using testing_support::view_of_unit_cube;

// Opaque pixels count as much as thin ones; 2000 of them are a fair sample of a picture's errors, not of its worst pixel:
// classify/README.md has the figures of whole pictures.
TEST(Accuracy, OfPiecesOnADelaunayMesh) {
    const ImageSize size = CELLPROJ_SANITIZED ? ImageSize{128, 128} : ImageSize{512, 512};
    const auto mesh = std::make_shared<const TetMesh>(delaunay_mesh(CELLPROJ_SANITIZED ? 1500 : 30800, 1));
    const auto field = std::make_shared<const ScalarField>(point_field(*mesh, scenes::waves));
    const auto renderer = make_renderer(Backend::gl_osmesa);
    std::shared_ptr<const RayIndex> index;
    for (const bool ramp : {true, false}) {
        const Scene scene{mesh, field, std::make_shared<TransferFunction>(ramp ? scenes::ramp() : scenes::table_peaks())};
        const Reference reference(scene, index);
        index = reference.shared_index();
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Camera camera = view_of_unit_cube(projection);
            const auto truths = reference.pixels(camera, size, reference.sample(camera, size, CELLPROJ_SANITIZED ? 300 : 2000), rasterizer_slack);
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
