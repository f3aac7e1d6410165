// SPDX-License-Identifier: BSD-3-Clause
//
// What clip regions and bodies leave of the rays of a tile (render/depth_window.hpp), and the cutting of segments there. A cut moves an end
// of a segment along its ray; the scalars at both ends are found from the nearness afterwards, as those of whole segments are. Included once
// per instruction set, behind Highway; private to kernels.cpp.
#if defined(CELLPROJ_WINDOW_DRAWING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_WINDOW_DRAWING_INL
#undef CELLPROJ_WINDOW_DRAWING_INL
#else
#define CELLPROJ_WINDOW_DRAWING_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

struct WindowTile {
    HWY_ALIGN float near[tile_side * tile_side], far[tile_side * tile_side];  // nearness, as of ScreenPoint; near < far: nothing is kept
    float nearest = -NearnessInterval::unbounded, farthest = NearnessInterval::unbounded;  // of all pixels that keep something
    bool at_eye = false;  // perspective: some ray is cut between the eye and the near plane
    // Hits that begin there, and how much of the axis of the view they keep: what else is drawn of them begins at the eye.
    std::int32_t cut_hit[tile_side * tile_side];
    float cut_length[tile_side * tile_side];
    std::size_t cut_count = 0;

    WindowTile(const View& view, const NearnessInterval* rows, std::size_t stride, int width, int height) {
        for (int y = 0; y < tile_side; ++y)
            for (int x = 0; x < tile_side; ++x) {
                const bool inside = x < width && y < height;
                const NearnessInterval pixel = inside ? rows[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)] : NearnessInterval::nothing();
                near[tile_side * y + x] = pixel.near;
                far[tile_side * y + x] = pixel.far;
                if (!(pixel.near > pixel.far)) continue;
                nearest = HWY_MAX(nearest, pixel.near);
                farthest = HWY_MIN(farthest, pixel.far);
                if (!view.perspective) continue;
                const float plane = view.near_plane - view.base_nearness;
                at_eye |= (pixel.near > plane && pixel.near < NearnessInterval::unbounded) || pixel.far > plane;
            }
    }
    WindowTile(const WindowTile&) = delete;
    WindowTile& operator=(const WindowTile&) = delete;

    // Whether the cell in column k may have a part that some ray of the tile keeps. Those at the near plane begin at the eye.
    bool may_keep(const View& view, const CellPlanes& cell, std::size_t k) const {
        const bool ends_before = cell.anchor[k] + cell.nearest[k] <= farthest && !(at_eye && cell.base[k] + cell.nearest[k] > view.near_plane);
        return !ends_before && cell.anchor[k] + cell.farthest[k] < nearest;
    }
};

HWY_INLINE std::int32_t pixel_of(const CellPlanes& cell, std::int32_t place) {
    constexpr std::int32_t pixels = tile_side * tile_side;
    return cell.first_pixel[place / pixels] + place % pixels;
}

// Where a hit that begins at the near plane is drawn from the eye on, how much of that is kept.
HWY_INLINE float kept_from_eye(const View& view, const WindowTile& window, std::int32_t pixel, float whole_back) {
    const float near = window.near[pixel], far = window.far[pixel];
    const float start = near < NearnessInterval::unbounded ? 1.0F / (near + view.base_nearness) : 0.0F;
    return 1.0F / HWY_MAX(whole_back, far + view.base_nearness) - start;
}

// The same as cut_hits for tiles with cuts between the eye and the near plane: one by one.
template <class HitList>
HWY_NOINLINE void cut_hits_at_eye(const View& view, const CellPlanes& cell, WindowTile& window, HitList& hits) {
    const std::size_t count = hits.count;
    hits.count = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t place = hits.place[i], pixel = pixel_of(cell, place);
        const auto k = static_cast<std::size_t>(place) / (tile_side * tile_side);
        const bool from_eye = cell.base[k] + hits.front[i] > view.near_plane && window.near[pixel] + view.base_nearness > view.near_plane;
        const float kept = from_eye ? kept_from_eye(view, window, pixel, cell.base[k] + hits.back[i]) : 0.0F;
        const float front = HWY_MIN(hits.front[i], window.near[pixel] - cell.anchor[k]);
        const float back = HWY_MAX(hits.back[i], window.far[pixel] - cell.anchor[k]);
        if (from_eye ? !(kept > 0.0F) : !(front > back)) continue;
        if (from_eye) {
            window.cut_hit[window.cut_count] = static_cast<std::int32_t>(hits.count);
            window.cut_length[window.cut_count++] = kept;
        }
        hits.front[hits.count] = front;
        hits.back[hits.count] = HWY_MIN(back, front);
        hits.place[hits.count++] = place;
    }
}

