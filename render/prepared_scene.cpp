// SPDX-License-Identifier: BSD-3-Clause
#include "render/prepared_scene.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "classify/segment_method.hpp"
#include "mesh/error.hpp"
#include "render/order_check.hpp"

namespace cellproj {

namespace {

SceneUnits find_units(const Scene& scene) {
    validate(scene);
    const ScalarRange values = range(scene.field->values);
    const double half_diagonal = bounds(scene.mesh->points).diagonal() / 2;
    SceneUnits units{half_diagonal > 0 ? half_diagonal : 1.0, values.low, values.high};
    if (scene.opacity_field) {
        const ScalarRange opacity = range(scene.opacity_field->values);
        units.opacity_low = opacity.low;
        units.opacity_high = opacity.high;
    }
    return units;
}

double find_mean_chord(const TetMesh& mesh, double unit) {
    double volume = 0.0, surface = 0.0;
    for (CellId cell = 0; cell < mesh.tets.size(); ++cell) {
        volume += std::abs(signed_volume(mesh, cell)) / (unit * unit * unit);
        for (int face = 0; face < 4; ++face) {
            const auto v = face_vertices(mesh.tets[cell], face);
            const glm::dvec3 a = (mesh.points[v[1]] - mesh.points[v[0]]) / unit;
            const glm::dvec3 b = (mesh.points[v[2]] - mesh.points[v[0]]) / unit;
            surface += glm::length(glm::cross(a, b)) / 2;
        }
    }
    const double chord = surface > 0.0 ? 4.0 * volume / surface : 0.0;
    return chord > 0.0 ? chord : 1.0;  // flat cells only: nothing is drawn
}

struct ScalarInterval {
    double low, high;
};

// A field and its range, as the transfer function is asked for it.
struct RangedField {
    const TetMesh& mesh;
    const ScalarField& field;
    ScalarInterval range;

    double normalized(double s) const { return range.high > range.low ? (s - range.low) / (range.high - range.low) : 0.0; }
};

RangedField main_field(const Scene& scene, const SceneUnits& units) {
    return {*scene.mesh, *scene.field, {units.scalar_low, units.scalar_high}};
}

RangedField opacity_field(const Scene& scene, const SceneUnits& units) {
    return {*scene.mesh, *scene.opacity_field, {units.opacity_low, units.opacity_high}};
}

// The scalars of a cell; nothing when one is not finite.
std::optional<ScalarInterval> scalars_of(const RangedField& field, std::size_t cell) {
    double low = field.field.at(field.mesh, static_cast<CellId>(cell), 0), high = low, sum = low;
    for (int corner = 1; corner < 4; ++corner) {
        const double s = field.field.at(field.mesh, static_cast<CellId>(cell), corner);
        low = std::min(low, s);
        high = std::max(high, s);
        sum += 0.25 * s;
    }
    return std::isfinite(sum) ? std::optional(ScalarInterval{low, high}) : std::nullopt;
}

// The field's range in bins: another transfer function is asked once per bin and, where that does not tell, for a cell.
constexpr std::uint16_t bin_count = 4096;

std::uint16_t bin_of(const RangedField& field, double s) {
    return static_cast<std::uint16_t>(std::clamp(field.normalized(s), 0.0, 1.0) * (bin_count - 1));
}

template <class Body>
void for_all(std::size_t count, Body body) {
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, count, 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
    });
}

std::vector<PreparedScene::BinRange> find_bins(const RangedField& field) {
    std::vector<PreparedScene::BinRange> bins(field.mesh.tets.size());
    for_all(bins.size(), [&](std::size_t cell) {
        const auto s = scalars_of(field, cell);
        if (s) bins[cell] = {bin_of(field, s->low), bin_of(field, s->high)};
    });
    return bins;
}

// Which scalars of a bin can be seen: for each bin the next one, itself included, where some can, and where all can;
// bin_count where none follows.
struct VisibleBins {
    std::vector<std::uint16_t> some, all;
};

