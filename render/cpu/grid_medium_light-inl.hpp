// SPDX-License-Identifier: BSD-3-Clause
//
// A grid's medium that is lit by the gradient of the scalar (SurfaceScene::lit_medium; EKE01 §5.4, RS00 §8): the walk of grid_walk-inl.hpp that
// finds what share of its light each cell sends to the eye where rays enter and leave it. Included once per instruction set, behind Highway;
// private to grid_kernels.cpp.
#if defined(CELLPROJ_GRID_MEDIUM_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_GRID_MEDIUM_LIGHT_INL
#undef CELLPROJ_GRID_MEDIUM_LIGHT_INL
#else
#define CELLPROJ_GRID_MEDIUM_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Gradients are in the axes of the grid [field range / length]; places u in cells 0..1.

// Of the trilinear scalar between these corners, x first. `per_width`: of the cells [1/axis units].
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> gradient_of_corners(D d, const GridSurfaces& surfaces, const V (&c)[8], const V (&u)[3], const V (&per_width)[3]) {
    V slope[3];
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t along = std::size_t{1} << a, b = (a + 1) % 3, e = (a + 2) % 3, second = std::size_t{1} << b, third = std::size_t{1} << e;
        const auto edge = [&](std::size_t corner) HWY_ATTR { return hn::Sub(c[corner | along], c[corner]); };
        const V low = hn::MulAdd(u[b], hn::Sub(edge(second), edge(0)), edge(0));
        const V high = hn::MulAdd(u[b], hn::Sub(edge(second | third), edge(third)), edge(third));
        slope[a] = hn::Mul(hn::MulAdd(u[e], hn::Sub(high, low), low), hn::Mul(per_width[a], hn::Set(d, surfaces.per_length[a])));
    }
    return {slope[0], slope[1], slope[2]};
}

// In the cells with these low corners: flat, or smooth where there are gradients of points.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> gradient_in_cell(D d, const GridCells& grid, const GridSurfaces& surfaces, hn::Vec<hn::RebindToSigned<D>> corner,
                                         const V (&u)[3], const V (&per_width)[3]) {
    const hn::RebindToSigned<D> di;
    V values[8], sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t c = 0; c < 8; ++c) {
        std::int32_t offset = 0;
        V weight = hn::Set(d, 1.0F);
        for (std::size_t a = 0; a < 3; ++a) {
            const bool high = (c >> a & 1U) != 0;
            if (high) offset += grid.axes[a].value_stride;
            weight = hn::Mul(weight, high ? u[a] : hn::Sub(hn::Set(d, 1.0F), u[a]));
        }
        if (!surfaces.gradients) {
            values[c] = hn::GatherIndex(d, grid.values + offset, corner);
            continue;
        }
        const auto at = hn::Mul(hn::Add(corner, hn::Set(di, offset)), hn::Set(di, 3));
        for (std::size_t a = 0; a < 3; ++a) sum[a] = hn::MulAdd(weight, hn::GatherIndex(d, surfaces.gradients + a, at), sum[a]);
    }
    if (surfaces.gradients) return {sum[0], sum[1], sum[2]};
    return gradient_of_corners(d, surfaces, values, u, per_width);
}

// From places on rays to the eye, in the axes of the grid, of unit length. `along`: change of a place per length [axis units].
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> to_eye(D d, const GridSurfaces& surfaces, const V (&along)[3]) {
    const auto towards = [&](std::size_t a) HWY_ATTR { return hn::Mul(along[a], hn::Set(d, -1.0F / surfaces.per_length[a])); };
    hn::Mask<D> some;
    return unit(d, Direction<V>{towards(0), towards(1), towards(2)}, some);
}

// What of the light of a packet's segments reaches the eye, by channel: `front` where they begin, and how much more where they end.
struct ShareStep {
    alignas(64) float front[3][packet_lanes], change[3][packet_lanes];
};

// Cells' light goes through their shares at the mean place of it.
template <class D>
HWY_NOINLINE void light_medium(D d, const ShareStep* shares, SegmentChunk& chunk) {
    for (std::size_t i = 0; i < chunk.count; ++i) {
        auto& light = chunk.steps[i].light;
        const auto place = mean_place_of_light(d, hn::Load(d, light[3]));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto share = hn::MulAdd(place, hn::Load(d, shares[i].change[channel]), hn::Load(d, shares[i].front[channel]));
            hn::Store(hn::Mul(hn::Load(d, light[channel]), share), d, light[channel]);
        }
    }
}

