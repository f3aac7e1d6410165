// SPDX-License-Identifier: BSD-3-Clause
//
// Methods in a fragment: pictures of one cell against the float64 model of the same method along every pixel's ray.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "classify/segment_method.hpp"
#include "render/prepared_scene.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace method_picture_test {

using testing_support::Chord;
using testing_support::chord_in_first_cell;
using testing_support::error_but_for_snapping;

constexpr ImageSize size{64, 64};

const std::vector<std::string> methods{"average",
                                       "homogeneous",
                                       "linear:1",
                                       "linear:9",
                                       "stein",
                                       "preint2d:32",
                                       "preint2d:32:float16",
                                       "preint2d:32:uint8",
                                       "preint2d-exp:32",
                                       "preint2d-exp:32:float16",
                                       "preint2d-exp:32:uint8",
                                       "preint3d:16",
                                       "preint3d:16:float16",
                                       "preint3d:16:uint8",
                                       "preint3d:16:linear",
                                       "preint3d:16:linear:float16",
                                       "preint3d:16:linear:uint8"};

// Those of the transfer function's own pieces have a picture test of their own (piece_method_test).
std::vector<std::string> methods_and_pieces() {
    std::vector<std::string> all = methods;
    all.insert(all.end(), {"integral", "exact:1e-5"});
    return all;
}

TransferFunction ramp(OpticalModel model = OpticalModel::density) {
    return {
        model, {{0, {0.1, 0.2, 0.9}}, {0.4, {0.2, 1.0, 0.2}}, {1, {1.0, 0.6, 0.0}}}, {{0, 0.2}, {0.5, 6.0}, {1, 2.0}}};
}

Scene one_cell(TransferFunction transfer) {
    auto mesh = std::make_shared<TetMesh>(testing_support::unit_tet());
    auto field = std::make_shared<ScalarField>(
        testing_support::point_field(*mesh, [](const glm::dvec3& p) { return 0.1 + p.x - 0.3 * p.y + 0.6 * p.z; }));
    return {std::move(mesh), std::move(field), std::make_shared<TransferFunction>(std::move(transfer))};
}

Camera view(Camera::Projection projection = Camera::Projection::perspective) {
    return frame_bounds({glm::dvec3(0), glm::dvec3(1)}, projection, {0.9, -1.3, 0.5}, {0, 0, 1}, 1.0);
}

// The light of the float64 model along the ray through a place on the screen.
class Model {
public:
    Model(const std::string& method, const Scene& scene, const Camera& camera)
        : scene_(scene), prepared_(scene), transform_(camera, size) {
        const SceneUnits& units = prepared_.units();
        method_ = make_segment_method(
            parse_method(method), in_scene_units(*scene.transfer, units.scalar_low, units.scalar_high, units.length),
            2.0, prepared_.mean_chord());
    }

    glm::dvec4 at(const glm::dvec2& screen) const {
        const auto ray = transform_.ray(screen);
        const Chord chord = chord_in_first_cell(*scene_.mesh, ray, false);
        if (chord.length() == 0) return glm::dvec4(0.0);
        const auto scalar = [&](double t) {
            const glm::dvec3 p = ray.origin + t * ray.direction;
            return prepared_.units().normalized(0.1 + p.x - 0.3 * p.y + 0.6 * p.z);
        };
        const double length = chord.length() * glm::length(ray.direction) / prepared_.units().length;
        const Light light = method_->light(scalar(chord.enter), scalar(chord.leave), length);
        return {light.color, light.opacity};
    }

private:
    Scene scene_;
    PreparedScene prepared_;
    ScreenTransform transform_;
    std::unique_ptr<SegmentMethod> method_;
};

bool is_8_bit(const std::string& method) {
    return method.find("uint8") != std::string::npos;
}

