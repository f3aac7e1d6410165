// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/cpu_renderer.hpp"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "classify/segment_method.hpp"
#include "render/cpu/backend_version.hpp"
#include "render/cpu/classification.hpp"
#include "render/cpu/kernels.hpp"
#include "render/cpu/screen_mesh.hpp"
#include "render/cpu/tile_bins.hpp"
#include "render/depth_window.hpp"
#include "render/plan.hpp"
#include "render/prepared_scene.hpp"

namespace cellproj::cpu {

namespace {

// The region of a picture whose first pixel is (x, y).
Region region_at(ImageSize size, int x, int y) {
    constexpr int side = region_side * tile_side;
    return {x, y, std::min(side, size.width - x), std::min(side, size.height - y)};
}

class CpuRenderer : public Renderer {
public:
    CpuRenderer(int threads, const PlanRules& rules) : arena_(threads > 0 ? threads : oneapi::tbb::task_arena::automatic), rules_(rules) {}

    void prepare(const Scene& scene, const Quality& quality) override {
        require_drawn(Backend::cpu, quality, fields_read(scene));
        arena_.execute([&] { prepare_here(scene, quality); });
    }

    Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality,
                 Statistics* statistics) override {
        validate(camera, "camera");
        validate(size, "size");
        require_drawn(Backend::cpu, quality, fields_read(scene));
        return arena_.execute([&] { return render_here(scene, camera, size, quality, statistics); });
    }

private:
    void prepare_here(const Scene& scene, const Quality& quality);
    Image render_here(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Statistics* out);
    using Drawing = Plan::Drawing;
    // What one picture is of.
    struct Frame {
        const Scene& scene;
        const Camera& camera;
        ImageSize size;
        Plan plan;
    };
    struct SortedCells {
        ViewOrder order;
        OrderReport report;
    };
    std::span<const CellId> drawn_cells(const Plan& plan) const;
    std::optional<DepthWindow> window_of(const Frame& frame) const;
    std::optional<DepthWindow> sort_cells(const Frame& frame, const Quality& quality, SortedCells& sorted, Statistics& statistics);
    std::span<const std::uint32_t> items_of(const Frame& frame, ViewOrder& order, const std::optional<DepthWindow>& window, Statistics& statistics);
    void draw_regions(Image& image, const Plan& plan, std::span<const std::uint32_t> items, Statistics& statistics);
    void prepare_method(const Method& method, const TransferFunction& transfer, bool same_transfer);
    void describe(Statistics& statistics, const Quality& quality, const Plan& plan) const;
    void set_windows(const DepthWindow& window);
    void draw(Image& image, const Region& region, Drawing drawing, Statistics& statistics);
    bool may_be_opaque() const;

