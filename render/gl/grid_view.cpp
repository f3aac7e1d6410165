// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_view.hpp"

#include <vector>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "render/scene_view.hpp"

namespace cellproj::gl {

namespace {

// Behind those of the methods (segment_shader.hpp); 8 has the grid's values (grid_volume.hpp).
constexpr unsigned int planes_unit = 9;

// Components of the viewing direction that are nothing but the rounding of the camera's frame.
constexpr double stillness = 1e-12;

// The planes of all axes one after the other, as texels of four.
Texture upload_planes(const GridView& view) {
    std::vector<float> planes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < view.grid().axes[axis].points(); ++i)
            planes.push_back(static_cast<float>(view.plane(axis, i)));
    }
    planes.resize((planes.size() + 3) / 4 * 4);
    return Texture::list(planes);
}

}  // namespace

GridView::GridView(const Grid& grid, const GridUnits& units, const Camera& camera, ImageSize size)
    : grid_(grid),
      length_(units.length),
      eye_(camera.eye),
      reference_(camera.projection == Camera::Projection::perspective ? camera.eye : grid.bounds().center()),
      transform_(relative_transform(camera, size, units.length)),
      axes_{transform_.to_eye({1, 0, 0}), transform_.to_eye({0, 1, 0}), transform_.to_eye({0, 0, 1})},
      center_(perspective() ? transform_.principal_point()
                            : transform_.to_screen(to_eye(glm::dvec3(0.0)))),
      planes_(upload_planes(*this)) {}

double GridView::plane(std::size_t axis, std::size_t i) const {
    return (grid_.axes[axis].coordinates[i] - reference_[static_cast<int>(axis)]) / length_;
}

std::array<glm::dvec3, 8> GridView::corners(const CellRange& cells) const {
    std::array<glm::dvec3, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) corners[c][static_cast<int>(axis)] = plane(axis, (c >> axis & 1U) != 0 ? cells.high[axis] : cells.low[axis]);
    }
    return corners;
}

glm::dvec3 GridView::to_eye(const glm::dvec3& place) const { return transform_.to_eye(place + (reference_ - eye_) / length_); }

Bounds GridView::box_about_eye(const GridCell& cell) const {
    const Bounds box = grid_.cell_bounds(cell);
    return {(box.low - eye_) / length_, (box.high - eye_) / length_};
}

std::string GridView::defines() const {
    return std::string(perspective() ? "#define PERSPECTIVE\n" : "") +
           (grid_.location == FieldLocation::cells ? "#define ON_CELLS\n" : "");
}

void GridView::set_place(const Program& program) const {
    set_screen(program);
    program.set("picture", static_cast<float>(transform_.size().width), static_cast<float>(transform_.size().height));
    program.set("grid_cells", glm::vec3(grid_.axes[0].cells(), grid_.axes[1].cells(), grid_.axes[2].cells()));
    planes_.bind(planes_unit);
}

void GridView::set_screen(const Program& program) const {
    const auto& [x, y, z] = axes_;
    program.set("ray_center", static_cast<float>(center_.x), static_cast<float>(center_.y));
    program.set("pixels_per_unit", static_cast<float>(transform_.pixels_per_unit()));
    program.set("axis_right", glm::vec3(x.x, y.x, z.x));
    program.set("axis_down", glm::vec3(x.y, y.y, z.y));
}

void GridView::set_rays(const Program& program) const {
    set_screen(program);
    const glm::dvec3 forward = this->forward();
    // Parallel rays through constant cells ask for their length alone.
    if (perspective() || grid_.location == FieldLocation::points) program.set("axis_forward", glm::vec3(forward));
    if (perspective()) return;
    const auto still = glm::lessThan(glm::abs(forward), glm::dvec3(stillness));
    program.set("inverse_forward", glm::vec3(glm::mix(1.0 / forward, glm::dvec3(1e20), still)));
    program.set("nudge", glm::vec3(glm::mix(glm::dvec3(0.0), glm::dvec3(1e-10), still)));
}

}  // namespace cellproj::gl
