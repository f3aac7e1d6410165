// SPDX-License-Identifier: BSD-3-Clause
//
// classify/piece_walk.cpp for as many segments at once as a vector has lanes, in float32: the light of segments by the pieces of
// the transfer function. Included once per instruction set, behind Highway; private to the files of kernels.
//
// Where this differs from the float64 model: in the density model `integral` takes the opacity of parts that are no deeper than 1 times
// the colour where their light starts in the mean (mean_place), without quadrature.
#if defined(CELLPROJ_SEGMENT_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_SEGMENT_LIGHT_INL
#undef CELLPROJ_SEGMENT_LIGHT_INL
#else
#define CELLPROJ_SEGMENT_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct LightOf {
    V r, g, b, opacity;
};

// e^(−x), x ≥ 0; 0 to float32's accuracy from x = 86 on. Relative error 2e-7: 2^f on −½ .. ½ by Cephes' polynomial.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V exp_of_minus(D d, V x) {
    const hn::RebindToSigned<D> di;
    const V y = hn::Max(hn::Mul(x, hn::Set(d, -1.44269504F)), hn::Set(d, -125.0F));
    const auto k = hn::NearestInt(y);
    const V f = hn::Sub(y, hn::ConvertTo(d, k));
    V p = hn::Set(d, 1.535336188e-4F);
    p = hn::MulAdd(p, f, hn::Set(d, 1.339887440e-3F));
    p = hn::MulAdd(p, f, hn::Set(d, 9.618437357e-3F));
    p = hn::MulAdd(p, f, hn::Set(d, 5.550332471e-2F));
    p = hn::MulAdd(p, f, hn::Set(d, 2.402264791e-1F));
    p = hn::MulAdd(p, f, hn::Set(d, 6.931472028e-1F));
    p = hn::MulAdd(p, f, hn::Set(d, 1.0F));
    return hn::BitCast(d, hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(k)));
}

// Depths up to here are shallow: short series serve, and differences would lose digits.
inline constexpr float shallow_depth = 0.125F;

// (1 − e^(−D))/D for D ≤ shallow_depth: the next term is D⁵/720 < 5e-8.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V mean_transmittance_shallow(D d, V depth) {
    V series = hn::NegMulAdd(hn::Set(d, 1.0F / 120), depth, hn::Set(d, 1.0F / 24));
    series = hn::NegMulAdd(series, depth, hn::Set(d, 1.0F / 6));
    series = hn::NegMulAdd(series, depth, hn::Set(d, 0.5F));
    return hn::NegMulAdd(series, depth, hn::Set(d, 1.0F));
}

