// SPDX-License-Identifier: BSD-3-Clause
#include "project/camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

constexpr double frame_margin = 1.05;  // what is framed stays off the border

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(const glm::dvec3& v) {
    const auto number = [](double x) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.9g", x);
        return std::string(buffer);
    };
    return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

// Unit vector, also where the squares of the components would overflow or underflow; 0 stays 0.
glm::dvec3 direction(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0 ? glm::normalize(v / largest) : v;
}

glm::dvec3 rotate(const glm::dvec3& v, const glm::dvec3& axis, double radians) {  // Rodrigues
    const double c = std::cos(radians), s = std::sin(radians);
    return c * v + s * glm::cross(axis, v) + (1 - c) * glm::dot(axis, v) * axis;
}

}  // namespace

Eye Camera::viewpoint() const {
    return projection == Projection::perspective ? Eye::at(eye) : Eye::towards(direction(eye - center));
}

void validate(ImageSize size, const std::string& place) {
    const auto fits = [](int side) { return side >= 1 && side <= 16384; };
    if (fits(size.width) && fits(size.height)) return;
    throw Error({ErrorKind::option, place, "a width and a height of 1 to 16384 pixels",
                 std::to_string(size.width) + "x" + std::to_string(size.height), "512x512 is a usual size"});
}

void validate(const Camera& camera, const std::string& place) {
    const auto require = [&](bool holds, const char* expected, const std::string& found, const char* advice) {
        if (!holds) throw Error({ErrorKind::option, place, expected, found, advice});
    };
    require(finite(camera.eye) && finite(camera.center) && finite(camera.up), "finite eye, center and up",
            text(camera.eye) + ", " + text(camera.center) + ", " + text(camera.up), "give three numbers each");
    require(camera.eye != camera.center, "eye and center to differ", "both at " + text(camera.eye),
            "move the eye away from the center");
    // Within 1e-9 of parallel, the picture's rotation about the view axis would be rounding noise.
    const double sine = glm::length(glm::cross(direction(camera.eye - camera.center), direction(camera.up)));
    require(sine > 1e-9, "up to differ from the viewing direction", text(camera.up),
            "choose an up vector across the view");
    if (camera.projection == Camera::Projection::parallel) {
        require(std::isfinite(camera.height) && camera.height > 0, "height > 0", std::to_string(camera.height),
                "give the height of the view in mesh units");
    } else {
        require(camera.fov_y_degrees > 0 && camera.fov_y_degrees < 180, "0 < fov_y_degrees < 180",
                std::to_string(camera.fov_y_degrees), "30 is a usual angle");
    }
}

Camera frame_bounds(const Bounds& box, Camera::Projection projection, const glm::dvec3& from, const glm::dvec3& up,
                    double aspect) {
    Camera camera = frame_sphere(box, projection, from, up, aspect);
    if (box.diagonal() == 0) return camera;
    // Seen from the sphere's camera: how far the corners reach across the view, and how near they come.
    const double tangent = std::tan(glm::radians(camera.fov_y_degrees) / 2) / frame_margin;
    const ScreenTransform transform(camera, {1, 1});
    const double center_depth = transform.to_eye(camera.center).z;
    double half_height = 0, distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p = transform.to_eye({corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                               corner & 4 ? box.high.z : box.low.z});
        const double across = std::max(std::abs(p.y), std::abs(p.x) / aspect);
        half_height = std::max(half_height, across);
        distance = std::max(distance, across / tangent - (p.z - center_depth));
    }
    camera.height = 2 * frame_margin * half_height;
    if (projection == Camera::Projection::perspective) camera.eye = camera.center + distance * direction(from);
    return camera;
}

Camera frame_sphere(const Bounds& box, Camera::Projection projection, const glm::dvec3& from, const glm::dvec3& up,
                    double aspect) {
    const double radius = box.diagonal() > 0 ? frame_margin * box.diagonal() / 2 : 1.0;
    Camera camera{.projection = projection, .eye = {}, .center = box.center(), .up = up};
    camera.height = 2 * radius / std::min(1.0, aspect);
    const double half_y = glm::radians(camera.fov_y_degrees) / 2;
    const double half_angle = aspect < 1 ? std::atan(aspect * std::tan(half_y)) : half_y;
    camera.eye = camera.center + radius / std::sin(half_angle) * direction(from);
    return camera;
}

Camera orbit(const Camera& camera, double degrees) {
    Camera turned = camera;
    turned.eye = camera.center + rotate(camera.eye - camera.center, direction(camera.up), glm::radians(degrees));
    return turned;
}

ScreenTransform::ScreenTransform(const Camera& camera, ImageSize size)
    : eye_(camera.eye),
      forward_(direction(camera.center - camera.eye)),
      perspective_(camera.projection == Camera::Projection::perspective),
      size_(size) {
    right_ = direction(glm::cross(forward_, direction(camera.up)));
    down_ = glm::cross(forward_, right_);
    const double view_height = perspective_ ? 2 * std::tan(glm::radians(camera.fov_y_degrees) / 2) : camera.height;
    scale_ = size.height / view_height;
}

glm::dvec3 ScreenTransform::to_eye(const glm::dvec3& point) const {
    const glm::dvec3 p = point - eye_;
    return {glm::dot(p, right_), glm::dot(p, down_), glm::dot(p, forward_)};
}

glm::dvec2 ScreenTransform::to_screen(const glm::dvec3& eye_point) const {
    const double scale = perspective_ ? scale_ / eye_point.z : scale_;
    return principal_point() + scale * glm::dvec2(eye_point);
}

ScreenTransform::Ray ScreenTransform::ray(const glm::dvec2& screen) const {
    const glm::dvec2 offset = (screen - principal_point()) / scale_;
    const glm::dvec3 across = offset.x * right_ + offset.y * down_;
    if (perspective_) return {eye_, glm::normalize(forward_ + across)};
    return {eye_ + across, forward_};
}

}  // namespace cellproj
