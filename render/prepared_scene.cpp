// SPDX-License-Identifier: BSD-3-Clause
#include "render/prepared_scene.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

SceneUnits find_units(const Scene& scene) {
    assert(scene.mesh && scene.field && scene.transfer);
    const auto& [mesh, field] = std::tie(*scene.mesh, *scene.field);
    const std::size_t rows = field.location == FieldLocation::points ? mesh.points.size() : mesh.tets.size();
    if (field.values.size() != rows) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", std::to_string(rows) + " values",
                     std::to_string(field.values.size()), "choose a field of this mesh"});
    }
    const ScalarRange values = range(field.values);
    if (values.not_finite == field.values.size()) {
        throw Error({ErrorKind::data, "field \"" + field.name + "\"", "finite values", "none", "choose another field"});
    }
    const double half_diagonal = bounds(mesh.points).diagonal() / 2;
    return {half_diagonal > 0 ? half_diagonal : 1.0, values.low, values.high};
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

// The field's range in bins: where a cell's scalars lie, so that another transfer function is asked once per bin instead
// of once per cell. Bins only grow ranges: a cell that adds nothing may be drawn, none that adds is lost.
constexpr std::uint16_t bin_count = 4096;

std::uint16_t bin_of(const SceneUnits& units, double s) {
    return static_cast<std::uint16_t>(std::clamp(units.normalized(s), 0.0, 1.0) * (bin_count - 1));
}

std::vector<PreparedScene::BinRange> find_bins(const Scene& scene, const SceneUnits& units) {
    const TetMesh& mesh = *scene.mesh;
    std::vector<PreparedScene::BinRange> bins(mesh.tets.size());
    const auto look = [&](const oneapi::tbb::blocked_range<std::size_t>& cells) {
        for (std::size_t c = cells.begin(); c != cells.end(); ++c) {
            double low = scene.field->at(mesh, static_cast<CellId>(c), 0), high = low, sum = low;
            for (int corner = 1; corner < 4; ++corner) {
                const double s = scene.field->at(mesh, static_cast<CellId>(c), corner);
                low = std::min(low, s);
                high = std::max(high, s);
                sum += 0.25 * s;
            }
            if (std::isfinite(sum)) bins[c] = {bin_of(units, low), bin_of(units, high)};
        }
    };
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, bins.size(), 4096), look);
    return bins;
}

// For each bin the next one, itself included, in which something can be seen; bin_count where none follows.
std::vector<std::uint16_t> next_visible_bins(const TransferFunction& transfer, const SceneUnits& units) {
    std::vector<std::uint16_t> next(bin_count, bin_count);
    const auto mark = [&](double begin, double end) {
        if (end < units.scalar_low || begin > units.scalar_high) return;
        for (std::uint16_t b = bin_of(units, std::max(begin, units.scalar_low)), last = bin_of(units, std::min(end, units.scalar_high)); b <= last; ++b)
            next[b] = b;
    };
    const bool emitter = transfer.model() == OpticalModel::emitter;
    const auto shines = [](const glm::dvec3& color) { return std::max({color.x, color.y, color.z}) > 0.0; };
    for (const LinearPiece& piece : transfer.pieces()) {
        if (std::max(piece.extinction_begin, piece.extinction_end) > 0.0 ||
            (emitter && (shines(piece.color_begin) || shines(piece.color_end))))
            mark(piece.begin, piece.end);
    }
    // At its outermost nodes a function may be visible though it is so nowhere beside them.
    for (const double s : transfer.breakpoints()) {
        if (transfer.visible(s, s)) mark(s, s);
    }
    for (std::uint16_t b = bin_count - 1; b > 0; --b) {
        if (next[b - 1] == bin_count) next[b - 1] = next[b];
    }
    return next;
}

std::vector<std::uint8_t> find_visible(const TransferFunction& transfer, const SceneUnits& units,
                                       const std::vector<PreparedScene::BinRange>& bins) {
    const std::vector<std::uint16_t> next = next_visible_bins(transfer, units);
    std::vector<std::uint8_t> visible(bins.size());
    const auto look = [&](const oneapi::tbb::blocked_range<std::size_t>& cells) {
        for (std::size_t c = cells.begin(); c != cells.end(); ++c)
            visible[c] = bins[c].low <= bins[c].high && next[bins[c].low] <= bins[c].high;
    };
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, visible.size(), 16384), look);
    return visible;
}

}  // namespace

PreparedScene::PreparedScene(Scene scene)
    : scene_(std::move(scene)), units_(find_units(scene_)), sorter_(*scene_.mesh),
      mean_chord_(find_mean_chord(*scene_.mesh, units_.length)),
      bins_(find_bins(scene_, units_)),
      visible_(find_visible(*scene_.transfer, units_, bins_)) {}

void PreparedScene::set_transfer(std::shared_ptr<const TransferFunction> transfer) {
    scene_.transfer = std::move(transfer);
    visible_ = find_visible(*scene_.transfer, units_, bins_);
}

}  // namespace cellproj
