// SPDX-License-Identifier: BSD-3-Clause
//
// What the rays of a picture's pixels meet, in eye space and float64: planes and triangles. Private to depth_window and slice_view.
//
// In eye space a ray is z·(u, v, 1) in perspective and (u, v, z) in parallel views, and the side of a plane is affine in z along it: its
// root cuts the interval, exactly but for rounding, for planes at any place, through the eye or along the ray too. A ray meets a triangle
// abc where its volumes with the three edges have one sign, d·(a×b), d·(b×c), d·(c×a) (in parallel views areas on the screen): no division,
// no clipping at the eye, and bit for bit one number, but for its sign, for both triangles of an edge, so that closed bodies have no
// holes. These are the weights of the corners, with which depths and scalars are mixed.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "project/camera.hpp"
#include "render/clip_region.hpp"

namespace cellproj {

// Cameras in eye space and scene units, and the rays of their pixels.
class EyeRays {
public:
    EyeRays(const Camera& camera, ImageSize size, double unit);

    bool perspective() const { return transform_.perspective(); }
    ImageSize size() const { return transform_.size(); }
    glm::dvec3 place(const glm::dvec3& point) const { return transform_.to_eye((point - eye_) / unit_); }
    glm::dvec3 direction(const glm::dvec3& v) const { return transform_.to_eye(v); }
    glm::dvec2 screen(const glm::dvec3& place) const { return transform_.to_screen(place); }
    glm::dvec2 slope(int x, int y) const {
        return (glm::dvec2(x + 0.5, y + 0.5) - transform_.principal_point()) * units_per_pixel_;
    }
    glm::dvec3 to_eye(int x, int y) const { return -transform_.ray({x + 0.5, y + 0.5}).direction; }  // in the axes of the mesh
    // The point of a ray at a depth [mesh units].
    glm::dvec3 point(const glm::dvec2& slope, double z) const;

private:
    ScreenTransform transform_;
    glm::dvec3 eye_, right_, down_, forward_;
    double unit_, units_per_pixel_;
};

// A half space in eye space: its side at z·(u, v, 1), or at (u, v, z), is offset + slope·z; ≥ 0 is kept.
class EyePlane {
public:
    EyePlane(const HalfSpace& half_space, const EyeRays& rays);

    struct Side {
        double offset, slope;

        // Where the ray meets the plane; not a number, or infinite, where it runs along it.
        double root() const { return -offset / slope; }
    };
    Side along(const glm::dvec2& uv) const {
        const double across = normal_.x * uv.x + normal_.y * uv.y;
        return perspective_ ? Side{offset_, across + normal_.z} : Side{offset_ + across, normal_.z};
    }

private:
    glm::dvec3 normal_;
    double offset_;
    bool perspective_;
};

// Pixels whose centres a triangle may cover.
struct PixelCover {
    int left = 0, top = 0, right = -1, bottom = -1;

    bool empty() const { return left > right || top > bottom; }
};

using EyeCorners = std::array<glm::dvec3, 3>;

PixelCover cover_of(const EyeCorners& corners, const EyeRays& rays);

// Rows that one task draws: enough that each triangle is looked at a few times only.
inline constexpr int band_rows = 32;
inline int band_count(int height) { return (height + band_rows - 1) / band_rows; }

struct Rows {
    int top, bottom;  // the last one included
};

inline Rows rows_of_band(int band, int height) {
    const int end = (band + 1) * band_rows;
    return {band * band_rows, (end < height ? end : height) - 1};
}

// For each band the triangles that may cover pixels of it, in their order.
std::vector<std::vector<std::size_t>> by_bands(const std::vector<PixelCover>& covers, int height);

// A triangle as rays meet it.
class TriangleOnRays {
public:
    TriangleOnRays(const EyeCorners& corners, bool perspective);

    // The shares of its corners where the ray meets it, with sum 1; nothing where it does not, or only edge-on.
    std::optional<std::array<double, 3>> shares(const glm::dvec2& uv) const;
    // The depth there; infinite for nothing, and behind the eye in perspective.
    double depth(const glm::dvec2& uv) const;

private:
    // Twice that of the ray and the edge opposite to a corner, on the screen.
    double area(std::size_t corner, const glm::dvec2& uv) const;

    EyeCorners corners_;
    std::array<glm::dvec3, 3> edges_;  // of the edge opposite to each corner, the cross product of its ends
    bool perspective_;
};

}  // namespace cellproj
