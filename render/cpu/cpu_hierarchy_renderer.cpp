// SPDX-License-Identifier: BSD-3-Clause
//
// Hierarchies of grids: boxes of one piece each, from front to back (mesh/hierarchy_boxes.hpp), drawn tile by tile as grids are
// (grid_kernels.hpp) and composited.
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
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
#include "render/hierarchy_renderer.hpp"

namespace cellproj {

namespace cpu {

namespace {

// A part of the picture [pixels].
struct Window {
    double left, top, right, bottom;

    bool overlaps(const Tile& tile) const {
        return left < tile.x + tile.width && right > tile.x && top < tile.y + tile.height && bottom > tile.y;
    }
};

// Where a box can be seen: around its corners, and everywhere where one of them is not in front of the eye. A pixel more, as they are
// rounded.
Window window_of(const Bounds& box, const ScreenTransform& transform) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Window window{infinity, infinity, -infinity, -infinity};
    for (unsigned c = 0; c < 8; ++c) {
        const glm::dvec3 corner((c & 1U) != 0 ? box.high.x : box.low.x, (c & 2U) != 0 ? box.high.y : box.low.y, (c & 4U) != 0 ? box.high.z : box.low.z);
        const glm::dvec3 seen = transform.to_eye(corner);
        if (transform.perspective() && !(seen.z > 0)) return {-infinity, -infinity, infinity, infinity};
        const glm::dvec2 place = transform.to_screen(seen);
        window = {std::min(window.left, place.x - 1), std::min(window.top, place.y - 1), std::max(window.right, place.x + 1), std::max(window.bottom, place.y + 1)};
    }
    return window;
}

class CpuHierarchyRenderer : public HierarchyRenderer {
public:
    explicit CpuHierarchyRenderer(int threads) : arena_(threads > 0 ? threads : oneapi::tbb::task_arena::automatic) {}

    void prepare(const HierarchyScene& scene, const Method& method) override {
        arena_.execute([&] { prepare_here(scene, method); });
    }

    Image render(const HierarchyScene& scene, const Camera& camera, ImageSize size, const Method& method, Statistics* statistics) override {
        validate(camera, "camera");
        validate(size, "size");
        return arena_.execute([&] { return render_here(scene, camera, size, method, statistics); });
    }

private:
    struct Part {
        Bounds box;
        GridVolume volume;
    };
    void prepare_here(const HierarchyScene& scene, const Method& method);
    void make_parts(const GridHierarchy& hierarchy);
    Image render_here(const HierarchyScene& scene, const Camera& camera, ImageSize size, const Method& method, Statistics* out);
    std::size_t draw(Image& image, const ScreenTransform& transform, const std::vector<std::size_t>& order) const;
    std::vector<Decision> plan() const;

