// SPDX-License-Identifier: BSD-3-Clause
#include "classify/isosurface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "classify/segment_integral.hpp"
#include "mesh/error.hpp"

namespace cellproj {

namespace {

bool is_color(const glm::dvec3& c) {
    return std::isfinite(c.x + c.y + c.z) && c.x >= 0 && c.y >= 0 && c.z >= 0;
}

void check(const IsoSurface& surface, const std::string& place) {
    const auto fail = [&](const std::string& expected, const std::string& found, const std::string& advice) {
        throw Error({ErrorKind::option, place, expected, found, advice});
    };
    if (!std::isfinite(surface.value))
        fail("a finite isovalue", std::to_string(surface.value), "give a scalar within the field's range");
    if (!(surface.opacity >= 0 && surface.opacity <= 1))
        fail("an opacity in 0..1", std::to_string(surface.opacity), "1 hides what is behind");
    if (!is_color(surface.color) || (surface.back_color && !is_color(*surface.back_color)))
        fail("finite colours, not negative", "another one", "give red, green and blue in 0..1");
}

// The surfaces crossed between two neighbouring positions of the table, as one layer.
Light layers(const IsoSurfaces& surfaces, double s_f, double s_b) {
    Light light;
    const IsoCrossings crossings = surfaces.crossings(s_f, s_b);
    for (std::size_t i = 0; i < crossings.size(); ++i) {
        const IsoCrossing crossing = crossings[i];
        const IsoSurface& surface = surfaces.surfaces()[crossing.surface];
        light = composite(light, layer(seen_color(surface, crossing.rising), surface.opacity));
    }
    return light;
}

}  // namespace

IsoCrossing IsoCrossings::operator[](std::size_t i) const {
    assert(i < size());
    const bool rising = s_f_ < s_b_;
    const std::size_t surface = rising ? first_ + i : last_ - 1 - i;
    const double v = surfaces_[surface].value;
    // Halves, so that no difference overflows; it is 0 only where the scalars are equal.
    const double way = 0.5 * s_b_ - 0.5 * s_f_, part = 0.5 * v - 0.5 * s_f_;
    return {surface, way != 0 ? std::clamp(part / way, 0.0, 1.0) : 0.0, rising};
}

IsoSurfaces::IsoSurfaces(std::vector<IsoSurface> surfaces, const std::string& place) : surfaces_(std::move(surfaces)) {
    for (std::size_t i = 0; i < surfaces_.size(); ++i)
        check(surfaces_[i], place + ", surface " + std::to_string(i));
    std::sort(surfaces_.begin(), surfaces_.end(), [](const IsoSurface& a, const IsoSurface& b) { return a.value < b.value; });
    const auto twice = std::adjacent_find(surfaces_.begin(), surfaces_.end(),
                                          [](const IsoSurface& a, const IsoSurface& b) { return a.value == b.value; });
    if (twice != surfaces_.end()) {
        throw Error({ErrorKind::option, place, "different isovalues", std::to_string(twice->value) + " twice",
                     "give each isovalue once"});
    }
}

bool IsoSurfaces::opaque() const {
    return std::ranges::all_of(surfaces_, [](const IsoSurface& surface) { return surface.opacity == 1; });
}

IsoCrossings IsoSurfaces::crossings(double s_f, double s_b) const {
    assert(std::isfinite(s_f) && std::isfinite(s_b));
    // The first surface that s is below.
    const auto below = [&](double s) {
        return static_cast<std::size_t>(
            std::upper_bound(surfaces_.begin(), surfaces_.end(), s,
                             [](double scalar, const IsoSurface& surface) { return scalar < surface.value; }) -
            surfaces_.begin());
    };
    const std::size_t front = below(s_f), back = below(s_b);
    return {surfaces_, std::min(front, back), std::max(front, back), s_f, s_b};
}

IsoSurfaceTable::IsoSurfaceTable(const IsoSurfaces& surfaces, double low, double high, int n)
    : low_(low), high_(high), size_(n), texels_(static_cast<std::size_t>(n) * static_cast<std::size_t>(n)) {
    assert(std::isfinite(low) && std::isfinite(high) && low < high && n >= 2 && n <= 4096);
    const auto grid = static_cast<std::size_t>(n);
    // From each position to the next one, up and down: a way of many steps is one of fewer and one step behind it.
    std::vector<Light> up(grid), down(grid);
    for (int i = 0; i + 1 < n; ++i) {
        up[static_cast<std::size_t>(i)] = layers(surfaces, scalar(i), scalar(i + 1));
        down[static_cast<std::size_t>(i) + 1] = layers(surfaces, scalar(i + 1), scalar(i));
    }
    for (int i = 0; i < n; ++i) {
        const auto fill = [&](int j, const Light& light) {
            const IsoCrossings crossings = surfaces.crossings(scalar(i), scalar(j));
            texels_[static_cast<std::size_t>(i) + grid * static_cast<std::size_t>(j)] = {
                {static_cast<float>(light.color.x), static_cast<float>(light.color.y), static_cast<float>(light.color.z)},
                static_cast<float>(light.opacity),
                crossings.empty() ? 0.0F : static_cast<float>(crossings[0].t)};
        };
        Light light;
        fill(i, light);
        for (int j = i + 1; j < n; ++j)
            fill(j, light = composite(light, up[static_cast<std::size_t>(j) - 1]));
        light = {};
        for (int j = i - 1; j >= 0; --j)
            fill(j, light = composite(light, down[static_cast<std::size_t>(j) + 1]));
    }
}

double IsoSurfaceTable::scalar_at(double low, double high, int n, int i) {
    const double share = static_cast<double>(i) / (n - 1);
    return (1 - share) * low + share * high;
}

int IsoSurfaceTable::position(double s) const {
    const double share = (0.5 * s - 0.5 * low_) / (0.5 * high_ - 0.5 * low_);  // no overflow
    return static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * (size_ - 1)));
}

const IsoSurfaceTable::Texel& IsoSurfaceTable::lookup(double s_f, double s_b) const {
    return texels_[static_cast<std::size_t>(position(s_f)) +
                   static_cast<std::size_t>(size_) * static_cast<std::size_t>(position(s_b))];
}

}  // namespace cellproj
