// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/hierarchy_reference.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace cellproj {

HierarchyReference::HierarchyReference(HierarchyScene scene) : scene_(std::move(scene)) { assert(scene_.hierarchy && scene_.transfer); }

std::vector<HierarchyReference::Crossing> HierarchyReference::cells_along(const ScreenTransform::Ray& ray, bool from_origin) const {
    std::vector<Crossing> all;
    const std::vector<Grid>& pieces = scene_.hierarchy->pieces;
    for (std::size_t p = 0; p < pieces.size(); ++p)
        for (const GridCrossing& cell : cellproj::cells_along(pieces[p], ray, from_origin)) all.push_back({p, cell});
    std::sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) { return a.cell.enter < b.cell.enter; });
    return all;
}

Light HierarchyReference::light(const ScreenTransform::Ray& ray, bool from_origin) const {
    CubicLight light(*scene_.transfer);
    for (const Crossing& crossing : cells_along(ray, from_origin)) {
        if (light.opaque()) break;
        light.add(scalar_along(scene_.hierarchy->pieces[crossing.piece], crossing.cell, ray), crossing.cell.leave - crossing.cell.enter);
    }
    return light.light();
}

std::vector<PixelTruth> HierarchyReference::pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels, double slack) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return truths_of(pixels, size, slack, [&](const glm::dvec2& place) { return light(transform.ray(place), transform.perspective()); });
}

std::vector<PixelId> HierarchyReference::sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed) const {
    validate(camera, "camera");
    validate(size, "size");
    const ScreenTransform transform(camera, size);
    return sample_pixels(size, count, seed,
                         [&](const glm::dvec2& place) { return !cells_along(transform.ray(place), transform.perspective()).empty(); });
}

}  // namespace cellproj