// (1 − e^(−D))/D
template <class D, class V = hn::Vec<D>>
HWY_INLINE V mean_transmittance(D d, V depth) {
    const V series = mean_transmittance_shallow(d, depth);
    const auto shallow = hn::Le(depth, hn::Set(d, shallow_depth));
    if (hn::AllTrue(d, shallow)) return series;
    const V safe = hn::Max(depth, hn::Set(d, shallow_depth));
    const V whole = hn::Div(hn::Sub(hn::Set(d, 1.0F), exp_of_minus(d, safe)), safe);
    return hn::IfThenElse(shallow, series, whole);
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V opacity_of_depth(D d, V depth) {
    return hn::Min(hn::Mul(depth, mean_transmittance(d, depth)), hn::Set(d, 1.0F));
}

// Entries of a list of a table per lane: one load where all lanes want the same one, as most do; of tables that fit into two vectors, which
// most do, a permutation of these; else a gather.
template <class D>
class PerLane {
public:
    using DI = hn::RebindToSigned<D>;
    using Index = hn::Vec<DI>;

    HWY_INLINE PerLane(D d, const PieceArrays& table, Index index) : d_(d), index_(index), first_(hn::GetLane(index)) {
        const DI di;
        const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
        same_ = hn::AllTrue(di, hn::Eq(index, hn::Set(di, first_)));
        tables_ = (table.count + lanes - 1) / lanes;
    }
    HWY_INLINE hn::Vec<D> of(const std::vector<float>& list) const {
        if (same_) return hn::Set(d_, list[static_cast<std::size_t>(first_)]);
        if (tables_ > 2) return hn::GatherIndex(d_, list.data(), index_);
        return permuted(list);
    }
    // The same for tables that fit into two vectors, however the lanes differ.
    HWY_INLINE hn::Vec<D> permuted(const std::vector<float>& list) const {
        const DI di;
        const auto lanes = static_cast<std::int32_t>(hn::Lanes(d_));
        const auto first = hn::LoadU(d_, list.data());
        const auto place = hn::IndicesFromVec(d_, hn::And(index_, hn::Set(di, lanes - 1)));
        if (tables_ == 1) return hn::TableLookupLanes(first, place);
        const auto second = hn::LoadU(d_, list.data() + lanes);
#if HWY_TARGET == HWY_AVX3
        return hn::Vec<D>{_mm512_permutex2var_ps(first.raw, index_.raw, second.raw)};  // Highway 1.0 has no name for it
#else
        const auto low = hn::TableLookupLanes(first, place), high = hn::TableLookupLanes(second, place);
        return hn::IfThenElse(hn::RebindMask(d_, hn::Lt(index_, hn::Set(di, lanes))), low, high);
#endif
    }

private:
    D d_;
    Index index_;
    std::int32_t first_;
    bool same_;
    std::int32_t tables_;  // vectors that hold a list
};

// The last piece that begins at or below s, per lane.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> pieces_of(D d, const PieceArrays& table, V s) {
    const hn::RebindToSigned<D> di;
    using VI = hn::Vec<decltype(di)>;
    // Of tables that are permuted, by halving.
    constexpr auto longest = static_cast<std::int32_t>(2 * hn::MaxLanes(D()));
    if (longest >= 32 && table.count <= longest) {
        VI piece = hn::Zero(di);
        for (std::int32_t step = table.count > longest / 2 ? longest / 2 : longest / 4; step > 0; step /= 2) {
            const VI tried = hn::Add(piece, hn::Set(di, step));
            const auto reached = hn::RebindMask(di, hn::Ge(s, PerLane<D>(d, table, tried).permuted(table.begin)));
            piece = hn::IfThenElse(reached, tried, piece);
        }
        return piece;
    }
    const VI bin = hn::ConvertTo(di, hn::Mul(s, hn::Set(d, table.bin_count)));
    VI first = hn::GatherIndex(di, table.first.data(), bin), last = hn::GatherIndex(di, table.last.data(), bin);
    while (!hn::AllTrue(di, hn::Eq(first, last))) {
        const VI middle = hn::ShiftRight<1>(hn::Add(hn::Add(first, last), hn::Set(di, 1)));
        const auto below = hn::RebindMask(di, hn::Lt(s, hn::GatherIndex(d, table.begin.data(), middle)));
        last = hn::IfThenElse(below, hn::Sub(middle, hn::Set(di, 1)), last);
        first = hn::IfThenElse(below, first, middle);
    }
    return first;
}

// Up to this depth the series below serve.
inline constexpr float mean_place_depth = 1.0F;

