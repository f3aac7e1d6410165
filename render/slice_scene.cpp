// SPDX-License-Identifier: BSD-3-Clause
#include "render/slice_scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include <glm/common.hpp>

namespace cellproj {

namespace {

// The plane of a grid's axis that x is meant to be, or x: as distance_to_plane has it for points of a mesh.
double on_plane_nearby(const std::vector<double>& planes, double x) {
    const auto above = std::ranges::lower_bound(planes, x);
    const auto is_it = [&](double plane) { return distance_to_plane({plane, 0, 0}, {x, 0, 0}, {1, 0, 0}) == 0; };
    if (above != planes.end() && is_it(*above)) return *above;
    if (above != planes.begin() && is_it(*std::prev(above))) return *std::prev(above);
    return x;
}

// Where the slice lies in a face of the cell on the normal's side: the cell behind that face, if there is one.
void take_cell_behind(const Grid& grid, const glm::dvec3& normal, GridCell& cell, glm::dvec3& u) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const bool up = normal[axis] > 0 && u[axis] == 0 && cell[a] > 0;
        const bool down = normal[axis] < 0 && u[axis] == 1 && cell[a] + 1 < grid.axes[a].cells();
        if (!up && !down) continue;
        up ? --cell[a] : ++cell[a];
        u[axis] = 1 - u[axis];
    }
}

}  // namespace

std::vector<Slice> slices_and_caps(const std::vector<HalfSpace>& planes, const ClipRegion* capped) {
    std::vector<Slice> slices;
    for (const HalfSpace& plane : planes) slices.push_back({plane, false});
    if (capped)
        for (const HalfSpace& plane : capped->half_spaces) slices.push_back({plane, true});
    return slices;
}

SliceScene cut_slices(const TetMesh& mesh, const ScalarField& field, const ScalarField* other, std::vector<Slice> slices,
                      std::shared_ptr<const TransferFunction> colors) {
    SliceScene scene{std::move(slices), std::move(colors)};
    validate(scene);
    for (const Slice& slice : scene.slices)
        scene.cuts.push_back(cut_by_plane(mesh, field, other, slice.plane.point, unit_normal(slice.plane),
                                          slice.cap ? PlaneCutSides::above : PlaneCutSides::both));
    return scene;
}

void validate(const SliceScene& scene) {
    assert(scene.colors);
    ClipRegion planes;
    for (const Slice& slice : scene.slices) planes.half_spaces.push_back(slice.plane);
    validate(planes, "slice");
}

std::optional<double> scalar_at(const Grid& grid, const Slice& slice, const glm::dvec3& point) {
    const glm::dvec3 normal = unit_normal(slice.plane);
    const bool across = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)}) == 1;
    GridCell cell{};
    glm::dvec3 u;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const std::vector<double>& planes = grid.axes[a].coordinates;
        // All points of a plane across an axis have its own coordinate, so that they are on one side of the grid's planes.
        const bool fixed = across && normal[axis] != 0;
        const double x = fixed ? on_plane_nearby(planes, slice.plane.point[axis]) : point[axis];
        if (!(x >= planes.front() && x <= planes.back())) return std::nullopt;
        std::size_t& i = cell[a];
        i = static_cast<std::size_t>(std::upper_bound(planes.begin() + 1, planes.end() - 1, x) - planes.begin()) - 1;
        if (fixed && x == planes[i] && normal[axis] < 0 && i > 0) --i;
        u[axis] = (x - planes[i]) / (planes[i + 1] - planes[i]);
        if (fixed && slice.cap && u[axis] == (normal[axis] > 0 ? 1 : 0)) return std::nullopt;  // all of the grid is on the other side
    }
    if (across && !slice.cap && grid.is_blanked(cell)) take_cell_behind(grid, normal, cell, u);
    if (grid.is_blanked(cell)) return std::nullopt;
    const std::array<double, 8> corners = grid.corner_values(cell);
    // Where all corners are equal, rounding must not make another value of them.
    const auto [low, high] = std::ranges::minmax(corners);
    return std::clamp(interpolate(corners, u), low, high);
}

bool slice_meets(const Slice& slice, const Bounds& box) {
    const glm::dvec3 normal = unit_normal(slice.plane);
    bool above = false, below = false;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y, corner & 4 ? box.high.z : box.low.z};
        const double distance = distance_to_plane(p, slice.plane.point, normal);
        above = above || distance >= 0;
        below = below || distance <= 0;
    }
    return above && below;
}

double color_scale(const TransferFunction& function) {
    if (function.model() == OpticalModel::density) return 1;
    double brightest = 0;
    for (const ColorNode& node : function.color_nodes()) brightest = std::max({brightest, node.color.x, node.color.y, node.color.z});
    return brightest > 0 ? brightest : 1;
}

std::optional<glm::dvec3> SliceColors::at(double s) const {
    const std::vector<ColorNode>& nodes = function_->color_nodes();
    if (function_->outside() == Outside::transparent && (s < nodes.front().scalar || s > nodes.back().scalar)) return std::nullopt;
    return glm::clamp(function_->color(s) / brightest_, 0.0, 1.0);
}

}  // namespace cellproj