    oneapi::tbb::task_arena arena_;
    PlanRules rules_;
    std::optional<PreparedScene> prepared_;
    Plan plan_;  // of all views of it
    Method method_;
    std::optional<Classification> classification_;  // of method_, for the prepared scene
    bool classified_ = false;                       // and for its transfer function
    ScreenMesh mesh_;
    TileBins bins_;
    std::vector<std::uint8_t> extra_drawn_;
    std::vector<PixelTrail> trails_;  // with isosurfaces, of the picture's pixels
    std::vector<NearnessInterval> windows_;  // of the picture's pixels, where something is cut
    oneapi::tbb::enumerable_thread_specific<PendingFragments> pending_;
};

// Brings what depends on the scene and the quality up to date; usually there is nothing to do.
void CpuRenderer::prepare_here(const Scene& scene, const Quality& quality) {
    const bool same_cells = prepared_ && prepared_->scene().mesh == scene.mesh && prepared_->scene().field == scene.field;
    const bool same_transfer = same_cells && prepared_->scene().transfer == scene.transfer;
    if (!same_cells) {
        classification_.reset();
        prepared_.emplace(scene, SurfaceSides{}, rules_);
        mesh_.set_scene(*prepared_);
    } else if (!same_transfer) {
        prepared_->set_transfer(scene.transfer);
        mesh_.set_visible();
    }
    if (same_cells && prepared_->scene().surfaces != scene.surfaces) {
        prepared_->set_surfaces(scene.surfaces);
        mesh_.set_visible();
        mesh_.set_surfaces();
    } else if (same_cells && !same_transfer) {
        mesh_.set_surfaces();  // with or without a medium
    }
    plan_ = plan_scene(prepared_->facts(), quality, Backend::cpu, rules_);
    if (plan_.sorts() && !plan_.few_cells) prepared_->sorter();
    prepare_method(plan_.method, *scene.transfer, same_transfer);
}

void CpuRenderer::prepare_method(const Method& method, const TransferFunction& transfer, bool same_transfer) {
    const bool same_method = classification_ && method_ == method;
    if (same_transfer && same_method && classified_) return;
    classified_ = false;  // until all of it is done: no stale table behind a failure

    const SceneUnits& units = prepared_->units();
    const TransferFunction scaled = in_scene_units(transfer, units.scalar_low, units.scalar_high, units.length);
    if (same_method) {
        classification_->set_transfer(scaled);
        classified_ = true;
        return;
    }
    // A walk over all cells, which one method alone wants to know of.
    const double mean_length = method.kind == MethodKind::preint2d ? prepared_->mean_chord() : longest_segment;
    classification_.emplace(method, scaled, mean_length);
    method_ = method;
    classified_ = true;
}

Image CpuRenderer::render_here(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Statistics* out) {
    Statistics statistics;
    const Stopwatch total;
    prepare_here(scene, quality);
    const Frame frame{scene, camera, size, plan_view(plan_, prepared_->facts(), camera, size, ray_cuts(scene), rules_)};
    Image image(size.width, size.height);
    statistics.ms.plan = total.ms();
    SortedCells sorted;
    if (frame.plan.drawing == Drawing::nothing) {
        if (const auto window = window_of(frame)) window->add_opaque(image);
    } else {
        const std::optional<DepthWindow> window = sort_cells(frame, quality, sorted, statistics);
        const auto items = items_of(frame, sorted.order, window, statistics);
        draw_regions(image, frame.plan, items, statistics);
        if (window) window->add_opaque(image);
    }
    statistics.ms.total = total.ms();
    if (!out) return image;

    describe(statistics, quality, frame.plan);
    if (frame.plan.drawing == Drawing::by_cells) {  // the proof of the order is no part of the frame
        prepared_->judge(sorted.order, sorted.report, camera, size, quality, statistics);
        tell_order(statistics.plan, statistics.order, statistics.order_exact);
    }
    *out = std::move(statistics);
    return image;
}

// The cells that a picture looks at; none stands for all. Of surfaces alone, what they do not cross is not looked at.
std::span<const CellId> CpuRenderer::drawn_cells(const Plan& plan) const {
    return plan.drawing == Drawing::nearest_surfaces ? prepared_->surfaces()->crossed() : std::span<const CellId>();
}

std::optional<DepthWindow> CpuRenderer::window_of(const Frame& frame) const {
    if (!ray_cuts(frame.scene).any()) return {};
    return DepthWindow(frame.scene, frame.camera, frame.size, prepared_->units().length);
}

// Points and boxes do not depend on the order: they are found beside it, where part of a sort leaves cores idle, as is what cuts rays.
std::optional<DepthWindow> CpuRenderer::sort_cells(const Frame& frame, const Quality& quality, SortedCells& sorted, Statistics& statistics) {
    const Stopwatch watch;
    std::optional<DepthWindow> window;
    oneapi::tbb::parallel_invoke(
        [&] {
            // Pixels that sort their own fragments want cells nearly sorted, no more.
            const auto method = frame.plan.drawing == Drawing::by_pixels ? OrderMethod::centroid : quality.order;
            if (frame.plan.sorts()) sorted.order = prepared_->order(frame.camera, frame.size, method, &sorted.report);
        },
        [&] {
            const bool nearest = frame.plan.drawing == Drawing::nearest_surfaces;
            mesh_.set_view(frame.camera, frame.size, nearest ? prepared_->surfaces()->crossed_points() : std::span<const VertexId>());
            bins_.find_cells(mesh_.cells(), region_at(frame.size, 0, 0), drawn_cells(frame.plan));
        },
        [&] { window = window_of(frame); });
    statistics.ms.sort = watch.ms();
    return window;
}

// What is to be drawn, in its order; without a sort, one that takes no time.
std::span<const std::uint32_t> CpuRenderer::items_of(const Frame& frame, ViewOrder& order, const std::optional<DepthWindow>& window,
                                                     Statistics& statistics) {
    const Stopwatch watch;
    const Plan& plan = frame.plan;
    if (plan.drawing == Drawing::sum) order = prepared_->any_order();
    if (plan.blends() && !plan.sorts()) order.items = mesh_.nearly_sorted(prepared_->any_order().items);
    // In any order; nearly sorted ones hide most of each other.
    if (plan.drawing == Drawing::nearest_surfaces) order.items = mesh_.nearly_sorted(drawn_cells(plan));
    const auto items = mesh_.cut(order);
    extra_drawn_.assign(mesh_.extra_cells().size(), 0);
    const std::size_t pixels = static_cast<std::size_t>(frame.size.width) * static_cast<std::size_t>(frame.size.height);
    if (prepared_->surfaces()) trails_.assign(pixels, {});
    windows_.clear();
    if (window) set_windows(*window);
    statistics.ms.project = watch.ms();
    return items;
}

void CpuRenderer::draw_regions(Image& image, const Plan& plan, std::span<const std::uint32_t> items, Statistics& statistics) {
    const ImageSize size{image.width, image.height};
    const Region first = region_at(size, 0, 0);
    for (int y = 0; y < size.height; y += first.height)
        for (int x = 0; x < size.width; x += first.width) {
            const Region region = region_at(size, x, y);
            bins_.begin(mesh_.cells(), region, items, extra_drawn_, plan.blends() && may_be_opaque(), drawn_cells(plan));
            draw(image, region, plan.drawing, statistics);
            statistics.counts.drawn += bins_.drawn();
        }
    std::vector<CellId> cut_cells;  // each once, of however many parts
    for (std::size_t i = 0; i < extra_drawn_.size(); ++i)
        if (extra_drawn_[i]) cut_cells.push_back(mesh_.extra_cells()[i]);
    std::sort(cut_cells.begin(), cut_cells.end());
    statistics.counts.drawn += static_cast<std::size_t>(std::unique(cut_cells.begin(), cut_cells.end()) - cut_cells.begin());
}

// What is known without the order of cells.
void CpuRenderer::describe(Statistics& statistics, const Quality& quality, const Plan& plan) const {
    statistics.counts.cells = prepared_->facts().cells;
    statistics.counts.culled = statistics.counts.cells - statistics.counts.drawn;
    statistics.method = to_string(quality.method);
    statistics.target = to_string(quality.target);
    statistics.table_bytes = classification_->bytes();
    statistics.backend = to_string(Backend::cpu);
    statistics.backend_version = backend_version();
    statistics.plan = plan.decisions;
    statistics.order = plan.drawing == Drawing::by_pixels ? "pixel" : "none";
    statistics.order_exact = true;
}

// Isosurfaces may hide what is behind where together they let less than half through: rays meet them several times.
bool CpuRenderer::may_be_opaque() const {
    if (classification_->may_be_opaque()) return true;
    const PreparedSurfaces* surfaces = prepared_->surfaces();
    if (!surfaces) return false;
    double transmitted = 1.0;
    for (const IsoSurface& surface : surfaces->scene().isosurfaces.surfaces()) transmitted *= 1.0 - surface.opacity;
    return transmitted < 0.5;
}

void CpuRenderer::set_windows(const DepthWindow& window) {
    for (const DepthInterval& pixel : window.pixels())
        windows_.push_back(pixel.empty() ? NearnessInterval::nothing() : NearnessInterval{mesh_.nearness(pixel.near), mesh_.nearness(pixel.far)});
}

// Slab by slab from the front, each tile by one task: the same order of operations for any number of threads.
void CpuRenderer::draw(Image& image, const Region& region, Drawing drawing, Statistics& statistics) {
    const int columns = (region.width + tile_side - 1) / tile_side, rows = (region.height + tile_side - 1) / tile_side;
    Shading shading = classification_->shading();
    if (!may_be_opaque()) shading.opaque = 1.0F;
    std::atomic<std::size_t> fragments = 0;
    for (;;) {
        const Stopwatch filling;
        const bool some = drawing == Drawing::by_pixels ? bins_.next_tiles() : bins_.next();
        statistics.ms.project += filling.ms();
        if (!some) break;
        const Stopwatch tiles;
        oneapi::tbb::parallel_for(
            0, columns * rows,
            [&](int index) {
                const int column = index % columns, row = index / columns;
                const auto items = bins_.tile(column, row);
                if (items.empty()) return;
                const int x = region.x + column * tile_side, y = region.y + row * tile_side;
                Tile tile{x, y, std::min(tile_side, image.width - x), std::min(tile_side, image.height - y), &image.at(x, y),
                          static_cast<std::size_t>(image.width), &bins_.full(column, row)};
                if (prepared_->surfaces())
                    tile.trails = &trails_[static_cast<std::size_t>(y) * tile.stride + static_cast<std::size_t>(x)];
                if (!windows_.empty())
                    tile.windows = &windows_[static_cast<std::size_t>(y) * tile.stride + static_cast<std::size_t>(x)];
                switch (drawing) {
                    case Drawing::nothing:
                        break;
                    case Drawing::sum:
                    case Drawing::by_cells:
                        fragments += draw_tile(mesh_.cells(), shading, tile, items);
                        break;
                    case Drawing::by_pixels:
                        fragments += draw_tile_by_pixels(mesh_.cells(), shading, tile, items, pending_.local());
                        break;
                    case Drawing::nearest_surfaces:
                        tile.full = nullptr;  // what comes later may be nearer
                        fragments += draw_nearest_surfaces(mesh_.cells(), tile, items);
                        break;
                }
            },
            oneapi::tbb::simple_partitioner());
        statistics.ms.draw += tiles.ms();
    }
    statistics.counts.fragments += fragments;
}

}  // namespace

std::unique_ptr<Renderer> make_renderer(int threads, const PlanRules& rules) { return std::make_unique<CpuRenderer>(threads, rules); }

}  // namespace cellproj::cpu