// Where the light of a segment starts in the mean, from its front, 0, to its back, 1, in the density model: the light is the opacity
// times the colour there, as colour is linear in a piece. With D(t) = D·((1 − r)·t + r·t²), r = (τ_b − τ_f)/(τ_b + τ_f),
//   ∫ t·e^(−D(t)) dD(t) / (1 − e^(−D))
//     = 1/2 + r/6 + D·(r²/60 − 1/12) + D²·(r³/840 − r/360) + D³·(1/720 − r²/2520 + r⁴/15120) + D⁴·(r/15120 − r³/30240 + …)
//       + D⁵·(−1/30240 + r²/100800 − …) + D⁶·(−r/604800 + …).
// What is left out is less than 2e-6 up to mean_place_depth, and of shallow depths, which take three terms, 3e-6.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V mean_place(D d, V depth, V r) {
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const V square = hn::Mul(r, r);
    const V slope = hn::MulAdd(hn::Mul(r, depth), set(-1.0F / 360), hn::MulAdd(square, set(1.0F / 60), set(-1.0F / 12)));
    const V few_terms = hn::MulAdd(slope, depth, hn::MulAdd(r, set(1.0F / 6), set(0.5F)));
    const auto shallow = hn::Le(depth, set(shallow_depth));
    if (hn::AllTrue(d, shallow)) return few_terms;
    V mean = hn::MulAdd(square, set(1.0F / 100800), set(-1.0F / 30240));
    mean = hn::MulAdd(mean, depth, hn::Mul(r, hn::MulAdd(square, set(-1.0F / 30240), set(1.0F / 15120))));
    mean = hn::MulAdd(mean, depth, hn::MulAdd(square, hn::MulAdd(square, set(1.0F / 15120), set(-1.0F / 2520)), set(1.0F / 720)));
    mean = hn::MulAdd(mean, depth, hn::Mul(r, hn::MulAdd(square, set(1.0F / 840), set(-1.0F / 360))));
    mean = hn::MulAdd(mean, depth, hn::MulAdd(square, set(1.0F / 60), set(-1.0F / 12)));
    mean = hn::MulAdd(mean, depth, hn::MulAdd(r, set(1.0F / 6), set(0.5F)));
    return hn::IfThenElse(shallow, few_terms, mean);  // the same for a lane, whatever the others are
}

template <class D, class V = hn::Vec<D>>
class Walk {
public:
    using DI = hn::RebindToSigned<D>;
    using VI = hn::Vec<DI>;
    using M = hn::Mask<D>;

    HWY_INLINE Walk(D d, const PieceArrays& table, V s_f, V s_b, V length)
        : d_(d), table_(table), from_(s_f), to_(s_b), range_(hn::Abs(hn::Sub(s_b, s_f))), length_(length),
          rising_(hn::Le(s_f, s_b)), red_(hn::Zero(d)), green_(hn::Zero(d)), blue_(hn::Zero(d)), depth_(hn::Zero(d)) {
        const M some = hn::Gt(range_, hn::Zero(d));
        per_range_ = hn::IfThenElseZero(some, hn::Div(hn::Set(d, 1.0F), hn::IfThenElse(some, range_, hn::Set(d, 1.0F))));
    }

    HWY_INLINE LightOf<V> light() {
        const DI di;
        const V deepest = hn::Set(d_, static_cast<float>(table_.limits.deepest));
        const VI step = hn::IfThenElse(hn::RebindMask(di, rising_), hn::Set(di, 1), hn::Set(di, -1));
        VI piece = pieces_of(d_, table_, from_);
        V s = from_;
        M active = hn::Ge(length_, hn::Zero(d_));
        for (int parts = 1;; ++parts) {
            const PerLane<D> lanes(d_, table_, piece);
            const V begin = lanes.of(table_.begin), end = lanes.of(table_.end);
            const V stop = hn::IfThenElse(rising_, hn::Min(end, to_), hn::Max(begin, to_));
            add_part(lanes, begin, s, stop, active);
            active = hn::And(active, hn::And(hn::Ne(stop, to_), hn::Lt(depth_, deepest)));
            if (hn::AllFalse(d_, active)) break;
            piece = hn::IfThenElse(hn::RebindMask(di, active), hn::Add(piece, step), piece);
            s = hn::IfThenElse(active, stop, s);
            if (table_.limits.takes_blocks() && parts >= 2) take_blocks(active, step, piece, s);
        }
        return {red_, green_, blue_, opacity_of_depth(d_, depth_)};
    }

private:
    // A part of a piece, t = 0 .. 1 along it: D(t) = depth·((1 − r)·t + r·t²).
    struct Part {
        V length, depth, r;
    };
    struct Weights {
        V front, back;  // of the colours at both ends
    };

