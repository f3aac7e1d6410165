// SPDX-License-Identifier: AGPL-3.0-or-later
#include "seeds.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <sstream>

#include "mesh/error.hpp"

namespace cellproj {

namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

// Closed: a point in a common face is in both cells.
bool contains(const TetMesh& mesh, CellId cell, const glm::dvec3& p) {
    std::array<glm::dvec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i)
        corners[i] = mesh.points[mesh.tets[cell][i]];
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis]});
        if (p[axis] < low || p[axis] > high) return false;
    }
    const auto orientation = [](const std::array<glm::dvec3, 4>& q) {
        const auto point = [&](std::size_t i) { return Point(q[i].x, q[i].y, q[i].z); };
        return static_cast<int>(CGAL::orientation(point(0), point(1), point(2), point(3)));
    };
    const int inside = orientation(corners);
    for (std::size_t i = 0; i < 4; ++i) {
        std::array<glm::dvec3, 4> moved = corners;
        moved[i] = p;
        if (inside * orientation(moved) < 0) return false;
    }
    return inside != 0;
}

std::optional<double> part_of(const TetMesh& parts, const glm::dvec3& p) {
    for (CellId cell = 0; cell < parts.tets.size(); ++cell) {
        if (contains(parts, cell, p)) return parts.cell_fields.front().values[cell];
    }
    return std::nullopt;
}

std::string in_words(std::size_t number, const Region& region) {
    std::ostringstream text;
    text << "region " << number << " (attribute " << region.attribute << ") at " << region.seed.x << ", " << region.seed.y
         << ", " << region.seed.z;
    return text.str();
}

}  // namespace

void require_seeds(const TetMesh& parts, const std::vector<Region>& regions, const std::string& place) {
    std::map<double, std::size_t> seeded;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const auto refuse = [&](const std::string& expected, const std::string& found) {
            throw Error({.kind = ErrorKind::data,
                         .place = place,
                         .expected = expected,
                         .found = found,
                         .advice = "move it, or leave it out; regions count from 0"});
        };
        const auto part = part_of(parts, regions[i].seed);
        if (!part) refuse("regions inside the surface", in_words(i, regions[i]) + ", which is outside or in a hole");
        const auto [first, is_new] = seeded.try_emplace(*part, i);
        if (!is_new) {
            refuse("one region in each part that facets enclose",
                   in_words(i, regions[i]) + " in the same part as region " + std::to_string(first->second));
        }
    }
}

}  // namespace cellproj
