// SPDX-License-Identifier: BSD-3-Clause
//
// The ways to isosurfaces that are not exact (RKE00 Fig. 6, 9, 13, 15 and the smooth combination of §10): what a table draws is what the
// judge finds at the isovalues to which it rounds, and what is approximate keeps within what it leaves out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "apps/scenes/measured_scenes.hpp"
#include "mesh/error.hpp"
#include "render/clip_region.hpp"
#include "render/prepared_surfaces.hpp"
#include "render/judge/reference.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/either_projection.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/view_judge.hpp"

namespace cellproj {
namespace surface_methods_test {

using namespace testing_support;

constexpr ImageSize size{48, 48};

Renderer& gl() {
    static const auto renderer = make_renderer(Backend::gl_osmesa);
    return *renderer;
}

Quality by(const char* surfaces, const char* method = "integral") {
    return {.method = parse_method(method), .surfaces = parse_surface_method(surfaces)};
}

std::vector<IsoSurface> three(double opacity) {
    return {{0.31, {0.2, 0.9, 0.4}, opacity, {}}, {0.5, {1, 0, 0}, opacity, glm::dvec3(0, 0, 1)}, {0.77, {0.5, 0.5, 0.5}, opacity, {}}};
}

// The isovalues that a table of n texels an axis draws: halfway between the texels around them, less the margin of float32.
std::vector<IsoSurface> rounded(std::vector<IsoSurface> list, const ScalarRange& values, int n) {
    for (IsoSurface& surface : list) {
        const double share = (surface.value - values.low) / (values.high - values.low);
        surface.value = values.low + (values.high - values.low) * ((std::ceil(share * (n - 1)) - 0.5) / (n - 1) - float32_margin);
    }
    return list;
}

// Exact from `enough` on.
double error(const Scene& drawn, const Quality& quality, const Scene& truth, const Camera& camera, double enough = 1e-5) {
    return largest(ViewJudge(Reference(truth), camera, size, rasterizer_slack).compare(gl().render(drawn, camera, size, quality), enough));
}

class SurfaceMethods : public testing::TestWithParam<Camera::Projection> {};
INSTANTIATE_TEST_SUITE_P(Gl, SurfaceMethods, testing_support::either_projection, testing_support::name_of_projection);

// Without a medium, unlit or lit by the gradient of the cell, where in the segment a surface stands does not matter: the table is as closed
// and as right as the exact way, for other isovalues. Float32 in the light, and the light's exponent, leave 2e-5.
TEST_P(SurfaceMethods, ATableDrawsTheIsovaluesToWhichItRounds) {
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9});
    for (const double opacity : {1.0, 0.3}) {
        for (const Shading shading : {Shading::unlit, Shading::flat}) {
            for (const int n : {17, 256}) {
                const Scene bare = scene_of(grid_mesh(5, 0.2, 3), linear, constant_medium(0));
                const Scene drawn = with_surfaces(bare, three(opacity), shading);
                const Scene truth = with_surfaces(bare, rounded(three(opacity), range(bare.field->values), n), shading);
                const std::string table = "table:" + std::to_string(n);
                EXPECT_LT(error(drawn, by(table.c_str()), truth, camera), 2e-5) << table << ", opacity " << opacity;
            }
        }
    }
}

// More surfaces than the table has texels: those within one step count as many times.
TEST_P(SurfaceMethods, ATableLosesNoneOfManyLayers) {
    std::vector<IsoSurface> list;
    for (int i = 0; i < 40; ++i) list.push_back({(i + 0.5) / 40, {1, 0.5, 0.25}, 0.05, {}});
    const Scene bare = scene_of(grid_mesh(5, 0.2, 3), linear, constant_medium(0));
    const ScalarRange values = range(bare.field->values);
    std::vector<IsoSurface> moved = rounded(list, values, 17);
    for (std::size_t i = 1; i < moved.size(); ++i)  // IsoSurfaces wants different ones
        moved[i].value = std::max(moved[i].value, std::nextafter(moved[i - 1].value, 2.0));
    EXPECT_LT(error(with_surfaces(bare, list, Shading::unlit), by("table:17"), with_surfaces(bare, moved, Shading::unlit),
                    view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9})), 1e-5);
}

