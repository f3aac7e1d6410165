// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <glm/common.hpp>

#include "render/plan.hpp"

namespace cellproj {

namespace {

// Twenty times below a step of 8 bits.
constexpr double hidden_light = 1e-4;

// Sums of opacities in float32 are told from 1 by this: 16 of its last digits.
constexpr double least_share = 1e-6;

constexpr double longest_ray = 2.0;  // in a grid, in GridUnits

double largest(const glm::dvec3& color) { return std::max({color.x, color.y, color.z}); }

// No channel of what a ray meets is brighter. Densities and surfaces give a mean of their colours; what emits but does not absorb adds up.
double brightest(const TransferFunction& transfer, const SurfaceScene* surfaces) {
    double medium = 0.0, material = 0.0, lit = 1.0;
    for (const ColorNode& node : transfer.color_nodes()) medium = std::max(medium, largest(node.color));
    if (surfaces) {
        for (const IsoSurface& surface : surfaces->isosurfaces.surfaces())
            material = std::max({material, largest(surface.color), largest(surface.back_color.value_or(surface.color))});
        glm::dvec3 sum = surfaces->lighting.ambient;
        for (const DirectionalLight& light : surfaces->lighting.lights) sum += light.color * (light.diffuse + light.specular);
        lit = std::max(1.0, largest(sum));
    }
    return lit * (transfer.model() == OpticalModel::emitter ? longest_ray * medium + material : std::max(medium, material));
}

Decision cells(const GridQuality& quality, const GridFacts& facts) {
    if (quality.sampling.cut != GridSampling::Cut::cells)
        return {"cells", "all " + std::to_string(facts.cells), "slabs between slices (" + to_string(quality.sampling) + ") know no cells"};
    const std::string chosen = std::to_string(facts.drawn) + " of " + std::to_string(facts.cells);
    if (facts.drawn == facts.cells) return {"cells", chosen, "every one shows something"};
    if (facts.front_to_back) return {"cells", chosen, "the others show nothing, or lie behind opaque tiles"};
    return {"cells", chosen, facts.rays ? "rays leap over bricks that show nothing" : "the others show nothing"};
}

Decision order(const GridQuality& quality, const GridFacts& facts) {
    if (facts.rays) return {"order", "none", "rays meet their cells one after the other"};
    const bool by_cells = quality.sampling.cut == GridSampling::Cut::cells;
    if (facts.front_to_back)
        return {"order", by_cells ? "front to back, the largest slices first" : "front to back", "rays may become opaque: it stops behind opaque tiles"};
    if (by_cells) return {"order", "slices, back to front", "the order of boxes follows from the eye alone"};
    return {"order", "back to front", "slabs follow each other"};
}

Decision segments(const GridScene& scene, const GridQuality& quality, const GridFacts& facts) {
    const std::string method = to_string(quality.method);
    if (facts.drawn == 0) return {"segments", "none", "no cell shows anything"};
    if (!facts.medium && has_surfaces(scene)) return {"segments", "none", "nothing is seen between the isosurfaces"};
    if (quality.sampling.cut != GridSampling::Cut::cells) return {"segments", method, "one in each slab, linear between its slices"};
    if (facts.smaller_than_a_pixel && light_at_vertices(quality.method))
        return {"segments", method, "cells are smaller than pixels: each is one square, lit along the pixel's own ray, not at vertices"};
    if (quality.method.kind == MethodKind::exact) return {"segments", method, "the cubic of the trilinear scalar, in as many lines as the error takes"};
    return {"segments", method, "one line in each cell, between the bilinear scalars of its faces"};
}

Decision surfaces(const GridScene& scene, const GridQuality& quality) {
    if (!has_surfaces(scene)) return {"surfaces", "none", "none is asked for"};
    const std::string count = std::to_string(scene.surfaces->isosurfaces.surfaces().size());
    if (quality.sampling.cut != GridSampling::Cut::cells) return {"surfaces", count + ", by slabs", "each is met where the line between two slices passes its value"};
    return {"surfaces", count + ", by exact roots", "rays are cut where the trilinear scalar passes their values"};
}

Decision gradients(const GridScene& scene, const GridFacts& facts) {
    const bool medium = facts.medium && has_lit_medium(scene);
    if (!has_surfaces(scene) && !medium) return {"gradients", "none", "nothing is lit"};
    const std::string of_medium = medium ? "; the medium is lit by them" : "";
    switch (scene.surfaces->shading) {
        case Shading::unlit: return {"gradients", "none", "isosurfaces are unlit"};
        case Shading::flat: return {"gradients", "of the trilinear scalar in the cell", "flat shading" + of_medium};
        case Shading::smooth: break;
    }
    return {"gradients", "of all points", "smooth shading: central differences, trilinear in between" + of_medium};
}

}  // namespace

std::optional<float> hiding_opacity(const TransferFunction& transfer, const SurfaceScene* surfaces) {
    const double hidden = hidden_light / std::max(1.0, brightest(transfer, surfaces));
    double depth = transfer.max_extinction(0.0, 1.0) * longest_ray;
    if (surfaces) {
        for (const IsoSurface& surface : surfaces->isosurfaces.surfaces()) depth -= 2.0 * std::log1p(-surface.opacity);
    }
    if (hidden < least_share || !(depth > -std::log(hidden))) return std::nullopt;
    return static_cast<float>(1.0 - hidden);
}

std::vector<Decision> plan_of(const GridScene& scene, const GridQuality& quality, const GridFacts& facts) {
    return {cells(quality, facts), order(quality, facts), segments(scene, quality, facts), surfaces(scene, quality), gradients(scene, facts),
            decide_rays(ray_cuts(scene))};
}

}  // namespace cellproj