    // Adds the rule's sums over t = begin .. begin + width.
    template <std::size_t N>
    HWY_INLINE void integrate(const Part& part, V begin, V width, const float (&position)[N], const float (&weight)[N],
                              Weights& sum) const {
        const V one = hn::Set(d_, 1.0F), slope = hn::Sub(one, part.r), two_r = hn::Add(part.r, part.r);
        for (std::size_t i = 0; i < N; ++i) {
            const V t = hn::MulAdd(width, hn::Set(d_, position[i]), begin);
            const V behind = hn::MulAdd(hn::Mul(part.depth, t), hn::MulAdd(part.r, t, slope), depth_);
            const V q = table_.density ? hn::Mul(part.depth, hn::MulAdd(two_r, t, slope)) : part.length;
            const V light = hn::Mul(hn::Mul(q, exp_of_minus(d_, behind)), hn::Mul(width, hn::Set(d_, weight[i])));
            sum.back = hn::MulAdd(light, t, sum.back);
            sum.front = hn::MulAdd(light, hn::Sub(one, t), sum.front);
        }
    }

    // Gauss–Legendre on 0..1 (Abramowitz and Stegun, Table 25.4).
    HWY_INLINE Weights weights_of(const Part& part) const {
        static constexpr float position3[]{0.11270167F, 0.5F, 0.88729833F}, weight3[]{0.27777778F, 0.44444444F, 0.27777778F};
        static constexpr float position4[]{0.06943184F, 0.33000948F, 0.66999052F, 0.93056816F};
        static constexpr float weight4[]{0.17392742F, 0.32607258F, 0.32607258F, 0.17392742F};
        const V zero = hn::Zero(d_), one = hn::Set(d_, 1.0F);
        Weights sum{zero, zero};
        if (hn::AllTrue(d_, hn::Le(part.depth, hn::Set(d_, table_.three_point_depth)))) {
            integrate(part, zero, one, position3, weight3, sum);
            return sum;
        }
        const V step_depth = hn::Set(d_, static_cast<float>(table_.limits.step_depth));
        if (hn::AllTrue(d_, hn::Le(part.depth, step_depth))) {
            integrate(part, zero, one, position4, weight4, sum);
            return sum;
        }
        // Steps of equal optical depth: (1 − r)·t + r·t² = k/steps, solved without cancellation.
        const V steps = hn::Max(one, hn::Ceil(hn::Div(part.depth, step_depth)));
        const V slope = hn::Sub(one, part.r), deepest = hn::Set(d_, static_cast<float>(table_.limits.deepest));
        V begin = zero, k = one;
        for (;;) {
            const V share = hn::Min(one, hn::Div(k, steps));
            const V square = hn::MulAdd(slope, slope, hn::Mul(hn::Mul(hn::Set(d_, 4.0F), part.r), share));
            const V root = hn::Sqrt(hn::Max(zero, square));
            const V solved = hn::Min(one, hn::Div(hn::Add(share, share), hn::Add(slope, root)));
            const V end = hn::IfThenElse(hn::Lt(k, steps), solved, one);
            integrate(part, begin, hn::Max(zero, hn::Sub(end, begin)), position4, weight4, sum);
            begin = end;
            const M more = hn::And(hn::Lt(k, steps), hn::Lt(hn::MulAdd(part.depth, share, depth_), deepest));
            if (hn::AllFalse(d_, more)) return sum;
            k = hn::Add(k, one);
        }
    }

