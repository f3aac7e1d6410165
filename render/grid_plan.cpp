// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_plan.hpp"

#include <string>

#include "render/plan.hpp"

namespace cellproj {

namespace {

Decision cells(const GridQuality& quality, const GridFacts& facts) {
    if (quality.sampling.cut != GridSampling::Cut::cells)
        return {"cells", "all " + std::to_string(facts.cells), "slabs between slices (" + to_string(quality.sampling) + ") know no cells"};
    const std::string chosen = std::to_string(facts.drawn) + " of " + std::to_string(facts.cells);
    if (facts.drawn == facts.cells) return {"cells", chosen, "every one shows something"};
    return {"cells", chosen, facts.rays ? "rays leap over bricks that show nothing" : "the others show nothing"};
}

Decision order(const GridQuality& quality, const GridFacts& facts) {
    if (facts.rays) return {"order", "none", "rays meet their cells one after the other"};
    if (quality.sampling.cut == GridSampling::Cut::cells) return {"order", "slices, back to front", "the order of boxes follows from the eye alone"};
    return {"order", "back to front", "slabs follow each other"};
}

Decision segments(const GridScene& scene, const GridQuality& quality, const GridFacts& facts) {
    const std::string method = to_string(quality.method);
    if (facts.drawn == 0) return {"segments", "none", "no cell shows anything"};
    if (!facts.medium && has_surfaces(scene)) return {"segments", "none", "nothing is seen between the isosurfaces"};
    if (quality.sampling.cut != GridSampling::Cut::cells) return {"segments", method, "one in each slab, linear between its slices"};
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

std::vector<Decision> plan_of(const GridScene& scene, const GridQuality& quality, const GridFacts& facts) {
    return {cells(quality, facts), order(quality, facts), segments(scene, quality, facts), surfaces(scene, quality), gradients(scene, facts),
            decide_rays(ray_cuts(scene))};
}

}  // namespace cellproj