// Of the group's hits what the window keeps.
template <class D, class HitList>
HWY_NOINLINE void cut_hits(D d, const View& view, const CellPlanes& cell, WindowTile& window, HitList& hits) {
    const hn::RebindToSigned<D> di;
    const std::size_t lanes = hn::Lanes(d), count = hits.count;
    if (count == 0) return;
    if (window.at_eye) {
        cut_hits_at_eye(view, cell, window, hits);
        return;
    }
    for (std::size_t i = 0; i < lanes; ++i) {  // the last vector may be part empty: pairs of no length
        hits.front[count + i] = hits.back[count + i] = -NearnessInterval::unbounded;
        hits.place[count + i] = hits.place[count - 1];
    }
    std::size_t kept = 0;
    for (std::size_t begin = 0; begin < count; begin += lanes) {
        const auto place = hn::Load(di, hits.place + begin);
        const auto column = hn::ShiftRight<10>(place);
        const auto pixel = hn::Add(hn::TableLookupLanes(hn::Load(di, cell.first_pixel), hn::IndicesFromVec(di, column)),
                                   hn::And(place, hn::Set(di, tile_side * tile_side - 1)));
        const auto anchor = hn::TableLookupLanes(hn::Load(d, cell.anchor), hn::IndicesFromVec(d, column));
        const auto front = hn::Min(hn::Load(d, hits.front + begin), hn::Sub(hn::GatherIndex(d, window.near, pixel), anchor));
        const auto back = hn::Max(hn::Load(d, hits.back + begin), hn::Sub(hn::GatherIndex(d, window.far, pixel), anchor));
        const LanePacker<D> packer(d, hn::Gt(front, back));
        packer.store(d, front, hits.front + kept);
        packer.store(d, back, hits.back + kept);
        packer.store(di, place, hits.place + kept);
        kept += packer.count();
    }
    hits.count = kept;
}

// The lengths that cut_hits_at_eye found, into the fragments made of the hits, from number `begin` on.
HWY_INLINE void set_cut_lengths(WindowTile& window, float* length, std::size_t begin) {
    for (std::size_t i = 0; i < window.cut_count; ++i) length[begin + static_cast<std::size_t>(window.cut_hit[i])] = window.cut_length[i];
    window.cut_count = 0;
}

// What is kept of a fragment with isosurfaces.
struct FragmentCut {
    float from = 0.0F, to = 1.0F;  // shares of the way, by depth
    float before;                  // of the way from the eye to the near plane, for fragments that begin there
    bool any = true;
};

// `near_front`, `near_back`: its whole nearness; `before`: what comes before it, from the eye on, or 0.
template <bool perspective>
HWY_INLINE FragmentCut cut_fragment(const View& view, const WindowTile& window, std::int32_t pixel, float near_front, float near_back,
                                    float before) {
    const float near = window.near[pixel] + view.base_nearness, far = window.far[pixel] + view.base_nearness;
    FragmentCut cut{.before = before};
    cut.any = near > near_back && (before > 0.0F || far < near_front) && near > far;
    const auto share = [&](float n) HWY_ATTR {
        const float s = (near_front - n) / (near_front - near_back) * (perspective ? near_back / n : 1.0F);
        return HWY_MIN(HWY_MAX(s, 0.0F), 1.0F);
    };
    if (!cut.any) return cut;
    if (near < near_front) {
        cut.from = share(near);
        cut.before = 0.0F;
    } else if (before > 0.0F) {
        cut.before = HWY_MAX(kept_from_eye(view, window, pixel, near_front), 0.0F);
    }
    if (far > near_back) cut.to = far < near_front ? share(far) : 0.0F;
    return cut;
}

// Whether a place on the pixel's ray is kept [whole nearness].
HWY_INLINE bool is_kept(const View& view, const WindowTile& window, std::int32_t pixel, float nearness) {
    return nearness <= window.near[pixel] + view.base_nearness && nearness >= window.far[pixel] + view.base_nearness;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