    // From s to `stop` inside a piece, for the lanes of `active`.
    HWY_INLINE void add_part(const PerLane<D>& piece, V piece_begin, V s, V stop, M active) {
        const V per_width = piece.of(table_.inverse_width);
        const V t0 = hn::Mul(hn::Sub(s, piece_begin), per_width), t1 = hn::Mul(hn::Sub(stop, piece_begin), per_width);
        const V tau_a = piece.of(table_.extinction[0]), tau_b = piece.of(table_.extinction[1]);
        const V one = hn::Set(d_, 1.0F), zero = hn::Zero(d_);
        const V tau0 = hn::MulAdd(tau_b, t0, hn::Mul(tau_a, hn::Sub(one, t0)));
        const V tau1 = hn::MulAdd(tau_b, t1, hn::Mul(tau_a, hn::Sub(one, t1)));
        const V share = hn::IfThenElse(hn::Gt(range_, zero), hn::Mul(hn::Abs(hn::Sub(stop, s)), per_range_), one);
        const V length = hn::IfThenElseZero(active, hn::Mul(length_, hn::Min(share, one)));
        const V tau = hn::Max(hn::Add(tau0, tau1), zero);
        const M absorbs = hn::Gt(tau, zero);
        const V depth = hn::Mul(hn::Mul(length, hn::Set(d_, 0.5F)), tau);
        const V r = hn::IfThenElseZero(absorbs, hn::Div(hn::Sub(tau1, tau0), hn::IfThenElse(absorbs, tau, one)));
        V at_end, at_begin;  // weights of the colours at both ends of the piece
        if (table_.mean_place && hn::AllTrue(d_, hn::Le(depth, hn::Set(d_, mean_place_depth)))) {
            const V seen = hn::Mul(exp_of_minus(d_, depth_), opacity_of_depth(d_, depth));
            at_end = hn::Mul(seen, hn::MulAdd(mean_place(d_, depth, r), hn::Sub(t1, t0), t0));
            at_begin = hn::Sub(seen, at_end);
        } else {
            Weights w = weights_of({length, depth, r});
            if (table_.density) {
                const V seen = hn::Mul(exp_of_minus(d_, depth_), opacity_of_depth(d_, depth));
                w.front = hn::Max(zero, hn::Sub(seen, w.back));
            }
            at_end = hn::MulAdd(w.front, t0, hn::Mul(w.back, t1));
            at_begin = hn::Sub(hn::Add(w.front, w.back), at_end);
        }
        red_ = hn::MulAdd(at_begin, piece.of(table_.color[0][0]), hn::MulAdd(at_end, piece.of(table_.color[1][0]), red_));
        green_ = hn::MulAdd(at_begin, piece.of(table_.color[0][1]), hn::MulAdd(at_end, piece.of(table_.color[1][1]), green_));
        blue_ = hn::MulAdd(at_begin, piece.of(table_.color[0][2]), hn::MulAdd(at_end, piece.of(table_.color[1][2]), blue_));
        depth_ = hn::Add(depth_, depth);
    }

    // The running integral of a channel between the begins of two pieces, > 0.
    HWY_INLINE V between(std::size_t channel, const PerLane<D>& a, const PerLane<D>& b) const {
        const V rounded = hn::Sub(b.of(table_.running[channel]), a.of(table_.running[channel]));
        return hn::Abs(hn::Add(rounded, hn::Sub(b.of(table_.lost[channel]), a.of(table_.lost[channel]))));
    }

