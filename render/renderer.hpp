// SPDX-License-Identifier: BSD-3-Clause
//
// Scene and camera to picture.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "classify/method.hpp"
#include "project/camera.hpp"
#include "render/gpu.hpp"
#include "render/image.hpp"
#include "render/plan_rules.hpp"
#include "render/scene.hpp"
#include "render/statistics.hpp"
#include "render/surface_method.hpp"
#include "render/target_format.hpp"
#include "sort/view_order.hpp"

namespace cellproj {

// The speed–accuracy choices of one picture.
struct Quality {
    Method method = {};                           // how a segment becomes light
    TargetFormat target = TargetFormat::rgba32f;  // what cells are blended in
    std::optional<OrderMethod> order = {};        // how cells are sorted; nothing: exactly for this mesh
    // CPU backend: each pixel sorts what its ray meets, instead of an order of cells. Exact at pixel centres for any mesh whose cells do
    // not overlap, cyclic or not; `order` and `check_rays` do not count then.
    bool order_per_pixel = false;
    SurfaceMethod surfaces = {};                  // how isosurfaces are found; the CPU backend draws `exact` only
    // After the frame, for the statistics: count face neighbours in the wrong order, by exact signs (an eighth of a frame), …
    bool check_neighbours = true;
    std::size_t check_rays = 0;                   // … and as many rays that judge it
};

// A renderer keeps what does not depend on the view (adjacency, table, visibility of cells) for the scene it drew last: a
// second picture of the same scene is cheaper. Not thread-safe: one thread at a time.
class Renderer {
public:
    virtual ~Renderer() = default;

    // Does now what the first picture of a scene would do besides drawing; later pictures find it done. Throws as
    // `require_drawn`.
    virtual void prepare(const Scene& scene, const Quality& quality = {}) = 0;

    // The associated picture, over nothing: the background is added when it is written. Throws Error (option) for an
    // unusable camera or size, Error (environment) when the driver fails.
    virtual Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality = {},
                         Statistics* statistics = nullptr) = 0;
};

enum class Backend {
    gl_osmesa,  // OpenGL 4.5 core on the CPU, off screen: needs no display and no GPU; draws every method and target
    gl_egl,     // the same through EGL: on a GPU where there is one, else on the CPU
    cpu         // native, the faster one without a GPU; light for each pixel, rgba32f
};

std::string to_string(Backend backend);  // "gl_osmesa", "gl_egl", "cpu", as statistics say

struct RendererOptions {
    std::string osmesa_library = "libOSMesa.so.8";  // name or path, loaded when the renderer is made
    std::string egl_library = "libEGL.so.1";        // likewise
    int threads = 0;                                // of the CPU backend, ≥ 0; 0: all that the process may use
    PlanRules rules = {};                           // for tests and benchmarks: the same pictures without some of them
};

// Whether a backend draws pictures of this quality, of a scene with or without an opacity field.
bool draws(Backend backend, const Quality& quality, FieldsRead fields = FieldsRead::one);
// Throws Error (option), which says what to do instead, when it does not; so do renderers.
void require_drawn(Backend backend, const Quality& quality, FieldsRead fields = FieldsRead::one);
// OpenGL on a GPU; without one the native backend where it can, and what it does not draw, OpenGL on the CPU does. Pixels that sort
// themselves are native only.
Backend usual_backend(const Quality& quality, FieldsRead fields = FieldsRead::one, const Gpu& gpu = {});

// Whether EGL offers a GPU here. A few milliseconds where there is none.
Gpu find_gpu(const RendererOptions& options = {});

// Throws Error (environment) when the backend is not available here; the message names the package to install.
std::unique_ptr<Renderer> make_renderer(Backend backend, const RendererOptions& options = {});

}  // namespace cellproj
