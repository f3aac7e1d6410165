// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL through EGL: the same pictures as through OSMesa, both in one process, and what is said where EGL or a GPU is missing.
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "mesh/error.hpp"
#include "render/gl/egl_context.hpp"
#include "render/renderer.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scenes.hpp"

namespace cellproj {
namespace egl_test {

using testing_support::grid_mesh;
using testing_support::max_difference;
using testing_support::ramp;
using testing_support::scene_of;
using testing_support::view_of_unit_cube;

constexpr ImageSize small{96, 80};

double bumps(const glm::dvec3& p) { return 0.5 + 0.4 * std::sin(7 * p.x) * std::sin(5 * p.y + 3 * p.z); }

// One process in turns: each binds its context for a call and lets it go. Mesa's two libraries draw by one rasterizer, so every bit is the same; another
// driver may round its interpolation otherwise, up to the 2e-3 to which backends agree.
TEST(Egl, DrawsWhatOsmesaDraws) {
    const auto egl = make_renderer(Backend::gl_egl), osmesa = make_renderer(Backend::gl_osmesa);
    for (const char* method : {"integral", "preint3d:32", "shirley-tuchman"})
        for (const auto projection : {Camera::Projection::parallel, Camera::Projection::perspective}) {
            const Scene scene = scene_of(grid_mesh(5, 0.2), bumps, ramp());
            const Quality quality{.method = parse_method(method)};
            Statistics by_egl, by_osmesa;
            const Image a = egl->render(scene, view_of_unit_cube(projection), small, quality, &by_egl);
            const Image b = osmesa->render(scene, view_of_unit_cube(projection), small, quality, &by_osmesa);
            EXPECT_LE(max_difference(a, b), gl::draws_on_cpu(by_egl.backend_version) ? 0.0 : 2e-3) << method;
            EXPECT_EQ(by_egl.backend, "gl_egl");
            EXPECT_EQ(by_osmesa.backend, "gl_osmesa");
            EXPECT_GT(by_egl.counts.drawn, 100U);
        }
}

// EGL refuses a context that is current in another thread.
TEST(Egl, ServesOneThreadAfterTheOther) {
    const auto egl = make_renderer(Backend::gl_egl);
    const Scene scene = scene_of(grid_mesh(3, 0.2), bumps, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const Image here = egl->render(scene, camera, small, {});
    Image there;
    std::thread([&] { there = egl->render(scene, camera, small, {}); }).join();
    EXPECT_EQ(max_difference(here, there), 0.0);
}

TEST(Egl, TwoRenderersShareADisplay) {
    const Scene scene = scene_of(grid_mesh(3, 0.2), bumps, ramp());
    const Camera camera = view_of_unit_cube(Camera::Projection::perspective);
    const auto first = make_renderer(Backend::gl_egl);
    make_renderer(Backend::gl_egl)->prepare(scene);  // and goes
    EXPECT_EQ(max_difference(first->render(scene, camera, small, {}), make_renderer(Backend::gl_egl)->render(scene, camera, small, {})), 0.0);
}

TEST(Egl, WithoutItTheMessageNamesThePackageAndThereIsNoGpu) {
    const RendererOptions without{.egl_library = "libEGL-not-there.so.1"};
    try {
        make_renderer(Backend::gl_egl, without);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::environment);
        EXPECT_NE(std::string(error.what()).find("libegl1"), std::string::npos);
    }
    EXPECT_FALSE(find_gpu(without).found);
    EXPECT_NE(find_gpu(without).what.find("libEGL-not-there"), std::string::npos);
}

TEST(Egl, AGpuIsWhatDoesNotDrawOnTheCpu) {
    EXPECT_TRUE(gl::draws_on_cpu("llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5"));
    EXPECT_TRUE(gl::draws_on_cpu("softpipe"));
    EXPECT_TRUE(gl::draws_on_cpu("Software Rasterizer"));
    EXPECT_FALSE(gl::draws_on_cpu("NVIDIA A100-SXM4-40GB/PCIe/SSE2, OpenGL 4.5"));
    EXPECT_FALSE(gl::draws_on_cpu("AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6), OpenGL 4.6"));
    const Gpu gpu = find_gpu();
    EXPECT_FALSE(gpu.what.empty());
    EXPECT_FALSE(gpu.found && gl::draws_on_cpu(gpu.what));
}

TEST(Egl, TheUsualBackendIsAGpuThenTheNativeOne) {
    const Gpu gpu{true, "a GPU"};
    EXPECT_EQ(usual_backend({}, FieldsRead::one, gpu), Backend::gl_egl);
    EXPECT_EQ(usual_backend({}, FieldsRead::one), Backend::cpu);
    EXPECT_EQ(usual_backend({.order_per_pixel = true}, FieldsRead::one, gpu), Backend::cpu);  // native only
    EXPECT_EQ(usual_backend({.target = TargetFormat::rgba8}, FieldsRead::one), Backend::gl_osmesa);
    EXPECT_EQ(usual_backend({.target = TargetFormat::rgba8}, FieldsRead::two, gpu), Backend::gl_egl);
}

}  // namespace
}  // namespace cellproj
