// SPDX-License-Identifier: BSD-3-Clause
#include "render/gl/grid_slabs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "render/gl/grid_slab_outline.hpp"
#include "render/gl/shaders.hpp"

namespace cellproj::gl {

namespace {

constexpr unsigned int classified_unit = 10;  // shaders/grid_slab.frag

// A slab with a corner nearer to the eye than this [scene units] may cover all of the picture.
constexpr double near_depth = 1e-3;

// The rasterizer rounds positions to 1/256 of a pixel; rays find out by themselves what of them lies inside.
constexpr double margin = 1.0 / 64;

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
    const glm::dvec3 forward(view.axes()[0].z, view.axes()[1].z, view.axes()[2].z);
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

class SlabBatch {
public:
    SlabBatch(const GridView& view, const Bounds& box, const Slices& slices) : view_(view), box_(box), slices_(slices) {}

    // `slabs` from the slice `nearest` on, away from the eye.
    void add(int nearest, int slabs, int direction) {
        const int farthest = nearest + direction * slabs;
        const auto corners = slab_corners(box_, slices_.normal, slices_.at(std::min(nearest, farthest)), slices_.at(std::max(nearest, farthest)));
        const auto first = static_cast<std::uint32_t>(batch_.vertices.size());
        const std::vector<glm::dvec2> outline = outline_of(corners);
        if (outline.size() < 3) return;
        const glm::dvec2 picture(view_.transform().size().width, view_.transform().size().height);
        for (const glm::dvec2& pixel : outline) {
            const glm::dvec2 place = 2.0 * pixel / picture - 1.0;
            batch_.vertices.push_back({static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(nearest),
                                       static_cast<float>(direction)});
        }
        for (std::uint32_t i = 2; i < outline.size(); ++i)
            batch_.indices.insert(batch_.indices.end(), {first, first + i - 1, first + i});
    }

    const Triangles<SlabVertex>& triangles() const { return batch_; }

private:
    std::vector<glm::dvec2> outline_of(const std::vector<glm::dvec3>& corners) const {
        const ScreenTransform& transform = view_.transform();
        std::vector<glm::dvec2> places;
        for (const glm::dvec3& corner : corners) {
            const glm::dvec3 p = view_.to_eye(corner);
            if (view_.perspective() && p.z < near_depth) {
                const double width = transform.size().width, height = transform.size().height;
                return {{0, 0}, {width, 0}, {width, height}, {0, height}};
            }
            const glm::dvec2 place = transform.to_screen(p);
            for (const double x : {-margin, margin}) {
                for (const double y : {-margin, margin}) places.push_back(place + glm::dvec2(x, y));
            }
        }
        return convex_hull(std::move(places));
    }

    const GridView& view_;
    const Bounds& box_;
    const Slices& slices_;
    Triangles<SlabVertex> batch_;
};

Triangles<SlabVertex> back_to_front(const GridView& view, const Bounds& box, const Slices& slices, int per_polygon) {
    SlabBatch batch(view, box, slices);
    // The slabs from `own` on are seen from their low side, that of the eye among them; those before it from their high one.
    const int own = static_cast<int>(std::clamp(std::floor(slices.eye), 0.0, static_cast<double>(slices.count)));
    const auto groups = [&](int slabs) { return (slabs + per_polygon - 1) / per_polygon; };
    for (int g = groups(own); g-- > 0;) batch.add(own - g * per_polygon, std::min(per_polygon, own - g * per_polygon), -1);
    const int above = slices.count - own;
    for (int g = groups(above); g-- > 0;) batch.add(own + g * per_polygon, std::min(per_polygon, above - g * per_polygon), 1);
    return batch.triangles();
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
                       Programs& programs, const std::string& defines, TriangleStream& stream) {
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
    const Triangles<SlabVertex> triangles = back_to_front(view, box, slices, sampling.per_polygon);
    stream.draw(triangles);
    return triangles.indices.size() / 3;
}

}  // namespace cellproj::gl
