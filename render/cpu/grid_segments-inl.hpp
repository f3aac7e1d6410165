// SPDX-License-Identifier: BSD-3-Clause
//
// The segments of a packet of rays, one ray per lane, from front to back, and what the rays have seen. Included once per instruction
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

template <class D>
HWY_INLINE LightOf<hn::Vec<D>> load_light(D d, const float (&light)[4][packet_lanes]) {
    return {hn::Load(d, light[0]), hn::Load(d, light[1]), hn::Load(d, light[2]), hn::Load(d, light[3])};
}

// The light of each lane behind what the rays have seen.
template <class D>
HWY_INLINE void put_behind(const LightOf<hn::Vec<D>>& light, PacketLight<D>& seen) {
    seen.r = hn::MulAdd(seen.transmitted, light.r, seen.r);
    seen.g = hn::MulAdd(seen.transmitted, light.g, seen.g);
    seen.b = hn::MulAdd(seen.transmitted, light.b, seen.b);
    seen.transmitted = hn::NegMulAdd(seen.transmitted, light.opacity, seen.transmitted);
}
template <class D>
HWY_INLINE void put_behind(D d, const float (&light)[4][packet_lanes], PacketLight<D>& seen) {
    put_behind<D>(load_light(d, light), seen);
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