template <bool uniform, class D>
class LitWalk : public GridWalk<uniform, D> {
    using Base = GridWalk<uniform, D>;

protected:
    using typename Base::Ahead;
    using typename Base::M;
    using typename Base::V;
    using Base::active_, Base::axes_, Base::d_, Base::di_, Base::grid_, Base::t_;

public:
    HWY_INLINE LitWalk(D d, const GridCells& grid, const GridSurfaces& surfaces, const GridRays& rays, const std::int32_t* pixel, M some)
        : Base(d, grid, rays, pixel, some), surfaces_(surfaces), known_(hn::Lt(t_, hn::Zero(d))) {
        const V along[3]{axes_[0].direction, axes_[1].direction, axes_[2].direction};
        eye_ = to_eye(d, surfaces, along);
        for (std::size_t channel = 0; channel < 3; ++channel) front_[channel] = change_[channel] = hn::Zero(d);
    }

    HWY_INLINE void leap() {
        const V before = t_;
        Base::leap();
        known_ = hn::And(known_, hn::Eq(before, t_));
    }

protected:
    // What the medium sends to the eye where the rays are, and where they leave their cells. Gradients of points are those of both cells of a face:
    // what they send where a ray enters is what was found where it left.
    HWY_INLINE void find_shares(const Ahead& ahead) {
        V share[3];
        if (!surfaces_.gradients) {
            const auto cell = this->corners();
            const V widths[3]{per_width(0), per_width(1), per_width(2)};
            for (const bool front : {true, false}) {
                const V t = front ? t_ : ahead.leave;
                const V u[3]{place(0, t), place(1, t), place(2, t)};
                shares_of(gradient_of_corners(d_, surfaces_, cell.at, u, widths), front ? front_ : share);
            }
        } else {
            for (std::size_t channel = 0; channel < 3; ++channel) front_[channel] = hn::Add(front_[channel], change_[channel]);
            if (!hn::AllTrue(d_, hn::Or(known_, hn::Not(active_)))) {
                shares_of(gradient_at(t_), share);
                for (std::size_t channel = 0; channel < 3; ++channel) front_[channel] = hn::IfThenElse(known_, front_[channel], share[channel]);
            }
            shares_of(gradient_at_face(ahead), share);
            known_ = active_;
        }
        for (std::size_t channel = 0; channel < 3; ++channel) change_[channel] = hn::Sub(share[channel], front_[channel]);
    }

    // Of the chunk's steps from number `first` on, which are equal lines from x0 to x1 of the way through the cells: as many more as keep light
    // within what `bend` stands for.
    HWY_INLINE void put_shares(float bend, SegmentChunk& chunk, std::size_t first, V x0, V x1, ShareStep* shares) const {
        if (bend < std::numeric_limits<float>::max()) cut_lines(bend, chunk, first, hn::Sub(x1, x0));
        const V width = hn::Mul(hn::Sub(x1, x0), hn::Set(d_, 1.0F / static_cast<float>(chunk.count - first)));
        for (std::size_t i = first; i < chunk.count; ++i) {
            const V x = hn::MulAdd(width, hn::Set(d_, static_cast<float>(i - first)), x0);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                hn::Store(hn::MulAdd(x, change_[channel], front_[channel]), d_, shares[i].front[channel]);
                hn::Store(hn::Mul(width, change_[channel]), d_, shares[i].change[channel]);
            }
        }
    }

    HWY_INLINE V per_width(std::size_t a) const {
        if constexpr (uniform) return hn::Set(d_, 1.0F);
        return hn::GatherIndex(d_, grid_.axes[a].per_width, hn::ConvertTo(di_, axes_[a].cell));
    }

    const GridSurfaces& surfaces_;

