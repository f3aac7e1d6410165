// SPDX-License-Identifier: BSD-3-Clause
//
// The light of the segments of a packet (grid_segments-inl.hpp). Included once per instruction set, behind Highway; private to
// grid_kernels.cpp.
//
// `integral` in the density model has closed forms for segments inside one piece of the transfer function, and for those from one piece
// to the next one: two parts, each inside its piece. Steps in which no lane changes its piece are lit as they are. Of others the segments
// that show something are packed side by side, those of two pieces at most and the rest, which walk: few rays at a time see a narrow peak,
// and vectors are full again.
#if defined(CELLPROJ_GRID_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_GRID_LIGHT_INL
#undef CELLPROJ_GRID_LIGHT_INL
#else
#define CELLPROJ_GRID_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Segments side by side, from all lanes and steps, and their light.
struct SegmentList {
    static constexpr std::size_t most = (SegmentChunk::most + 1) * packet_lanes;  // a vector is written as a whole
    alignas(64) float front[most], back[most], length[most];
    alignas(64) std::int32_t piece_front[most], piece_back[most];
    alignas(64) float light[4][most];
    std::size_t count = 0;
};
struct CrossingSegments {
    SegmentList neighbours;  // in one piece, or in two that follow each other
    SegmentList others;
};

// The pieces of the transfer function in which the scalars of lanes lie.
template <class D>
class LanePieces {
public:
    using V = hn::Vec<D>;
    using DI = hn::RebindToSigned<D>;
    using M = hn::Mask<D>;

    HWY_INLINE LanePieces(D d, const PieceArrays& table, V s) : LanePieces(d, table, piece_of_lanes(d, table, s)) {}

    HWY_INLINE hn::Vec<DI> numbers() const { return numbers_; }
    HWY_INLINE const PerLane<D>& entries() const { return entries_; }
    // A scalar at the end of a piece is the next one's.
    HWY_INLINE M hold(V s) const { return hn::And(hn::Ge(s, begin_), hn::Lt(s, end_)); }
    HWY_INLINE M dark() const { return dark_; }

private:
    HWY_INLINE LanePieces(D d, const PieceArrays& table, hn::Vec<DI> numbers)
        : numbers_(numbers), entries_(d, table, numbers), begin_(entries_.of(table.begin)), end_(entries_.of(table.end)),
          dark_(hn::Eq(hn::Max(entries_.of(table.extinction[0]), entries_.of(table.extinction[1])), hn::Zero(d))) {}

    // Few pieces are counted, more are looked up.
    static HWY_INLINE hn::Vec<DI> piece_of_lanes(D d, const PieceArrays& table, V s) {
        constexpr std::int32_t few = 12;
        const DI di;
        if (table.count > few) return pieces_of(d, table, s);
        auto piece = hn::Zero(di);
        for (std::size_t i = 1; i < static_cast<std::size_t>(table.count); ++i)
            piece = hn::Add(piece, hn::IfThenElseZero(hn::RebindMask(di, hn::Ge(s, hn::Set(d, table.begin[i]))), hn::Set(di, 1)));
        return piece;
    }

    hn::Vec<DI> numbers_;
    PerLane<D> entries_;
    V begin_, end_;
    M dark_;
};

// A vector of a list of neighbours: the part in the piece of its front, and behind it that in the piece of its back.
template <class D>
HWY_INLINE LightOf<hn::Vec<D>> light_in_two_pieces(D d, const PieceArrays& table, const SegmentList& list, std::size_t begin) {
    using V = hn::Vec<D>;
    const hn::RebindToSigned<D> di;
    const V front = hn::Load(d, list.front + begin), back = hn::Load(d, list.back + begin), length = hn::Load(d, list.length + begin);
    const auto first = hn::Load(di, list.piece_front + begin), second = hn::Load(di, list.piece_back + begin);
    const PerLane<D> in_first(d, table, first), in_second(d, table, second);
    const auto crosses = hn::RebindMask(d, hn::Ne(first, second));
    const V one = hn::Set(d, 1.0F);
    const V middle = hn::IfThenElse(crosses, hn::Max(in_first.of(table.begin), in_second.of(table.begin)), back);
    const V share = hn::Div(hn::Sub(middle, front), hn::IfThenElse(crosses, hn::Sub(back, front), one));
    const V before = hn::IfThenElse(crosses, hn::Mul(length, share), length);
    V depth, depth_behind;
    const LightOf<V> light = LightInPiece<D>(d, table, in_first)(front, middle, before, depth);
    const LightOf<V> behind = LightInPiece<D>(d, table, in_second)(middle, back, hn::Sub(length, before), depth_behind);
    const V passed = hn::Sub(one, light.opacity);
    const auto added = [&](V a, V b) HWY_ATTR { return hn::MulAdd(passed, b, a); };
    const LightOf<V> both{added(light.r, behind.r), added(light.g, behind.g), added(light.b, behind.b), added(light.opacity, behind.opacity)};
    const auto deep = hn::Gt(hn::Max(depth, depth_behind), hn::Set(d, mean_place_depth));
    if (hn::AllFalse(d, deep)) return both;
    const LightOf<V> walked = light_of_walk(d, table, front, back, length);
    return {hn::IfThenElse(deep, walked.r, both.r), hn::IfThenElse(deep, walked.g, both.g), hn::IfThenElse(deep, walked.b, both.b),
            hn::IfThenElse(deep, walked.opacity, both.opacity)};
}

