// SPDX-License-Identifier: BSD-3-Clause
//
// Rays through a grid with isosurfaces: the walk of grid_walk-inl.hpp, cut at every place where the trilinear scalar passes an isovalue. Media
// that are lit go the same way, with and without surfaces in them.
// Included once per instruction set, behind Highway; private to grid_kernels.cpp.
//
// A cell whose corners have one level (render/grid_surfaces.hpp) is crossed by no surface and is left as it is. In others the cubic along
// the ray is monotonic between the places where it turns back; from one such place to the next, the levels of both ends say which surfaces
// lie between. The scalar on a face is one number for both cells, and each cell begins with the level at which the one before ended: no
// rounding loses a surface or meets it twice.
#if defined(CELLPROJ_GRID_SURFACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_GRID_SURFACES_INL
#undef CELLPROJ_GRID_SURFACES_INL
#else
#define CELLPROJ_GRID_SURFACES_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Newton's steps towards a root, halved where they leave what is known to hold it.
inline constexpr int root_steps = 12;

// Places where rays meet isosurfaces, from all lanes and steps.
struct GridHits {
    static constexpr std::size_t most = SegmentChunk::most * packet_lanes;
    using Floats = float[most + packet_lanes];
    using Integers = std::int32_t[most + packet_lanes];

    alignas(64) Integers material, corner;  // of GridSurfaces::materials; the value of the cell's low corner
    alignas(64) Integers slot;              // where the light goes, its r, from which other channels are packet_lanes apart
    alignas(64) Floats u[3];                // where in the cell, 0..1
    alignas(64) Floats per_width[3];        // of the cell, 1/axis units
    alignas(64) Floats direction[3];        // of the ray, axis units per length
    std::size_t count = 0;
};

// The light of a packet's rays, step by step: the medium, and behind it the surface where the step ends at one.
template <class D>
class SurfaceLight {
public:
    using V = hn::Vec<D>;
    using DI = hn::RebindToSigned<D>;
    using VI = hn::Vec<DI>;

    SurfaceLight(const GridCells& grid, const GridSurfaces& surfaces, const Shading& shading) : grid_(grid), surfaces_(surfaces), shading_(shading) {}

    SegmentChunk& chunk() { return chunk_; }
    GridHits& hits() { return hits_; }
    ShareStep* shares() { return shares_; }  // of the chunk's steps
    bool full() const { return chunk_.count + static_cast<std::size_t>(most_parts) + 1 > SegmentChunk::most; }

    // The last step of the chunk ends at surfaces: the slot of its first lane.
    HWY_INLINE std::int32_t begin_surface(D d) {
        const std::size_t step = chunk_.count - 1;
        behind_some_[step] = true;
        for (auto& channel : behind_[step]) hn::Store(hn::Zero(d), d, channel);
        return static_cast<std::int32_t>(step * 4 * packet_lanes);
    }

    // Puts all steps behind what was seen, and begins anew.
    HWY_NOINLINE void flush(D d, PacketLight<D>& seen) {
        if (surfaces_.medium) light_of_chunk(d, shading_, false, chunk_, crossing_);
        if (surfaces_.lit_medium) light_medium(d, shares_, chunk_);
        shade_hits(d);
        for (std::size_t i = 0; i < chunk_.count; ++i) {
            if (surfaces_.medium) put_behind(d, chunk_.steps[i].light, seen);
            if (behind_some_[i]) put_behind(d, behind_[i], seen);
            behind_some_[i] = false;
        }
        chunk_.count = 0;
        hits_.count = 0;
    }

private:
    void shade_hits(D d);

    const GridCells& grid_;
    const GridSurfaces& surfaces_;
    const Shading& shading_;
    SegmentChunk chunk_;
    CrossingSegments crossing_;
    GridHits hits_;
    ShareStep shares_[SegmentChunk::most];
    alignas(64) float behind_[SegmentChunk::most][4][packet_lanes];  // of steps, channels, lanes
    bool behind_some_[SegmentChunk::most] = {};
};

