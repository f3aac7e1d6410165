// SPDX-License-Identifier: BSD-3-Clause
//
// How a packet of rays walks through a grid (grid_kernels.hpp). Where a ray crosses plane i follows from i itself, not
// from sums along the way: nothing drifts, and the next plane is never nearer than the last one. Included once per
// instruction set, behind Highway; private to grid_kernels.cpp.
#if defined(CELLPROJ_GRID_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_GRID_WALK_INL
#undef CELLPROJ_GRID_WALK_INL
#else
#define CELLPROJ_GRID_WALK_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// After so many steps a packet looks at the light, and whether it may leap: small enough for the first-level cache.
inline constexpr std::size_t steps_at_once = 16;
// A cell is cut into at most this many lines.
inline constexpr float most_parts = 32;
static_assert(SegmentChunk::most >= steps_at_once + static_cast<std::size_t>(most_parts));

// Where the rays of a packet leave their cells, step by step.
struct FaceChunk {
    struct Face {
        PairPlaces edge, opposite;
        alignas(64) float along[packet_lanes], between[packet_lanes];
    };
    Face of_step[steps_at_once];
};

template <bool uniform, class D>
class GridWalk {
public:
    using V = hn::Vec<D>;
    using DI = hn::RebindToSigned<D>;
    using VI = hn::Vec<DI>;
    using M = hn::Mask<D>;

    // `pixel`: of each lane; lanes behind `count` are none.
    HWY_NOINLINE GridWalk(D d, const GridCells& grid, const GridRays& rays, const std::int32_t* pixel, M some) : d_(d), grid_(grid) {
        const VI at = hn::LoadU(di_, pixel);
        length_ = hn::IfThenElseZero(some, hn::GatherIndex(d, rays.length.data(), at));
        t_ = hn::Zero(d);
        active_ = hn::Gt(length_, t_);
        t_end_ = hn::Set(d, never);
        for (std::size_t a = 0; a < 3; ++a) {
            Axis& axis = axes_[a];
            axis.origin = hn::IfThenElseZero(active_, hn::GatherIndex(d, rays.origin[a].data(), at));
            axis.direction = hn::IfThenElseZero(active_, hn::GatherIndex(d, rays.direction[a].data(), at));
            const M moves = hn::Ne(axis.direction, hn::Zero(d)), up = hn::Ge(axis.direction, hn::Zero(d));
            const V one = hn::Set(d, 1.0F);
            axis.inverse = hn::IfThenElseZero(moves, hn::Div(one, hn::IfThenElse(moves, axis.direction, one)));
            axis.up = hn::IfThenElseZero(up, one);
            axis.step = hn::IfThenElse(up, one, hn::Set(d, -1.0F));
            const auto upwards = hn::RebindMask(di_, up);
            const auto stride = [&](std::int32_t n) HWY_ATTR { return hn::IfThenElse(upwards, hn::Set(di_, n), hn::Set(di_, -n)); };
            axis.next_value = stride(grid.axes[a].value_stride);
            axis.next_turned = stride(grid.axes[a].turned_stride);
            axis.next_cell = stride(grid.axes[a].cell_stride);
            axis.to_exit = hn::IfThenElseZero(upwards, hn::Set(di_, a == 0 ? grid.axes[a].turned_stride : grid.axes[a].value_stride));
            axis.first = hn::IfThenElse(moves, uniform ? hn::Mul(hn::Sub(axis.up, axis.origin), axis.inverse) : hn::Zero(d), hn::Set(d, never));
            const V last = hn::Set(d, static_cast<float>(grid.axes[a].cells - 1));
            axis.cell = cell_at(a, axis.origin, hn::Zero(d), last);
            t_end_ = hn::Min(t_end_, plane_ahead(a, hn::IfThenElseZero(up, last)));
        }
        cut_ = rays.cut;
        if (cut_) t_end_ = hn::Min(t_end_, length_);
        find_ids();
        if (!grid.constant) scalar_ = interpolate(t_);
    }