// `integral` in the density model.
template <class D>
class LightInsidePieces {
public:
    using V = hn::Vec<D>;
    using DI = hn::RebindToSigned<D>;
    using M = hn::Mask<D>;

    LightInsidePieces(D d, const PieceArrays& table, SegmentChunk& chunk, CrossingSegments& crossing)
        : d_(d), table_(table), chunk_(chunk), neighbours_(crossing.neighbours), others_(crossing.others) {
        neighbours_.count = others_.count = 0;
    }

    // Calls take(i, light) for each step that shows something, in their order.
    template <class Take>
    HWY_INLINE void find(Take take) {
        LanePieces<D> pieces(d_, table_, hn::Load(d_, chunk_.steps[0].front));
        std::size_t waiting = chunk_.count;  // the first step whose segments are packed: what follows it waits
        for (std::size_t i = 0; i < chunk_.count; ++i) {
            SegmentChunk::Step& step = chunk_.steps[i];
            state_[i] = State::dark;
            const V front = hn::Load(d_, step.front), back = hn::Load(d_, step.back), length = hn::Load(d_, step.length);
            if (!hn::AllTrue(d_, pieces.hold(front))) pieces = LanePieces<D>(d_, table_, front);
            const M some = hn::Gt(length, hn::Zero(d_)), stays = pieces.hold(back);
            const M seen = hn::AndNot(hn::And(stays, pieces.dark()), some);
            if (hn::AllFalse(d_, seen)) continue;
            LightOf<V> light;
            if (hn::AllTrue(d_, stays) && light_inside(pieces, front, back, length, light)) {
                if (waiting == chunk_.count) {
                    take(i, light);
                } else {
                    store_light(d_, light, step);
                    state_[i] = State::lit;
                }
                continue;
            }
            waiting = HWY_MIN(waiting, i);
            const auto piece_front = pieces.numbers();
            pieces = LanePieces<D>(d_, table_, back);
            pack(i, seen, piece_front, pieces.numbers());
        }
        if (waiting == chunk_.count) return;
        light_lists();
        for (std::size_t i = waiting; i < chunk_.count; ++i) {
            if (state_[i] == State::lit) take(i, load_light(d_, chunk_.steps[i].light));
            if (state_[i] == State::packed) take(i, unpacked(i));
        }
    }

private:
    enum class State : std::uint8_t { dark, lit, packed };
    struct Packed {
        M lanes;
        std::size_t first;  // of the list
    };

    // False where a segment is too deep for the closed form.
    HWY_INLINE bool light_inside(const LanePieces<D>& pieces, V front, V back, V length, LightOf<V>& light) const {
        V depth;
        light = LightInPiece<D>(d_, table_, pieces.entries())(front, back, length, depth);
        return hn::AllTrue(d_, hn::Le(depth, hn::Set(d_, mean_place_depth)));
    }

    HWY_INLINE void pack(std::size_t i, M seen, hn::Vec<DI> piece_front, hn::Vec<DI> piece_back) {
        const DI di;
        const M near = hn::RebindMask(d_, hn::Lt(hn::Abs(hn::Sub(piece_back, piece_front)), hn::Set(di, 2)));
        state_[i] = State::packed;
        in_neighbours_[i] = {hn::And(seen, near), neighbours_.count};
        in_others_[i] = {hn::AndNot(near, seen), others_.count};
        const auto add = [&](const Packed& packed, SegmentList& list) HWY_ATTR {
            const SegmentChunk::Step& step = chunk_.steps[i];
            const LanePacker<D> packer(d_, packed.lanes);
            packer.store(d_, hn::Load(d_, step.front), list.front + list.count);
            packer.store(d_, hn::Load(d_, step.back), list.back + list.count);
            packer.store(d_, hn::Load(d_, step.length), list.length + list.count);
            packer.store(di, piece_front, list.piece_front + list.count);
            packer.store(di, piece_back, list.piece_back + list.count);
            list.count += packer.count();
        };
        add(in_neighbours_[i], neighbours_);
        if (!hn::AllFalse(d_, in_others_[i].lanes)) add(in_others_[i], others_);
    }

