// SPDX-License-Identifier: BSD-3-Clause
#include "classify/lighting.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

// Of unit length, without overflow or underflow on the way; nothing for a vector without direction.
std::optional<glm::dvec3> unit(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0) || !std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return std::nullopt;
    return glm::normalize(v / largest);
}

bool is_amount(double x) { return std::isfinite(x) && x >= 0; }
bool is_amount(const glm::dvec3& v) { return is_amount(v.x) && is_amount(v.y) && is_amount(v.z); }

void require(bool good, const std::string& place, const std::string& expected) {
    if (!good) throw Error({ErrorKind::option, place, expected, "another value", "correct it"});
}

}  // namespace

void validate(const Lighting& lighting, const std::string& place) {
    require(is_amount(lighting.ambient), place, "finite ambient light, not negative");
    require(std::isfinite(lighting.exponent) && lighting.exponent >= 1, place, "a finite exponent of at least 1");
    for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
        const DirectionalLight& light = lighting.lights[i];
        const std::string which = place + ", light " + std::to_string(i);
        require(!light.towards || unit(*light.towards), which, "a direction: finite and not 0");
        require(is_amount(light.color), which, "a finite colour, not negative");
        require(is_amount(light.diffuse) && is_amount(light.specular), which, "finite parts, not negative");
    }
}

glm::dvec3 shade(const Lighting& lighting, const glm::dvec3& color, const glm::dvec3& normal, const glm::dvec3& to_eye) {
    const auto outward = unit(normal), eye = unit(to_eye);
    assert(eye);
    if (!outward) return color;
    const glm::dvec3 n = lighting.two_sided && glm::dot(*outward, *eye) < 0 ? -*outward : *outward;
    glm::dvec3 sum = lighting.ambient;
    for (const DirectionalLight& light : lighting.lights) {
        const glm::dvec3 l1 = light.towards ? unit(*light.towards).value_or(*eye) : *eye;
        const double facing = glm::dot(n, l1);
        if (!(facing > 0)) continue;
        const auto l2 = unit(l1 + *eye);  // none for a light straight behind
        const double highlight = l2 ? std::pow(std::max(0.0, glm::dot(n, *l2)), lighting.exponent) : 0.0;
        sum += light.color * (light.diffuse * std::min(facing, 1.0) + light.specular * std::min(highlight, 1.0));
    }
    return sum * color;
}

glm::dvec3 lit_share(const Lighting& lighting, const glm::dvec3& gradient, const glm::dvec3& to_eye) {
    const double size = std::hypot(gradient.x, gradient.y, gradient.z);
    if (!(size > 0)) return glm::dvec3(1);
    const double weight = 1.0 / (1.0 + 1.0 / size / size);
    return 1.0 + weight * (shade(lighting, glm::dvec3(1), -gradient, to_eye) - 1.0);
}

}  // namespace cellproj