    HWY_INLINE bool ended() const { return hn::AllFalse(d_, active_); }
    HWY_INLINE void keep(M still) { active_ = hn::And(active_, still); }
    HWY_INLINE std::size_t active() const { return hn::CountTrue(d_, active_); }

    // Through the cell in which the rays are, and into the next one.
    HWY_INLINE void step(float bend, SegmentChunk& chunk) {
        const Ahead ahead = look_ahead();
        if (grid_.constant) {
            const V scalar = hn::GatherIndex(d_, grid_.values, value_id_);
            push(scalar, scalar, ahead.length, chunk);
        } else {
            const V next = scalar_at_face<false>(ahead);
            if (bend < std::numeric_limits<float>::max()) {
                push_lines(scalar_, next, polynomial_to(corners(), next, ahead.leave), ahead.length, bend, chunk);
            } else {
                push(scalar_, next, ahead.length, chunk);
            }
            scalar_ = next;
        }
        advance(ahead);
    }

    // As many steps as a chunk takes at once, one line from face to face each. Values per point, and rays that are not cut in the grid. First
    // where the rays leave their cells, then the scalars there: neither waits for the other, and memory answers for many steps at once.
    // Returns the number of segments.
    HWY_INLINE std::size_t step_along_lines(FaceChunk& faces, SegmentChunk& chunk) {
        std::size_t segments = 0;
        GridWalk walk = *this;  // which what is stored below cannot change, as compilers know
        while (chunk.count < steps_at_once && !walk.ended()) {
            segments += walk.active();
            const Ahead ahead = walk.look_ahead();
            const FacePlace place = walk.place_on_face(ahead);
            FaceChunk::Face& face = faces.of_step[chunk.count];
            store_places(d_, place.edge, face.edge);
            store_places(d_, place.opposite, face.opposite);
            hn::Store(place.along, d_, face.along);
            hn::Store(place.between, d_, face.between);
            hn::Store(ahead.length, d_, chunk.steps[chunk.count++].length);
            walk.advance(ahead);
        }
        take_state(walk);
        V scalar = scalar_;
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const FaceChunk::Face& face = faces.of_step[i];
            const auto [c0, c1] = load_pairs(d_, grid_.values, face.edge);
            const auto [c2, c3] = load_pairs(d_, grid_.values, face.opposite);
            const V u = hn::Load(d_, face.along), v = hn::Load(d_, face.between);
            hn::Store(scalar, d_, chunk.steps[i].front);
            scalar = in_unit(between(between(c0, c1, u), between(c2, c3, u), v));
            hn::Store(scalar, d_, chunk.steps[i].back);
        }
        scalar_ = scalar;
        return segments;
    }
    HWY_INLINE bool along_lines(float bend) const { return !grid_.constant && !cut_ && !(bend < std::numeric_limits<float>::max()); }

    // Out of bricks that show nothing, where most rays are in such.
    HWY_NOINLINE void leap() {
        const M none = hn::Lt(t_, hn::Zero(d_));
        M leapt = none, entered[3] = {none, none, none};  // and across which planes they came into their cells
        for (;;) {
            VI brick = hn::Zero(di_);
            for (std::size_t a = 0; a < 3; ++a)
                brick = hn::Add(brick, hn::Mul(hn::ShiftRight<2>(hn::ConvertTo(di_, axes_[a].cell)), hn::Set(di_, grid_.axes[a].brick_stride)));
            const VI level = hn::IfThenElseZero(hn::RebindMask(di_, active_), hn::GatherIndex(di_, grid_.empty, brick));
            const M empty = hn::RebindMask(d_, hn::Gt(level, hn::Zero(di_)));
            // A packet is done when its last ray is: few that leap gain nothing.
            if (2 * hn::CountTrue(d_, empty) < active() + 1) break;
            leapt = hn::Or(leapt, leap_out_of(empty, hn::Add(level, level), entered));
        }
        if (hn::AllFalse(d_, leapt)) return;
        find_ids();
        if (grid_.constant) return;
        // On the plane itself: what rounding puts beside it may lie on another side of an isovalue than all that was leapt over.
        V u[3];
        for (std::size_t a = 0; a < 3; ++a)
            u[a] = hn::IfThenElse(entered[a], hn::Sub(hn::Set(d_, 1.0F), axes_[a].up), fraction(a, t_));
        scalar_ = hn::IfThenElse(leapt, interpolate(corners(), u[0], u[1], u[2]), scalar_);
    }

