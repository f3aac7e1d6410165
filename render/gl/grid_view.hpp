// SPDX-License-Identifier: BSD-3-Clause
//
// One camera's view of a grid: what all shaders of grids know. Places on the device are about a reference point, the eye or, in parallel
// views, the middle of the grid, so that large coordinates cancel in float64.
#pragma once

#include <array>
#include <string>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/grid.hpp"
#include "project/camera.hpp"
#include "render/gl/objects.hpp"
#include "render/gl/textures.hpp"
#include "render/grid_scene.hpp"

namespace cellproj::gl {

// Cells by their number along each axis, low ≤ i < high.
struct CellRange {
    std::array<std::size_t, 3> low, high;
};

class GridView {
public:
    // `grid` must outlive this.
    GridView(const Grid& grid, const GridUnits& units, const Camera& camera, ImageSize size);

    const Grid& grid() const { return grid_; }
    const ScreenTransform& transform() const { return transform_; }  // about the eye, scene units
    bool perspective() const { return transform_.perspective(); }
    // The axes of the grid in eye space.
    const std::array<glm::dvec3, 3>& axes() const { return axes_; }
    // Plane i of an axis, about the reference point or about the eye [scene units].
    double plane(std::size_t axis, std::size_t i) const;
    // Of the box of some cells, about the reference point.
    std::array<glm::dvec3, 8> corners(const CellRange& cells) const;
    // Into the picture, in the axes of the grid.
    glm::dvec3 forward() const { return {axes_[0].z, axes_[1].z, axes_[2].z}; }
    // Of a place about the reference point.
    glm::dvec3 to_eye(const glm::dvec3& place) const;
    Bounds box_about_eye(const GridCell& cell) const;

    // For a program with shaders/grid_place.vert: sets what that asks, and binds the planes.
    std::string defines() const;
    void set_place(const Program& program) const;
    // For a program with shaders/grid_rays.frag.
    void set_rays(const Program& program) const;

private:
    void set_screen(const Program& program) const;

    const Grid& grid_;
    double length_;
    glm::dvec3 eye_, reference_;  // mesh units
    ScreenTransform transform_;
    std::array<glm::dvec3, 3> axes_;
    glm::dvec2 center_;  // where the reference is on the screen [pixels]; the principal point in perspective
    Texture planes_;
};

}  // namespace cellproj::gl
