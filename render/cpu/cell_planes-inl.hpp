// SPDX-License-Identifier: BSD-3-Clause
//
// Cells to affine terms over the pixels of a tile, as many cells at once as a vector has lanes. Included once per instruction
// set, behind Highway; private to kernels.cpp.
//
// Nearness is affine on the screen over the plane of a face. So a ray enters a cell at the smallest nearness of the faces that
// look towards the eye and leaves it at the largest of the others, and misses it where that is no way. No edges, no classes.
//
// Numerics. A cell's corners are taken in the order of their numbers, so that both cells of a face compute its slopes from the
// same numbers in the same order: bit for bit the same. The cross products have the error of one rounding (Kahan). An edge-on
// face has slopes without bounds; they are cut off at a size where the plane is still vertical to a billionth of a pixel.
// Then the side on which the cell lies does not depend on the rounded sign of the face's area: towards the eye the plane
// lies infinitely far or near for the two sides of its line, whichever of both it counts as. All nearness is relative to the
// cell's first corner: a thin cell far away keeps its thickness.
#if defined(CELLPROJ_CELL_PLANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_CELL_PLANES_INL
#undef CELLPROJ_CELL_PLANES_INL
#else
#define CELLPROJ_CELL_PLANES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Terms of a group of cells, one column per cell. Pixel offsets count from (left, top), which lies in the tile.
struct alignas(64) CellPlanes {
    static constexpr std::size_t columns = 16;
    using Row = float[columns];

    Row nearness[4], slope_x[4], slope_y[4];  // of the faces' planes
    std::uint32_t front_faces[columns];       // bit k: face k looks towards the eye
    Row nearest, farthest;                    // of the corners
    // s = first_scalar + (scalar + x·scalar_x + y·scalar_y + n·scalar_n)·depth, depth 1 in parallel views
    Row first_scalar, scalar, scalar_x, scalar_y, scalar_n;
    Row lowest, highest;       // scalar
    Row base;                  // nearness of the first corner, to which the above are relative; perspective: its 1/depth
    Row anchor;                // the same nearness as that of ScreenPoint
    std::int32_t left[columns], top[columns], width[columns], height[columns];  // pixels of the tile; width ≤ 0: none
    std::int32_t first_pixel[columns];                                            // left + tile_side·top
};

template <class V>
struct Vec3 {
    V x, y, n;
};

// a·b + c with one rounding, as most instruction sets do it. For what the place of a fragment hangs on: a bit of its scalar moves the light of a narrow
// peak by 1e-5. Others find the same bits in float64, which holds the product of two floats (but where two roundings differ from one, once in
// a hundred million times): slower, and all give one picture.
template <class V>
HWY_INLINE V fused(V a, V b, V c) {
#if HWY_NATIVE_FMA || !HWY_HAVE_FLOAT64
    return hn::MulAdd(a, b, c);
#else
    using D = hn::DFromV<V>;
    const D d;
    const hn::Half<D> half;
    const hn::Rebind<double, decltype(half)> dd;
    const auto of = [&](auto x, auto y, auto z) HWY_ATTR {
        return hn::DemoteTo(half, hn::Add(hn::Mul(hn::PromoteTo(dd, x), hn::PromoteTo(dd, y)), hn::PromoteTo(dd, z)));
    };
#if HWY_TARGET == HWY_SCALAR
    (void)d;
    return of(a, b, c);
#else
    const auto low = of(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c));
    const auto high = of(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c));
    return hn::Combine(d, high, low);
#endif
#endif
}

// a·d − b·c with the error of one rounding (Kahan; Jeannerod, Louvet, Muller 2013).
template <class V>
HWY_INLINE V difference_of_products(V a, V d, V b, V c) {
    const V product = hn::Mul(b, c);
    return hn::Add(fused(a, d, hn::Neg(product)), fused(hn::Neg(b), c, product));
}