protected:
    static constexpr float never = 1e30F;  // where a plane is crossed that the ray runs along

    struct Axis {
        V origin, direction, inverse;  // of the ray, axis units; inverse 0 for one that crosses no plane
        V first;                       // uniform: where plane `up` is crossed; otherwise 0; `never` without direction
        V up, step;                    // 1 and 1 towards higher cells, 0 and −1 towards lower ones
        V cell;                        // a whole number
        VI to_exit;                    // from a cell's value to the lowest of the face where the ray leaves; along x of the turned ones
        VI next_value, next_turned, next_cell;  // from a cell's ids to those of the next one
    };

    // The way out of a cell.
    struct Ahead {
        V nearest, leave, length;
        M by_x, by_y, last;  // the plane that is crossed; last: out of the grid
    };
    HWY_INLINE Ahead look_ahead() const {
        const V tx = plane_ahead(0, axes_[0].cell), ty = plane_ahead(1, axes_[1].cell), tz = plane_ahead(2, axes_[2].cell);
        Ahead ahead;
        ahead.nearest = hn::Min(hn::Min(tx, ty), tz);
        ahead.by_x = hn::Eq(ahead.nearest, tx);
        ahead.by_y = hn::AndNot(ahead.by_x, hn::Eq(ahead.nearest, ty));
        ahead.last = hn::Ge(ahead.nearest, t_end_);
        ahead.leave = hn::Max(t_, hn::IfThenElse(ahead.last, length_, ahead.nearest));
        ahead.length = hn::IfThenElseZero(active_, hn::Sub(ahead.leave, t_));
        if (grid_.present) ahead.length = hn::Mul(ahead.length, hn::GatherIndex(d_, grid_.present, cell_id_));
        return ahead;
    }

    HWY_INLINE void advance(const Ahead& ahead) {
        t_ = ahead.leave;
        active_ = hn::AndNot(ahead.last, active_);
        const M by_x = hn::And(ahead.by_x, active_), by_y = hn::And(ahead.by_y, active_), crossed[3]{by_x, by_y, hn::AndNot(hn::Or(by_x, by_y), active_)};
        for (std::size_t a = 0; a < 3; ++a) {
            Axis& axis = axes_[a];
            const auto moves = hn::RebindMask(di_, crossed[a]);
            axis.cell = add_where(d_, crossed[a], axis.cell, axis.step);
            value_id_ = add_where(di_, moves, value_id_, axis.next_value);
            turned_id_ = add_where(di_, moves, turned_id_, axis.next_turned);
            if (grid_.present) cell_id_ = add_where(di_, moves, cell_id_, axis.next_cell);
        }
    }

    // Sets of instructions with masks add where one is set, others add 0.
    template <class DT>
    static HWY_INLINE hn::Vec<DT> add_where(DT dt, hn::Mask<DT> where, hn::Vec<DT> a, hn::Vec<DT> b) {
        (void)dt;
        return HWY_TARGET == HWY_AVX3 ? hn::IfThenElse(where, hn::Add(a, b), a) : hn::Add(a, hn::IfThenElseZero(where, b));
    }

    HWY_INLINE void take_state(const GridWalk& walk) {
        t_ = walk.t_;
        active_ = walk.active_;
        value_id_ = walk.value_id_;
        turned_id_ = walk.turned_id_;
        cell_id_ = walk.cell_id_;
        for (std::size_t a = 0; a < 3; ++a) axes_[a].cell = walk.axes_[a].cell;
    }

    // Where the ray crosses the plane ahead, at the end of these cells.
    HWY_INLINE V plane_ahead(std::size_t a, V cell) const {
        const Axis& axis = axes_[a];
        if constexpr (uniform) return hn::MulAdd(cell, axis.inverse, axis.first);
        const V plane = hn::GatherIndex(d_, grid_.axes[a].planes, hn::ConvertTo(di_, hn::Add(cell, axis.up)));
        return hn::MulAdd(hn::Sub(plane, axis.origin), axis.inverse, axis.first);
    }

    // The cell at a place, among those from low to high.
    HWY_INLINE V cell_at(std::size_t a, V place, V low, V high) const {
        if constexpr (uniform) return hn::Min(hn::Max(hn::Floor(place), low), high);
        VI first = hn::ConvertTo(di_, low), last = hn::ConvertTo(di_, high);
        while (!hn::AllTrue(di_, hn::Eq(first, last))) {
            const VI middle = hn::ShiftRight<1>(hn::Add(hn::Add(first, last), hn::Set(di_, 1)));
            const auto below = hn::RebindMask(di_, hn::Lt(place, hn::GatherIndex(d_, grid_.axes[a].planes, middle)));
            // Not below `first`: a place may lie in front of the cells it is looked for in.
            last = hn::IfThenElse(below, hn::Max(first, hn::Sub(middle, hn::Set(di_, 1))), last);
            first = hn::IfThenElse(below, first, middle);
        }
        return hn::ConvertTo(d_, first);
    }

    // Where in its cell a ray is at t, 0..1 but for rounding.
    HWY_INLINE V fraction(std::size_t a, V t) const {
        const Axis& axis = axes_[a];
        const V place = hn::MulAdd(t, axis.direction, axis.origin);
        if constexpr (uniform) return hn::Sub(place, axis.cell);
        const VI cell = hn::ConvertTo(di_, axis.cell);
        return hn::Mul(hn::Sub(place, hn::GatherIndex(d_, grid_.axes[a].planes, cell)), hn::GatherIndex(d_, grid_.axes[a].per_width, cell));
    }

    HWY_INLINE void find_ids() {
        value_id_ = hn::Zero(di_);
        turned_id_ = hn::Set(di_, grid_.turned);
        cell_id_ = hn::Zero(di_);
        for (std::size_t a = 0; a < 3; ++a) {
            const VI cell = hn::ConvertTo(di_, axes_[a].cell);
            value_id_ = hn::Add(value_id_, hn::Mul(cell, hn::Set(di_, grid_.axes[a].value_stride)));
            turned_id_ = hn::Add(turned_id_, hn::Mul(cell, hn::Set(di_, grid_.axes[a].turned_stride)));
            if (grid_.present) cell_id_ = hn::Add(cell_id_, hn::Mul(cell, hn::Set(di_, grid_.axes[a].cell_stride)));
        }
    }

    HWY_INLINE V between(V low, V high, V share) const { return hn::MulAdd(hn::Sub(high, low), share, low); }
    HWY_INLINE V in_unit(V x) const { return hn::Min(hn::Max(x, hn::Zero(d_)), hn::Set(d_, 1.0F)); }

    // Where a ray leaves through the face of a cell: the numbers of the values of two edges of the face, lower ends, and the place along and
    // between them, 0..1 but for rounding in even cells.
    struct FacePlace {
        VI edge, opposite;
        V along, between;
    };
    HWY_INLINE FacePlace place_on_face(const Ahead& ahead) const {
        const M by_x = ahead.by_x, by_y = ahead.by_y, by_z = hn::Not(hn::Or(by_x, by_y));
        const V t = hn::Min(ahead.leave, ahead.nearest);
        const V ux = fraction(0, t), uy = fraction(1, t), uz = fraction(2, t);
        // Edges along x, of a face across x along y.
        const auto ix = hn::RebindMask(di_, by_x), iy = hn::RebindMask(di_, by_y), iz = hn::RebindMask(di_, by_z);
        const VI low = hn::IfThenElse(ix, turned_id_, value_id_);
        const VI edge = hn::Add(low, hn::IfThenElse(ix, axes_[0].to_exit, hn::IfThenElse(iy, axes_[1].to_exit, axes_[2].to_exit)));
        const VI across = hn::IfThenElse(iz, hn::Set(di_, grid_.axes[1].value_stride), hn::Set(di_, grid_.axes[2].value_stride));
        const V u = hn::IfThenElse(by_x, uy, ux), v = hn::IfThenElse(by_z, uy, uz);
        if constexpr (uniform) return {edge, hn::Add(edge, across), u, v};
        return {edge, hn::Add(edge, across), in_unit(u), in_unit(v)};
    }

    // The bilinear scalar on the face where the ray leaves; where it is cut in the cell, the trilinear one there. `bounded`: never beyond those
    // of the corners of the face.
    template <bool bounded>
    HWY_INLINE V scalar_at_face(const Ahead& ahead) const {
        const FacePlace place = place_on_face(ahead);
        const auto [c0, c1] = load_pairs(d_, grid_.values, place.edge);
        const auto [c2, c3] = load_pairs(d_, grid_.values, place.opposite);
        const V u = bounded ? in_unit(place.along) : place.along, v = bounded ? in_unit(place.between) : place.between;
        V scalar = between(between(c0, c1, u), between(c2, c3, u), v);
        if constexpr (bounded) {
            const V least = hn::Min(hn::Min(c0, c1), hn::Min(c2, c3)), most = hn::Max(hn::Max(c0, c1), hn::Max(c2, c3));
            scalar = hn::Min(hn::Max(scalar, least), most);
        } else {
            scalar = in_unit(scalar);
        }
        if (!cut_) return scalar;
        const M inside = hn::And(hn::And(ahead.last, active_), hn::Lt(ahead.leave, ahead.nearest));  // cut before the face
        return hn::AllFalse(d_, inside) ? scalar : hn::IfThenElse(inside, interpolate(ahead.leave), scalar);
    }

    HWY_INLINE V value(VI id) const { return hn::GatherIndex(d_, grid_.values, id); }

    struct Corners {
        V at[8];
    };
    HWY_INLINE Corners corners() const {
        Corners result;
        for (std::size_t c = 0; c < 8; c += 2) {  // pairs along x
            std::int32_t offset = 0;
            for (std::size_t a = 1; a < 3; ++a)
                if (c >> a & 1U) offset += grid_.axes[a].value_stride;
            const auto [low, high] = load_pairs(d_, grid_.values, hn::Add(value_id_, hn::Set(di_, offset)));
            result.at[c] = low;
            result.at[c + 1] = high;
        }
        return result;
    }
    HWY_INLINE V interpolate(const Corners& c, V ux, V uy, V uz) const {
        const V u = in_unit(ux), v = in_unit(uy), w = in_unit(uz);
        const V low = between(between(c.at[0], c.at[1], u), between(c.at[2], c.at[3], u), v);
        const V high = between(between(c.at[4], c.at[5], u), between(c.at[6], c.at[7], u), v);
        return in_unit(between(low, high, w));
    }
    HWY_INLINE V interpolate(const Corners& c, V t) const { return interpolate(c, fraction(0, t), fraction(1, t), fraction(2, t)); }
    HWY_INLINE V interpolate(V t) const { return interpolate(corners(), t); }

    HWY_INLINE void push(V front, V back, V length, SegmentChunk& chunk) const {
        SegmentChunk::Step& step = chunk.steps[chunk.count++];
        hn::Store(front, d_, step.front);
        hn::Store(back, d_, step.back);
        hn::Store(length, d_, step.length);
    }

    // The scalar from where the rays are to where they leave: its scalar there + x·(slope + x·(square + x·cube)), 0 ≤ x ≤ 1.
    struct Polynomial {
        V slope, square, cube;

        HWY_INLINE V at(V x, V start) const { return hn::MulAdd(hn::MulAdd(hn::MulAdd(cube, x, square), x, slope), x, start); }
    };
    HWY_INLINE Polynomial polynomial_to(const Corners& cell, V next, V leave) const {
        const auto set = [&](float x) HWY_ATTR { return hn::Set(d_, x); };
        const V step = hn::Mul(hn::Sub(leave, t_), set(1.0F / 3));
        const V s1 = interpolate(cell, hn::Add(t_, step)), s2 = interpolate(cell, hn::Sub(leave, step));
        // Bézier points but for the ends, and the differences 3·(b1 − b0) … of the power form.
        const V b1 = hn::MulAdd(scalar_, set(-5.0F / 6), hn::MulAdd(s1, set(3), hn::MulAdd(s2, set(-1.5F), hn::Mul(next, set(1.0F / 3)))));
        const V b2 = hn::MulAdd(scalar_, set(1.0F / 3), hn::MulAdd(s1, set(-1.5F), hn::MulAdd(s2, set(3), hn::Mul(next, set(-5.0F / 6)))));
        const V bend0 = hn::Add(hn::Sub(scalar_, hn::Add(b1, b1)), b2), bend1 = hn::Add(hn::Sub(b1, hn::Add(b2, b2)), next);
        return {hn::Mul(set(3), hn::Sub(b1, scalar_)), hn::Mul(set(3), bend0), hn::Sub(bend1, bend0)};
    }

    // The cubic in as many equal lines as keep it within `bend`. Each has the same mean as the cubic in its part, which
    // the chord misses by h²/12·s'' (s'' in the middle; exactly so for a cubic): where the transfer function is linear,
    // optical depth is then exact, and a line stays within M/12 of a function whose second derivative is at most M. That
    // of a cubic is at one of its ends.
    HWY_INLINE void push_lines(V start, V end, const Polynomial& p, V length, float bend, SegmentChunk& chunk) const {
        const auto set = [&](float x) HWY_ATTR { return hn::Set(d_, x); };
        const V last_bend = hn::MulAdd(p.cube, set(3), p.square);
        const V most = hn::Mul(hn::Max(hn::Abs(p.square), hn::Abs(last_bend)), set(2.0F / 12));
        const V seen = hn::IfThenElseZero(hn::Gt(length, hn::Zero(d_)), most);
        const float wanted = std::ceil(std::sqrt(hn::GetLane(hn::MaxOfLanes(d_, seen)) / bend));
        const float parts = std::min(std::max(wanted, 1.0F), most_parts);
        const V per_part = set(1.0F / parts), part_length = hn::Mul(length, per_part);
        V front = start;
        for (float i = 1; i <= parts; ++i) {
            const V middle = hn::Mul(set(i - 0.5F), per_part);
            const V back = i < parts ? p.at(hn::Mul(set(i), per_part), start) : end;
            const V mean = hn::Mul(hn::MulAdd(hn::Mul(set(3), p.cube), middle, p.square), set(-1.0F / (6 * parts * parts)));
            push(in_unit(hn::Add(front, mean)), in_unit(hn::Add(back, mean)), part_length, chunk);
            front = back;
        }
    }

    // The lanes of `from` out of the bricks of 1 << shift cells they are in. Those that are still in the grid.
    HWY_INLINE M leap_out_of(M from, VI shift, M (&entered)[3]) {
        V low[3], high[3], ahead[3];
        for (std::size_t a = 0; a < 3; ++a) {
            const VI first = hn::Shl(hn::Shr(hn::ConvertTo(di_, axes_[a].cell), shift), shift);
            const VI last = hn::Min(hn::Add(first, hn::Sub(hn::Shl(hn::Set(di_, 1), shift), hn::Set(di_, 1))), hn::Set(di_, grid_.axes[a].cells - 1));
            low[a] = hn::ConvertTo(d_, first);
            high[a] = hn::ConvertTo(d_, last);
            ahead[a] = plane_ahead(a, hn::IfThenElse(hn::Gt(axes_[a].step, hn::Zero(d_)), high[a], low[a]));
        }
        const V nearest = hn::Min(hn::Min(ahead[0], ahead[1]), ahead[2]);
        active_ = hn::AndNot(hn::And(from, hn::Ge(nearest, t_end_)), active_);
        const M go = hn::And(from, active_);
        t_ = hn::IfThenElse(go, hn::Max(t_, nearest), t_);
        M crosses = go;  // along the first axis whose plane is the nearest
        for (std::size_t a = 0; a < 3; ++a) {
            Axis& axis = axes_[a];
            const M up = hn::Gt(axis.step, hn::Zero(d_));
            const M by = hn::And(crosses, hn::Eq(nearest, ahead[a]));
            crosses = hn::AndNot(by, crosses);
            entered[a] = hn::Or(hn::AndNot(go, entered[a]), by);
            // Rounding must not turn a ray round: never behind the cell where it was.
            const V along = cell_at(a, hn::MulAdd(t_, axis.direction, axis.origin), hn::IfThenElse(up, axis.cell, low[a]),
                                    hn::IfThenElse(up, high[a], axis.cell));
            const V across = hn::Add(hn::IfThenElse(up, high[a], low[a]), axis.step);
            axis.cell = hn::IfThenElse(go, hn::IfThenElse(by, across, along), axis.cell);
        }
        return go;
    }

    D d_;
    DI di_;
    const GridCells& grid_;
    Axis axes_[3];
    V t_, t_end_, length_, scalar_;
    bool cut_;
    VI value_id_, turned_id_, cell_id_;
    M active_;
};

