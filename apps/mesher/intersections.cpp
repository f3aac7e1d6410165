// SPDX-License-Identifier: AGPL-3.0-or-later
//
// As CGAL's PMP::self_intersections, but for triangles that need not form a manifold. CGAL's Box_intersection_d is GPL.
#include "intersections.hpp"

#include <CGAL/Bbox_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace cellproj {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::array<VertexId, 3>;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;

class Soup {
public:
    Soup(const std::vector<glm::dvec3>& points, const FacetTriangles& triangles)
        : points_(points), triangles_(triangles) {}

    std::vector<Box> boxes() const {
        std::vector<Box> boxes;
        for (std::size_t i = 0; i < triangles_.corners.size(); ++i)
            boxes.emplace_back(triangle(triangles_.corners[i]).bbox(), i);
        return boxes;
    }

    bool intersect(std::size_t first, std::size_t second) const {
        Corners a = triangles_.corners[first], b = triangles_.corners[second];
        switch (bring_common_corners_forward(a, b)) {
            case 0:
                return CGAL::do_intersect(triangle(a), triangle(b));
            case 1:
                return CGAL::do_intersect(triangle(a), Kernel::Segment_3(at(b[1]), at(b[2]))) ||
                       CGAL::do_intersect(triangle(b), Kernel::Segment_3(at(a[1]), at(a[2])));
            case 2:  // on the same side of the common edge, in one plane
                return CGAL::coplanar(at(a[0]), at(a[1]), at(a[2]), at(b[2])) &&
                       CGAL::coplanar_orientation(at(a[0]), at(a[1]), at(a[2]), at(b[2])) == CGAL::POSITIVE;
            default:
                return true;
        }
    }

private:
    Kernel::Point_3 at(VertexId v) const { return {points_[v].x, points_[v].y, points_[v].z}; }
    Kernel::Triangle_3 triangle(const Corners& corners) const {
        return {at(corners[0]), at(corners[1]), at(corners[2])};
    }

    static std::size_t bring_common_corners_forward(Corners& a, Corners& b) {
        std::size_t common = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto same = std::find(b.begin() + static_cast<std::ptrdiff_t>(common), b.end(), a[i]);
            if (same == b.end()) continue;
            std::swap(*same, b[common]);
            std::swap(a[i], a[common]);
            ++common;
        }
        return common;
    }

    const std::vector<glm::dvec3>& points_;
    const FacetTriangles& triangles_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> intersecting_facets(const std::vector<glm::dvec3>& points,
                                                              const FacetTriangles& triangles) {
    const Soup soup(points, triangles);
    std::vector<Box> boxes = soup.boxes();
    std::vector<const Box*> pointers;
    for (const Box& box : boxes)
        pointers.push_back(&box);
    std::vector<std::array<std::uint32_t, 2>> pairs;
    // Boxes that only touch count: so may their triangles.
    CGAL::box_self_intersection_d(pointers.begin(), pointers.end(), [&](const Box* a, const Box* b) {
        if (!soup.intersect(a->info(), b->info())) return;
        const auto [low, high] = std::minmax(triangles.facets[a->info()], triangles.facets[b->info()]);
        pairs.push_back({low, high});
    });
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

}  // namespace cellproj
