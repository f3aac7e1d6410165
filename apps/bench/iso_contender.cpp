// SPDX-License-Identifier: BSD-3-Clause
#include "apps/bench/iso_contender.hpp"

#include <stdexcept>
#include <utility>

#include "render/renderer.hpp"

namespace cellproj::bench {

namespace {

class OurSurfaces final : public IsoContender {
public:
    OurSurfaces(Backend backend, ImageSize size) : renderer_(make_renderer(backend)), size_(size) {}

    void set(const Scene& scene) override {
        scene_ = scene;
        renderer_->prepare(scene_);
    }
    void draw(const Camera& camera) override { renderer_->render(scene_, camera, size_); }

private:
    std::unique_ptr<Renderer> renderer_;
    ImageSize size_;
    Scene scene_;
};

}  // namespace

std::vector<std::string> iso_contender_names() {
#if CELLPROJ_BENCH_VTK
    return {"cpu", "gl", "vtk"};
#else
    return {"cpu", "gl"};
#endif
}

std::unique_ptr<IsoContender> make_iso_contender(const std::string& name, ImageSize size) {
    if (name == "cpu") return std::make_unique<OurSurfaces>(Backend::cpu, size);
    if (name == "gl") return std::make_unique<OurSurfaces>(Backend::gl_osmesa, size);
#if CELLPROJ_BENCH_VTK
    if (name == "vtk") return make_vtk_contours(size);
#endif
    throw std::invalid_argument("no contender is called " + name);
}

}  // namespace cellproj::bench
