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

// At places u, 0..1, in the cells with these low corners and 1/widths [axis units], in the axes of the grid [field range / length].
template <class D, class V = hn::Vec<D>>
HWY_INLINE Direction<V> gradient_in_cell(D d, const GridCells& grid, const GridSurfaces& surfaces, hn::Vec<hn::RebindToSigned<D>> corner,
                                         const V (&u)[3], const V (&per_width)[3]) {
    const hn::RebindToSigned<D> di;
    const V one = hn::Set(d, 1.0F);
    V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t c = 0; c < 8; ++c) {
        std::int32_t offset = 0;
        V share[3], sign[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const bool high = (c >> a & 1U) != 0;
            if (high) offset += grid.axes[a].value_stride;
            share[a] = high ? u[a] : hn::Sub(one, u[a]);
            sign[a] = hn::Set(d, high ? 1.0F : -1.0F);
        }
        if (surfaces.gradients) {
            const V weight = hn::Mul(hn::Mul(share[0], share[1]), share[2]);
            const auto at = hn::Mul(hn::Add(corner, hn::Set(di, offset)), hn::Set(di, 3));
            for (std::size_t a = 0; a < 3; ++a) sum[a] = hn::MulAdd(weight, hn::GatherIndex(d, surfaces.gradients + a, at), sum[a]);
        } else {
            const V value = hn::GatherIndex(d, grid.values + offset, corner);
            for (std::size_t a = 0; a < 3; ++a)
                sum[a] = hn::MulAdd(hn::Mul(hn::Mul(sign[a], share[(a + 1) % 3]), share[(a + 2) % 3]), value, sum[a]);
        }
    }
    if (!surfaces.gradients)
        for (std::size_t a = 0; a < 3; ++a) sum[a] = hn::Mul(sum[a], hn::Mul(per_width[a], hn::Set(d, surfaces.per_length[a])));
    return {sum[0], sum[1], sum[2]};
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
        for (std::size_t channel = 0; channel < 3; ++channel) front_[channel] = hn::Add(front_[channel], change_[channel]);
        if (!surfaces_.gradients || !hn::AllTrue(d_, hn::Or(known_, hn::Not(active_)))) {
            V share[3];
            shares_at(t_, share);
            for (std::size_t channel = 0; channel < 3; ++channel) front_[channel] = hn::IfThenElse(known_, front_[channel], share[channel]);
        }
        V share[3];
        shares_at(ahead.leave, share);
        for (std::size_t channel = 0; channel < 3; ++channel) change_[channel] = hn::Sub(share[channel], front_[channel]);
        if (surfaces_.gradients) known_ = active_;
    }

    // Of the chunk's steps from number `first` on, which are equal lines from x0 to x1 of the way through the cells.
    HWY_INLINE void put_shares(const SegmentChunk& chunk, std::size_t first, V x0, V x1, ShareStep* shares) const {
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
    HWY_NOINLINE void shares_at(V t, V (&share)[3]) const {
        const V u[3]{this->in_unit(this->fraction(0, t)), this->in_unit(this->fraction(1, t)), this->in_unit(this->fraction(2, t))};
        const V widths[3]{per_width(0), per_width(1), per_width(2)};
        const Direction<V> g = scaled(gradient_in_cell(d_, grid_, surfaces_, this->value_id_, u, widths), hn::Set(d_, static_cast<float>(1 / weak_gradient)));
        lit_share(d_, surfaces_.lighting, g, eye_, share);
    }

    Direction<V> eye_;
    V front_[3], change_[3];
    M known_;  // whether front_ + change_ is what the medium sends where the rays are
};

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