// One opaque surface in a constant medium of depth τ: the table cuts the medium at the isovalue itself where the segment reaches it, and at its
// end otherwise, at most half a step beside: error ≤ τ·h/2 over the slope along the ray, here τ = 2, slope ≥ .3. The combination is wrong by the
// medium of a cell, mixed in the wrong order: of depth D = τ·.35 in the longest segment, at most t(1 − t)·(1 − e^(−D)) ≤ .13.
TEST_P(SurfaceMethods, InAMediumAreOffByWhatTheyLeaveOut) {
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9});
    for (const double opacity : {1.0, 0.5}) {
        const Scene scene = with_surfaces(scene_of(grid_mesh(5, 0.2, 3), linear, constant_medium(2)), {{0.5, {1, 0.5, 0}, opacity, {}}}, Shading::flat);
        const Scene moved = with_surfaces(scene, rounded({{0.5, {1, 0.5, 0}, opacity, {}}}, range(scene.field->values), 512), Shading::flat);
        const double exact = error(scene, by("exact"), scene, camera);
        const double table = error(scene, by("table:512"), moved, camera), combined = error(scene, by("combined:512"), moved, camera);
        EXPECT_LT(exact, 2e-4);
        EXPECT_LT(table, 2 / 0.3 / 511);
        EXPECT_LT(combined, 0.13);
        EXPECT_GT(combined, table);
    }
}

// Every variant of the shader: finite, opacity in 0..1, and near the exact way.
TEST_P(SurfaceMethods, OfEveryShadingWithAndWithoutMediumAndSecondField) {
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9});
    Scene scene = scene_of(grid_mesh(9, 0.2, 3), scenes::waves, ramp());
    for (const char* medium : {"none", "one field", "two fields"}) {
        scene.transfer = std::make_shared<TransferFunction>(medium == std::string("none") ? constant_medium(0) : ramp());
        scene.opacity_field = medium == std::string("two fields") ? scene.field : nullptr;
        for (const double opacity : {1.0, 0.4})
            for (const Shading shading : {Shading::unlit, Shading::flat, Shading::smooth}) {
                const Scene drawn = with_surfaces(scene, three(opacity), shading);
                const Image exact = gl().render(drawn, camera, size, by("exact"));
                for (const char* name : {"table:", "combined:"}) {
                    const std::string method = name + std::string(CELLPROJ_SANITIZED ? "256" : "1024");  // large tables are slow to make there
                    const Image image = gl().render(drawn, camera, size, by(method.c_str()));
                    double sum = 0;
                    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
                        const glm::vec4 p = image.pixels[i], q = exact.pixels[i];
                        EXPECT_TRUE(std::isfinite(p.r + p.g + p.b) && p.a >= 0 && p.a <= 1);
                        sum += std::abs(p.r - q.r) + std::abs(p.g - q.g) + std::abs(p.b - q.b);
                    }
                    EXPECT_LT(sum / static_cast<double>(image.pixels.size()), 0.05) << medium << ", " << method << ", opacity " << opacity;
                }
            }
    }
}

// Cut by a box, unlit and without a medium: what is kept is told by the place of the isovalue, off by half a step of the table from the
// surface that is drawn. Pixels where the box's faces cut that close to the surface differ, and no others: fewer, the finer the table.
TEST_P(SurfaceMethods, AreCutByClipping) {
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9});
    Scene bare = scene_of(grid_mesh(5, 0.2, 3), linear, constant_medium(0));
    bare.clip = std::make_shared<ClipRegion>(box_region({glm::dvec3(0.22), glm::dvec3(0.81)}));
    const std::size_t texels = CELLPROJ_SANITIZED ? 512 : 2048;  // large tables are slow to make there
    for (const double opacity : {1.0, 0.4})
        for (const char* way : {"table:", "combined:"}) {
            const std::string method = way + std::to_string(texels);
            const Scene scene = with_surfaces(bare, three(opacity), Shading::unlit);
            const Image exact = gl().render(scene, camera, size, by("exact")), cut = gl().render(scene, camera, size, by(method.c_str()));
            std::size_t differing = 0, seen = 0;
            for (std::size_t i = 0; i < cut.pixels.size(); ++i) {
                differing += glm::any(glm::greaterThan(glm::abs(cut.pixels[i] - exact.pixels[i]), glm::vec4(1e-3F)));
                seen += exact.pixels[i].a > 0;
            }
            EXPECT_GT(seen, 50U);
            EXPECT_LE(differing, seen * 2048 / (50 * texels)) << method << ", opacity " << opacity;
        }
    // A constant medium, cut alike by all ways: where no surface is seen, no way shows more of it.
    bare.transfer = std::make_shared<TransferFunction>(constant_medium(2));
    const Scene medium = with_surfaces(bare, {{5.0}}, Shading::unlit);
    for (const char* method : {"table:33", "combined:33"})
        EXPECT_LT(max_difference(gl().render(medium, camera, size, by(method)), gl().render(medium, camera, size, by("exact"))), 1e-5) << method;
}