VisibleBins find_visible_bins(const TransferFunction& transfer, const RangedField& field) {
    std::vector<std::uint8_t> seen(bin_count), unseen(bin_count);
    const auto mark = [&](double begin, double end, bool visible) {
        if (end < field.range.low || begin > field.range.high) return;
        const std::uint16_t first = bin_of(field, std::max(begin, field.range.low));
        const std::uint16_t last = bin_of(field, std::min(end, field.range.high));
        auto& bins = visible ? seen : unseen;
        std::fill(bins.begin() + first, bins.begin() + last + 1, std::uint8_t{1});
    };
    const bool emitter = transfer.model() == OpticalModel::emitter;
    const auto shines = [](const glm::dvec3& color) { return std::max({color.x, color.y, color.z}) > 0.0; };
    for (const LinearPiece& piece : transfer.pieces()) {
        mark(piece.begin, piece.end,
             std::max(piece.extinction_begin, piece.extinction_end) > 0.0 ||
                 (emitter && (shines(piece.color_begin) || shines(piece.color_end))));
    }
    for (const double s : transfer.breakpoints()) mark(s, s, transfer.visible(s, s));

    VisibleBins next{std::vector<std::uint16_t>(bin_count + 1, bin_count), std::vector<std::uint16_t>(bin_count + 1, bin_count)};
    for (std::uint16_t b = bin_count; b-- > 0;) {
        next.some[b] = seen[b] ? b : next.some[b + 1];
        next.all[b] = seen[b] && !unseen[b] ? b : next.all[b + 1];
    }
    return next;
}

std::vector<std::uint8_t> find_visible(const RangedField& field, const TransferFunction& transfer,
                                       const std::vector<PreparedScene::BinRange>& bins) {
    const VisibleBins next = find_visible_bins(transfer, field);
    std::vector<std::uint8_t> visible(bins.size());
    for_all(bins.size(), [&](std::size_t cell) {
        const auto [low, high] = bins[cell];
        if (low > high || next.some[low] > high) return;
        // A cell has all scalars of the bins between its outermost ones, but only some of those two.
        const bool surely = next.all[low] <= high || next.some[low + 1] < high;
        const auto s = surely ? std::nullopt : scalars_of(field, cell);
        visible[cell] = surely || transfer.visible(s->low, s->high);
    });
    return visible;
}

// What absorbs over the opacity field, and what shines by itself over the other one; nothing where either is not finite.
std::vector<std::uint8_t> find_visible(const Scene& scene, const SceneUnits& units, const std::vector<PreparedScene::BinRange>& bins,
                                       const std::vector<PreparedScene::BinRange>& opacity_bins) {
    if (!scene.opacity_field) return find_visible(main_field(scene, units), *scene.transfer, bins);
    std::vector<std::uint8_t> visible =
        find_visible(opacity_field(scene, units), extinction_alone(*scene.transfer), opacity_bins);
    std::vector<std::uint8_t> shining(visible.size());
    if (scene.transfer->model() == OpticalModel::emitter)
        shining = find_visible(main_field(scene, units), color_alone(*scene.transfer), bins);
    for_all(visible.size(), [&](std::size_t cell) {
        const bool finite = bins[cell].low <= bins[cell].high && opacity_bins[cell].low <= opacity_bins[cell].high;
        visible[cell] = finite && (visible[cell] || shining[cell]);
    });
    return visible;
}

}  // namespace

PreparedScene::PreparedScene(Scene scene, const SurfaceSides& sides, const PlanRules& rules)
    : scene_(std::move(scene)), units_(find_units(scene_)), culling_(rules.culling),
      bins_(find_bins(main_field(scene_, units_))),
      opacity_bins_(scene_.opacity_field ? find_bins(opacity_field(scene_, units_)) : std::vector<BinRange>{}) {
    facts_.box = bounds(scene_.mesh->points);
    facts_.cells = bins_.size();
    facts_.location = scene_.field->location;
    facts_.fields = fields_read(scene_);
    for (std::size_t cell = 0; cell < bins_.size(); ++cell) facts_.not_finite += !finite(cell);
    if (has_surface_scene(scene_)) surfaces_.emplace(scene_, units_, sides);
    find_visible_cells();
}

bool PreparedScene::finite(std::size_t cell) const {
    return bins_[cell].low <= bins_[cell].high && (opacity_bins_.empty() || opacity_bins_[cell].low <= opacity_bins_[cell].high);
}

void PreparedScene::find_visible_cells() {
    visible_ = find_visible(scene_, units_, bins_, opacity_bins_);
    any_order_.clear();
    find_facts();
    if (surfaces_)
        for (const auto& cells : {surfaces_->crossed(), surfaces_->beside_jumps()})
            for (const CellId cell : cells) visible_[cell] |= finite(cell);  // else left out
    if (culling_) return;
    for_all(visible_.size(), [&](std::size_t cell) { visible_[cell] = finite(cell); });
}

