// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_slabs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "render/gl/grid_slab_outline.hpp"
#include "render/gl/shaders.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int classified_unit = 10;  // shaders/grid_slab.frag

constexpr std::array<VertexAttribute, 2> slab_attributes{{{0, 2, offsetof(SlabVertex, x)}, {1, 2, offsetof(SlabVertex, first)}}};

// Slices about the view's reference point.
struct Slices {
    glm::dvec3 normal;
    double first, thickness;  // where slice 0 is along the normal
    int count;                // of slabs
    double eye;               // the slab that holds it, as a real number of slices; −∞ or ∞ for an eye at infinity

    double at(int i) const { return first + i * thickness; }
};

Slices slices_of(const GridView& view, const GridUnits& units, const GridSampling& sampling, const Bounds& box) {
    constexpr double infinite = 1e300;
    const std::size_t axis = nearest_axis(view);
    const double thickness = slab_thickness(view.grid(), units, sampling, axis);
    const glm::dvec3 forward = view.forward();
    if (sampling.cut == GridSampling::Cut::view) {
        // About the middle of the box, wherever the eye is.
        const double first = glm::dot(forward, box.center()) - 0.5 * thickness * sampling.slabs;
        return {forward, first, thickness, sampling.slabs, view.perspective() ? -first / thickness : -infinite};
    }
    const auto a = static_cast<int>(axis);
    glm::dvec3 normal(0.0);
    normal[a] = 1.0;
    const double far = forward[a] > 0 ? -infinite : infinite;
    return {normal, box.low[a], thickness, sampling.slabs, view.perspective() ? -box.low[a] / thickness : far};
}

// Slabs that one polygon draws: `count` of them from the slice `nearest` on, away from the eye.
struct SlabGroup {
    int nearest, direction, count;

    int farthest() const { return nearest + direction * count; }
    int low() const { return std::min(nearest, farthest()); }
    int high() const { return std::max(nearest, farthest()); }
};

std::vector<SlabGroup> groups_front_to_back(const Slices& slices, int per_polygon) {
    // The slabs from `own` on are seen from their low side, that of the eye among them; those before it from their high one.
    const int own = static_cast<int>(std::clamp(std::floor(slices.eye), 0.0, static_cast<double>(slices.count)));
    std::vector<SlabGroup> groups;
    for (int first = own; first < slices.count; first += per_polygon) groups.push_back({first, 1, std::min(per_polygon, slices.count - first)});
    for (int first = own; first > 0; first -= per_polygon) groups.push_back({first, -1, std::min(per_polygon, first)});
    return groups;
}

void append(const GridView& view, const Bounds& box, const Slices& slices, const SlabGroup& group, Triangles<SlabVertex>& batch) {
    const auto corners = slab_corners(box, slices.normal, slices.at(group.low()), slices.at(group.high()));
    const auto first = static_cast<std::uint32_t>(batch.vertices.size());
    const std::vector<glm::dvec2> outline = outline_on_screen(view, corners);
    if (outline.size() < 3) return;
    for (const glm::dvec2& pixel : outline) {
        const glm::vec2 place = clip_space(view, pixel);
        batch.vertices.push_back({place.x, place.y, static_cast<float>(group.nearest), static_cast<float>(group.direction)});
    }
    for (std::uint32_t i = 2; i < outline.size(); ++i) batch.indices.insert(batch.indices.end(), {first, first + i - 1, first + i});
}

// Of all that lies in the groups.
std::vector<glm::dvec3> corners_of(const Bounds& box, const Slices& slices, std::span<const SlabGroup> groups) {
    int low = slices.count, high = 0;
    for (const SlabGroup& group : groups) {
        low = std::min(low, group.low());
        high = std::max(high, group.high());
    }
    return slab_corners(box, slices.normal, slices.at(low), slices.at(high));
}

}  // namespace

std::span<const VertexAttribute> vertex_attributes(const SlabVertex*) { return slab_attributes; }

std::size_t nearest_axis(const GridView& view) {
    std::size_t axis = 0;
    for (const std::size_t a : {1U, 2U}) {
        if (std::abs(view.axes()[a].z) > std::abs(view.axes()[axis].z)) axis = a;
    }
    return axis;
}

double slab_thickness(const Grid& grid, const GridUnits& units, const GridSampling& sampling, std::size_t axis) {
    const Bounds box = grid.bounds();
    const auto a = static_cast<int>(axis);
    const double extent = sampling.cut == GridSampling::Cut::object ? box.high[a] - box.low[a] : box.diagonal();
    return extent / units.length / sampling.slabs;
}

std::size_t draw_slabs(const GridView& view, const GridUnits& units, const GridSampling& sampling, const GridLight& light, const Texture* classified,
                       Programs& programs, const std::string& defines, TriangleStream& stream, ClosedTiles* closed) {
    const std::string own = "#define SLABS " + std::to_string(sampling.per_polygon) + '\n' + (classified ? "#define PRE\n" : "") +
                            (sampling.light == GridSampling::Light::post ? "#define POST\n" : "");
    const Program& program = programs.of(shaders::grid_slab_vert + light.vertex_source(),
                                         shaders::grid_rays_frag + light.fragment_source(shaders::grid_slab_frag + (classified ? shaders::light_glsl : "")),
                                         view.defines() + defines + light.defines() + own);
    view.set_rays(program);
    light.bind(program);
    if (classified) classified->bind(classified_unit);

    Bounds box;
    glm::dvec3 scale, offset;
    for (int a = 0; a < 3; ++a) {
        const std::size_t axis = static_cast<std::size_t>(a), points = view.grid().axes[axis].points();
        box.low[a] = view.plane(axis, 0);
        box.high[a] = view.plane(axis, points - 1);
        // Points are the middles of texels.
        scale[a] = (1.0 - 1.0 / static_cast<double>(points)) / (box.high[a] - box.low[a]);
        offset[a] = 0.5 / static_cast<double>(points) - box.low[a] * scale[a];
    }
    const Slices slices = slices_of(view, units, sampling, box);
    program.set("box_low", glm::vec3(box.low));
    program.set("box_high", glm::vec3(box.high));
    program.set("point_scale", glm::vec3(scale));
    program.set("point_offset", glm::vec3(offset));
    program.set("slice_normal", glm::vec3(slices.normal));
    program.set("slices", static_cast<float>(slices.first), static_cast<float>(slices.thickness));
    program.use();
    std::vector<SlabGroup> groups = groups_front_to_back(slices, sampling.per_polygon);
    Triangles<SlabVertex> batch;
    std::size_t triangles = 0;
    const auto flush = [&] {
        stream.draw(batch);
        triangles += batch.indices.size() / 3;
        batch.clear();
    };
    if (!closed) {
        std::reverse(groups.begin(), groups.end());
        for (const SlabGroup& group : groups) append(view, box, slices, group, batch);
        flush();
        return triangles;
    }
    LookRhythm rhythm(groups.size());
    for (std::span<const SlabGroup> rest(groups); !rest.empty() && !closed->all();) {
        const std::size_t some = std::min(rhythm.step(), rest.size());
        for (const SlabGroup& group : rest.first(some)) append(view, box, slices, group, batch);
        rest = rest.subspan(some);
        program.use();
        flush();
        if (!rest.empty()) rhythm.looked(closed->look(corners_of(box, slices, rest)));
    }
    return triangles;
}

}  // namespace cellproj::gl
