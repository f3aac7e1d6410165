// SPDX-License-Identifier: BSD-3-Clause
//
// Cameras. Screen space: x to the right and y down, in pixels; pixel (i, j) has its centre at (i + 0.5, j + 0.5), row 0 is
// the top row. The third coordinate of a projected point is its distance from the eye along the viewing direction
// ("depth"), in mesh units: positive in front of the eye.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/predicates.hpp"
#include "mesh/tet_mesh.hpp"

namespace cellproj {

struct ImageSize {
    int width = 512;   // pixels, 1 .. 16384
    int height = 512;  // pixels, 1 .. 16384
};

// Throws Error (option) at `place` when a side is not in 1 .. 16384.
void validate(ImageSize size, const std::string& place);

struct Camera {
    enum class Projection { parallel, perspective };

    Projection projection = Projection::perspective;
    glm::dvec3 eye{0, 0, 1};     // mesh units; in parallel views only the direction to `center` counts
    glm::dvec3 center{0, 0, 0};  // what appears in the middle of the picture
    glm::dvec3 up{0, 1, 0};      // appears upwards; not parallel to the viewing direction
    double height = 1.0;         // parallel: height of the view [mesh units], > 0
    double fov_y_degrees = 30.0; // perspective: full vertical angle, 0 < angle < 180

    // Where cells are seen from, for sorting.
    Eye viewpoint() const;
};

// Throws Error (option) at `place` when eye = center, up is parallel to the view, a number is not finite or out of range.
void validate(const Camera& camera, const std::string& place);

// A camera that sees the whole box from the direction `from` (from the box towards the eye), as large as fits a picture of
// that aspect (width / height) with a margin of 5 %.
Camera frame_bounds(const Bounds& box, Camera::Projection projection, const glm::dvec3& from, const glm::dvec3& up,
                    double aspect);

// The same for the sphere around the box: the box stays in view from every direction, as in an orbit.
Camera frame_sphere(const Bounds& box, Camera::Projection projection, const glm::dvec3& from, const glm::dvec3& up,
                    double aspect);

// The camera turned by `degrees` about the axis through its center along its up vector.
Camera orbit(const Camera& camera, double degrees);

// One camera or an array of them from the JSON of the design; `place` names the source. Throws Error (option, format).
std::vector<Camera> parse_cameras(std::string_view json, const std::string& place);
std::vector<Camera> read_cameras(const std::filesystem::path& file);
std::string to_json(const Camera& camera);

// The orthonormal frame of a camera and its scale in pixels, made once per picture.
//
// Eye space: x to the right, y down, z = depth along the viewing direction, all in mesh units, with the eye at the origin.
class ScreenTransform {
public:
    ScreenTransform(const Camera& camera, ImageSize size);

    bool perspective() const { return perspective_; }
    ImageSize size() const { return size_; }

    glm::dvec3 to_eye(const glm::dvec3& point) const;
    // Pixel position of a point of eye space. In perspective its depth must be > 0.
    glm::dvec2 to_screen(const glm::dvec3& eye_point) const;

    struct Ray {
        glm::dvec3 origin;     // perspective: the eye; parallel: in the plane through the eye
        glm::dvec3 direction;  // unit length
    };
    // The viewing ray through a pixel position, in mesh coordinates.
    Ray ray(const glm::dvec2& screen) const;

    glm::dvec2 principal_point() const { return 0.5 * glm::dvec2(size_.width, size_.height); }  // pixels
    double pixels_per_unit() const { return scale_; }  // parallel: pixels per mesh unit; perspective: the same at depth 1

private:
    glm::dvec3 eye_, right_, down_, forward_;
    double scale_;
    bool perspective_;
    ImageSize size_;
};

}  // namespace cellproj
