// SPDX-License-Identifier: BSD-3-Clause
#include "trade_ways.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "grid_options.hpp"
#include "mesh/error.hpp"
#include "render/grid_trade.hpp"
#include "render/judge/hierarchy_reference.hpp"

namespace cellproj::cli {

namespace {

// The backend that `render` would take, for each quality. Renderers are made when they are wanted first.
class ChosenRenderer : public Renderer {
public:
    explicit ChosenRenderer(const TradeChoices& choices) : wish_(choices.wish), gpu_(choices.gpu) {}

    void prepare(const Scene& scene, const Quality& quality) override { of(scene, quality).prepare(scene, quality); }
    Image render(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Statistics* statistics) override {
        return of(scene, quality).render(scene, camera, size, quality, statistics);
    }

private:
    Renderer& of(const Scene& scene, const Quality& quality) {
        std::unique_ptr<Renderer>& renderer = renderers_[wished_backend(wish_, quality, fields_read(scene), gpu_)];
        if (!renderer) renderer = make_renderer(wished_backend(wish_, quality, fields_read(scene), gpu_));
        return *renderer;
    }

    BackendWish wish_;
    Gpu gpu_;
    std::map<Backend, std::unique_ptr<Renderer>> renderers_;
};

// The backend that has to draw a quality.
Backend backend_for(const SceneOptions& scene, const TradeChoices& choices, const Quality& quality) {
    return wished_backend(choices.wish, quality, scene.fields(), choices.gpu);
}

// Those that can draw the scene.
std::vector<Quality> possible_qualities(const SceneOptions& scene, const TradeChoices& choices) {
    std::vector<Quality> qualities = scene.iso.any_shaded() ? surface_qualities() : trade_qualities();
    std::erase_if(qualities, [&](const Quality& quality) {
        return !draws(backend_for(scene, choices, quality), quality, scene.fields()) || !draws(quality.method, planned_cuts(scene.cuts)) ||
               (!scene.iso.any() && quality.surfaces.kind != SurfaceMethodKind::exact);
    });
    return qualities;
}

// Each of the qualities, changed in each of the ways that were asked for.
template <class Change>
std::vector<Quality> varied(const std::vector<Quality>& qualities, const std::vector<std::string>& ways, Change change) {
    if (ways.empty()) return qualities;
    std::vector<Quality> all;
    for (const std::string& way : ways)
        for (Quality quality : qualities) {
            change(quality, way);
            all.push_back(quality);
        }
    return all;
}

}  // namespace

std::vector<Quality> choose_qualities(const SceneOptions& scene, const TradeChoices& choices) {
    if (choices.methods.empty() && choices.targets.empty() && choices.iso_methods.empty()) return possible_qualities(scene, choices);
    std::vector<Quality> usual;
    for (const std::string& text : choices.methods) usual.push_back({.method = parse_method(text, "--method")});
    if (choices.methods.empty()) {
        usual = possible_qualities(scene, choices);
        std::erase_if(usual, [](const Quality& quality) {
            return quality.target != Quality{}.target || (quality.surfaces.kind != SurfaceMethodKind::exact);
        });
    }
    usual = varied(usual, choices.iso_methods, [](Quality& quality, const std::string& text) {
        quality.surfaces = parse_surface_method(text, "--iso-method");
    });
    return varied(usual, choices.targets, [](Quality& quality, const std::string& text) {
        quality.target = parse_target_format(text, "--target");
    });
}

void require_all_drawn(const SceneOptions& scene, const TradeChoices& choices, std::span<const Quality> qualities) {
    if (qualities.empty()) require_drawn(backend_for(scene, choices, {}), {}, scene.fields());  // says why there is none
    for (const Quality& quality : qualities) {
        require_drawn(backend_for(scene, choices, quality), quality, scene.fields());
        require_drawn(quality.method, planned_cuts(scene.cuts));
    }
}

std::vector<GridSampling> choose_samplings(const TradeChoices& choices) {
    std::vector<GridSampling> samplings;
    for (const std::string& text : choices.samplings) samplings.push_back(parse_grid_sampling(text, "--sampling"));
    return samplings;
}

TradeSubject mesh_subject(const LoadedScene& loaded, const TradeChoices& choices, std::span<const Quality> qualities, const Camera& camera,
                          ImageSize size) {
    const auto reference = std::make_shared<const Reference>(loaded.scene);
    const auto renderer = std::make_shared<ChosenRenderer>(choices);
    return {ways_of(*renderer, loaded.scene, camera, size, qualities), judge_by(*reference, camera, size),
            std::to_string(loaded.scene.mesh->tets.size()) + " tetrahedra", {reference, renderer}};
}

namespace {

// Those that draw grids: rays on the CPU and OpenGL's projection, side by side unless one of them was asked for.
std::vector<Backend> grid_backends(const TradeChoices& choices) {
    if (choices.wish == BackendWish::cpu) return {Backend::cpu};
    const Backend gl = wished_backend(choices.wish == BackendWish::automatic ? BackendWish::gl : choices.wish, {}, FieldsRead::one, choices.gpu);
    if (choices.wish != BackendWish::automatic) return {gl};
    return {Backend::cpu, gl};
}

// What was asked for; slabs by the usual method unless others were.
std::vector<GridQuality> chosen_qualities(const TradeChoices& choices, std::span<const Quality> qualities) {
    std::vector<GridSampling> samplings = choose_samplings(choices);
    if (samplings.empty()) samplings.emplace_back();
    const Quality usual;
    if (choices.methods.empty() && choices.targets.empty()) qualities = {&usual, 1};
    std::vector<GridQuality> chosen;
    for (const GridSampling& sampling : samplings)
        for (const Quality& quality : qualities) chosen.push_back({quality.method, quality.target, sampling});
    return chosen;
}

void add(std::vector<TradeWay>& ways, std::vector<TradeWay> more) {
    ways.insert(ways.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

// The same grid cut into tetrahedra, judged as the grid is: inside a tetrahedron the scalar is linear, which is the error that counts.
std::vector<TradeWay> tetrahedral_ways(const SceneOptions& options, const LoadedScene& grid, const TradeChoices& choices,
                                       std::span<const Quality> asked_for, const Camera& camera, ImageSize size, TradeSubject& subject) {
    std::vector<Quality> qualities(asked_for.begin(), asked_for.end());
    if (choices.is_empty())
        for (const char* method : {"homogeneous", "integral", "exact:1e-3"}) qualities.push_back({.method = parse_method(method)});
    std::erase_if(qualities, [&](const Quality& quality) { return !draws(backend_for(options, choices, quality), quality, options.fields()); });
    if (qualities.empty()) return {};
    Scene scene = load_scene(options, DrawnAs::tets).scene;
    scene.transfer = grid.scene.transfer;
    const auto renderer = std::make_shared<ChosenRenderer>(choices);
    subject.kept.push_back(renderer);
    std::vector<TradeWay> ways = ways_of(*renderer, scene, camera, size, qualities);
    for (TradeWay& way : ways) way.name = "tets, " + way.name;
    return ways;
}

}  // namespace

TradeSubject grid_subject(const SceneOptions& options, const LoadedScene& loaded, const TradeChoices& choices,
                          std::span<const Quality> qualities, const Camera& camera, ImageSize size) {
    const GridScene& scene = *loaded.grid;
    const auto reference = std::make_shared<const GridReference>(scene);
    const GridDimensions n = scene.grid->dimensions();
    TradeSubject subject{{}, judge_by(*reference, camera, size),
                         "a grid of " + std::to_string(n.ni) + "x" + std::to_string(n.nj) + "x" + std::to_string(n.nk) + " points", {reference}};
    const std::vector<Backend> backends = grid_backends(choices);
    const std::vector<GridQuality> chosen = chosen_qualities(choices, qualities);
    if (!choices.methods.empty() || !choices.samplings.empty()) {  // each of them was asked for by its name
        for (const GridQuality& quality : chosen) {
            if (std::any_of(backends.begin(), backends.end(), [&](Backend b) { return draws_grid(b, scene, quality); })) continue;
            require_grid_drawn(backends.back(), quality, grid_shading(scene));  // says why it cannot be drawn
            require_grid_cut(quality, ray_cuts(scene));
        }
    }
    for (const Backend backend : backends) {
        std::vector<GridQuality> drawn = choices.is_empty() ? grid_trade_qualities(backend, scene) : chosen;
        std::erase_if(drawn, [&](const GridQuality& quality) { return !draws_grid(backend, scene, quality); });
        if (drawn.empty()) continue;
        const std::shared_ptr<GridRenderer> renderer = make_grid_renderer(backend);
        subject.kept.push_back(renderer);
        add(subject.ways, ways_of(*renderer, scene, camera, size, drawn));
    }
    if (choices.samplings.empty())
        add(subject.ways, tetrahedral_ways(options, loaded, choices, choices.is_empty() ? std::span<const Quality>() : qualities, camera, size, subject));
    return subject;
}

TradeSubject hierarchy_subject(const SceneOptions& options, const LoadedScene& loaded, const TradeChoices& choices,
                               std::span<const Quality> qualities, const Camera& camera, ImageSize size) {
    const HierarchyScene& scene = *loaded.hierarchy;
    const auto reference = std::make_shared<const HierarchyReference>(scene);
    const std::shared_ptr<HierarchyRenderer> renderer = make_hierarchy_renderer();
    std::vector<Method> methods;
    if (choices.is_empty()) {
        for (const char* method : {"average", "homogeneous", "preint2d-exp:256", "integral", "exact:1e-3", "exact:1e-5"}) methods.push_back(parse_method(method));
    } else {
        for (const GridQuality& quality : chosen_qualities(choices, qualities)) {
            require_hierarchy_drawn(options, choices.wish == BackendWish::automatic ? Backend::cpu : grid_backends(choices).back(), quality);
            methods.push_back(quality.method);
        }
    }
    TradeSubject subject{ways_of(*renderer, scene, camera, size, methods), judge_by(*reference, camera, size),
                         "a hierarchy of grids, " + std::to_string(scene.hierarchy->visible_cells()) + " cells", {reference, renderer}};
    add(subject.ways, tetrahedral_ways(options, loaded, choices, choices.is_empty() ? std::span<const Quality>() : qualities, camera, size, subject));
    return subject;
}

}  // namespace cellproj::cli