// Pixels of a packet: squares, or what a vector can be.
template <class D>
HWY_INLINE int packet_width(D d) {
    return static_cast<int>(hn::Lanes(d) >= 8 ? 4 : hn::Lanes(d) >= 2 ? 2 : 1);
}

// The pixels of a tile whose rays are the lanes of a vector. Those beyond its sides are none.
template <class D>
class Packet {
public:
    HWY_INLINE Packet(D d, const Tile& tile, int x, int y) : x_(x), y_(y) {
        const hn::RebindToSigned<D> di;
        const auto lanes = static_cast<int>(hn::Lanes(d));
        alignas(64) std::int32_t inside[packet_lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            const int column = x + lane % packet_width(d), row = y + lane / packet_width(d);
            inside[lane] = column < tile.width && row < tile.height ? 1 : 0;
            pixel_[lane] = inside[lane] ? tile_side * row + column : 0;
        }
        some_ = hn::RebindMask(d, hn::Gt(hn::Load(di, inside), hn::Zero(di)));
    }

    const std::int32_t* pixel() const { return pixel_; }
    HWY_INLINE hn::Mask<D> some() const { return some_; }

    HWY_INLINE void keep(D d, const PacketLight<D>& seen, const Tile& tile) const {
        alignas(64) float rgba[4 * packet_lanes];
        hn::StoreInterleaved4(seen.r, seen.g, seen.b, hn::Sub(hn::Set(d, 1.0F), seen.transmitted), d, rgba);
        for (int lane = 0; lane < static_cast<int>(hn::Lanes(d)); ++lane) {
            const int column = x_ + lane % packet_width(d), row = y_ + lane / packet_width(d);
            const float* light = rgba + 4 * lane;
            if (column < tile.width && row < tile.height)
                tile.pixels[static_cast<std::size_t>(row) * tile.stride + static_cast<std::size_t>(column)] = {light[0], light[1], light[2], light[3]};
        }
    }

private:
    int x_, y_;
    alignas(64) std::int32_t pixel_[packet_lanes];
    hn::Mask<D> some_;
};