template <class D>
HWY_NOINLINE void SurfaceLight<D>::shade_hits(D d) {
    const DI di;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = hits_.count; i < hits_.count + lanes; ++i) {  // the last vector may be part empty
        hits_.material[i] = hits_.corner[i] = 0;
        for (std::size_t a = 0; a < 3; ++a) hits_.u[a][i] = hits_.per_width[a][i] = hits_.direction[a][i] = 0.0F;
    }
    for (std::size_t begin = 0; begin < hits_.count; begin += lanes) {
        const V one = hn::Set(d, 1.0F);
        V sum[3] = {one, one, one};
        if (surfaces_.shading != SurfaceShading::unlit) {
            V u[3], per_width[3], along[3];
            for (std::size_t a = 0; a < 3; ++a) {
                u[a] = hn::Load(d, hits_.u[a] + begin);
                per_width[a] = hn::Load(d, hits_.per_width[a] + begin);
                along[a] = hn::Load(d, hits_.direction[a] + begin);
            }
            const Direction<V> gradient = gradient_in_cell(d, grid_, surfaces_, hn::Load(di, hits_.corner + begin), u, per_width);
            reflect(d, surfaces_.lighting, gradient, to_eye(d, surfaces_, along), sum);
        }
        const VI material = hn::Load(di, hits_.material + begin);
        const auto of_material = [&](std::size_t k) HWY_ATTR { return hn::GatherIndex(d, surfaces_.materials.data() + k, material); };
        const V opacity = of_material(3);
        alignas(64) float light[4][packet_lanes];
        for (std::size_t channel = 0; channel < 3; ++channel)
            hn::Store(hn::Mul(opacity, hn::Mul(sum[channel], of_material(channel))), d, light[channel]);
        hn::Store(opacity, d, light[3]);
        for (std::size_t k = 0; k < HWY_MIN(lanes, hits_.count - begin); ++k)
            for (std::size_t channel = 0; channel < 4; ++channel)
                *(&behind_[0][0][0] + hits_.slot[begin + k] + channel * packet_lanes) = light[channel][k];
    }
}

template <bool uniform, class D>
class SurfaceWalk : public LitWalk<uniform, D> {
    using Base = LitWalk<uniform, D>;
    using typename Base::Ahead;
    using typename Base::Corners;
    using typename Base::M;
    using typename Base::Polynomial;
    using typename Base::V;
    using typename Base::VI;
    using Base::active_, Base::axes_, Base::d_, Base::di_, Base::grid_, Base::scalar_, Base::surfaces_, Base::t_;

public:
    HWY_INLINE SurfaceWalk(D d, const GridCells& grid, const GridSurfaces& surfaces, const GridRays& rays, const std::int32_t* pixel, M some)
        : Base(d, grid, surfaces, rays, pixel, some) {}

    // As GridWalk::step.
    HWY_INLINE void step(float bend, SurfaceLight<D>& light, PacketLight<D>& seen) {
        if (light.full()) light.flush(d_, seen);
        const Ahead ahead = this->look_ahead();
        const V next = this->template scalar_at_face<true>(ahead);
        if (surfaces_.lit_medium) this->find_shares(ahead);
        M inside = active_;
        if (grid_.present) inside = hn::And(inside, hn::Gt(hn::GatherIndex(d_, grid_.present, this->cell_id_), hn::Zero(d_)));
        const M near = surfaces_.count > 0 ? hn::And(inside, in_crossed_brick()) : hn::Lt(t_, hn::Zero(d_));
        if (hn::AllFalse(d_, near) || !cut_cell(bend, ahead, next, near, light, seen)) {
            if (surfaces_.medium) push_whole(bend, ahead, next, light);
        }
        scalar_ = next;
        this->advance(ahead);
    }

private:
    HWY_INLINE M in_crossed_brick() const {
        VI brick = hn::Zero(di_);
        for (std::size_t a = 0; a < 3; ++a)
            brick = hn::Add(brick, hn::Mul(hn::ShiftRight<2>(hn::ConvertTo(di_, axes_[a].cell)), hn::Set(di_, grid_.axes[a].brick_stride)));
        return hn::RebindMask(d_, hn::Gt(hn::GatherIndex(di_, surfaces_.crossed, brick), hn::Zero(di_)));
    }

    HWY_INLINE void push_whole(float bend, const Ahead& ahead, V next, SurfaceLight<D>& light) const {
        SegmentChunk& chunk = light.chunk();
        const std::size_t first = chunk.count;
        if (bend < std::numeric_limits<float>::max()) {
            this->push_lines(scalar_, next, this->polynomial_to(this->corners(), next, ahead.leave), ahead.length, bend, chunk);
        } else {
            this->push(scalar_, next, ahead.length, chunk);
        }
        if (surfaces_.lit_medium) this->put_shares(bend, chunk, first, hn::Zero(d_), hn::Set(d_, 1.0F), light.shares());
    }

    // How many isovalues a scalar is not below. Few are counted, more are searched.
    HWY_INLINE VI level_of(V s) const {
        const std::int32_t count = surfaces_.count;
        const float* values = surfaces_.values;
        VI level = hn::Zero(di_);
        if (count <= 8) {
            for (std::int32_t i = 0; i < count; ++i)
                level = hn::Add(level, hn::IfThenElseZero(hn::RebindMask(di_, hn::Ge(s, hn::Set(d_, values[i]))), hn::Set(di_, 1)));
            return level;
        }
        std::int32_t step = 1;
        while (step <= count / 2) step *= 2;
        for (; step > 0; step /= 2) {
            const VI tried = hn::Add(level, hn::Set(di_, step));
            const VI index = hn::Min(hn::Sub(tried, hn::Set(di_, 1)), hn::Set(di_, count - 1));
            const auto reached = hn::AndNot(hn::Gt(tried, hn::Set(di_, count)), hn::RebindMask(di_, hn::Ge(s, hn::GatherIndex(d_, values, index))));
            level = hn::IfThenElse(reached, tried, level);
        }
        return level;
    }

