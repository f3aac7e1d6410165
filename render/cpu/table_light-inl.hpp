// SPDX-License-Identifier: BSD-3-Clause
//
// The light of segments by the methods without pieces: classify/sampled_methods.cpp, mean_tables.cpp and preintegration_table.cpp
// for as many segments at once as a vector has lanes, in float32. Depths are cut off at 1e30, which is as opaque as can be, so that
// no product is infinite times 0. Included once per instruction set, behind Highway; private to the files of kernels.
#if defined(CELLPROJ_TABLE_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_TABLE_LIGHT_INL
#undef CELLPROJ_TABLE_LIGHT_INL
#else
#define CELLPROJ_TABLE_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> scaled(D d, const LightOf<V>& light, V factor) {
    (void)d;
    return {hn::Mul(light.r, factor), hn::Mul(light.g, factor), hn::Mul(light.b, factor), hn::Mul(light.opacity, factor)};
}

// a + b·weight
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> plus(D d, const LightOf<V>& a, const LightOf<V>& b, V weight) {
    (void)d;
    return {hn::MulAdd(b.r, weight, a.r), hn::MulAdd(b.g, weight, a.g), hn::MulAdd(b.b, weight, a.b),
            hn::MulAdd(b.opacity, weight, a.opacity)};
}

// Linear interpolation as texture units do it (classify/table_lookup.hpp). Fractions 0..1.
template <std::size_t Axes, class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> texel_at(D d, const MethodTables& tables, const V (&fractions)[Axes]) {
    const hn::RebindToSigned<D> di;
    using VI = hn::Vec<decltype(di)>;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
    VI first = hn::Zero(di);
    V rest[Axes];
    std::int32_t stride[Axes];
    for (std::size_t axis = 0; axis < Axes; ++axis) {
        stride[axis] = axis == 0 ? 4 : stride[axis - 1] * tables.size;
        const V place = hn::Mul(hn::Min(hn::Max(fractions[axis], zero), one), hn::Set(d, static_cast<float>(tables.size - 1)));
        const VI texel = hn::Min(hn::ConvertTo(di, place), hn::Set(di, tables.size - 2));
        rest[axis] = hn::Sub(place, hn::ConvertTo(d, texel));
        first = hn::Add(first, hn::Mul(texel, hn::Set(di, stride[axis])));
    }
    LightOf<V> sum{zero, zero, zero, zero};
    for (std::size_t corner = 0; corner < std::size_t{1} << Axes; ++corner) {
        std::int32_t offset = 0;
        V weight = one;
        for (std::size_t axis = 0; axis < Axes; ++axis) {
            const bool next = (corner >> axis & 1U) != 0;
            if (next) offset += stride[axis];
            weight = hn::Mul(weight, next ? rest[axis] : hn::Sub(one, rest[axis]));
        }
        const float* texels = tables.texels + offset;
        const LightOf<V> texel{hn::GatherIndex(d, texels, first), hn::GatherIndex(d, texels + 1, first),
                               hn::GatherIndex(d, texels + 2, first), hn::GatherIndex(d, texels + 3, first)};
        sum = plus(d, sum, texel, weight);
    }
    return sum;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V depth_of(D d, V extinction, V length) {
    return hn::Min(hn::Mul(extinction, length), hn::Set(d, 1e30F));
}

// classify/optics.hpp, of (emission, extinction).
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> homogeneous_light(D d, const LightOf<V>& medium, V length) {
    const V depth = depth_of(d, medium.opacity, length), transmitted = mean_transmittance(d, depth);
    LightOf<V> light = scaled(d, medium, hn::Mul(length, transmitted));
    light.opacity = hn::Min(hn::Mul(depth, transmitted), hn::Set(d, 1.0F));
    return light;
}

// Form::steps. The middles of equal parts.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> stepped_light(D d, const MethodTables& tables, V s_f, V s_b, V length) {
    const V zero = hn::Zero(d), range = hn::Sub(s_b, s_f);
    const float share = 1.0F / static_cast<float>(tables.steps);
    const V step_length = hn::Mul(length, hn::Set(d, share));
    LightOf<V> light{zero, zero, zero, zero};
    V depth = zero;
    for (int step = 0; step < tables.steps; ++step) {
        const V middle[1]{hn::MulAdd(range, hn::Set(d, (static_cast<float>(step) + 0.5F) * share), s_f)};
        const LightOf<V> medium = texel_at(d, tables, middle);
        light = plus(d, light, homogeneous_light(d, medium, step_length), exp_of_minus(d, depth));
        depth = hn::Min(hn::Add(depth, depth_of(d, medium.opacity, step_length)), hn::Set(d, 1e30F));
    }
    light.opacity = opacity_of_depth(d, depth);
    return light;
}

