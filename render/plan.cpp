// SPDX-License-Identifier: BSD-3-Clause
#include "render/plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mesh/error.hpp"
#include "render/prepared_scene.hpp"
#include "render/scene_view.hpp"

namespace cellproj {

namespace {

using Drawing = Plan::Drawing;

std::string counted(std::size_t number, const char* noun) { return std::to_string(number) + " " + noun + (number == 1 ? "" : "s"); }

// ---- For all views

Decision decide_cells(const SceneFacts& facts, const PlanRules& rules) {
    const std::size_t crossed = facts.surfaces ? facts.surfaces->crossed : 0;
    std::string chosen = std::to_string(facts.medium) + " of " + std::to_string(facts.cells) + " with a visible medium";
    if (facts.surfaces) chosen += ", " + std::to_string(crossed) + " with isosurfaces";
    if (!rules.culling) return {"cells", chosen + "; all are drawn", "the rule is switched off"};
    std::string why = facts.medium == facts.cells ? "every cell shows something" : "the others show nothing over the range of their scalars: left out before sorting";
    if (facts.not_finite > 0) why += "; " + counted(facts.not_finite, "cell") + (facts.not_finite == 1 ? " has" : " have") + " a scalar that is not finite";
    return {"cells", std::move(chosen), std::move(why)};
}

struct OrderChoice {
    Drawing drawing;
    Decision decision;
    bool few_cells = false;
};

// Sorting takes all cells, seen or not, as those in between tell which of two is in front; pixels sort what they meet, at a higher price.
// Measured (apps/bench/plan.cpp, 0.2M and 1.5M cells): prices are even at about two fragments for each cell of the mesh; never beyond the share
// that keeps a scene's cells from being sorted for nothing.
constexpr std::size_t few_cells_share = 8;
constexpr double few_fragments_per_cell = 2.0;

std::size_t drawn_at_most(const SceneFacts& facts) { return facts.medium + (facts.surfaces ? facts.surfaces->crossed : 0); }

OrderChoice decide_order(const SceneFacts& facts, const Quality& quality, Backend backend, const PlanRules& rules) {
    const auto choose = [](Drawing drawing, std::string chosen, std::string why) {
        return OrderChoice{drawing, {"order", std::move(chosen), std::move(why)}};
    };
    if (!facts.seen() && rules.nothing_seen)
        return choose(Drawing::nothing, "none: an empty picture at once", "no cell shows anything");
    const bool surfaces_alone = facts.surfaces && facts.medium == 0;
    // Surfaces in jumps of the scalar are told from the sequence of cells.
    const bool unseen_jump = facts.surfaces && facts.surfaces->jump;
    if (surfaces_alone && facts.surfaces->opaque && !unseen_jump && rules.nearest_surfaces)
        return choose(Drawing::nearest_surfaces, "none: the nearest surface of each pixel", "all isosurfaces are opaque and no medium is seen");
    if (!facts.surfaces && !facts.absorbs && rules.sum)
        return choose(Drawing::sum, "none: light adds up", "there is no extinction over the field's range, so that nothing hides anything");
    const std::string why = surfaces_alone && facts.surfaces->opaque && unseen_jump
                                ? "isosurfaces lie in jumps of the scalar, which only the sequence of cells tells"
                            : facts.medium > 0 ? "the medium hides what is behind it"
                                               : "isosurfaces are translucent";
    if (quality.order_per_pixel) return choose(Drawing::by_pixels, "by each pixel", why + "; asked for");
    if (quality.order) return choose(Drawing::by_cells, "cells by " + to_string(*quality.order), why + "; asked for");
    OrderChoice exact = choose(Drawing::by_cells, "cells, exactly for this mesh", why);
    exact.few_cells = rules.few_cells && backend == Backend::cpu && !unseen_jump && quality.check_rays == 0 &&
                      drawn_at_most(facts) <= facts.cells / few_cells_share;
    return exact;
}

// Methods that give the closed form of a homogeneous segment where colour and extinction are constant, within the rounding of float32. The
// others would not, and are what was asked for.
bool exact_where_constant(const Method& method) {
    if (light_at_vertices(method)) return false;
    switch (method.kind) {
        case MethodKind::integral:
        case MethodKind::exact:
        case MethodKind::linear:
            return true;
        case MethodKind::preint2d_exp:
            return method.storage == TableStorage::float32;
        default:
            return false;
    }
}

Decision decide_method(const SceneFacts& facts, const Quality& quality, Backend backend, const PlanRules& rules, Method& method) {
    method = quality.method;
    if (!rules.constant_light || light_at_vertices(quality.method)) return {"method", to_string(method), "asked for"};
    // The cheapest that has no table: in the kernels one piece without a search, in a shader two samples.
    Method closed_form = quality.method;
    closed_form.kind = backend == Backend::cpu ? MethodKind::integral : MethodKind::homogeneous;
    closed_form.size = Method{}.size;
    if (facts.medium == 0) {
        method = closed_form;
        return {"method", "none", "no medium is seen: no table"};
    }
    if (!facts.constant_light) return {"method", to_string(method), "colour or extinction vary over the field's range"};
    if (!exact_where_constant(quality.method)) return {"method", to_string(method), "asked for, though colour and extinction are constant"};
    method = closed_form;
    const std::string instead = closed_form.kind == quality.method.kind ? "" : " instead of " + to_string(quality.method);
    return {"method", to_string(method) + instead, "colour and extinction are the same over the field's range: a closed form, exact, without a table"};
}

Decision decide_field(const SceneFacts& facts) {
    const std::string second = facts.fields == FieldsRead::two ? ", two fields" : "";
    if (facts.location == FieldLocation::cells)
        return {"field", "one value for a cell" + second, "it is given on cells: a segment has one scalar, none is interpolated"};
    return {"field", "linear in a cell" + second, "it is given on points"};
}

Decision decide_gradients(const SceneFacts& facts) {
    if (!facts.surfaces && !facts.lit_medium) return {"gradients", "none", "nothing is lit"};
    const std::string of_medium = facts.lit_medium ? "; the medium is lit by them" : "";
    switch (facts.lit_medium ? *facts.lit_medium : facts.surfaces->shading) {
        case Shading::unlit:
            return {"gradients", "none", "isosurfaces are unlit"};
        case Shading::flat:
            return {"gradients", "one for a cell", "flat shading needs none at points" + of_medium};
        case Shading::smooth:
            break;
    }
    return {"gradients", "at points", "smooth shading interpolates them" + of_medium};
}

}  // namespace

Decision decide_rays(const RayCuts& cuts) {
    if (!cuts.any()) return {"rays", "whole", "nothing is clipped, and there are no bodies and no slices"};
    return {"rays", "cut", describe(cuts) + ": a part of each ray is left"};
}

Plan plan_scene(const SceneFacts& facts, const Quality& quality, Backend backend, const PlanRules& rules) {
    Plan result;
    result.decisions.push_back(decide_cells(facts, rules));
    OrderChoice order = decide_order(facts, quality, backend, rules);
    result.drawing = order.drawing;
    result.few_cells = order.few_cells;
    result.decisions.push_back(std::move(order.decision));
    result.decisions.push_back(decide_method(facts, quality, backend, rules, result.method));
    result.decisions.push_back(decide_field(facts));
    result.decisions.push_back(decide_gradients(facts));
    return result;
}

Plan plan_view(Plan plan, const SceneFacts& facts, const Camera& camera, ImageSize size, const RayCuts& cuts, const PlanRules& rules) {
    if (camera.projection == Camera::Projection::parallel) {
        plan.decisions.push_back({"projection", "parallel", "depth and scalar are affine on the screen: no division at a pixel"});
    } else {
        plan.decisions.push_back({"projection", "perspective", "the eye is at a place: 1/depth is affine on the screen"});
    }
    if (plan.few_cells && expected_fragments(facts, drawn_at_most(facts), camera, size) <= few_fragments_per_cell * static_cast<double>(facts.cells)) {
        plan.drawing = Drawing::by_pixels;
        const auto order = std::ranges::find(plan.decisions, "order", &Decision::rule);
        order->chosen = "by each pixel";
        order->why += "; few cells are drawn: what a pixel meets is sorted sooner than all cells";
    }
    if (rules.empty_view && outside_view(facts.box, camera, size)) {
        plan.drawing = Plan::Drawing::nothing;
        plan.decisions.push_back({"view", "an empty picture at once", "the mesh's box lies outside the view"});
    } else {
        plan.decisions.push_back({"view", "what the view holds", "the mesh's box reaches into it"});
    }
    if (plan.drawing == Drawing::nothing && cuts.opaque()) {
        const auto order = std::ranges::find(plan.decisions, "order", &Decision::rule);
        order->chosen = "none: " + describe(cuts, true) + " alone";
        order->why += "; the nearest one of each pixel is seen";
    }
    plan.decisions.push_back(decide_rays(cuts));
    return plan;
}

Plan plan(const Scene& scene, const Camera& camera, ImageSize size, const Quality& quality, Backend backend) {
    validate(camera, "camera");
    validate(size, "size");
    require_drawn(backend, quality, fields_read(scene));
    const SceneFacts facts = PreparedScene(scene).facts();
    return plan_view(plan_scene(facts, quality, backend), facts, camera, size, ray_cuts(scene));
}

double expected_fragments(const SceneFacts& facts, std::size_t cells, const Camera& camera, ImageSize size) {
    const double unit = std::max(facts.box.diagonal() / 2, 1e-300);
    const ScreenTransform transform = relative_transform(camera, size, unit);
    const glm::dvec3 edge = (facts.box.high - facts.box.low) / unit;
    const double volume = edge.x * edge.y * edge.z / static_cast<double>(std::max<std::size_t>(facts.cells, 1));
    const double area = 1.8 * std::cbrt(volume * volume);  // a regular tetrahedron's surface is 7.2 V^(2/3)
    const double depth = transform.to_eye((facts.box.center() - camera.eye) / unit).z;
    const double scale = transform.pixels_per_unit() / (transform.perspective() ? std::max(depth, near_plane_depth(camera, unit)) : 1.0);
    return static_cast<double>(cells) * area * scale * scale;
}

// Half-spaces through the eye (perspective) or along the view (parallel), a pixel wider than the picture, so that rounding drops nothing.
bool outside_view(const Bounds& box, const Camera& camera, ImageSize size) {
    const double unit = std::max(box.diagonal() / 2, 1e-300);
    const ScreenTransform transform = relative_transform(camera, size, unit);
    const double near = near_plane_depth(camera, unit);
    const glm::dvec2 half = (transform.principal_point() + 1.0) / transform.pixels_per_unit();
    bool left = true, right = true, above = true, below = true, behind = transform.perspective();
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y, corner & 4 ? box.high.z : box.low.z};
        const glm::dvec3 e = transform.to_eye((p - camera.eye) / unit);
        const double reach = transform.perspective() ? e.z : 1.0;
        left = left && e.x < -half.x * reach;
        right = right && e.x > half.x * reach;
        above = above && e.y < -half.y * reach;
        below = below && e.y > half.y * reach;
        behind = behind && e.z < near;
    }
    return left || right || above || below || behind;
}