TEST(MethodPicture, FragmentsComputeWhatTheModelDoes) {
    const auto renderer = make_renderer(Backend::gl_osmesa);
    for (const Camera::Projection projection : {Camera::Projection::parallel, Camera::Projection::perspective})
        for (const OpticalModel optical_model : {OpticalModel::density, OpticalModel::emitter})
            for (const std::string& method : methods) {
                const Scene scene = one_cell(ramp(optical_model));
                const Image image = renderer->render(scene, view(projection), size, {.method = parse_method(method)});
                const Model model(method, scene, view(projection));
                const double error = error_but_for_snapping(image, [&](const glm::dvec2& at) { return model.at(at); });
                // float32 terms and lookups: measured 8e-6. The driver (llvmpipe) filters 8-bit texels in 8 bits: one
                // rounding to 1/255 of the range per axis, times the length where the texel is an extinction: 1e-2.
                EXPECT_LT(error, is_8_bit(method) ? 2e-2 : 2e-5) << method;
                const auto opaque =
                    std::count_if(image.pixels.begin(), image.pixels.end(), [](const auto& p) { return p.a > 0.05F; });
                EXPECT_GT(opaque, 200) << method;  // there is something to compare
            }
}

TEST(MethodPicture, ExtremesStayFiniteAndPhysical) {
    const auto renderer = make_renderer(Backend::gl_osmesa);
    const double half = 0.5, next = std::nextafter(0.5, 1.0), after = std::nextafter(next, 1.0);
    const std::vector<ColorNode> colors{{0, {0, 0, 1}}, {1, {1, 0.5, 0}}};
    for (const TransferFunction& f : {
             TransferFunction(OpticalModel::density, colors, {{0, 0}, {1, 1e8}}),
             TransferFunction(OpticalModel::density, colors, {{0, 0}, {half, 0}, {next, 1e6}, {after, 0}, {1, 0}}),
             TransferFunction(OpticalModel::density, colors, {{0, 1}, {half, 1}, {next, 1e4}, {1, 1e4}}),
             TransferFunction(OpticalModel::emitter, {{0, {1e6, 0, 0}}, {1, {0, 0, 1e6}}},
                              {{0, 0}, {0.5, 1e-30}, {1, 1e6}}),
             TransferFunction(OpticalModel::emitter, colors, {{0, 0}}),
         })
        for (const std::string& method : methods_and_pieces()) {
            const Image image = renderer->render(one_cell(f), view(), size, {.method = parse_method(method)});
            for (const auto& pixel : image.pixels) {
                ASSERT_TRUE(pixel.a >= 0.0F && pixel.a <= 1.0F) << method << " " << pixel.a;
                for (int c = 0; c < 3; ++c)
                    ASSERT_TRUE(pixel[c] >= 0.0F && std::isfinite(pixel[c])) << method;
            }
        }
}

// A change of the transfer function goes through local updates of the tables: the picture is that of a fresh renderer.
TEST(MethodPicture, AnotherTransferFunctionReachesTheNextPicture) {
    const auto picture = [](Renderer& renderer, const TransferFunction& f, const std::string& method, Scene& scene) {
        scene.transfer = std::make_shared<TransferFunction>(f);
        return renderer.render(scene, view(), size, {.method = parse_method(method)}).pixels;
    };
    const TransferFunction local(OpticalModel::density, ramp().color_nodes(),
                                 {{0, 0.2}, {0.5, 6.0}, {0.7, 0.5}, {1, 2.0}});
    const TransferFunction bright(OpticalModel::emitter, ramp().color_nodes(), {{0, 9}, {1, 0}});
    for (const std::string& method : methods_and_pieces()) {
        Scene scene = one_cell(ramp());
        const auto renderer = make_renderer(Backend::gl_osmesa);
        auto before = picture(*renderer, ramp(), method, scene);
        for (const TransferFunction& f : {local, bright, ramp()}) {
            const auto updated = picture(*renderer, f, method, scene);
            EXPECT_NE(updated, before) << method;
            EXPECT_EQ(updated, picture(*make_renderer(Backend::gl_osmesa), f, method, scene)) << method;
            before = updated;
        }
    }
}

}  // namespace
}  // namespace cellproj