template <class D>
HWY_INLINE PacketLight<D> nothing_seen(D d) {
    const auto zero = hn::Zero(d);
    return {zero, zero, zero, hn::Set(d, 1.0F)};
}

// Calls draw(pixel, some, seen) for each packet of a tile's rays, which fills `seen`, and keeps what it has seen as pixels.
template <class D, class Draw>
HWY_INLINE void for_packets(D d, const Tile& tile, Draw draw) {
    const int columns = packet_width(d), rows = static_cast<int>(hn::Lanes(d)) / columns;
    for (int y = 0; y < tile.height; y += rows)
        for (int x = 0; x < tile.width; x += columns) {
            const Packet<D> packet(d, tile, x, y);
            PacketLight<D> seen = nothing_seen(d);
            draw(packet.pixel(), packet.some(), seen);
            packet.keep(d, seen, tile);
        }
}

// Packets side by side that take turns, some steps each: the cells that one has just read are in the first-level cache for the others.
template <bool uniform, class D>
class PacketGroup {
public:
    static constexpr int side = 8;  // pixels

    HWY_INLINE PacketGroup(D d, const GridCells& grid, const GridRays& rays, const Tile& tile, int x, int y) : PacketGroup(d, grid, rays, tile, x, y, Numbers()) {}

    // Returns the number of segments.
    HWY_INLINE std::size_t draw(const GridCells& grid, const Shading& shading, float bend, SegmentChunk& chunk, CrossingSegments& crossing) {
        const auto hidden = hn::Set(d_, 1.0F - shading.opaque);
        std::size_t segments = 0;
        for (bool more = true; more;) {
            more = false;
            for (std::size_t i = 0; i < count; ++i) {
                GridWalk<uniform, D>& walk = walks_[i];
                if (walk.ended()) continue;
                if (grid.empty) walk.leap();
                chunk.count = 0;
                if (walk.along_lines(bend)) {
                    segments += walk.step_along_lines(faces_, chunk);
                } else {
                    while (chunk.count < steps_at_once && !walk.ended()) {
                        segments += walk.active();
                        walk.step(bend, chunk);
                    }
                }
                composite(d_, shading, grid.constant, chunk, crossing, seen_[i]);
                walk.keep(hn::Gt(seen_[i].transmitted, hidden));
                more = more || !walk.ended();
            }
        }
        return segments;
    }