    HWY_NOINLINE void light_lists() {
        const std::size_t lanes = hn::Lanes(d_);
        for (SegmentList* list : {&neighbours_, &others_}) {
            finish_last_vector(*list);
            for (std::size_t begin = 0; begin < list->count; begin += lanes) {
                const LightOf<V> light = list == &neighbours_ ? light_in_two_pieces(d_, table_, *list, begin)
                                                              : light_of_walk(d_, table_, hn::Load(d_, list->front + begin), hn::Load(d_, list->back + begin),
                                                                              hn::Load(d_, list->length + begin));
                hn::Store(light.r, d_, list->light[0] + begin);
                hn::Store(light.g, d_, list->light[1] + begin);
                hn::Store(light.b, d_, list->light[2] + begin);
                hn::Store(light.opacity, d_, list->light[3] + begin);
            }
        }
    }

    // With segments of no length.
    HWY_INLINE void finish_last_vector(SegmentList& list) const {
        const DI di;
        hn::StoreU(hn::Zero(d_), d_, list.front + list.count);
        hn::StoreU(hn::Zero(d_), d_, list.back + list.count);
        hn::StoreU(hn::Zero(d_), d_, list.length + list.count);
        hn::StoreU(hn::Zero(di), di, list.piece_front + list.count);
        hn::StoreU(hn::Zero(di), di, list.piece_back + list.count);
    }

    HWY_INLINE LightOf<V> unpacked(std::size_t i) const {
        LightOf<V> light = unpacked(in_neighbours_[i], neighbours_);
        if (hn::AllFalse(d_, in_others_[i].lanes)) return light;
        const LightOf<V> rest = unpacked(in_others_[i], others_);
        return {hn::Add(light.r, rest.r), hn::Add(light.g, rest.g), hn::Add(light.b, rest.b), hn::Add(light.opacity, rest.opacity)};
    }
    HWY_INLINE LightOf<V> unpacked(const Packed& packed, const SegmentList& list) const {
        const LaneUnpacker<D> unpacker(d_, packed.lanes);
        return {unpacker.load(list.light[0] + packed.first), unpacker.load(list.light[1] + packed.first),
                unpacker.load(list.light[2] + packed.first), unpacker.load(list.light[3] + packed.first)};
    }

    D d_;
    const PieceArrays& table_;
    SegmentChunk& chunk_;
    SegmentList& neighbours_;
    SegmentList& others_;
    State state_[SegmentChunk::most];
    Packed in_neighbours_[SegmentChunk::most], in_others_[SegmentChunk::most];
};

// Calls take(i, light) for steps of the chunk in their order; those it leaves out have none. `constant`: fields on cells.
template <class D, class Take>
HWY_INLINE void for_lit_steps(D d, const Shading& shading, bool constant, SegmentChunk& chunk, CrossingSegments& crossing, Take take) {
    if (chunk.count == 0) return;
    if (shading.pieces && shading.pieces->mean_place && !constant && !shading.half_opacity)
        return LightInsidePieces<D>(d, *shading.pieces, chunk, crossing).find(take);
    for (std::size_t i = 0; i < chunk.count; ++i) {
        const SegmentChunk::Step& step = chunk.steps[i];
        take(i, shade(d, shading, constant, hn::Load(d, step.front), hn::Load(d, step.back), hn::Load(d, step.length)));
    }
}

// The light of all steps, in their places.
template <class D>
HWY_NOINLINE void light_of_chunk(D d, const Shading& shading, bool constant, SegmentChunk& chunk, CrossingSegments& crossing) {
    for (std::size_t i = 0; i < chunk.count; ++i)
        for (auto& channel : chunk.steps[i].light) hn::Store(hn::Zero(d), d, channel);
    for_lit_steps(d, shading, constant, chunk, crossing,
                  [&](std::size_t i, const LightOf<hn::Vec<D>>& light) HWY_ATTR { store_light(d, light, chunk.steps[i]); });
}

// The light of all steps behind what the rays have seen.
template <class D>
HWY_NOINLINE void composite(D d, const Shading& shading, bool constant, SegmentChunk& chunk, CrossingSegments& crossing, PacketLight<D>& seen) {
    PacketLight<D> now = seen;  // kept in registers
    for_lit_steps(d, shading, constant, chunk, crossing, [&](std::size_t, const LightOf<hn::Vec<D>>& light) HWY_ATTR { put_behind<D>(light, now); });
    seen = now;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