    // The most whole pieces from `piece` on, by halving, that are thin enough to be taken together.
    HWY_INLINE void take_blocks(M active, VI step, VI& piece, V& s) {
        const DI di;
        const VI newest = hn::Set(di, table_.count - 1);
        const VI last = pieces_of(d_, table_, to_), one = hn::Set(di, 1), zero = hn::Zero(di);
        VI count = hn::IfThenElseZero(hn::RebindMask(di, active), hn::Mul(hn::Sub(last, piece), step));
        const auto rising = hn::RebindMask(di, rising_);
        while (!hn::AllFalse(di, hn::Gt(count, one))) {
            const VI begin = hn::Min(hn::IfThenElse(rising, piece, hn::Add(piece, one)), newest);
            const VI end = hn::Add(begin, hn::Mul(hn::Max(count, zero), step));
            const PerLane<D> a(d_, table_, begin), b(d_, table_, end);
            const V width = hn::Abs(hn::Sub(b.of(table_.begin), a.of(table_.begin)));
            const V scale = hn::Mul(length_, per_range_);  // ∫ ds → ∫ dx
            const V block_depth = hn::Mul(between(3, a, b), scale);
            const M take = hn::And(hn::And(hn::RebindMask(d_, hn::Gt(count, one)), hn::Gt(width, hn::Zero(d_))),
                                   hn::Le(block_depth, hn::Set(d_, static_cast<float>(table_.limits.block_depth))));
            if (!hn::AllFalse(d_, take)) {
                const V light = hn::IfThenElseZero(
                    take, hn::Mul(scale, hn::Mul(mean_transmittance(d_, block_depth), exp_of_minus(d_, depth_))));
                red_ = hn::MulAdd(light, between(0, a, b), red_);
                green_ = hn::MulAdd(light, between(1, a, b), green_);
                blue_ = hn::MulAdd(light, between(2, a, b), blue_);
                depth_ = hn::Add(depth_, hn::IfThenElseZero(take, block_depth));
                const auto taken = hn::RebindMask(di, take);
                const VI next = hn::Add(piece, hn::Mul(count, step));
                piece = hn::IfThenElse(taken, next, piece);
                // A walk down continues at the end of its next piece, which is the begin of the one above.
                s = hn::IfThenElse(take, b.of(table_.begin), s);
                count = hn::IfThenElse(taken, zero, count);
            }
            count = hn::ShiftRight<1>(count);
        }
    }

    D d_;
    const PieceArrays& table_;
    V from_, to_, range_, length_;
    M rising_;
    V per_range_;
    V red_, green_, blue_;
    V depth_;  // so far
};

// The last piece that begins at or below s.
HWY_INLINE std::int32_t piece_of(const PieceArrays& table, float s) {
    const auto bin = static_cast<std::size_t>(s * table.bin_count);
    std::int32_t first = table.first[bin], last = table.last[bin];
    while (first < last) {
        const std::int32_t middle = (first + last + 1) / 2;
        if (s < table.begin[static_cast<std::size_t>(middle)]) {
            last = middle - 1;
        } else {
            first = middle;
        }
    }
    return first;
}

// What Walk gives in the density model, for segments inside one piece that are no deeper than mean_place_depth. Cells are small and transfer
// functions have few pieces: this is most of the work, and nothing but arithmetic.
template <class D>
class LightInPiece {
public:
    using V = hn::Vec<D>;

    HWY_INLINE LightInPiece(D d, const PieceArrays& table, std::int32_t piece)
        : d_(d), begin_(hn::Set(d, table.begin[at(piece)])), per_width_(hn::Set(d, table.inverse_width[at(piece)])),
          extinction_(d, table.extinction[0], table.extinction[1], at(piece)), red_(d, table.color[0][0], table.color[1][0], at(piece)),
          green_(d, table.color[0][1], table.color[1][1], at(piece)), blue_(d, table.color[0][2], table.color[1][2], at(piece)) {}
    // A piece of its own for each lane.
    HWY_INLINE LightInPiece(D d, const PieceArrays& table, const PerLane<D>& piece)
        : d_(d), begin_(piece.of(table.begin)), per_width_(piece.of(table.inverse_width)), extinction_(piece, table.extinction[0], table.extinction[1]),
          red_(piece, table.color[0][0], table.color[1][0]), green_(piece, table.color[0][1], table.color[1][1]),
          blue_(piece, table.color[0][2], table.color[1][2]) {}