    // The lanes of `near` whose rays may meet a surface in their cells.
    HWY_INLINE M crossed_among(M near, const Corners& cell, V next) const {
        V low = cell.at[0], high = cell.at[0];
        for (std::size_t c = 1; c < 8; ++c) {
            low = hn::Min(low, cell.at[c]);
            high = hn::Max(high, cell.at[c]);
        }
        // Where the scalars of both faces differ in level, surfaces lie between, whatever the corners say.
        const auto cell_differs = hn::Ne(level_of(low), level_of(high)), faces_differ = hn::Ne(level_of(scalar_), level_of(next));
        return hn::And(near, hn::RebindMask(d_, hn::Or(cell_differs, faces_differ)));
    }

    // Where the polynomial is v, monotonic from low to high.
    HWY_INLINE V root_of(const Polynomial& p, V v, V low, V high, M rising) const {
        const V half = hn::Set(d_, 0.5F);
        V x = hn::Mul(half, hn::Add(low, high));
        for (int i = 0; i < root_steps; ++i) {
            const V s = p.at(x, scalar_);
            const V slope = hn::MulAdd(hn::MulAdd(hn::Mul(hn::Set(d_, 3.0F), p.cube), x, hn::Add(p.square, p.square)), x, p.slope);
            const M behind = hn::Not(hn::Xor(hn::Lt(s, v), rising));  // the root is
            low = hn::IfThenElse(behind, x, low);
            high = hn::IfThenElse(behind, high, x);
            const V newton = hn::Add(x, hn::Div(hn::Sub(v, s), slope));
            const M held = hn::And(hn::Ge(newton, low), hn::Le(newton, high));  // false for what is no number
            x = hn::IfThenElse(held, newton, hn::Mul(half, hn::Add(low, high)));
        }
        return x;
    }

    // The ends of the parts in which the polynomial is monotonic: both turning points, or 1 where there is none inside.
    HWY_INLINE void find_turns(const Polynomial& p, V& first, V& second) const {
        const V one = hn::Set(d_, 1.0F), zero = hn::Zero(d_), a = hn::Mul(hn::Set(d_, 3.0F), p.cube);
        const V discriminant = hn::Sub(hn::Mul(p.square, p.square), hn::Mul(a, p.slope));
        const V q = hn::Neg(hn::Add(p.square, hn::CopySign(hn::Sqrt(hn::Max(discriminant, zero)), p.square)));
        const auto inside = [&](V x) HWY_ATTR {
            return hn::IfThenElse(hn::And(hn::Ge(discriminant, zero), hn::And(hn::Gt(x, zero), hn::Lt(x, one))), x, one);
        };
        const V r0 = inside(hn::Div(q, a)), r1 = inside(hn::Div(p.slope, q));
        first = hn::Min(r0, r1);
        second = hn::Max(r0, r1);
    }

    // From x0 to x1 of the way through the cell; both 0 and 1 for whole cells.
    HWY_INLINE void push_part(float bend, const Polynomial& p, V x0, V x1, V s0, V s1, V length, SurfaceLight<D>& light) const {
        const std::size_t first = light.chunk().count;
        push_lines_of_part(bend, p, x0, x1, s0, s1, length, light.chunk());
        if (surfaces_.lit_medium) this->put_shares(bend, light.chunk(), first, x0, x1, light.shares());
    }
    HWY_INLINE void push_lines_of_part(float bend, const Polynomial& p, V x0, V x1, V s0, V s1, V length, SegmentChunk& chunk) const {
        const V share = hn::Sub(x1, x0), part = hn::Mul(length, share);
        if (!(bend < std::numeric_limits<float>::max())) return this->push(s0, s1, part, chunk);
        const V three = hn::Set(d_, 3.0F), at_x0 = hn::Mul(p.cube, x0);
        const V slope = hn::MulAdd(hn::MulAdd(three, at_x0, hn::Add(p.square, p.square)), x0, p.slope);
        const V square = hn::Mul(hn::MulAdd(three, at_x0, p.square), hn::Mul(share, share));
        this->push_lines(s0, s1, {hn::Mul(slope, share), square, hn::Mul(hn::Mul(p.cube, share), hn::Mul(share, share))}, part, bend, chunk);
    }

