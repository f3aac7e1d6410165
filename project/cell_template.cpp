// SPDX-License-Identifier: BSD-3-Clause
#include "project/cell_template.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "mesh/grid.hpp"

namespace cellproj {

namespace {

// One axis as the eye sees it, turned so that the front face of a visible axis is the low one.
struct AxisView {
    double eye = 0, front = 0, back = 0;  // coordinates: of the eye (parallel: of its direction), of the two faces
    double edge = 0;                      // h
    double to_front = 0, to_back = 0;  // g, G; not visible: how far the eye lies behind the low and the high face, ≥ 0
    bool visible = false;
    bool turned = false;
};

AxisView parallel_axis(double towards_eye, double edge) {
    // The front face at the origin, the eye in the negative direction.
    const double share = std::abs(towards_eye);
    return {.eye = -share,
            .front = 0,
            .back = edge,
            .edge = edge,
            .to_front = share,
            .to_back = share,
            .visible = share > 0,
            .turned = towards_eye > 0};
}

AxisView perspective_axis(double eye, double low, double high) {
    AxisView axis{.eye = eye, .front = low, .back = high, .edge = high - low};
    if (low <= eye && eye <= high) {
        axis.to_front = eye - low;
        axis.to_back = high - eye;
        return axis;
    }
    if (eye > high) {
        axis.eye = -eye;
        axis.front = -high;
        axis.back = -low;
        axis.turned = true;
    }
    axis.visible = true;
    axis.to_front = axis.front - axis.eye;
    axis.to_back = axis.back - axis.eye;
    return axis;
}

// g_i h_j − g_j h_i, its sign exact: positive when a ray crosses the cell sooner along i than along j.
double lead(const AxisView& i, const AxisView& j) {
    return doubled_area({i.front, j.front}, {i.back, j.back}, {i.eye, j.eye});
}

// Where the ray to the farthest corner enters, and where that from the nearest one leaves, along i (see the header).
// The clamps only undo rounding.
double entry_of_farthest(const AxisView& a, const AxisView& i) {
    return std::clamp(lead(a, i) / (a.to_back * i.edge), 0.0, 1.0);
}
double exit_of_nearest(const AxisView& a, const AxisView& i) {
    if (lead(a, i) == 0) return 1.0;
    return std::min(i.to_front * a.edge / (a.to_front * i.edge), 1.0);
}

// Along an axis whose faces are both behind: where the ray that leaves at its low or high end is entered.
std::array<double, 2> entries(const AxisView& a, const AxisView& i) {
    const double scale = a.edge / (a.to_back * i.edge);
    const double low = std::min(i.to_front * scale, 1.0);
    return {low, std::max(1.0 - i.to_back * scale, low)};
}

// Fills a template from vertices and polygons in *turned* coordinates: axes in the order a, b, c, each from front to
// back.
class Builder {
public:
    // The number of exchanges of the order (a, b, c) and of turned axes says whether the turned space is mirrored.
    Builder(CellTemplate& shape, const std::array<AxisView, 3>& axes, const std::array<int, 3>& order)
        : shape_(shape), axes_(axes), order_(order) {
        bool odd = false;
        for (int axis = 0; axis < 3; ++axis) {
            odd ^= axes[static_cast<std::size_t>(axis)].turned;
            for (int later = axis + 1; later < 3; ++later)
                odd ^= order[static_cast<std::size_t>(axis)] > order[static_cast<std::size_t>(later)];
        }
        mirrored_ = odd;
        ids_.fill(unused);
    }

    void corner(std::size_t slot, const glm::dvec3& u) { slots_[slot] = {u, u, false}; }
    void interior(std::size_t slot, const glm::dvec3& front, const glm::dvec3& back) {
        slots_[slot] = {front, back, true};
    }
    void same(std::size_t slot, std::size_t as) { alias_[slot] = as; }

    // `back_high`: the back face is at the high end of its axis; always where that axis is visible. Vertices
    // counter-clockwise in the plane of the axes that follow the front face's in the cycle a, b, c, that is, clockwise
    // for the eye. Those that are the same count once; fewer than three make no polygon.
    void polygon(std::size_t front, std::size_t back, bool back_high, std::initializer_list<std::size_t> slots) {
        std::array<std::size_t, 4> kept{};
        std::size_t count = 0;
        for (const std::size_t slot : slots) {
            const std::size_t own = resolve(slot);
            if (std::find(kept.begin(), kept.begin() + count, own) == kept.begin() + count) kept[count++] = own;
        }
        if (count < 3) return;
        if (!mirrored_) std::reverse(kept.begin(), kept.begin() + count);
        TemplatePolygon& p = shape_.polygon_storage[shape_.polygon_count++];
        p.count = static_cast<std::uint8_t>(count);
        for (std::size_t v = 0; v < count; ++v)
            p.vertices[v] = id(kept[v]);
        p.front_face = face(front, false);
        p.back_face = face(back, back_high);
    }

private:
    static constexpr std::uint8_t unused = 0xff;

    std::size_t resolve(std::size_t slot) const { return alias_[slot] == none ? slot : resolve(alias_[slot]); }