// Isovalues that points have, below and above all of them, one value everywhere, scalars of any size.
TEST_P(SurfaceMethods, AtTheEdgesOfTheTable) {
    const Camera camera = view_of_unit_cube(GetParam(), {1.3, -2.1, 0.9});
    for (const double scale : {1.0, 1e-12, 1e12}) {
        const Scene bare = scene_of(grid_mesh(5, 0.0), [&](const glm::dvec3& p) { return scale * p.z; }, constant_medium(0));
        const auto at = [&](double value) { return with_surfaces(bare, {{scale * value, {1, 0.5, 0}, 0.5, {}}}, Shading::unlit); };
        const Image inside = gl().render(at(0.5), camera, size, by("table:33"));
        EXPECT_GT(std::ranges::count_if(inside.pixels, [](const glm::vec4& p) { return p.a == 0.5F; }), 100) << scale;
        for (const double outside : {-1.0, 0.0, 2.0}) {
            const Image none = gl().render(at(outside), camera, size, by("table:33"));
            EXPECT_TRUE(std::ranges::all_of(none.pixels, [](const glm::vec4& p) { return p == glm::vec4(0); })) << scale << " " << outside;
        }
    }
    const Scene same = with_surfaces(scene_of(grid_mesh(3), [](const glm::dvec3&) { return 7.0; }, constant_medium(0)), {{7.0}}, Shading::unlit);
    EXPECT_TRUE(std::ranges::all_of(gl().render(same, camera, size, by("table")).pixels, [](const glm::vec4& p) { return p.a == 0; }));
}

TEST(SurfaceMethod, ChangesBetweenPicturesLeaveNothingBehind) {
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective, {1.3, -2.1, 0.9});
    const Scene scene = with_surfaces(scene_of(grid_mesh(6, 0.2, 3), scenes::waves, constant_medium(0)), three(0.4), Shading::smooth);
    const Image exact = gl().render(scene, camera, size, by("exact"));
    const Image table = gl().render(scene, camera, size, by("table:9"));
    EXPECT_GT(max_difference(exact, table), 0.1);
    EXPECT_EQ(max_difference(gl().render(scene, camera, size, by("exact")), exact), 0);
    EXPECT_EQ(max_difference(gl().render(scene, camera, size, by("table:9")), table), 0);
}

TEST(SurfaceMethod, NamesGoThereAndBack) {
    for (const char* name : {"exact", "table:2", "table:2048", "combined:300"}) EXPECT_EQ(to_string(parse_surface_method(name)), name);
    EXPECT_EQ(to_string(parse_surface_method("table")), "table:512");
    for (const char* wrong : {"", "tables", "exact:5", "table:", "table:1", "table:2049", "table:8x", "combined:-4"})
        EXPECT_THROW(parse_surface_method(wrong), Error) << wrong;
}

TEST(SurfaceMethod, IsRefusedByTheCpuBackendUnlessExact) {
    EXPECT_TRUE(draws(Backend::cpu, by("exact")));
    EXPECT_FALSE(draws(Backend::cpu, by("table")));
    EXPECT_EQ(usual_backend(by("combined")), Backend::gl_osmesa);
    try {
        require_drawn(Backend::cpu, by("table"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::option);
        EXPECT_NE(std::string(error.what()).find("--iso-method"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace cellproj
