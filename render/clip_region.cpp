// SPDX-License-Identifier: BSD-3-Clause
#include "render/clip_region.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string in_words(const HalfSpace& h) {
    char text[256];
    std::snprintf(text, sizeof text, "%g,%g,%g:%g,%g,%g", h.point.x, h.point.y, h.point.z, h.normal.x, h.normal.y, h.normal.z);
    return text;
}

// normal · p ≥ offset
struct Plane {
    glm::dvec3 normal;
    double offset;
};

}  // namespace

ClipRegion box_region(const Bounds& box) {
    ClipRegion region;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 inward(0.0);
        inward[axis] = 1.0;
        region.half_spaces.push_back({box.low, inward});
        region.half_spaces.push_back({box.high, -inward});
    }
    return region;
}

void validate(const ClipRegion& region, const std::string& place) {
    for (const HalfSpace& half_space : region.half_spaces) {
        if (!finite(half_space.point) || !finite(half_space.normal))
            throw Error({ErrorKind::option, place, "a finite point and normal", in_words(half_space), "correct it"});
        if (half_space.normal == glm::dvec3(0.0))
            throw Error({ErrorKind::option, place, "a normal with a length", in_words(half_space), "it points to one side of the plane, such as 0,0,1"});
    }
}

glm::dvec3 unit_normal(const HalfSpace& half_space) {
    const glm::dvec3& n = half_space.normal;
    return glm::normalize(n / std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}));
}

// The corners of the region within the box are where three planes meet: it has a point when one of these lies in all half spaces.
bool meets(const ClipRegion& region, const Bounds& box) {
    const double size = std::max(box.diagonal(), 1e-300), slack = 1e-9;
    const glm::dvec3 middle = box.center();
    std::vector<Plane> planes;  // relative to the box: its middle is 0, its diagonal 1
    ClipRegion all = box_region(box);
    all.half_spaces.insert(all.half_spaces.end(), region.half_spaces.begin(), region.half_spaces.end());
    for (const HalfSpace& half_space : all.half_spaces) {
        const glm::dvec3 n = unit_normal(half_space);
        planes.push_back({n, glm::dot(n, (half_space.point - middle) / size)});
    }
    const auto inside = [&](const glm::dvec3& p) {
        return std::ranges::all_of(planes, [&](const Plane& plane) { return glm::dot(plane.normal, p) >= plane.offset - slack; });
    };
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (std::size_t j = i + 1; j < planes.size(); ++j)
            for (std::size_t k = j + 1; k < planes.size(); ++k) {
                const Plane &a = planes[i], &b = planes[j], &c = planes[k];
                const glm::dvec3 bc = glm::cross(b.normal, c.normal);
                const double volume = glm::dot(a.normal, bc);
                if (std::abs(volume) < 1e-12) continue;  // two of them are parallel
                const glm::dvec3 p =
                    (a.offset * bc + b.offset * glm::cross(c.normal, a.normal) + c.offset * glm::cross(a.normal, b.normal)) / volume;
                if (inside(p)) return true;
            }
    return false;
}

}  // namespace cellproj