// ---- Backends

namespace {

constexpr std::array backend_names{std::pair{"auto", BackendWish::automatic}, std::pair{"cpu", BackendWish::cpu},
                                   std::pair{"gl", BackendWish::gl}, std::pair{"egl", BackendWish::egl},
                                   std::pair{"osmesa", BackendWish::osmesa}};

// Of those that `automatic` may take.
std::string why_automatic(Backend backend, const Quality& quality, FieldsRead fields, const Gpu& gpu) {
    if (backend == Backend::gl_egl) return "a GPU: " + gpu.what;
    if (backend == Backend::cpu)
        return gpu.found ? "pixels that sort themselves are drawn by it alone" : "without a GPU it is the fastest (EGL: " + gpu.what + ")";
    const std::string what = fields == FieldsRead::two                           ? "opacity from another field"
                             : light_at_vertices(quality.method)                 ? "light at vertices"
                             : quality.surfaces.kind != SurfaceMethodKind::exact ? "isosurfaces by " + to_string(quality.surfaces)
                                                                                 : "target " + to_string(quality.target);
    return what + " is drawn by OpenGL only, and there is no GPU (EGL: " + gpu.what + ")";
}

}  // namespace

BackendWish parse_backend(const std::string& name, const std::string& place) {
    std::string known;
    for (const auto& [text, wish] : backend_names) {
        if (name == text) return wish;
        known += (known.empty() ? "" : ", ") + std::string(text);
    }
    throw Error({ErrorKind::option, place, "one of " + known, name, "correct it"});
}