    std::uint8_t face(std::size_t axis, bool high) const {
        const auto own = static_cast<std::size_t>(order_[axis]);
        return static_cast<std::uint8_t>(2 * own + (high != axes_[own].turned ? 1 : 0));
    }

    glm::dvec3 in_cell(const glm::dvec3& u) const {
        glm::dvec3 own;
        for (int i = 0; i < 3; ++i) {
            const int axis = order_[static_cast<std::size_t>(i)];
            own[axis] = axes_[static_cast<std::size_t>(axis)].turned ? 1.0 - u[i] : u[i];
        }
        return own;
    }

    std::uint8_t id(std::size_t slot) {
        if (ids_[slot] == unused) {
            ids_[slot] = static_cast<std::uint8_t>(shape_.vertex_count);
            const TemplateVertex& v = slots_[slot];
            shape_.vertex_storage[shape_.vertex_count++] = {in_cell(v.front), in_cell(v.back), v.interior};
        }
        return ids_[slot];
    }

    static constexpr std::size_t none = 10;
    CellTemplate& shape_;
    const std::array<AxisView, 3>& axes_;
    const std::array<int, 3>& order_;
    bool mirrored_ = false;
    std::array<TemplateVertex, 10> slots_{};
    std::array<std::size_t, 10> alias_{none, none, none, none, none, none, none, none, none, none};
    std::array<std::uint8_t, 10> ids_{};
};

// ---- One, two and three visible faces; a, b, c are axes 0, 1, 2 of the builder ----

void one_face(Builder& build, const AxisView& a, const AxisView& b, const AxisView& c) {
    // The corners of the front and of the back face, by their b and c.
    enum Slot : std::size_t { s00, s10, s11, s01, f00, f10, f11, f01 };
    const std::array<double, 2> eb = entries(a, b), ec = entries(a, c);
    build.corner(s00, {0, 0, 0});
    build.corner(s10, {0, 1, 0});
    build.corner(s11, {0, 1, 1});
    build.corner(s01, {0, 0, 1});
    build.interior(f00, {0, eb[0], ec[0]}, {1, 0, 0});
    build.interior(f10, {0, eb[1], ec[0]}, {1, 1, 0});
    build.interior(f11, {0, eb[1], ec[1]}, {1, 1, 1});
    build.interior(f01, {0, eb[0], ec[1]}, {1, 0, 1});
    build.polygon(0, 0, true, {f00, f10, f11, f01});
    if (b.to_front > 0) build.polygon(0, 1, false, {s00, f00, f01, s01});
    if (b.to_back > 0) build.polygon(0, 1, true, {s10, s11, f11, f10});
    if (c.to_front > 0) build.polygon(0, 2, false, {s00, s10, f10, f00});
    if (c.to_back > 0) build.polygon(0, 2, true, {s01, f01, f11, s11});
}

// The edge in front and the one behind both run along c; `tie`: the one hides the other.
void two_faces(Builder& build, const AxisView& a, const AxisView& b, const AxisView& c, bool tie) {
    // Ends of the front edge; where it crosses the edges behind; ends of the back edge; the other corners, all at low
    // and high c.
    enum Slot : std::size_t { n0, n1, x0, x1, f0, f1, b0, b1, a0, a1 };
    const std::array<double, 2> ec = entries(a, c);
    const double entry = entry_of_farthest(a, b), exit = exit_of_nearest(a, b);
    for (std::size_t high = 0; high < 2; ++high) {
        const auto end = static_cast<double>(high);
        build.corner(n0 + high, {0, 0, end});
        build.interior(x0 + high, {0, 0, ec[high]}, {1, exit, end});
        build.interior(f0 + high, {0, entry, ec[high]}, {1, 1, end});
        build.corner(b0 + high, {0, 1, end});
        build.corner(a0 + high, {1, 0, end});
        if (tie) build.same(x0 + high, f0 + high);
    }
    build.polygon(0, 0, true, {x0, f0, f1, x1});
    build.polygon(0, 1, true, {f0, b0, b1, f1});
    build.polygon(1, 0, true, {x0, x1, a1, a0});
    if (c.to_front > 0) {
        build.polygon(0, 2, false, {n0, b0, f0, x0});
        build.polygon(1, 2, false, {n0, x0, a0});
    }
    if (c.to_back > 0) {
        build.polygon(0, 2, true, {n1, x1, f1, b1});
        build.polygon(1, 2, true, {n1, a1, x1});
    }
}

// `tie_b`, `tie_c`: the far corner lies over the front edge between a and b, a and c; with both, over the nearest
// corner.
void three_faces(Builder& build, const AxisView& a, const AxisView& b, const AxisView& c, bool tie_b, bool tie_c) {
    enum Slot : std::size_t { nearest, farthest, along_b, along_c, s010, s011, s001, s101, s100, s110 };
    const double entry_b = entry_of_farthest(a, b), entry_c = entry_of_farthest(a, c);
    const double exit_b = exit_of_nearest(a, b), exit_c = exit_of_nearest(a, c);
    build.interior(nearest, {0, 0, 0}, {1, exit_b, exit_c});
    build.interior(farthest, {0, entry_b, entry_c}, {1, 1, 1});
    build.interior(along_b, {0, entry_b, 0}, {1, 1, exit_c});  // the front edge along b crosses the back edge along c
    build.interior(along_c, {0, 0, entry_c}, {1, exit_b, 1});
    build.corner(s010, {0, 1, 0});
    build.corner(s011, {0, 1, 1});
    build.corner(s001, {0, 0, 1});
    build.corner(s101, {1, 0, 1});
    build.corner(s100, {1, 0, 0});
    build.corner(s110, {1, 1, 0});
    if (tie_b) {
        build.same(along_b, nearest);
        build.same(along_c, farthest);
    }
    if (tie_c) {
        build.same(along_c, nearest);
        if (!tie_b) build.same(along_b, farthest);
    }
    if (tie_b && tie_c) build.same(farthest, nearest);
    build.polygon(0, 0, true, {nearest, along_b, farthest, along_c});
    build.polygon(0, 1, true, {along_b, s010, s011, farthest});
    build.polygon(0, 2, true, {along_c, farthest, s011, s001});
    build.polygon(1, 0, true, {nearest, along_c, s101, s100});
    build.polygon(1, 2, true, {along_c, s001, s101});
    build.polygon(2, 0, true, {nearest, s100, s110, along_b});
    build.polygon(2, 1, true, {along_b, s110, s010});
}

// `towards_eye_length`: |d| of a parallel view, 0 in perspective.
CellTemplate make_template(const std::array<AxisView, 3>& axes, double towards_eye_length) {
    CellTemplate shape;
    for (const AxisView& axis : axes)
        shape.visible_faces += axis.visible ? 1 : 0;
    if (shape.visible_faces == 0) return shape;

    // a leads all visible axes; b is the other visible one where there are two.
    std::array<int, 3> order{0, 1, 2};
    const auto view = [&](int n) -> const AxisView& {
        return axes[static_cast<std::size_t>(order[static_cast<std::size_t>(n)])];
    };
    for (const int n : {1, 2, 1}) {
        const AxisView &first = view(n - 1), &second = view(n);
        if (second.visible && (!first.visible || lead(second, first) > 0))
            std::swap(order[static_cast<std::size_t>(n - 1)], order[static_cast<std::size_t>(n)]);
    }
    const AxisView &a = view(0), &b = view(1), &c = view(2);
    const bool tie_b = b.visible && lead(a, b) == 0, tie_c = c.visible && lead(a, c) == 0;
    shape.crossed_axes =
        static_cast<std::uint8_t>(1 << order[0] | (tie_b ? 1 << order[1] : 0) | (tie_c ? 1 << order[2] : 0));
    shape.interior_thickness = (towards_eye_length > 0 ? towards_eye_length : 1.0) * a.edge / a.to_back;

    Builder build(shape, axes, order);
    if (shape.visible_faces == 1) one_face(build, a, b, c);
    if (shape.visible_faces == 2) two_faces(build, a, b, c, tie_b);
    if (shape.visible_faces == 3) three_faces(build, a, b, c, tie_b, tie_c);
    return shape;
}

glm::dvec3 point_at(const Bounds& cell, const glm::dvec3& u) {
    return (1.0 - u) * cell.low + u * cell.high;
}

}  // namespace

CellTemplate parallel_template(const glm::dvec3& towards_eye, const glm::dvec3& edges) {
    assert(towards_eye != glm::dvec3(0) && edges.x > 0 && edges.y > 0 && edges.z > 0);
    std::array<AxisView, 3> axes{};
    for (int i = 0; i < 3; ++i)
        axes[static_cast<std::size_t>(i)] = parallel_axis(towards_eye[i], edges[i]);
    return make_template(axes, glm::length(towards_eye));
}

CellTemplate perspective_template(const glm::dvec3& eye, const Bounds& cell) {
    assert(cell.low.x < cell.high.x && cell.low.y < cell.high.y && cell.low.z < cell.high.z);
    std::array<AxisView, 3> axes{};
    for (int i = 0; i < 3; ++i)
        axes[static_cast<std::size_t>(i)] = perspective_axis(eye[i], cell.low[i], cell.high[i]);
    return make_template(axes, 0.0);
}

ProjectedVertex project(const TemplateVertex& vertex, const CellTemplate& shape, const Bounds& cell,
                        const std::array<double, 8>& corner_scalars, const ScreenTransform& transform) {
    const glm::dvec3 front = transform.to_eye(point_at(cell, vertex.front));
    const double s_f = interpolate(corner_scalars, vertex.front);
    const double s_b = vertex.interior ? interpolate(corner_scalars, vertex.back) : s_f;
    const double share = vertex.interior ? shape.interior_thickness : 0.0;
    if (!transform.perspective()) return {transform.to_screen(front), front.z, share, s_f, s_b};
    assert(front.z > 0);
    const double depth = 1.0 / front.z, thickness = share * depth;
    return {transform.to_screen(front), depth, thickness, s_f * depth, s_b * (depth - thickness)};
}

}  // namespace cellproj
