// SPDX-License-Identifier: BSD-3-Clause
//
// Two neighbours in memory for each lane of a vector, which is how rays read the corners of a face. Included once per instruction set,
// behind Highway; private to grid_kernels.cpp.
//
// A gather of pairs costs as many loads as one of single values, but instructions that gather are slow where each lane is a handful of
// their own operations (AMD's Zen 4: 46 cycles for four corners of 16 lanes). Plain loads of 64 bits take less than half of that.
#if defined(CELLPROJ_LANE_PAIRS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_LANE_PAIRS_INL
#undef CELLPROJ_LANE_PAIRS_INL
#else
#define CELLPROJ_LANE_PAIRS_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct LanePairs {
    hn::Vec<D> first, second;  // values[at] and values[at + 1] of each lane
};

// Where the pairs of lanes begin, each below 2³²: two lanes in 64 bits, the lower one in the lower half.
struct PairPlaces {
    alignas(64) std::uint64_t both[packet_lanes / 2];
};

#if HWY_TARGET == HWY_SCALAR

template <class D>
HWY_INLINE void store_places(D d, hn::Vec<hn::RebindToSigned<D>> at, PairPlaces& places) {
    (void)d;
    places.both[0] = static_cast<std::uint32_t>(hn::GetLane(at));
}

template <class D>
HWY_INLINE LanePairs<D> load_pairs(D d, const float* values, const PairPlaces& at) {
    const float* pair = values + static_cast<std::uint32_t>(at.both[0]);
    return {hn::LoadU(d, pair), hn::LoadU(d, pair + 1)};
}

#else

template <class D>
HWY_INLINE void store_places(D d, hn::Vec<hn::RebindToSigned<D>> at, PairPlaces& places) {
    (void)d;
    const hn::Repartition<std::uint64_t, D> d64;
    hn::Store(hn::BitCast(d64, at), d64, places.both);
}

// As many pairs as D holds, one after the other. `at`: as PairPlaces.
template <class D>
HWY_INLINE hn::Vec<D> pairs_in_a_row(D d, const float* values, const std::uint64_t* at) {
    constexpr std::size_t floats = hn::MaxLanes(D());
    const hn::Half<D> half;
    if constexpr (floats > 4) {
        return hn::Combine(d, pairs_in_a_row(half, values, at + floats / 8), pairs_in_a_row(half, values, at));
    } else {
        return hn::Combine(d, hn::LoadU(half, values + (*at >> 32)), hn::LoadU(half, values + static_cast<std::uint32_t>(*at)));
    }
}

template <class D>
HWY_INLINE LanePairs<D> load_pairs(D d, const float* values, const PairPlaces& at) {
    const auto low = pairs_in_a_row(d, values, at.both), high = pairs_in_a_row(d, values, at.both + hn::MaxLanes(D()) / 4);
    return {hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low)};
}

#endif

template <class D>
HWY_INLINE LanePairs<D> load_pairs(D d, const float* values, hn::Vec<hn::RebindToSigned<D>> at) {
    PairPlaces places;
    store_places(d, at, places);
    return load_pairs(d, values, places);
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