// Of the cells whose medium is seen, and of the function in the range of its field: the last node below and the first one above hold no more.
void PreparedScene::find_facts() {
    facts_.medium = static_cast<std::size_t>(std::ranges::count(visible_, std::uint8_t{1}));
    const ScalarSpan span{units_.scalar_low, units_.scalar_high};
    const ScalarSpan opacity_span = scene_.opacity_field ? ScalarSpan{units_.opacity_low, units_.opacity_high} : span;
    const TransferFunction transfer = in_scene_units(*scene_.transfer, span, opacity_span, units_.length);
    const auto& extinction = transfer.extinction_nodes();
    const auto& color = transfer.color_nodes();
    facts_.absorbs = std::ranges::any_of(extinction, [](const ExtinctionNode& node) { return node.extinction > 0.0; });
    // The ends of the range lie between nodes: what is interpolated there between equal values may be rounded.
    const auto alike = [](double a, double b) { return std::abs(a - b) <= 1e-14 * std::max(a, b); };
    facts_.constant_light =
        std::ranges::all_of(extinction, [&](const ExtinctionNode& node) { return alike(node.extinction, extinction.front().extinction); }) &&
        std::ranges::all_of(color, [&](const ColorNode& node) {
            const glm::dvec3 &a = node.color, &b = color.front().color;
            return alike(a.x, b.x) && alike(a.y, b.y) && alike(a.z, b.z);
        });
    facts_.lit_medium.reset();
    if (has_lit_medium(scene_) && has_medium()) facts_.lit_medium = scene_.surfaces->shading;
    facts_.surfaces.reset();
    if (!has_surfaces(scene_)) return;
    facts_.surfaces = {surfaces_->values().size(), surfaces_->crossed().size(), surfaces_->scene().isosurfaces.opaque(), surfaces_->jump(),
                       surfaces_->scene().shading};
}

VisibilitySorter& PreparedScene::sorter() {
    if (!sorter_) sorter_.emplace(*scene_.mesh);
    return *sorter_;
}

ViewOrder PreparedScene::any_order() {
    if (any_order_.empty())
        for (CellId cell = 0; cell < visible_.size(); ++cell)
            if (visible_[cell]) any_order_.push_back(cell);
    return {any_order_, {}};
}

double PreparedScene::mean_chord() {
    if (!mean_chord_) mean_chord_ = find_mean_chord(*scene_.mesh, units_.length);
    return *mean_chord_;
}

void PreparedScene::set_transfer(std::shared_ptr<const TransferFunction> transfer) {
    scene_.transfer = std::move(transfer);
    find_visible_cells();
}

void PreparedScene::set_surfaces(std::shared_ptr<const SurfaceScene> surfaces, const SurfaceSides& sides) {
    Scene changed = scene_;
    changed.surfaces = std::move(surfaces);
    validate(changed);
    const std::optional<PreparedSurfaces> before = std::exchange(surfaces_, std::nullopt);
    scene_ = std::move(changed);
    if (has_surface_scene(scene_)) surfaces_.emplace(scene_, units_, sides, before ? &*before : nullptr);
    find_visible_cells();
}

ViewOrder PreparedScene::order(const Camera& camera, ImageSize size, std::optional<OrderMethod> method, OrderReport* report) {
    const PixelGrid pixels = pixel_grid(camera, size);
    return sorter().order(camera.viewpoint(), report, method, &pixels, visible_);
}

void PreparedScene::judge(const ViewOrder& order, const OrderReport& report, const Camera& camera, ImageSize size,
                          const Quality& quality, Statistics& statistics) {
    statistics.order = to_string(report.method);
    statistics.order_exact = report.exact;
    statistics.counts.unordered = report.unordered;
    statistics.counts.cycles = report.cycles;
    statistics.counts.split_cells = report.split_cells;
    statistics.counts.order_violations.reset();
    if (quality.check_neighbours) statistics.counts.order_violations = sorter().count_violations(order, camera.viewpoint());
    if (quality.check_rays == 0) return;
    if (!ray_index_) ray_index_ = std::make_unique<const RayIndex>(*scene_.mesh);
    statistics.order_check = check_order(*ray_index_, visible_.size(), order, camera, size, quality.check_rays);
}

}  // namespace cellproj
