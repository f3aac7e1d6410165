// SPDX-License-Identifier: BSD-3-Clause
//
// Some lanes of several vectors, packed, and back. Included once per instruction set, behind Highway; private to the files of kernels.
//
// By AVX2 Highway 1.0 has a table in each call of Compress, which GCC 12 copies to the stack, a kilobyte, whenever it comes
// there: four fifths of the time of a frame. Here the table stands once, and is looked up once for all vectors that share a mask.
#if defined(CELLPROJ_PACK_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_PACK_LANES_INL
#undef CELLPROJ_PACK_LANES_INL
#else
#define CELLPROJ_PACK_LANES_INL
#endif

#ifndef CELLPROJ_PACKED_LANES
#define CELLPROJ_PACKED_LANES
namespace cellproj::cpu {

// The bits that are set in a number of 8, ascending; behind them 0.
using SetBits = std::array<std::array<std::uint8_t, 8>, 256>;
constexpr SetBits make_set_bits() {
    SetBits result{};
    for (std::size_t bits = 0; bits < 256; ++bits) {
        std::size_t count = 0;
        for (std::uint8_t bit = 0; bit < 8; ++bit)
            if (bits >> bit & 1U) result[bits][count++] = bit;
    }
    return result;
}
alignas(64) inline constexpr SetBits set_bits = make_set_bits();

// How many bits are set below each bit of a number of 8.
constexpr SetBits make_bits_below() {
    SetBits result{};
    for (std::size_t bits = 0; bits < 256; ++bits)
        for (std::size_t bit = 1; bit < 8; ++bit)
            result[bits][bit] = static_cast<std::uint8_t>(result[bits][bit - 1] + (bits >> (bit - 1) & 1U));
    return result;
}
alignas(64) inline constexpr SetBits bits_below = make_bits_below();

}  // namespace cellproj::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Of lanes of 32 bits.
template <class D>
class LanePacker {
public:
    using Mask = hn::Mask<D>;
    static constexpr bool by_table = HWY_TARGET == HWY_AVX2;

    HWY_INLINE LanePacker(D d, Mask mask) : d_(d), mask_(mask) {
        if constexpr (by_table) {
            std::uint8_t bits[8];  // as much as Highway may write
            hn::StoreMaskBits(d, mask, bits);
            bits_ = bits[0];
        }
    }

    // The lanes that are set, first to last; what is behind them has no meaning. Writes a whole vector.
    template <class DT>
    HWY_INLINE void store(DT dt, hn::Vec<DT> v, hn::TFromD<DT>* to) const {
        if constexpr (by_table) {
            static_assert(sizeof(hn::TFromD<DT>) == 4 && hn::MaxLanes(DT()) <= 8);
            const hn::RebindToSigned<DT> di;
            const hn::Rebind<std::uint8_t, DT> d8;
            const auto lanes = hn::PromoteTo(di, hn::LoadU(d8, set_bits[bits_].data()));
            hn::StoreU(hn::TableLookupLanes(v, hn::IndicesFromVec(dt, lanes)), dt, to);
        } else {
            hn::StoreU(hn::Compress(v, hn::RebindMask(dt, mask_)), dt, to);
        }
    }

    HWY_INLINE std::size_t count() const { return hn::CountTrue(d_, mask_); }

private:
    D d_;
    Mask mask_;
    std::size_t bits_ = 0;
};

// Back into the lanes that LanePacker took them from.
template <class D>
class LaneUnpacker {
public:
    using V = hn::Vec<D>;
    using Mask = hn::Mask<D>;

    HWY_INLINE LaneUnpacker(D d, Mask mask) : d_(d), mask_(mask) {
        if constexpr (HWY_TARGET != HWY_AVX3) {
            std::uint8_t bits[8];
            hn::StoreMaskBits(d, mask, bits);
            bits_ = bits[0];
        }
    }

    // `from`: as many floats as a vector has. Lanes that are not set are 0.
    HWY_INLINE V load(const float* from) const {
#if HWY_TARGET == HWY_AVX3
        return V{_mm512_maskz_expand_ps(mask_.raw, hn::LoadU(d_, from).raw)};  // Highway 1.0 has no name for it
#else
        const std::uint8_t* places = bits_below[bits_].data();
        if constexpr (HWY_TARGET == HWY_AVX2) {
            const hn::RebindToSigned<D> di;
            const auto lanes = hn::PromoteTo(di, hn::LoadU(hn::Rebind<std::uint8_t, D>(), places));
            return hn::IfThenElseZero(mask_, hn::TableLookupLanes(hn::LoadU(d_, from), hn::IndicesFromVec(d_, lanes)));
        } else {
            alignas(64) float lanes[hn::MaxLanes(D())];
            for (std::size_t i = 0; i < hn::Lanes(d_); ++i) lanes[i] = from[places[i]];
            return hn::IfThenElseZero(mask_, hn::Load(d_, lanes));
        }
#endif
    }

private:
    D d_;
    Mask mask_;
    std::size_t bits_ = 0;
};

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
