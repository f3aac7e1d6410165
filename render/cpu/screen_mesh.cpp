// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/screen_mesh.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include "render/scene_view.hpp"

namespace cellproj::cpu {

namespace {

// Products of such coordinates stay finite in float32; no pixel lies beyond.
double bounded(double pixels) { return std::clamp(pixels, -1e12, 1e12); }

// The corners' weights at a place in the tetrahedron, by volumes; those of its middle where it has none.
std::array<double, 4> weights_at(const std::array<EyeVertex, 4>& corners, const glm::dvec3& p) {
    const auto volume = [](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
        return glm::dot(glm::cross(b - a, c - a), d - a);
    };
    const glm::dvec3 &a = corners[0].position, &b = corners[1].position, &c = corners[2].position, &d = corners[3].position;
    const double whole = volume(a, b, c, d);
    std::array<double, 4> weights{volume(p, b, c, d) / whole, volume(a, p, c, d) / whole, volume(a, b, p, d) / whole, volume(a, b, c, p) / whole};
    double sum = 0;
    for (double& w : weights) sum += w = std::max(w, 0.0);
    if (!(sum > 0 && std::isfinite(sum))) return {0.25, 0.25, 0.25, 0.25};
    for (double& w : weights) w /= sum;
    return weights;
}

}  // namespace

void ScreenMesh::set_scene(const PreparedScene& prepared) {
    prepared_ = &prepared;
    const TetMesh& mesh = *prepared.scene().mesh;
    const ScalarField& field = *prepared.scene().field;
    const SceneUnits& units = prepared.units();
    const bool per_point = field.location == FieldLocation::points;
    points_.resize(mesh.points.size());
    cell_scalars_.resize(per_point ? 0 : mesh.tets.size());
    for (std::size_t i = 0; i < field.values.size(); ++i) {
        const auto scalar = static_cast<float>(std::clamp(units.normalized(field.values[i]), 0.0, 1.0));
        (per_point ? points_[i].scalar : cell_scalars_[i]) = scalar;
    }
    middle_ = bounds(mesh.points).center();
    cells_ = {};
    cells_.tets = mesh.tets;
    set_visible();
    set_surfaces();
}

void ScreenMesh::set_surfaces() {
    const PreparedSurfaces* prepared = prepared_->surfaces();
    cells_.surfaces = prepared ? &surfaces_ : nullptr;
    surfaces_ = {};
    precise_points_.clear();
    levels_.clear();
    gradients_.clear();
    if (!prepared) return;
    const SurfaceScene& scene = prepared->scene();
    surfaces_.values = prepared->values();
    surfaces_.rising = run_of(*prepared, true);
    surfaces_.falling = run_of(*prepared, false);
    surfaces_.shading = scene.shading;
    surfaces_.lighting = kernel_lighting(scene.lighting);
    surfaces_.medium = prepared_->has_medium();
    surfaces_.lit_medium = prepared_->lights_medium();
    levels_.assign(prepared->levels().begin(), prepared->levels().end());
    gradients_.assign(prepared->gradients().begin(), prepared->gradients().end());
}

void ScreenMesh::set_visible() {
    const auto& visible = prepared_->visible();
    const bool all = std::find(visible.begin(), visible.end(), std::uint8_t{0}) == visible.end();
    cells_.visible = all ? std::span<const std::uint8_t>() : std::span(visible);
}

void ScreenMesh::set_view(const Camera& camera, ImageSize size, std::span<const VertexId> points) {
    const TetMesh& mesh = *prepared_->scene().mesh;
    const double unit = prepared_->units().length;
    eye_ = camera.eye;
    transform_ = relative_transform(camera, size, unit);
    near_depth_ = near_plane_depth(camera, unit);

    // Half the diagonal is the unit: the mesh lies within 1 of its middle.
    const double middle = transform_.to_eye((middle_ - eye_) / unit).z;
    base_ = transform_.perspective() ? 1.0 / std::max(middle + 1.0, near_depth_) : middle;
    View& view = cells_.view;
    view.width = size.width;
    view.height = size.height;
    view.perspective = transform_.perspective();
    view.base_nearness = view.perspective ? static_cast<float>(base_) : 0.0F;
    view.near_plane = static_cast<float>(0.999 / near_depth_);
    view.unit_per_pixel = static_cast<float>(1.0 / transform_.pixels_per_unit());

    points_.resize(mesh.points.size());
    const bool precise = cells_.surfaces != nullptr;
    if (precise) {
        precise_points_.resize(mesh.points.size());
        const auto turned = [&](const glm::dvec3& axis) { return transform_.to_eye(axis); };
        const glm::dvec3 x = turned({1, 0, 0}), y = turned({0, 1, 0}), z = turned({0, 0, 1});
        surfaces_.right = glm::dvec3(x.x, y.x, z.x);
        surfaces_.down = glm::dvec3(x.y, y.y, z.y);
        surfaces_.forward = glm::dvec3(x.z, y.z, z.z);
    }
    std::atomic<bool> near_points = false;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    oneapi::tbb::parallel_for(Range(0, points.empty() ? mesh.points.size() : points.size(), 4096), [&](const Range& range) {
        bool behind = false;
        for (std::size_t number = range.begin(); number != range.end(); ++number) {
            const std::size_t i = points.empty() ? number : points[number];
            const glm::dvec3 place = transform_.to_eye((mesh.points[i] - eye_) / unit);
            if (precise && has_place(place)) {
                precise_points_[i] = precisely_on_screen(place);
                points_[i] = rounded(precise_points_[i], points_[i].scalar);
            } else {
                points_[i] = on_screen({place, points_[i].scalar});
            }
            behind |= points_[i].nearness == behind_near_plane;
        }
        if (behind) near_points = true;
    });
    near_points_ = near_points;
    cells_.points = points_;
}

// Perspective cannot show what lies behind the near plane.
bool ScreenMesh::has_place(const glm::dvec3& p) const { return !transform_.perspective() || p.z >= near_depth_ * (1.0 - 1e-9); }

// Whole nearness; for points that have a place.
glm::dvec3 ScreenMesh::precisely_on_screen(const glm::dvec3& p) const {
    const glm::dvec2 screen = transform_.to_screen(p) - transform_.principal_point();
    return {bounded(screen.x), bounded(screen.y), transform_.perspective() ? 1.0 / p.z : base_ - p.z};
}

float ScreenMesh::nearness(double depth) const {
    constexpr double unbounded = NearnessInterval::unbounded;
    return static_cast<float>(std::clamp(transform_.perspective() ? 1.0 / depth - base_ : base_ - depth, -unbounded, unbounded));
}

ScreenPoint ScreenMesh::rounded(const glm::dvec3& place, float scalar) const {
    const double nearness = transform_.perspective() ? place.z - base_ : place.z;
    return {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(nearness), scalar};
}

ScreenPoint ScreenMesh::on_screen(const EyeVertex& vertex) const {
    const auto scalar = static_cast<float>(vertex.scalar);
    if (!has_place(vertex.position)) return {0.0F, 0.0F, behind_near_plane, scalar};
    return rounded(precisely_on_screen(vertex.position), scalar);
}

ScreenMesh::Corners ScreenMesh::eye_corners(CellId cell) const {
    const TetMesh& mesh = *prepared_->scene().mesh;
    Corners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        const VertexId v = mesh.tets[cell][i];
        const float scalar = cell_scalars_.empty() ? points_[v].scalar : cell_scalars_[cell];
        corners[i] = {transform_.to_eye((mesh.points[v] - eye_) / prepared_->units().length), scalar};
    }
    return corners;
}