template <class V>
HWY_INLINE Vec3<V> cross(const Vec3<V>& a, const Vec3<V>& b) {
    return {difference_of_products(a.y, b.n, a.n, b.y), difference_of_products(a.n, b.x, a.x, b.n),
            difference_of_products(a.x, b.y, a.y, b.x)};
}

template <class V>
HWY_INLINE Vec3<V> minus(const Vec3<V>& a, const Vec3<V>& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.n, b.n)};
}

// The corners of a group of cells by their numbers; true where that order is an odd permutation of the cell's own.
template <class DU, class VU = hn::Vec<DU>>
HWY_INLINE hn::Mask<DU> sort_corners(DU du, VU (&v)[4]) {
    static constexpr int pairs[5][2]{{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
    hn::Mask<DU> odd = hn::Lt(v[0], v[0]);
    for (const auto& [a, b] : pairs) {
        odd = hn::Xor(odd, hn::Lt(v[b], v[a]));
        const VU low = hn::Min(v[a], v[b]);
        v[b] = hn::Max(v[a], v[b]);
        v[a] = low;
    }
    (void)du;
    return odd;
}

struct Corners {
    HWY_ALIGN std::uint32_t ids[4 * CellPlanes::columns];            // four per cell
    HWY_ALIGN float points[4][4 * CellPlanes::columns];              // per corner: x, y, nearness, scalar of each cell
    HWY_ALIGN float scalars[CellPlanes::columns];                    // of cells, for fields on cells
};

// The planes of `count` ≤ Lanes(d) cells over a tile whose first pixel centre is (tile_x, tile_y).
template <bool perspective, bool constant, class D>
HWY_NOINLINE void make_planes(D d, const ScreenCells& cells, const std::uint32_t* items, std::size_t count, float tile_x,
                            float tile_y, int tile_width, int tile_height, Corners& corners, CellPlanes& planes) {
    const hn::RebindToUnsigned<D> du;
    const hn::RebindToSigned<D> di;
    using V = hn::Vec<D>;
    const std::size_t lanes = hn::Lanes(d);

    for (std::size_t i = 0; i < lanes; ++i) {
        const std::uint32_t item = items[i < count ? i : 0];
        std::memcpy(&corners.ids[4 * i], cells.corners(item).data(), 16);
        if constexpr (constant) corners.scalars[i] = cells.cell_scalars[item];
    }
    hn::Vec<decltype(du)> id[4];
    hn::LoadInterleaved4(du, corners.ids, id[0], id[1], id[2], id[3]);
    const auto odd = sort_corners(du, id);
    hn::StoreInterleaved4(id[0], id[1], id[2], id[3], du, corners.ids);
    const ScreenPoint* points = cells.points.data();
    for (std::size_t i = 0; i < lanes; ++i) {
        for (std::size_t k = 0; k < 4; ++k) std::memcpy(&corners.points[k][4 * i], &points[corners.ids[4 * i + k]], 16);
    }
    Vec3<V> p[4];
    V s[4];
    for (std::size_t k = 0; k < 4; ++k) hn::LoadInterleaved4(d, corners.points[k], p[k].x, p[k].y, p[k].n, s[k]);

    // Pixel centres in the box around the cell, inside the tile.
    const auto lowest_of = [](V a, V b, V c, V e) HWY_ATTR { return hn::Min(hn::Min(a, b), hn::Min(c, e)); };
    const auto highest_of = [](V a, V b, V c, V e) HWY_ATTR { return hn::Max(hn::Max(a, b), hn::Max(c, e)); };
    const V zero = hn::Zero(d), x0 = hn::Set(d, tile_x), y0 = hn::Set(d, tile_y);
    const V right_end = hn::Set(d, static_cast<float>(tile_width - 1)), bottom_end = hn::Set(d, static_cast<float>(tile_height - 1));
    const V far_left = hn::Set(d, -2.0F);
    const V left = hn::Min(hn::Max(hn::Ceil(hn::Sub(lowest_of(p[0].x, p[1].x, p[2].x, p[3].x), x0)), zero), right_end);
    const V right = hn::Max(hn::Min(hn::Floor(hn::Sub(highest_of(p[0].x, p[1].x, p[2].x, p[3].x), x0)), right_end), far_left);
    const V top = hn::Min(hn::Max(hn::Ceil(hn::Sub(lowest_of(p[0].y, p[1].y, p[2].y, p[3].y), y0)), zero), bottom_end);
    const V bottom = hn::Max(hn::Min(hn::Floor(hn::Sub(highest_of(p[0].y, p[1].y, p[2].y, p[3].y), y0)), bottom_end), far_left);
    const auto one = hn::Set(di, 1);
    const auto left_pixel = hn::ConvertTo(di, left), top_pixel = hn::ConvertTo(di, top);
    hn::Store(left_pixel, di, planes.left);
    hn::Store(top_pixel, di, planes.top);
    hn::Store(hn::Add(left_pixel, hn::Mul(top_pixel, hn::Set(di, tile_side))), di, planes.first_pixel);
    hn::Store(hn::Add(hn::Sub(hn::ConvertTo(di, right), left_pixel), one), di, planes.width);
    hn::Store(hn::Add(hn::Sub(hn::ConvertTo(di, bottom), top_pixel), one), di, planes.height);

    const V first_x = hn::Add(x0, left), first_y = hn::Add(y0, top);
    hn::Store(hn::Sub(highest_of(p[0].n, p[1].n, p[2].n, p[3].n), p[0].n), d, planes.nearest);
    hn::Store(hn::Sub(lowest_of(p[0].n, p[1].n, p[2].n, p[3].n), p[0].n), d, planes.farthest);
    hn::Store(p[0].n, d, planes.anchor);
    hn::Store(hn::Add(p[0].n, hn::Set(d, cells.view.base_nearness)), d, planes.base);

    // The faces: the one opposite to corner k, its corners in the order of their numbers.
    static constexpr int face[4][3]{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    const Vec3<V> edge[3]{minus(p[1], p[0]), minus(p[2], p[0]), minus(p[3], p[0])};
    Vec3<V> normal[4];
    normal[0] = cross(minus(p[2], p[1]), minus(p[3], p[1]));
    normal[1] = cross(edge[1], edge[2]);
    normal[2] = cross(edge[0], edge[2]);
    normal[3] = cross(edge[0], edge[1]);
    // A face seen edge-on, but for the rounding of its corners, tells inside from outside, no nearness: a step at its line. Rays that run
    // in it, and along edges where several meet, belong to the one cell that holds the ray a little beside: all steps are moved alike,
    // by more than that rounding, in a direction that no mesh prefers.
    const float aside = 2.5e-7F * static_cast<float>(HWY_MAX(cells.view.width, cells.view.height));  // pixels
    auto front_faces = hn::Zero(du);
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3<V>& n = normal[k];
        const Vec3<V>& anchor = p[face[k][0]];
        const Vec3<V> e = minus(p[face[k][1]], anchor), g = minus(p[face[k][2]], anchor);
        const V reach = hn::Add(hn::Add(hn::Abs(e.x), hn::Abs(e.y)), hn::Add(hn::Abs(g.x), hn::Abs(g.y)));
        const V away_from_middle = hn::Add(hn::Add(hn::Abs(anchor.x), hn::Abs(anchor.y)), reach);
        // Twice the area is good to 4 products of an edge and half a unit in the last place of a corner.
        const auto edge_on = hn::Le(hn::Abs(n.n), hn::Mul(hn::Mul(reach, away_from_middle), hn::Set(d, 2.4e-7F)));
        // No slope beyond 1e20: then all products below are finite.
        const V least = fused(hn::Add(hn::Abs(n.x), hn::Abs(n.y)), hn::Set(d, 1e-20F), hn::Set(d, 1e-30F));
        const V area = hn::IfThenElse(edge_on, least, hn::Max(hn::Abs(n.n), least));
        const auto sign = hn::And(hn::BitCast(du, n.n), hn::Set(du, 0x80000000U));
        const V inverse = hn::Div(hn::Set(d, -1.0F), hn::BitCast(d, hn::Or(hn::BitCast(du, area), sign)));
        const V slope_x = hn::Mul(n.x, inverse), slope_y = hn::Mul(n.y, inverse);
        const V from_x = hn::Add(hn::Sub(first_x, anchor.x), hn::IfThenElseZero(edge_on, hn::Set(d, 0.79F * aside)));
        const V from_y = hn::Add(hn::Sub(first_y, anchor.y), hn::IfThenElseZero(edge_on, hn::Set(d, 0.61F * aside)));
        const V at_first = fused(slope_x, from_x, hn::Mul(slope_y, from_y));
        hn::Store(k == 0 ? hn::Add(at_first, edge[0].n) : at_first, d, planes.nearness[k]);
        hn::Store(slope_x, d, planes.slope_x[k]);
        hn::Store(slope_y, d, planes.slope_y[k]);
        // Corners in cell order turn positively around the normal of the face opposite to an even corner, seen from inside.
        const auto negative = hn::Ne(sign, hn::Zero(du));
        const auto bit = hn::Set(du, 1U << k), zero_bits = hn::Zero(du);
        const auto away = hn::Xor(negative, odd);
        front_faces = hn::Or(front_faces, k % 2 == 0 ? hn::IfThenElse(away, bit, zero_bits) : hn::IfThenElse(away, zero_bits, bit));
    }
    hn::Store(front_faces, du, planes.front_faces);

    if constexpr (constant) {
        hn::Store(hn::Load(d, corners.scalars), d, planes.first_scalar);
    } else {
        // F = (s − s₀)/depth is affine in x, y and nearness: three edges give its three slopes.
        V f[3];
        for (std::size_t k = 0; k < 3; ++k) {
            f[k] = hn::Sub(s[k + 1], s[0]);
            if constexpr (perspective) f[k] = hn::Mul(f[k], hn::Add(p[k + 1].n, hn::Set(d, cells.view.base_nearness)));
        }
        const V volume = fused(edge[0].x, normal[1].x, fused(edge[0].y, normal[1].y, hn::Mul(edge[0].n, normal[1].n)));
        const auto solid = hn::Gt(hn::Abs(volume), hn::Set(d, 1e-30F));
        const V per_volume = hn::IfThenElseZero(solid, hn::Div(hn::Set(d, 1.0F), hn::IfThenElse(solid, volume, hn::Set(d, 1.0F))));
        // normal[1] = e₂×e₃, normal[2] = e₁×e₃, normal[3] = e₁×e₂
        const auto slope = [&](V n1, V n2, V n3) HWY_ATTR {
            const V sum = fused(f[0], n1, fused(hn::Neg(f[1]), n2, hn::Mul(f[2], n3)));
            return hn::Min(hn::Max(hn::Mul(sum, per_volume), hn::Set(d, -1e30F)), hn::Set(d, 1e30F));
        };
        const V sx = slope(normal[1].x, normal[2].x, normal[3].x), sy = slope(normal[1].y, normal[2].y, normal[3].y);
        hn::Store(sx, d, planes.scalar_x);
        hn::Store(sy, d, planes.scalar_y);
        hn::Store(slope(normal[1].n, normal[2].n, normal[3].n), d, planes.scalar_n);
        hn::Store(fused(sx, hn::Sub(first_x, p[0].x), hn::Mul(sy, hn::Sub(first_y, p[0].y))), d, planes.scalar);
        hn::Store(s[0], d, planes.first_scalar);
        hn::Store(lowest_of(s[0], s[1], s[2], s[3]), d, planes.lowest);
        hn::Store(highest_of(s[0], s[1], s[2], s[3]), d, planes.highest);
    }
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