    oneapi::tbb::task_arena arena_;
    HierarchyScene scene_;
    std::optional<HierarchyTree> tree_;
    std::vector<Part> parts_;  // of the tree's boxes
    GridUnits units_{};
    double mean_chord_ = 0;    // over all cells of the parts
    std::size_t empty_cells_ = 0;
    Method method_;
    std::optional<Classification> classification_;
    float bend_ = 0;
};

void CpuHierarchyRenderer::make_parts(const GridHierarchy& hierarchy) {
    units_ = units_of(hierarchy);
    tree_.emplace(hierarchy.lattice);
    double chords = 0, cells = 0;
    for (const HierarchyBox& box : tree_->boxes()) {
        const Grid grid = grid_in_box(hierarchy, box);
        parts_.push_back({grid.bounds(), GridVolume(grid, units_)});
        const auto count = static_cast<double>(grid.cell_count());
        chords += count * parts_.back().volume.mean_chord();
        cells += count;
    }
    mean_chord_ = chords / cells;
}

// Brings what depends on the scene and the method up to date; usually there is nothing to do.
void CpuHierarchyRenderer::prepare_here(const HierarchyScene& scene, const Method& method) {
    if (light_at_vertices(method)) {
        throw Error({ErrorKind::option, "--method", "a method of light per pixel for a hierarchy of grids", to_string(method),
                     "draw it as tetrahedra (--as tets)"});
    }
    const bool same_grids = tree_ && scene_.hierarchy == scene.hierarchy;
    if (same_grids && classification_ && scene_.transfer == scene.transfer && method_ == method) return;
    classification_.reset();  // none of another scene behind a failure
    if (!same_grids) {
        tree_.reset();
        parts_.clear();
        make_parts(*scene.hierarchy);
    }
    const TransferFunction transfer = in_scene_units(*scene.transfer, units_.scalar_low, units_.scalar_high, units_.length);
    scene_ = scene;
    method_ = method;
    empty_cells_ = 0;
    for (Part& part : parts_) {
        part.volume.set_light(transfer, {});
        empty_cells_ += part.volume.empty_cells();
    }
    bend_ = bend_of(method, transfer);
    classification_.emplace(method, transfer, mean_chord_);
}

std::vector<Decision> CpuHierarchyRenderer::plan() const {
    const Lattice& lattice = scene_.hierarchy->lattice;
    return {{"pieces", std::to_string(lattice.pieces.size()) + " in " + std::to_string(lattice.levels) + " levels", "the cells that no finer piece covers"},
            {"boxes", std::to_string(parts_.size()), "each of the cells of one piece, which rays walk"},
            {"order", "front to back", "a k-d tree of planes between boxes: exact for any eye"},
            {"segments", to_string(method_), method_.kind == MethodKind::exact ? "the cubic of the trilinear scalar, in as many lines as the error takes"
                                                                              : "one line in each cell, between the bilinear scalars of its faces"}};
}

Image CpuHierarchyRenderer::render_here(const HierarchyScene& scene, const Camera& camera, ImageSize size, const Method& method, Statistics* out) {
    const Stopwatch total;
    prepare_here(scene, method);
    Statistics statistics;
    statistics.ms.plan = total.ms();
    const Stopwatch sorting;
    const std::vector<std::size_t> order = tree_->front_to_back(camera.viewpoint());
    statistics.ms.sort = sorting.ms();
    Image image(size.width, size.height);
    const Stopwatch drawing;
    statistics.counts.fragments = draw(image, ScreenTransform(camera, size), order);
    statistics.ms.draw = drawing.ms();
    statistics.ms.total = total.ms();
    if (!out) return image;
    statistics.counts.cells = scene.hierarchy->visible_cells();
    statistics.counts.culled = std::min(empty_cells_, statistics.counts.cells);
    statistics.counts.drawn = statistics.counts.cells - statistics.counts.culled;
    statistics.method = to_string(method);
    statistics.target = "rgba32f";
    statistics.table_bytes = classification_->bytes();
    statistics.backend = "cpu";
    statistics.backend_version = backend_version();
    statistics.drawn_as = "grid";
    statistics.order = "boxes";
    statistics.order_exact = true;
    statistics.plan = plan();
    *out = std::move(statistics);
    return image;
}

// Returns the number of segments.
std::size_t CpuHierarchyRenderer::draw(Image& image, const ScreenTransform& transform, const std::vector<std::size_t>& order) const {
    Shading shading = classification_->shading();
    const float opaque = classification_->may_be_opaque() ? shading.opaque : 1.0F;
    shading.opaque = opaque;
    std::vector<Window> windows;
    for (const Part& part : parts_) windows.push_back(window_of(part.box, transform));
    return draw_tiles(image, [&](const Tile& tile) {
        std::array<glm::vec4, GridRays::count> light;  // of one box
        Tile box = tile;
        box.pixels = light.data();
        box.stride = tile_side;
        GridRays rays;
        std::size_t segments = 0;
        for (const std::size_t p : order) {
            if (!windows[p].overlaps(tile)) continue;
            const GridVolume& volume = parts_[p].volume;
            volume.find_rays(transform, tile.x, tile.y, tile.width, tile.height, {}, rays);
            bool met = false;
            for (int row = 0; row < tile.height; ++row)
                for (int column = 0; column < tile.width; ++column) {
                    float& length = rays.length[static_cast<std::size_t>(tile_side * row + column)];
                    if (image.at(tile.x + column, tile.y + row).a > opaque) length = 0;
                    met = met || length > 0;
                }
            if (!met) continue;
            segments += draw_grid_tile(volume.cells(), nullptr, rays, shading, bend_, box);
            for (int row = 0; row < tile.height; ++row)
                for (int column = 0; column < tile.width; ++column) {
                    glm::vec4& seen = image.at(tile.x + column, tile.y + row);
                    seen += (1.0F - seen.a) * light[static_cast<std::size_t>(tile_side * row + column)];
                }
        }
        return segments;
    });
}

}  // namespace

}  // namespace cpu

GridUnits units_of(const GridHierarchy& hierarchy) {
    GridUnits units{0.5 * hierarchy.bounds().diagonal(), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const Grid& piece : hierarchy.pieces) {
        const GridUnits own = units_of(piece);
        units.scalar_low = std::min(units.scalar_low, own.scalar_low);
        units.scalar_high = std::max(units.scalar_high, own.scalar_high);
    }
    return units;
}

std::unique_ptr<HierarchyRenderer> make_hierarchy_renderer(int threads) { return std::make_unique<cpu::CpuHierarchyRenderer>(threads); }

}  // namespace cellproj
