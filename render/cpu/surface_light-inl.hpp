// SPDX-License-Identifier: BSD-3-Clause
//
// classify/lighting.cpp for as many places on isosurfaces at once as a vector has lanes, in float32. Included once per instruction set,
// behind Highway; private to kernels.cpp.
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

template <class V>
struct Direction {
    V x, y, z;
};

template <class D>
HWY_INLINE Direction<hn::Vec<D>> direction(D d, const glm::vec3& v) {
    return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}

template <class V>
HWY_INLINE V dot(const Direction<V>& a, const Direction<V>& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <class V>
HWY_INLINE Direction<V> scaled(const Direction<V>& a, V factor) {
    return {hn::Mul(a.x, factor), hn::Mul(a.y, factor), hn::Mul(a.z, factor)};
}

// Of unit length where `some`; relative to its largest part first, so that no square leaves float32's range.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> unit(D d, const Direction<V>& a, hn::Mask<D>& some) {
    const V largest = hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z)));
    const V one = hn::Set(d, 1.0F);
    some = hn::Gt(largest, hn::Set(d, 1e-37F));
    const Direction<V> b = scaled(a, hn::Div(one, hn::IfThenElse(some, largest, one)));
    return scaled(b, hn::Div(one, hn::Sqrt(hn::Max(dot(b, b), hn::Set(d, 1e-30F)))));
}

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

// What a light adds to each channel, as shares of the surface's colour.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void add_light(D d, const SurfaceLighting::Light& light, float exponent, const Direction<V>& n, const Direction<V>& eye,
                          V (&sum)[3]) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
    const Direction<V> l1 = light.headlight ? eye : direction(d, light.towards);
    const V facing = dot(n, l1);
    V cosine = facing;  // with the middle between the light and the eye
    if (!light.headlight) {
        hn::Mask<D> has_middle;
        const Direction<V> l2 = unit(d, Direction<V>{hn::Add(l1.x, eye.x), hn::Add(l1.y, eye.y), hn::Add(l1.z, eye.z)}, has_middle);
        cosine = hn::IfThenElseZero(has_middle, dot(n, l2));
    }
    cosine = hn::Min(cosine, one);
    const auto shines = hn::Gt(cosine, hn::Set(d, 1e-30F));
    const V power = hn::Mul(hn::Log(d, hn::IfThenElse(shines, cosine, one)), hn::Set(d, exponent));
    const V highlight = hn::IfThenElseZero(shines, hn::Exp(d, hn::Max(power, hn::Set(d, -100.0F))));
    const auto lit = hn::Gt(facing, zero);
    const V diffuse = hn::IfThenElseZero(lit, hn::Min(facing, one)), specular = hn::IfThenElseZero(lit, hn::Min(highlight, one));
    for (int channel = 0; channel < 3; ++channel)
        sum[channel] = hn::MulAdd(hn::Set(d, light.diffuse[channel]), diffuse,
                                  hn::MulAdd(hn::Set(d, light.specular[channel]), specular, sum[channel]));
}

// What of its colour a place with this gradient reflects, by channel. `eye` of length 1.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void reflect(D d, const ScreenSurfaces& surfaces, const Direction<V>& gradient, const Direction<V>& eye, V (&shares)[3]) {
    const V one = hn::Set(d, 1.0F);
    hn::Mask<D> some;
    Direction<V> n = scaled(unit(d, gradient, some), hn::Set(d, -1.0F));  // the front side is that of the lower scalars
    if (surfaces.lighting.two_sided) n = scaled(n, hn::CopySign(one, dot(n, eye)));
    for (int channel = 0; channel < 3; ++channel) shares[channel] = hn::Set(d, surfaces.lighting.ambient[channel]);
    for (const SurfaceLighting::Light& light : surfaces.lighting.lights) add_light(d, light, surfaces.lighting.exponent, n, eye, shares);
    for (V& channel : shares) channel = hn::IfThenElse(some, channel, one);  // without a normal there is nothing to shade
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
            reflect(d, surfaces, gradient, to_eye(d, cells, tile_x, tile_y, hits.pixel + begin), sum);
        }
        for (int channel = 0; channel < 3; ++channel)
            sum[channel] = hn::Mul(sum[channel], hn::Load(d, hits.color[channel] + begin));
        hn::StoreInterleaved4(sum[0], sum[1], sum[2], opacity, d, hits.light + 4 * begin);
    }
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