// Of samples at both ends.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> light_of_ends(D d, const MethodTables& tables, V s_f, V s_b, V length) {
    const V half = hn::Set(d, 0.5F), one = hn::Set(d, 1.0F);
    const V front[1]{s_f}, back[1]{s_b};
    const LightOf<V> mean = plus(d, scaled(d, texel_at(d, tables, front), half), texel_at(d, tables, back), half);
    if (tables.form == MethodTables::Form::homogeneous) return homogeneous_light(d, mean, length);
    const V depth = depth_of(d, mean.opacity, length);
    if (tables.form == MethodTables::Form::stein) {
        const V opacity = opacity_of_depth(d, depth);
        LightOf<V> light = scaled(d, mean, opacity);
        light.opacity = opacity;
        return light;
    }
    // C·D: opaque from a depth of 1 on.
    const auto opaque = hn::Gt(depth, one);
    const V seen = hn::IfThenElse(opaque, hn::Div(one, hn::IfThenElse(opaque, mean.opacity, one)), length);
    LightOf<V> light = scaled(d, mean, seen);
    light.opacity = hn::Min(depth, one);
    return light;
}

// The light of segments: scalars 0..1, lengths ≥ 0 in scene units. No colour beyond 1e30.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> light_of_tables(D d, const MethodTables& tables, V s_f, V s_b, V any_length) {
    const V one = hn::Set(d, 1.0F), length = hn::Min(any_length, hn::Set(d, tables.longest));
    const V per_length = hn::Set(d, tables.per_length);
    LightOf<V> light;
    switch (tables.form) {
        case MethodTables::Form::steps:
            light = stepped_light(d, tables, s_f, s_b, length);
            break;
        case MethodTables::Form::mean_value: {
            const V ends[2]{s_f, s_b};
            light = homogeneous_light(d, texel_at(d, tables, ends), length);
            break;
        }
        case MethodTables::Form::mean_length: {
            const V ends[2]{s_f, s_b};
            const LightOf<V> texel = texel_at(d, tables, ends);
            const V factor = hn::Mul(length, per_length);
            const auto opaque = hn::Gt(hn::Mul(texel.opacity, factor), one);
            light = scaled(d, texel, hn::IfThenElse(opaque, hn::Div(one, hn::IfThenElse(opaque, texel.opacity, one)), factor));
            light.opacity = hn::Min(light.opacity, one);
            break;
        }
        case MethodTables::Form::effective: {
            const V place[3]{s_f, s_b, hn::Mul(hn::Log1p(d, hn::Mul(length, per_length)), hn::Set(d, tables.per_log_range))};
            light = homogeneous_light(d, texel_at(d, tables, place), length);
            break;
        }
        case MethodTables::Form::light: {
            const V place[3]{s_f, s_b, hn::Mul(length, per_length)};
            light = texel_at(d, tables, place);
            light.opacity = hn::Min(light.opacity, one);
            break;
        }
        default:
            light = light_of_ends(d, tables, s_f, s_b, length);
    }
    const V most = hn::Set(d, 1e30F);
    return {hn::Min(light.r, most), hn::Min(light.g, most), hn::Min(light.b, most), light.opacity};
}

// WVG91 §3.2 in one blending (classify/half_opacity.hpp).
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> half_opacity(D d, const LightOf<V>& cell) {
    const V one = hn::Set(d, 1.0F);
    LightOf<V> light = scaled(d, cell, hn::NegMulAdd(hn::Set(d, 0.5F), cell.opacity, one));
    light.opacity = hn::Mul(cell.opacity, hn::NegMulAdd(hn::Set(d, 0.25F), cell.opacity, one));
    return light;
}

// The light of segments as any method finds it. `constant`: s_f = s_b, as for fields on cells.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> shade(D d, const Shading& shading, bool constant, V s_f, V s_b, V length) {
    const LightOf<V> light = shading.tables ? light_of_tables(d, *shading.tables, s_f, s_b, length)
                             : constant     ? light_of_constants(d, *shading.pieces, s_f, length)
                                            : light_of_segments(d, *shading.pieces, s_f, s_b, length);
    return shading.half_opacity ? half_opacity(d, light) : light;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