bool depends_on_gpu(BackendWish wish) { return wish == BackendWish::automatic || wish == BackendWish::gl; }

Backend wished_backend(BackendWish wish, const Quality& quality, FieldsRead fields, const Gpu& gpu) {
    switch (wish) {
        case BackendWish::cpu: return Backend::cpu;
        case BackendWish::egl: return Backend::gl_egl;
        case BackendWish::osmesa: return Backend::gl_osmesa;
        case BackendWish::gl: return gpu.found ? Backend::gl_egl : Backend::gl_osmesa;
        case BackendWish::automatic: break;
    }
    return usual_backend(quality, fields, gpu);
}

ChosenBackend choose_backend(BackendWish wish, const Quality& quality, FieldsRead fields, const Gpu& gpu) {
    const Backend backend = wished_backend(wish, quality, fields, gpu);
    require_drawn(backend, quality, fields);
    std::string why = "asked for";
    if (wish == BackendWish::gl) why = "OpenGL was asked for, and there is " + (gpu.found ? "a GPU: " + gpu.what : "no GPU (EGL: " + gpu.what + ")");
    if (wish == BackendWish::automatic) why = why_automatic(backend, quality, fields, gpu);
    return {backend, {"backend", to_string(backend), std::move(why)}};
}

void tell_order(std::vector<Decision>& decisions, const std::string& method, bool exact) {
    const auto order = std::ranges::find(decisions, "order", &Decision::rule);
    if (order == decisions.end()) return;
    order->chosen = "cells by " + method;
    order->why += exact ? "; proven to be exact" : "; not proven to be exact";
}

std::string in_words(std::span<const Decision> decisions) {
    std::size_t rule = 0, chosen = 0;
    for (const Decision& d : decisions) {
        rule = std::max(rule, d.rule.size());
        chosen = std::max(chosen, d.chosen.size());
    }
    std::string text;
    for (const Decision& d : decisions)
        text += "  " + d.rule + std::string(rule - d.rule.size() + 2, ' ') + d.chosen + std::string(chosen - d.chosen.size() + 2, ' ') + d.why + "\n";
    return text;
}

}  // namespace cellproj