// Position and scalar are linear in space: both are mixed by the same weights.
ScreenMesh::Corners ScreenMesh::eye_corners(const CellPiece& piece) const {
    const Corners cell = eye_corners(piece.cell);
    Corners corners;
    for (std::size_t i = 0; i < 4; ++i) {
        corners[i] = {glm::dvec3(0.0), 0.0};
        for (int v = 0; v < 4; ++v) {
            const EyeVertex& vertex = cell[static_cast<std::size_t>(v)];
            corners[i].position += piece.corners[i][v] * vertex.position;
            corners[i].scalar += piece.corners[i][v] * vertex.scalar;
        }
    }
    return corners;
}

bool ScreenMesh::is_cut(CellId cell) const {
    const auto& tet = cells_.tets[cell];
    return std::any_of(tet.begin(), tet.end(), [&](VertexId v) { return points_[v].nearness == behind_near_plane; });
}

void ScreenMesh::add_extra(const Corners& corners, CellId cell) {
    const auto first = static_cast<VertexId>(points_.size());
    for (const EyeVertex& corner : corners) points_.push_back(on_screen(corner));
    // Positively oriented, as the mesh's cells are; the frame of the eye is right-handed.
    const glm::dvec3 a = corners[0].position;
    const double volume = glm::dot(glm::cross(corners[1].position - a, corners[2].position - a), corners[3].position - a);
    extra_.push_back(volume >= 0.0 ? std::array{first, first + 1, first + 2, first + 3}
                                   : std::array{first, first + 1, first + 3, first + 2});
    extra_cells_.push_back(cell);
    if (!cell_scalars_.empty()) cell_scalars_.push_back(static_cast<float>(corners[0].scalar));
    if (cells_.surfaces) add_surfaces_of_extra(corners, cell);
}

