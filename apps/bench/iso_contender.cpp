// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/iso_contender.hpp"

#include <stdexcept>
#include <utility>

#include "render/renderer.hpp"

namespace cellproj::bench {

namespace {

class OurSurfaces final : public IsoContender {
public:
    OurSurfaces(Backend backend, ImageSize size, SurfaceMethodKind method = SurfaceMethodKind::exact)
        : renderer_(make_renderer(backend)), size_(size), quality_{.surfaces = {.kind = method}} {}

    void set(const Scene& scene) override {
        scene_ = scene;
        renderer_->prepare(scene_, quality_);
    }
    void draw(const Camera& camera) override { renderer_->render(scene_, camera, size_, quality_); }

private:
    std::unique_ptr<Renderer> renderer_;
    ImageSize size_;
    Quality quality_;
    Scene scene_;
};

}  // namespace

std::vector<std::string> iso_contender_names() {
#if CELLPROJ_BENCH_VTK
    return {"cpu", "gl", "gl-table", "gl-combined", "vtk"};
#else
    return {"cpu", "gl", "gl-table", "gl-combined"};
#endif
}

std::unique_ptr<IsoContender> make_iso_contender(const std::string& name, ImageSize size) {
    if (name == "cpu") return std::make_unique<OurSurfaces>(Backend::cpu, size);
    if (name == "gl") return std::make_unique<OurSurfaces>(Backend::gl_osmesa, size);
    if (name == "gl-table") return std::make_unique<OurSurfaces>(Backend::gl_osmesa, size, SurfaceMethodKind::table);
    if (name == "gl-combined") return std::make_unique<OurSurfaces>(Backend::gl_osmesa, size, SurfaceMethodKind::combined);
#if CELLPROJ_BENCH_VTK
    if (name == "vtk") return make_vtk_contours(size);
#endif
    throw std::invalid_argument("no contender is called " + name);
}

}  // namespace cellproj::bench
