// SPDX-License-Identifier: BSD-3-Clause
#include "render/grid_trade.hpp"

#include <algorithm>
#include <cassert>

#include "mesh/error.hpp"
#include "render/gl/grid_gl_renderer.hpp"
#include "render/judge/hierarchy_reference.hpp"

namespace cellproj {

namespace {

using Cut = GridSampling::Cut;
using SlabLight = GridSampling::Light;

// As many slabs as the longest axis has cells, times `factor`.
int slab_count(const Grid& grid, std::size_t factor) {
    std::size_t most = 0;
    for (const GridAxis& axis : grid.axes) most = std::max(most, axis.cells());
    return static_cast<int>(std::min<std::size_t>(factor * most, 16384));
}

// Where the tolerance does not add up over a ray: half the lines.
Method loose_lines(double max_error) { return {.kind = MethodKind::exact, .tolerance = std::clamp(max_error, 1e-9, 1e-2)}; }

std::vector<GridQuality> drawn(std::vector<GridQuality> qualities, Backend backend, const GridScene& scene) {
    std::erase_if(qualities, [&](const GridQuality& quality) { return !draws_grid(backend, scene, quality); });
    return qualities;
}

}  // namespace

std::string to_string(const GridQuality& quality) {
    const bool usual = quality.target == GridQuality{}.target;
    return to_string(quality.sampling) + ", " + to_string(quality.method) + (usual ? "" : ", " + to_string(quality.target));
}

bool draws_grid(Backend backend, const GridScene& scene, const GridQuality& quality) {
    try {
        require_grid_drawn(backend, quality, grid_shading(scene));
        require_grid_cut(quality, ray_cuts(scene));
        if (quality.sampling.cut != Cut::cells) gl::require_sliced(*scene.grid, quality.sampling);
        return true;
    } catch (const Error&) {
        return false;
    }
}

std::vector<GridQuality> grid_trade_qualities(Backend backend, const GridScene& scene) {
    std::vector<GridQuality> qualities;
    for (const char* method : {"average:vertices", "homogeneous:vertices", "linear:8:vertices", "average", "homogeneous", "preint2d-exp:256",
                               "preint2d-exp:1024", "preint3d:64", "integral", "exact:1e-3", "exact:1e-5"})
        qualities.push_back({.method = parse_method(method)});
    for (const Cut cut : {Cut::object, Cut::view}) {
        const int coarse = slab_count(*scene.grid, 1), fine = slab_count(*scene.grid, 4);
        qualities.push_back({.sampling = {cut, coarse, SlabLight::pre}});
        for (const int slabs : {coarse, fine})
            for (const SlabLight light : {SlabLight::post, SlabLight::segment}) qualities.push_back({.sampling = {cut, slabs, light}});
    }
    return drawn(std::move(qualities), backend, scene);
}

std::vector<TradeWay> ways_of(GridRenderer& renderer, const GridScene& scene, const Camera& camera, ImageSize size,
                              std::span<const GridQuality> qualities) {
    std::vector<TradeWay> ways;
    for (const GridQuality& quality : qualities) {
        ways.push_back({.name = to_string(quality),
                        .quality = {.method = quality.method, .target = quality.target},
                        .sampling = quality.sampling,
                        .prepare = [=, &renderer] { renderer.prepare(scene, quality); },
                        .render = [=, &renderer](Statistics* out) { return renderer.render(scene, camera, size, quality, out); }});
    }
    return ways;
}

QualityChoice choose_grid_quality(GridRenderer& renderer, Backend backend, const GridScene& scene, const Camera& camera, ImageSize size,
                                  double max_error, const GridChoiceOptions& options) {
    std::vector<GridQuality> qualities;
    const GridSampling sampling = options.sampling.value_or(GridSampling{});
    if (!options.sampling) {
        for (const std::size_t factor : {std::size_t{1}, std::size_t{4}})
            qualities.push_back({Method{}, options.target, {Cut::object, slab_count(*scene.grid, factor)}});
    }
    for (const Method& method : choice_methods(max_error)) qualities.push_back({method, options.target, sampling});
    qualities.insert(qualities.end() - 1, {loose_lines(max_error), options.target, sampling});
    qualities = drawn(std::move(qualities), backend, scene);
    assert(!qualities.empty());
    const GridReference reference(scene.grid, scene.transfer, scene.surfaces);
    return choose_way(ways_of(renderer, scene, camera, size, qualities), judge_by(reference, camera, size), max_error, options.how);
}

std::vector<TradeWay> ways_of(HierarchyRenderer& renderer, const HierarchyScene& scene, const Camera& camera, ImageSize size,
                              std::span<const Method> methods) {
    std::vector<TradeWay> ways;
    for (const Method& method : methods) {
        ways.push_back({.name = to_string(GridQuality{.method = method}),
                        .quality = {.method = method},
                        .sampling = GridSampling{},
                        .prepare = [=, &renderer] { renderer.prepare(scene, method); },
                        .render = [=, &renderer](Statistics* out) { return renderer.render(scene, camera, size, method, out); }});
    }
    return ways;
}

QualityChoice choose_hierarchy_method(HierarchyRenderer& renderer, const HierarchyScene& scene, const Camera& camera, ImageSize size,
                                      double max_error, const ChoiceOptions& options) {
    std::vector<Method> methods = choice_methods(max_error);
    std::erase_if(methods, [](const Method& method) { return light_at_vertices(method); });
    methods.insert(methods.end() - 1, loose_lines(max_error));
    const HierarchyReference reference(scene);
    return choose_way(ways_of(renderer, scene, camera, size, methods), judge_by(reference, camera, size), max_error, options);
}

}  // namespace cellproj