void ScreenMesh::add_surfaces_of_extra(const Corners& corners, CellId cell) {
    for (const EyeVertex& corner : corners) precise_points_.push_back(precisely_on_screen(corner.position));
    levels_.push_back(levels_[cell]);
    if (surfaces_.shading == SurfaceShading::flat) gradients_.push_back(gradients_[cell]);
    if (surfaces_.shading != SurfaceShading::smooth) return;
    const Corners whole = eye_corners(cell);
    for (const EyeVertex& corner : corners) {
        const std::array<double, 4> weights = weights_at(whole, corner.position);
        glm::vec3 gradient(0);
        for (std::size_t i = 0; i < 4; ++i) gradient += static_cast<float>(weights[i]) * gradients_[cells_.tets[cell][i]];
        gradients_.push_back(gradient);
    }
}

// What of it lies before the near plane, back to front; returns the number of parts.
std::size_t ScreenMesh::add_front_part(const Corners& corners, CellId cell) {
    if (!transform_.perspective()) {
        add_extra(corners, cell);
        return 1;
    }
    const ClippedTet parts = clip_near(corners, near_depth_);
    for (std::size_t i = 0; i < parts.count; ++i) add_extra(parts.tets[i], cell);
    return parts.count;
}

std::span<const std::uint32_t> ScreenMesh::nearly_sorted(std::span<const CellId> cells) {
    constexpr std::size_t steps = 1024;
    using Range = oneapi::tbb::blocked_range<std::size_t>;
    keys_.resize(cells.size());
    oneapi::tbb::parallel_for(Range(0, cells.size(), 4096), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) keys_[i] = points_[cells_.tets[cells[i]][0]].nearness;
    });
    float farthest = behind_near_plane, nearest = -behind_near_plane;
    for (const float n : keys_) {
        if (n == behind_near_plane) continue;
        farthest = std::min(farthest, n);
        nearest = std::max(nearest, n);
    }
    const float per_step = nearest > farthest ? static_cast<float>(steps - 1) / (nearest - farthest) : 0.0F;
    const auto step = [&](float n) {
        return static_cast<std::size_t>(std::clamp((n - farthest) * per_step, 0.0F, static_cast<float>(steps - 1)));
    };
    std::array<std::uint32_t, steps + 1> next{};
    for (const float n : keys_) ++next[step(n) + 1];
    for (std::size_t i = 0; i < steps; ++i) next[i + 1] += next[i];
    sorted_.resize(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) sorted_[next[step(keys_[i])]++] = cells[i];
    return sorted_;
}

std::span<const std::uint32_t> ScreenMesh::cut(const ViewOrder& order) {
    const std::size_t cell_count = cells_.tets.size();
    points_.resize(prepared_->scene().mesh->points.size());
    extra_.clear();
    extra_cells_.clear();
    if (!cell_scalars_.empty()) cell_scalars_.resize(cell_count);
    if (cells_.surfaces) {
        precise_points_.resize(points_.size());
        levels_.resize(cell_count);
        gradients_.resize(prepared_->surfaces()->gradients().size());
    }
    std::span<const std::uint32_t> items = order.items;
    if (near_points_ || !order.pieces.empty()) {
        items_.clear();
        const auto& visible = prepared_->visible();
        for (const std::uint32_t item : order.items) {
            const bool whole = item < cell_count;
            const CellId cell = whole ? item : order.pieces[item - cell_count].cell;
            if (!visible[cell]) continue;
            if (whole && !is_cut(cell)) {
                items_.push_back(item);
                continue;
            }
            const auto first = static_cast<std::uint32_t>(cell_count + extra_.size());
            const std::size_t parts = add_front_part(whole ? eye_corners(cell) : eye_corners(order.pieces[item - cell_count]), cell);
            for (std::uint32_t i = 0; i < parts; ++i) items_.push_back(first + i);
        }
        items = items_;
    }
    cells_.points = points_;
    cells_.extra = extra_;
    cells_.cell_scalars = cell_scalars_;
    surfaces_.points = precise_points_;
    surfaces_.levels = levels_;
    surfaces_.gradients = gradients_;
    return items;
}

}  // namespace cellproj::cpu
