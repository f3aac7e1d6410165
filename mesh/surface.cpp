// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface.hpp"

#include <cmath>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

bool finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool finite(const Region& region) {
    return finite(region.seed) && std::isfinite(region.attribute) && std::isfinite(region.max_volume);
}

}  // namespace

std::uint32_t facet_of(const Surface& surface, std::size_t polygon) {
    return surface.facets.empty() ? static_cast<std::uint32_t>(polygon) : surface.facets[polygon];
}

void validate(const Surface& surface) {
    const auto refuse = [&](const std::string& expected, const std::string& found, const std::string& advice) {
        throw Error(
            {.kind = ErrorKind::data, .place = surface.name, .expected = expected, .found = found, .advice = advice});
    };
    const std::size_t count = surface.points.size();
    // TetGen numbers with int and addresses three coordinates per point with them.
    constexpr std::size_t most = 0x7fffffffU / 4;
    if (surface.polygons.empty()) refuse("a closed surface", "no polygons", "give a file with facets");
    if (count < 4 || count > most) {
        refuse("4 to " + std::to_string(most) + " points", std::to_string(count), "give a closed surface");
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (finite(surface.points[i])) continue;
        refuse("finite coordinates", "point " + std::to_string(i) + " is not finite", "repair or remove it");
    }
    if (!surface.facets.empty() && surface.facets.size() != surface.polygons.size()) {
        refuse("a facet for each of " + std::to_string(surface.polygons.size()) + " polygons",
               std::to_string(surface.facets.size()), "give one for each, or none");
    }
    for (std::size_t f = 0; f < surface.polygons.size(); ++f) {
        const std::string which = "facet " + std::to_string(facet_of(surface, f));
        if (surface.polygons[f].size() < 3) {
            refuse("facets of at least 3 vertices", which + " with " + std::to_string(surface.polygons[f].size()),
                   "remove it");
        }
        for (const VertexId v : surface.polygons[f]) {
            if (v < count) continue;
            refuse("vertex ids below " + std::to_string(count), which + " with id " + std::to_string(v),
                   "the file may be damaged: write it again");
        }
    }
    for (const Field& field : surface.point_fields) {
        if (field.components >= 1 && field.values.size() == count * static_cast<std::size_t>(field.components))
            continue;
        refuse("a value of every field at every point",
               "\"" + field.name + "\" with " + std::to_string(field.values.size()) + " numbers",
               "write the file again");
    }
    if (surface.inside == Inside::alternating && !(surface.holes.empty() && surface.regions.empty())) {
        refuse("holes and regions of an enclosed inside", "an alternating one", "leave them out, or choose Inside::enclosed");
    }
    for (std::size_t i = 0; i < surface.holes.size(); ++i) {
        if (!finite(surface.holes[i])) refuse("finite numbers", "hole " + std::to_string(i) + " without", "correct them");
    }
    for (std::size_t i = 0; i < surface.regions.size(); ++i) {
        if (!finite(surface.regions[i])) refuse("finite numbers", "region " + std::to_string(i) + " without", "correct them");
    }
}

}  // namespace cellproj
