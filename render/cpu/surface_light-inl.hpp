// SPDX-License-Identifier: BSD-3-Clause
//
// The light of places on isosurfaces (reflection-inl.hpp), gathered from the fragments of a tile. Included once per instruction set, behind
// Highway; private to kernels.cpp.
#if defined(CELLPROJ_SURFACE_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_SURFACE_LIGHT_INL
#undef CELLPROJ_SURFACE_LIGHT_INL
#else
#define CELLPROJ_SURFACE_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Places where rays meet isosurfaces.
struct SurfaceHits {
    static constexpr std::size_t capacity = 1024;
    using List = float[capacity + CellPlanes::columns];

    HWY_ALIGN List gradient[3];
    HWY_ALIGN List color[3];   // of the side that is seen, associated
    HWY_ALIGN List opacity;
    HWY_ALIGN std::int32_t pixel[capacity + CellPlanes::columns];  // x + tile_side·y
    HWY_ALIGN float light[4 * (capacity + CellPlanes::columns)];   // for shade_hits to fill: associated colour and opacity
    std::size_t count = 0;
};

// From the places seen in these pixels to the eye.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> to_eye(D d, const ScreenCells& cells, float tile_x, float tile_y, const std::int32_t* pixels) {
    const hn::RebindToSigned<D> di;
    const ScreenSurfaces& surfaces = *cells.surfaces;
    if (!cells.view.perspective) return direction(d, -surfaces.forward);
    const auto pixel = hn::Load(di, pixels);
    const V unit_length = hn::Set(d, cells.view.unit_per_pixel);
    const V x = hn::Mul(hn::Add(hn::ConvertTo(d, hn::And(pixel, hn::Set(di, tile_side - 1))), hn::Set(d, tile_x)), unit_length);
    const V y = hn::Mul(hn::Add(hn::ConvertTo(d, hn::ShiftRight<5>(pixel)), hn::Set(d, tile_y)), unit_length);
    const Direction<V> right = direction(d, surfaces.right), down = direction(d, surfaces.down), forward = direction(d, surfaces.forward);
    const Direction<V> ray{hn::MulAdd(x, right.x, hn::MulAdd(y, down.x, forward.x)), hn::MulAdd(x, right.y, hn::MulAdd(y, down.y, forward.y)),
                           hn::MulAdd(x, right.z, hn::MulAdd(y, down.z, forward.z))};
    return scaled(ray, hn::Div(hn::Set(d, -1.0F), hn::Sqrt(dot(ray, ray))));  // at least as long as the axis: 1
}

// The light of all hits. (tile_x, tile_y): the tile's first pixel centre.
template <class D>
HWY_NOINLINE void shade_hits(D d, const ScreenCells& cells, float tile_x, float tile_y, SurfaceHits& hits) {
    using V = hn::Vec<D>;
    const ScreenSurfaces& surfaces = *cells.surfaces;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < lanes; ++i) {  // the last vector may be part empty
        for (int k = 0; k < 3; ++k) hits.gradient[k][hits.count + i] = hits.color[k][hits.count + i] = 0.0F;
        hits.opacity[hits.count + i] = 0.0F;
        hits.pixel[hits.count + i] = 0;
    }
    for (std::size_t begin = 0; begin < hits.count; begin += lanes) {
        const V one = hn::Set(d, 1.0F), opacity = hn::Load(d, hits.opacity + begin);
        V sum[3] = {one, one, one};
        if (surfaces.shading != SurfaceShading::unlit) {
            const Direction<V> gradient{hn::Load(d, hits.gradient[0] + begin), hn::Load(d, hits.gradient[1] + begin),
                                        hn::Load(d, hits.gradient[2] + begin)};
            const Direction<V> eye = to_eye(d, cells, tile_x, tile_y, hits.pixel + begin);
            reflect(d, surfaces.lighting, gradient, eye, sum);
        }
        for (int channel = 0; channel < 3; ++channel)
            sum[channel] = hn::Mul(sum[channel], hn::Load(d, hits.color[channel] + begin));
        hn::StoreInterleaved4(sum[0], sum[1], sum[2], opacity, d, hits.light + 4 * begin);
    }
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
