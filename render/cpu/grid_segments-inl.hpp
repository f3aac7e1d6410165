// SPDX-License-Identifier: BSD-3-Clause
//
// The segments of a packet of rays, one ray per lane, from front to back, and their light. Included once per instruction
// set, behind Highway; private to grid_kernels.cpp.
#if defined(CELLPROJ_GRID_SEGMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_GRID_SEGMENTS_INL
#undef CELLPROJ_GRID_SEGMENTS_INL
#else
#define CELLPROJ_GRID_SEGMENTS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::size_t packet_lanes = 16;

// Some steps of a packet. Lanes that have ended have a length of 0.
struct SegmentChunk {
    static constexpr std::size_t most = 48;
    struct Step {
        alignas(64) float front[packet_lanes], back[packet_lanes], length[packet_lanes];
        alignas(64) float light[4][packet_lanes];  // r, g, b, opacity
    };
    Step steps[most];
    std::size_t count = 0;
};

// Segments that cross from piece to piece of the transfer function, gathered from all lanes and steps: few, so that
// walking along the pieces by full vectors pays.
struct CrossingSegments {
    static constexpr std::size_t most = SegmentChunk::most * packet_lanes;
    alignas(64) float front[most + packet_lanes], back[most + packet_lanes], length[most + packet_lanes];
    float* light[most + packet_lanes];  // of the step and lane: its r, from which other channels are packet_lanes apart
    std::size_t count = 0;
};

// What a packet of rays has seen so far.
template <class D>
struct PacketLight {
    hn::Vec<D> r, g, b, transmitted;
};

template <class D>
HWY_INLINE void store_light(D d, const LightOf<hn::Vec<D>>& light, SegmentChunk::Step& step) {
    hn::Store(light.r, d, step.light[0]);
    hn::Store(light.g, d, step.light[1]);
    hn::Store(light.b, d, step.light[2]);
    hn::Store(light.opacity, d, step.light[3]);
}

// The pieces that lanes lie in. Few pieces are counted, more are looked up.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> piece_of_lanes(D d, const PieceArrays& table, V s) {
    constexpr std::int32_t few = 12;
    const hn::RebindToSigned<D> di;
    if (table.count > few) return pieces_of(d, table, s);
    auto piece = hn::Zero(di);
    for (std::size_t i = 1; i < static_cast<std::size_t>(table.count); ++i)
        piece = hn::Add(piece, hn::IfThenElseZero(hn::RebindMask(di, hn::Ge(s, hn::Set(d, table.begin[i]))), hn::Set(di, 1)));
    return piece;
}

// `integral` in the density model: segments inside one piece by the closed form, all others walk.
template <class D>
HWY_NOINLINE void light_inside_pieces(D d, const PieceArrays& table, SegmentChunk& chunk, CrossingSegments& crossing) {
    using V = hn::Vec<D>;
    const hn::RebindToSigned<D> di;
    const std::size_t lanes = hn::Lanes(d);
    crossing.count = 0;
    for (std::size_t i = 0; i < chunk.count; ++i) {
        SegmentChunk::Step& step = chunk.steps[i];
        const V front = hn::Load(d, step.front), back = hn::Load(d, step.back), length = hn::Load(d, step.length);
        const auto piece = piece_of_lanes(d, table, front);
        const PerLane<D> per_lane(d, table, piece);
        // A scalar at the end of a piece is the next one's.
        const auto inside = hn::And(hn::Ge(back, per_lane.of(table.begin)), hn::Lt(back, per_lane.of(table.end)));
        V depth;
        store_light(d, LightInPiece<D>(d, table, per_lane)(front, back, length, depth), step);
        const auto done = hn::Or(hn::And(inside, hn::Le(depth, hn::Set(d, mean_place_depth))), hn::Le(length, hn::Zero(d)));
        if (hn::AllTrue(d, done)) continue;
        const auto rest = hn::Not(done);
        hn::CompressStore(front, rest, d, crossing.front + crossing.count);
        hn::CompressStore(back, rest, d, crossing.back + crossing.count);
        hn::CompressStore(length, rest, d, crossing.length + crossing.count);
        alignas(64) std::int32_t lane[packet_lanes];
        const std::size_t some = hn::CompressStore(hn::Iota(di, 0), hn::RebindMask(di, rest), di, lane);
        for (std::size_t k = 0; k < some; ++k) crossing.light[crossing.count + k] = step.light[0] + lane[k];
        crossing.count += some;
    }
    for (std::size_t k = 0; k < lanes; ++k) {  // the last vector's rest
        crossing.front[crossing.count + k] = crossing.back[crossing.count + k] = 0;
        crossing.length[crossing.count + k] = 0;
    }
    for (std::size_t begin = 0; begin < crossing.count; begin += lanes) {
        const auto light = light_of_walk(d, table, hn::LoadU(d, crossing.front + begin), hn::LoadU(d, crossing.back + begin),
                                         hn::LoadU(d, crossing.length + begin));
        SegmentChunk::Step walked;
        store_light(d, light, walked);
        for (std::size_t k = 0; k < HWY_MIN(lanes, crossing.count - begin); ++k)
            for (std::size_t channel = 0; channel < 4; ++channel)
                crossing.light[begin + k][channel * packet_lanes] = walked.light[channel][k];
    }
}

// `constant`: fields on cells.
template <class D>
HWY_INLINE void light_of_chunk(D d, const Shading& shading, bool constant, SegmentChunk& chunk, CrossingSegments& crossing) {
    if (shading.pieces && shading.pieces->mean_place && !constant && !shading.half_opacity)
        return light_inside_pieces(d, *shading.pieces, chunk, crossing);
    for (std::size_t i = 0; i < chunk.count; ++i) {
        SegmentChunk::Step& step = chunk.steps[i];
        store_light(d, shade(d, shading, constant, hn::Load(d, step.front), hn::Load(d, step.back), hn::Load(d, step.length)), step);
    }
}

// r, g, b, opacity of each lane behind what the rays have seen.
template <class D>
HWY_INLINE void put_behind(D d, const float (&light)[4][packet_lanes], PacketLight<D>& seen) {
    seen.r = hn::MulAdd(seen.transmitted, hn::Load(d, light[0]), seen.r);
    seen.g = hn::MulAdd(seen.transmitted, hn::Load(d, light[1]), seen.g);
    seen.b = hn::MulAdd(seen.transmitted, hn::Load(d, light[2]), seen.b);
    seen.transmitted = hn::NegMulAdd(seen.transmitted, hn::Load(d, light[3]), seen.transmitted);
}

template <class D>
HWY_INLINE void composite(D d, const SegmentChunk& chunk, PacketLight<D>& seen) {
    for (std::size_t i = 0; i < chunk.count; ++i) put_behind(d, chunk.steps[i].light, seen);
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
