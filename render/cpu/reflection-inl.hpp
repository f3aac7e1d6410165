// SPDX-License-Identifier: BSD-3-Clause
//
// classify/lighting.cpp for as many places on isosurfaces or in lit media at once as a vector has lanes, in float32. Included once per instruction set,
// behind Highway; private to render/cpu.
#if defined(CELLPROJ_REFLECTION_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_REFLECTION_INL
#undef CELLPROJ_REFLECTION_INL
#else
#define CELLPROJ_REFLECTION_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

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

// What of its colour a surface of this gradient sends to the eye, for each channel. `eye`: of unit length, towards it.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void reflect(D d, const SurfaceLighting& lighting, const Direction<V>& gradient, const Direction<V>& eye, V (&sum)[3]) {
    const V one = hn::Set(d, 1.0F);
    hn::Mask<D> some;
    Direction<V> n = scaled(unit(d, gradient, some), hn::Set(d, -1.0F));  // the front side is that of the lower scalars
    if (lighting.two_sided) n = scaled(n, hn::CopySign(one, dot(n, eye)));
    for (int channel = 0; channel < 3; ++channel) sum[channel] = hn::Set(d, lighting.ambient[channel]);
    for (const SurfaceLighting::Light& light : lighting.lights) add_light(d, light, lighting.exponent, n, eye, sum);
    for (V& channel : sum) channel = hn::IfThenElse(some, channel, one);  // without a normal there is nothing to shade
}

// What of its light a place in a medium sends to the eye, by a gradient over the weak one.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void lit_share(D d, const SurfaceLighting& lighting, const Direction<V>& gradient, const Direction<V>& eye, V (&share)[3]) {
    reflect(d, lighting, gradient, eye, share);
    const V one = hn::Set(d, 1.0F), square = hn::Min(dot(gradient, gradient), hn::Set(d, 1e30F));
    const V weight = hn::Div(square, hn::Add(one, square));
    for (V& channel : share) channel = hn::MulAdd(weight, hn::Sub(channel, one), one);
}

// Where on the way through a homogeneous segment of that opacity its light comes from in the mean, 0..1: with the optical depth D,
// 1/D − 1/(e^D − 1). Light that grows linearly along the way is, in the mean, what it is there.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V mean_place_of_light(D d, V opacity) {
    const V one = hn::Set(d, 1.0F), passed = hn::Max(hn::Sub(one, opacity), hn::Set(d, 1e-30F));
    const V depth = hn::Neg(hn::Log(d, passed));
    const V series = hn::MulAdd(depth, hn::MulAdd(hn::Mul(depth, depth), hn::Set(d, 1.0F / 720), hn::Set(d, -1.0F / 12)), hn::Set(d, 0.5F));
    const auto thin = hn::Lt(depth, hn::Set(d, 0.5F));  // D⁵/30240 is left out: 1e-6
    const V place = hn::Sub(hn::Div(one, hn::IfThenElse(thin, one, depth)), hn::Div(passed, hn::IfThenElse(thin, one, opacity)));
    return hn::IfThenElse(thin, series, place);
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