private:
    // Light that grows by q' along the scalar, times a share that changes by c along a line, is, by the share at the middle, off by
    // c·Δs·q'/12 of the line's length: as of a scalar that is off by c·Δs/12. Bends count on a tenth of the ray, this on all of it
    // (grid_bend.cpp).
    HWY_NOINLINE void cut_lines(float bend, SegmentChunk& chunk, std::size_t first, V width) const {
        V most = hn::Zero(d_);
        for (std::size_t i = first; i < chunk.count; ++i) {
            const SegmentChunk::Step& step = chunk.steps[i];
            const V difference = hn::Abs(hn::Sub(hn::Load(d_, step.back), hn::Load(d_, step.front)));
            most = hn::Max(most, hn::IfThenElseZero(hn::Gt(hn::Load(d_, step.length), hn::Zero(d_)), difference));
        }
        const std::size_t lines = chunk.count - first;
        V change = hn::Max(hn::Max(hn::Abs(change_[0]), hn::Abs(change_[1])), hn::Abs(change_[2]));
        change = hn::Mul(hn::Mul(change, width), hn::Set(d_, 1.0F / static_cast<float>(lines)));
        const float off = hn::GetLane(hn::MaxOfLanes(d_, hn::Mul(most, change))) / 12;
        const float wanted = std::min(std::ceil(std::sqrt(off / (0.1F * bend))), most_parts / static_cast<float>(lines));
        if (!(wanted >= 2)) return;
        const auto parts = static_cast<std::size_t>(wanted);
        chunk.count = first + lines * parts;
        for (std::size_t i = lines; i-- > 0;) {
            const V front = hn::Load(d_, chunk.steps[first + i].front), back = hn::Load(d_, chunk.steps[first + i].back);
            const V per_part = hn::Set(d_, 1.0F / static_cast<float>(parts)), length = hn::Mul(hn::Load(d_, chunk.steps[first + i].length), per_part);
            for (std::size_t k = 0; k < parts; ++k) {
                SegmentChunk::Step& step = chunk.steps[first + i * parts + k];
                const auto at = [&](std::size_t n) HWY_ATTR { return n == parts ? back : this->between(front, back, hn::Mul(hn::Set(d_, static_cast<float>(n)), per_part)); };
                hn::Store(at(k), d_, step.front);
                hn::Store(at(k + 1), d_, step.back);
                hn::Store(length, d_, step.length);
            }
        }
    }

    HWY_INLINE void shares_of(const Direction<V>& gradient, V (&share)[3]) const {
        lit_share(d_, surfaces_.lighting, scaled(gradient, hn::Set(d_, static_cast<float>(1 / weak_gradient))), eye_, share);
    }

    HWY_INLINE V place(std::size_t a, V t) const { return this->in_unit(this->fraction(a, t)); }

    // Smooth.
    HWY_INLINE Direction<V> gradient_at(V t) const {
        const V u[3]{place(0, t), place(1, t), place(2, t)};
        const V widths[3]{per_width(0), per_width(1), per_width(2)};
        return gradient_in_cell(d_, grid_, surfaces_, this->value_id_, u, widths);
    }

    // Smooth: of the four points of the face where the ray leaves; where it is cut in the cell, of all eight.
    HWY_INLINE Direction<V> gradient_at_face(const Ahead& ahead) const {
        const M by_z = hn::Not(hn::Or(ahead.by_x, ahead.by_y));
        const V ux = place(0, ahead.leave), uy = place(1, ahead.leave), uz = place(2, ahead.leave);
        const V u = hn::IfThenElse(ahead.by_x, uy, ux), v = hn::IfThenElse(by_z, uy, uz);
        const auto stride = [&](std::size_t a) HWY_ATTR { return hn::Set(di_, 3 * grid_.axes[a].value_stride); };
        const auto ix = hn::RebindMask(di_, ahead.by_x), iy = hn::RebindMask(di_, ahead.by_y), iz = hn::RebindMask(di_, by_z);
        const V up = hn::IfThenElse(ahead.by_x, axes_[0].up, hn::IfThenElse(ahead.by_y, axes_[1].up, axes_[2].up));
        const auto across = hn::IfThenElse(ix, stride(0), hn::IfThenElse(iy, stride(1), stride(2)));
        const auto first = hn::IfThenElse(ix, stride(1), stride(0)), second = hn::IfThenElse(iz, stride(1), stride(2));
        const auto c0 = hn::Add(hn::Mul(this->value_id_, hn::Set(di_, 3)), hn::IfThenElseZero(hn::RebindMask(di_, hn::Gt(up, hn::Zero(d_))), across));
        const auto c1 = hn::Add(c0, first), c2 = hn::Add(c0, second), c3 = hn::Add(c1, second);
        const auto part = [&](std::size_t a) HWY_ATTR {
            const auto at = [&](auto point) HWY_ATTR { return hn::GatherIndex(d_, surfaces_.gradients + a, point); };
            return this->between(this->between(at(c0), at(c1), u), this->between(at(c2), at(c3), u), v);
        };
        const Direction<V> g{part(0), part(1), part(2)};
        if (!this->cut_) return g;
        const M inside = hn::And(hn::And(ahead.last, active_), hn::Lt(ahead.leave, ahead.nearest));
        if (hn::AllFalse(d_, inside)) return g;
        const Direction<V> within = gradient_at(ahead.leave);
        return {hn::IfThenElse(inside, within.x, g.x), hn::IfThenElse(inside, within.y, g.y), hn::IfThenElse(inside, within.z, g.z)};
    }

    Direction<V> eye_;
    V front_[3], change_[3];
    M known_;  // whether front_ + change_ is what the medium sends where the rays are
};

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