    // Right where `depth` is at most mean_place_depth.
    HWY_INLINE LightOf<V> operator()(V s_f, V s_b, V length, V& depth) const {
        const auto set = [&](float value) HWY_ATTR { return hn::Set(d_, value); };
        const V t_f = hn::Mul(hn::Sub(s_f, begin_), per_width_), t_b = hn::Mul(hn::Sub(s_b, begin_), per_width_);
        const V tau_f = extinction_.at(t_f), tau_b = extinction_.at(t_b);
        const V both = hn::Max(hn::Add(tau_f, tau_b), set(1e-30F));
        depth = hn::Mul(hn::Mul(length, set(0.5F)), both);
        const V opacity = opacity_of_depth(d_, depth);
        const V r = hn::Min(hn::Max(hn::Div(hn::Sub(tau_b, tau_f), both), set(-1.0F)), set(1.0F));
        const V place = hn::MulAdd(mean_place(d_, depth, r), hn::Sub(t_b, t_f), t_f);
        return {hn::Mul(opacity, red_.at(place)), hn::Mul(opacity, green_.at(place)), hn::Mul(opacity, blue_.at(place)), opacity};
    }

private:
    // From the value at a piece's begin, t = 0, to that at its end, t = 1.
    struct Linear {
        V first, change;
        HWY_INLINE Linear(D d, const std::vector<float>& begins, const std::vector<float>& ends, std::size_t i)
            : first(hn::Set(d, begins[i])), change(hn::Set(d, ends[i] - begins[i])) {}
        HWY_INLINE Linear(const PerLane<D>& piece, const std::vector<float>& begins, const std::vector<float>& ends)
            : first(piece.of(begins)), change(hn::Sub(piece.of(ends), first)) {}
        HWY_INLINE V at(V t) const { return hn::MulAdd(change, t, first); }
    };
    static std::size_t at(std::int32_t piece) { return static_cast<std::size_t>(piece); }

    D d_;
    V begin_, per_width_;
    Linear extinction_, red_, green_, blue_;
};

template <class D, class V = hn::Vec<D>>
HWY_NOINLINE LightOf<V> light_of_walk(D d, const PieceArrays& table, V s_f, V s_b, V length) {
    return Walk<D>(d, table, s_f, s_b, length).light();
}

// The light of segments: scalars 0..1, lengths ≥ 0 in scene units.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> light_of_segments(D d, const PieceArrays& table, V s_f, V s_b, V length) {
    if (table.mean_place) {
        const float low = hn::GetLane(hn::MinOfLanes(d, hn::Min(s_f, s_b))), high = hn::GetLane(hn::MaxOfLanes(d, hn::Max(s_f, s_b)));
        const std::int32_t piece = piece_of(table, low);
        if (high < table.end[static_cast<std::size_t>(piece)]) {
            V depth;
            const LightOf<V> light = LightInPiece<D>(d, table, piece)(s_f, s_b, length, depth);
            if (hn::AllTrue(d, hn::Le(depth, hn::Set(d, mean_place_depth)))) return light;
        }
    }
    return light_of_walk(d, table, s_f, s_b, length);
}

// Segments of one scalar each, for fields on cells: homogeneous media, one exponential.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> light_of_constants(D d, const PieceArrays& table, V s, V length) {
    const PerLane<D> piece(d, table, pieces_of(d, table, s));
    const V one = hn::Set(d, 1.0F);
    const V t = hn::Mul(hn::Sub(s, piece.of(table.begin)), piece.of(table.inverse_width)), rest = hn::Sub(one, t);
    const auto mixed = [&](const std::vector<float>& begin, const std::vector<float>& end) HWY_ATTR {
        return hn::MulAdd(piece.of(end), t, hn::Mul(piece.of(begin), rest));
    };
    const V extinction = hn::Max(mixed(table.extinction[0], table.extinction[1]), hn::Zero(d));
    const V depth = hn::Min(hn::Mul(extinction, length), hn::Set(d, 1e30F));  // as opaque as can be, and not infinite
    const V transmitted = mean_transmittance(d, depth);
    const V opacity = hn::Min(hn::Mul(depth, transmitted), one);
    const V weight = table.density ? opacity : hn::Mul(length, transmitted);
    return {hn::Mul(weight, mixed(table.color[0][0], table.color[1][0])), hn::Mul(weight, mixed(table.color[0][1], table.color[1][1])),
            hn::Mul(weight, mixed(table.color[0][2], table.color[1][2])), opacity};
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
