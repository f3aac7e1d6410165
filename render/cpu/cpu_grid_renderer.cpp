// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/cpu_grid_renderer.hpp"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "classify/segment_method.hpp"
#include "mesh/error.hpp"
#include "render/cpu/backend_version.hpp"
#include "render/cpu/classification.hpp"
#include "render/cpu/grid_bend.hpp"
#include "render/cpu/grid_kernels.hpp"
#include "render/cpu/grid_volume.hpp"
#include "render/cpu/picture_tiles.hpp"
#include "render/depth_window.hpp"
#include "render/grid_plan.hpp"
#include "render/grid_surfaces.hpp"

namespace cellproj::cpu {

namespace {

class CpuGridRenderer : public GridRenderer {
public:
    explicit CpuGridRenderer(int threads) : arena_(threads > 0 ? threads : oneapi::tbb::task_arena::automatic) {}

    void prepare(const GridScene& scene, const GridQuality& quality) override {
        require_grid_drawn(Backend::cpu, quality, grid_shading(scene));
        arena_.execute([&] { prepare_here(scene, quality); });
    }

    Image render(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality,
                 Statistics* statistics) override {
        validate(camera, "camera");
        validate(size, "size");
        require_grid_drawn(Backend::cpu, quality, grid_shading(scene));
        return arena_.execute([&] { return render_here(scene, camera, size, quality, statistics); });
    }

private:
    void prepare_here(const GridScene& scene, const GridQuality& quality);
    Image render_here(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality, Statistics* out);
    void set_surfaces(bool medium);
    std::size_t draw(Image& image, const ScreenTransform& transform, std::span<const DepthInterval> kept) const;

    oneapi::tbb::task_arena arena_;
    GridScene scene_;
    std::optional<GridVolume> volume_;              // of scene_.grid
    std::vector<glm::vec3> gradients_;              // at its points, where shading wants them
    GridSurfaces surfaces_;                         // of scene_
    Method method_;
    std::optional<Classification> classification_;  // of method_ and scene_.transfer
    float bend_ = 0;
};

// Brings what depends on the scene and the quality up to date; usually there is nothing to do.
void CpuGridRenderer::prepare_here(const GridScene& scene, const GridQuality& quality) {
    const bool same_grid = volume_ && scene_.grid == scene.grid, same_surfaces = same_grid && scene_.surfaces == scene.surfaces;
    if (!same_grid || !same_surfaces) {
        validate(scene);
        classification_.reset();  // none of another scene behind a failure
    }
    if (!same_grid) {
        volume_.reset();
        gradients_.clear();
        volume_.emplace(*scene.grid);
    }
    if (same_surfaces && classification_ && scene_.transfer == scene.transfer && method_ == quality.method) return;

    const GridUnits& units = volume_->units();
    const TransferFunction transfer = in_scene_units(*scene.transfer, units.scalar_low, units.scalar_high, units.length);
    scene_ = scene;
    method_ = quality.method;
    classification_.reset();
    volume_->set_light(transfer, has_surfaces(scene) ? kept_isovalues(scene.surfaces->isosurfaces, units) : std::vector<float>{});
    set_surfaces(transfer.visible(0.0, 1.0));
    bend_ = bend_of(method_, transfer);
    classification_.emplace(method_, transfer, volume_->mean_chord());  // last: it tells that all is prepared
}

void CpuGridRenderer::set_surfaces(bool medium) {
    surfaces_ = volume_->surfaces();
    surfaces_.medium = medium;
    surfaces_.lit_medium = medium && has_lit_medium(scene_);
    if (!has_surfaces(scene_) && !surfaces_.lit_medium) return;
    const SurfaceScene& scene = *scene_.surfaces;
    for (const SurfaceMaterial& material : materials_of(scene.isosurfaces))
        for (const glm::vec3& color : {material.front, material.back})
            surfaces_.materials.insert(surfaces_.materials.end(), {color.r, color.g, color.b, material.opacity});
    surfaces_.shading = scene.shading;
    surfaces_.lighting = kernel_lighting(scene.lighting);
    if (scene.shading != SurfaceShading::smooth) return;
    // The kernels count their parts by 32 bits.
    if (constexpr std::size_t most = std::numeric_limits<std::int32_t>::max() / 3; scene_.grid->values.size() > most) {
        throw Error({ErrorKind::data, "grid", "at most " + std::to_string(most) + " points for smooth shading", std::to_string(scene_.grid->values.size()),
                     "use flat shading (--shading flat), resample it, or cut a part out"});
    }
    if (gradients_.empty()) gradients_ = kept_gradients(*scene_.grid, volume_->units());
    surfaces_.gradients = &gradients_[0].x;
}

Image CpuGridRenderer::render_here(const GridScene& scene, const Camera& camera, ImageSize size, const GridQuality& quality,
                                   Statistics* out) {
    const Stopwatch total;
    prepare_here(scene, quality);
    Statistics statistics;
    statistics.ms.plan = total.ms();
    Image image(size.width, size.height);
    const Stopwatch drawing;
    std::optional<DepthWindow> window;
    if (ray_cuts(scene).any()) window.emplace(scene, camera, size, volume_->units().length);
    const bool seen = volume_->empty_cells() < scene.grid->cell_count();  // besides slices and bodies
    if (seen) statistics.counts.fragments = draw(image, ScreenTransform(camera, size), window ? window->pixels() : std::span<const DepthInterval>{});
    if (window) window->add_opaque(image);
    statistics.ms.draw = drawing.ms();
    statistics.ms.total = total.ms();
    if (!out) return image;
    statistics.counts.cells = scene.grid->cell_count();
    statistics.counts.culled = volume_->empty_cells();
    statistics.counts.drawn = statistics.counts.cells - statistics.counts.culled;
    statistics.method = to_string(quality.method);
    statistics.target = to_string(quality.target);
    statistics.table_bytes = classification_->bytes();
    statistics.backend = to_string(Backend::cpu);
    statistics.backend_version = backend_version();
    statistics.drawn_as = "grid";
    statistics.order = "none";  // rays meet their cells one after the other
    statistics.order_exact = true;
    statistics.plan = plan_of(scene, quality, {.rays = true, .cells = statistics.counts.cells, .drawn = statistics.counts.drawn, .medium = surfaces_.medium});
    *out = std::move(statistics);
    return image;
}

// Returns the number of segments.
std::size_t CpuGridRenderer::draw(Image& image, const ScreenTransform& transform, std::span<const DepthInterval> kept) const {
    const GridCells cells = volume_->cells();
    Shading shading = classification_->shading();
    if (!classification_->may_be_opaque() && surfaces_.count == 0) shading.opaque = 1.0F;
    return draw_tiles(image, [&](const Tile& tile) {
        GridRays rays;
        volume_->find_rays(transform, tile.x, tile.y, tile.width, tile.height, kept, rays);
        return draw_grid_tile(cells, surfaces_.count > 0 || surfaces_.lit_medium ? &surfaces_ : nullptr, rays, shading, bend_, tile);
    });
}

}  // namespace

std::unique_ptr<GridRenderer> make_grid_renderer(int threads) { return std::make_unique<CpuGridRenderer>(threads); }

}  // namespace cellproj::cpu