    HWY_INLINE void push_hits(M some, V x, VI material, const Ahead& ahead, SurfaceLight<D>& light) const {
        const auto integers = hn::RebindMask(di_, some);
        GridHits& hits = light.hits();
        const std::size_t to = hits.count;
        hits.count += hn::CompressStore(hn::Iota(di_, light.begin_surface(d_)), integers, di_, hits.slot + to);
        hn::CompressStore(material, integers, di_, hits.material + to);
        hn::CompressStore(this->value_id_, integers, di_, hits.corner + to);
        const V t = hn::MulAdd(x, hn::Sub(ahead.leave, t_), t_);
        for (std::size_t a = 0; a < 3; ++a) {
            hn::CompressStore(this->in_unit(this->fraction(a, t)), some, d_, hits.u[a] + to);
            hn::CompressStore(axes_[a].direction, some, d_, hits.direction[a] + to);
            hn::CompressStore(this->per_width(a), some, d_, hits.per_width[a] + to);
        }
    }

    // The cells in pieces between the surfaces in them. False, and nothing is done, where no lane of `near` meets any.
    HWY_NOINLINE bool cut_cell(float bend, const Ahead& ahead, V next, M near, SurfaceLight<D>& light, PacketLight<D>& seen) {
        const Corners cell = this->corners();
        const M crossed = crossed_among(near, cell, next);
        if (hn::AllFalse(d_, crossed)) return false;
        const Polynomial p = this->polynomial_to(cell, next, ahead.leave);
        const V one = hn::Set(d_, 1.0F);
        V ends[3];
        find_turns(p, ends[0], ends[1]);
        ends[2] = one;
        V x = hn::Zero(d_), s = scalar_, begin = hn::Zero(d_);  // where the medium is up to, and the monotonic part begins
        VI level = level_of(s);
        for (const V end : ends) {
            const V s_end = hn::IfThenElse(hn::Lt(end, one), this->in_unit(p.at(end, scalar_)), next);
            const VI level_end = level_of(s_end);
            for (;;) {
                const M meets = hn::And(crossed, hn::RebindMask(d_, hn::Ne(level, level_end)));
                if (hn::AllFalse(d_, meets)) break;
                if (light.full()) light.flush(d_, seen);
                const auto up = hn::Lt(level, level_end);
                const M rising = hn::RebindMask(d_, up);
                const VI surface = hn::IfThenElse(up, hn::Min(level, hn::Set(di_, surfaces_.count - 1)), hn::Max(hn::Sub(level, hn::Set(di_, 1)), hn::Zero(di_)));
                // Of an isovalue beyond the field's range there is no crossing.
                const V v = hn::GatherIndex(d_, surfaces_.values, surface);
                const V at = hn::IfThenElse(meets, root_of(p, v, hn::Max(x, begin), end, rising), x);
                const V s_at = hn::IfThenElse(meets, v, s);
                if (surfaces_.medium) push_part(bend, p, x, at, s, s_at, ahead.length, light);
                else this->push(s, s, hn::Zero(d_), light.chunk());
                const VI material = hn::Add(hn::ShiftLeft<3>(surface), hn::IfThenElse(up, hn::Zero(di_), hn::Set(di_, 4)));
                push_hits(meets, at, material, ahead, light);
                x = at;
                s = s_at;
                const VI by = hn::IfThenElse(up, hn::Set(di_, 1), hn::Set(di_, -1));
                level = hn::IfThenElse(hn::RebindMask(di_, meets), hn::Add(level, by), level);
            }
            begin = end;
        }
        if (light.full()) light.flush(d_, seen);
        if (surfaces_.medium) push_part(bend, p, x, one, s, next, ahead.length, light);
        return true;
    }
};

template <bool uniform>
HWY_INLINE std::size_t draw_grid_surfaces(const GridCells& grid, const GridSurfaces& surfaces, const GridRays& rays, const Shading& shading, float bend,
                                          const Tile& tile) {
    using D = hn::CappedTag<float, packet_lanes>;
    const D d;
    SurfaceLight<D> light(grid, surfaces, shading);
    std::size_t segments = 0;
    for_packets(d, tile, [&](const std::int32_t* pixel, hn::Mask<D> some, PacketLight<D>& seen) HWY_ATTR {
        SurfaceWalk<uniform, D> walk(d, grid, surfaces, rays, pixel, some);
        const auto hidden = hn::Set(d, 1.0F - shading.opaque);
        while (!walk.ended()) {
            if (grid.empty) walk.leap();
            for (std::size_t i = 0; i < steps_at_once && !walk.ended(); ++i) {
                segments += walk.active();
                walk.step(bend, light, seen);
            }
            light.flush(d, seen);
            walk.keep(hn::Gt(seen.transmitted, hidden));
        }
    });
    return segments;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