    HWY_INLINE void keep(const Tile& tile) const {
        for (std::size_t i = 0; i < count; ++i) packets_[i].keep(d_, seen_[i], tile);
    }

private:
    static constexpr std::size_t count = static_cast<std::size_t>(side * side) / hn::MaxLanes(D());
    using Numbers = std::make_index_sequence<count>;

    static HWY_INLINE Packet<D> packet_at(D d, const Tile& tile, int x, int y, std::size_t i) {
        const int width = packet_width(d), columns = side / width, height = static_cast<int>(hn::Lanes(d)) / width;
        return Packet<D>(d, tile, x + width * (static_cast<int>(i) % columns), y + height * (static_cast<int>(i) / columns));
    }

    template <std::size_t... i>
    HWY_INLINE PacketGroup(D d, const GridCells& grid, const GridRays& rays, const Tile& tile, int x, int y, std::index_sequence<i...>)
        : d_(d), packets_{packet_at(d, tile, x, y, i)...}, walks_{GridWalk<uniform, D>(d, grid, rays, packets_[i].pixel(), packets_[i].some())...},
          seen_{((void)i, nothing_seen(d))...} {}

    D d_;
    Packet<D> packets_[count];
    GridWalk<uniform, D> walks_[count];
    PacketLight<D> seen_[count];
    FaceChunk faces_;
};

template <bool uniform>
HWY_INLINE std::size_t draw_grid(const GridCells& grid, const GridRays& rays, const Shading& shading, float bend, const Tile& tile) {
    using D = hn::CappedTag<float, packet_lanes>;
    using Group = PacketGroup<uniform, D>;
    const D d;
    SegmentChunk chunk;
    CrossingSegments crossing;
    std::size_t segments = 0;
    for (int y = 0; y < tile.height; y += Group::side)
        for (int x = 0; x < tile.width; x += Group::side) {
            Group group(d, grid, rays, tile, x, y);
            segments += group.draw(grid, shading, bend, chunk, crossing);
            group.keep(tile);
        }
    return segments;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
