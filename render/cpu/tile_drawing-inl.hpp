// SPDX-License-Identifier: BSD-3-Clause
//
// The cells of a tile to its pixels. Cells are small and their pixels few, so lanes are filled twice: blocks of pixels against a
// cell's planes give fragments, which are packed; then full vectors of fragments, whatever cells they come from, become light;
// one after the other they are composited. Included once per instruction set, behind Highway; private to kernels.cpp.
#if defined(CELLPROJ_TILE_DRAWING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_TILE_DRAWING_INL
#undef CELLPROJ_TILE_DRAWING_INL
#else
#define CELLPROJ_TILE_DRAWING_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Segments of rays in cells, in drawing order.
struct Fragments {
    static constexpr std::size_t capacity = 1024;
    using List = float[capacity + CellPlanes::columns];  // packing writes whole vectors

    HWY_ALIGN List front, back;                                       // scalars
    HWY_ALIGN List length;                                            // along the axis of the view [scene units]
    HWY_ALIGN List key;                                               // for pixels that sort: the middle's nearness
    HWY_ALIGN std::int32_t pixel[capacity + CellPlanes::columns];     // x + tile_side·y
    std::size_t count = 0;
    HWY_ALIGN List near_front, near_back;                             // with isosurfaces: whole nearness of both ends
};

struct SurfaceTile;  // surface_drawing-inl.hpp, as what is declared with it

// What a task needs while it draws a tile.
struct TileState {
    HWY_ALIGN float rgba[tile_side * tile_side][4];  // composited so far
    std::uint32_t open[tile_side];                   // per row: bit x is set while something can still be seen there
    bool some_closed = false;
    float x, y;                                      // the first pixel centre
    Fragments fragments;
    CellPlanes planes;
    Corners corners;
    SurfaceTile* surfaces = nullptr;                 // with isosurfaces
};

enum class Precision { float32, float64, float64_alone };
Precision precision_of(const ScreenCells& cells, const CellPlanes& planes, std::size_t k, std::uint32_t item, TileState& tile);
template <bool perspective>
float margin_of(const CellPlanes& planes, std::size_t k, Precision precision);
template <bool perspective>
void complete_fragments(const ScreenCells& cells, std::uint32_t item, Precision precision, std::size_t begin, TileState& tile);
template <bool perspective, class D>
void composite_with_surfaces(D d, const ScreenCells& cells, const Shading& shading, TileState& tile);
void append_ends(const TileState& tile, PendingFragments& pending);
void set_ends(const SurfaceEnds& ends, std::size_t fragment, TileState& tile);

template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> shade(D d, const Shading& shading, bool constant, V s_f, V s_b, V length) {
    const LightOf<V> light = shading.tables ? light_of_tables(d, *shading.tables, s_f, s_b, length)
                             : constant     ? light_of_constants(d, *shading.pieces, s_f, length)
                                            : light_of_segments(d, *shading.pieces, s_f, s_b, length);
    return shading.half_opacity ? half_opacity(d, light) : light;
}

// The last vector of fragments may be part empty.
template <class D>
HWY_INLINE void empty_last_vector(D d, Fragments& f) {
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        f.front[f.count + i] = f.back[f.count + i] = f.length[f.count + i] = 0.0F;
        f.pixel[f.count + i] = 0;
    }
}

// The light of a vector of fragments.
template <class D, class V = hn::Vec<D>>
HWY_INLINE LightOf<V> light_of_fragments(D d, const ScreenCells& cells, const Shading& shading, const TileState& tile, const Fragments& f,
                                         std::size_t begin) {
    const hn::RebindToSigned<D> di;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
    V length = hn::Load(d, f.length + begin);
    if (cells.view.perspective) {  // from the axis to the ray
        const auto unit = hn::Set(d, cells.view.unit_per_pixel);
        const auto pixel = hn::Load(di, f.pixel + begin);
        const V x = hn::Add(hn::ConvertTo(d, hn::And(pixel, hn::Set(di, tile_side - 1))), hn::Set(d, tile.x));
        const V y = hn::Add(hn::ConvertTo(d, hn::ShiftRight<5>(pixel)), hn::Set(d, tile.y));
        const V u = hn::Mul(x, unit), v = hn::Mul(y, unit);
        length = hn::Mul(length, hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one))));
    }
    const V s_f = hn::Min(hn::Max(hn::Load(d, f.front + begin), zero), one);
    const V s_b = hn::Min(hn::Max(hn::Load(d, f.back + begin), zero), one);
    return shade(d, shading, !cells.cell_scalars.empty(), s_f, s_b, length);
}

// Composites the fragments behind what is there, in their order, and forgets them.
template <class D>
HWY_NOINLINE void composite(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    Fragments& f = tile.fragments;
    const std::size_t lanes = hn::Lanes(d);
    empty_last_vector(d, f);
    HWY_ALIGN float light[4 * CellPlanes::columns];
    for (std::size_t begin = 0; begin < f.count; begin += lanes) {
        const auto l = light_of_fragments(d, cells, shading, tile, f, begin);
        hn::StoreInterleaved4(l.r, l.g, l.b, l.opacity, d, light);
        const std::size_t end = HWY_MIN(lanes, f.count - begin);
        for (std::size_t i = 0; i < end; ++i) {
            float* rgba = tile.rgba[f.pixel[begin + i]];
            const float transmitted = 1.0F - rgba[3];
            for (std::size_t channel = 0; channel < 4; ++channel) rgba[channel] += transmitted * light[4 * i + channel];
        }
    }
    f.count = 0;
}

template <bool perspective, bool surfaces, class D>
HWY_INLINE void composite_all(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    if constexpr (surfaces) {
        composite_with_surfaces<perspective>(d, cells, shading, tile);
    } else {
        composite(d, cells, shading, tile);
    }
}

// The fragments of one cell of the group.
// `margin`, with isosurfaces: how much thinner than nothing a segment may be.
template <bool perspective, bool constant, bool keyed, bool surfaces, class D>
HWY_INLINE void add_fragments(D d, const View& view, const CellPlanes& cell, std::size_t k, TileState& tile, float margin = 0.0F) {
    const hn::RebindToSigned<D> di;
    const hn::RebindToUnsigned<D> du;
    using V = hn::Vec<D>;
    Fragments& f = tile.fragments;
    // Lanes are pixels: a block of up to four in a row.
    constexpr int block_width = HWY_MIN(4, static_cast<int>(hn::MaxLanes(D())));
    const int block_height = static_cast<int>(hn::Lanes(d)) / block_width;
    const auto lane = hn::Iota(di, 0);
    const auto lane_x = hn::And(lane, hn::Set(di, block_width - 1));
    const auto lane_y = hn::ShiftRight<block_width == 4 ? 2 : 0>(hn::Sub(lane, lane_x));
    const V step_x = hn::ConvertTo(d, lane_x), step_y = hn::ConvertTo(d, lane_y);
    const auto lane_pixel = hn::Add(lane_x, hn::ShiftLeft<5>(lane_y));

    const int width = cell.width[k], height = cell.height[k];
    V nearness[4];
    hn::Mask<D> towards_eye[4];
    for (std::size_t face = 0; face < 4; ++face) {
        nearness[face] = hn::MulAdd(hn::Set(d, cell.slope_x[face][k]), step_x,
                                    hn::MulAdd(hn::Set(d, cell.slope_y[face][k]), step_y, hn::Set(d, cell.nearness[face][k])));
        towards_eye[face] = hn::RebindMask(d, hn::Ne(hn::Set(du, cell.towards_eye[face][k]), hn::Zero(du)));
    }
    const V nearest = hn::Set(d, cell.nearest[k]), farthest = hn::Set(d, cell.farthest[k]);

    for (int y = 0; y < height; y += block_height) {
        const V inside_y = hn::Set(d, static_cast<float>(height - y)), offset_y = hn::Set(d, static_cast<float>(y));
        for (int x = 0; x < width; x += block_width) {
            const V offset_x = hn::Set(d, static_cast<float>(x));
            V front = nearest, back = farthest;
            for (std::size_t face = 0; face < 4; ++face) {
                const V n = hn::MulAdd(hn::Set(d, cell.slope_x[face][k]), offset_x,
                                       hn::MulAdd(hn::Set(d, cell.slope_y[face][k]), offset_y, nearness[face]));
                front = hn::IfThenElse(towards_eye[face], hn::Min(front, n), front);
                back = hn::IfThenElse(towards_eye[face], back, hn::Max(back, n));
            }
            const auto in_box = hn::And(hn::Lt(step_x, hn::Set(d, static_cast<float>(width - x))), hn::Lt(step_y, inside_y));
            const auto hit = hn::And(hn::Gt(surfaces ? hn::Add(front, hn::Set(d, margin)) : front, back), in_box);
            const std::size_t hits = hn::CountTrue(d, hit);
            if (hits == 0) continue;

            V length = hn::Sub(front, back), depth_front = hn::Set(d, 1.0F), depth_back = depth_front;
            if constexpr (perspective) {
                const V base = hn::Set(d, cell.base[k]);
                const V w_front = hn::Add(base, front), w_back = hn::Add(base, back);
                const V both = hn::Div(hn::Set(d, 1.0F), hn::Mul(w_front, w_back));
                depth_front = hn::Mul(w_back, both);
                depth_back = hn::Mul(w_front, both);
                // What begins at the near plane has been cut there, and is drawn from the eye on.
                length = hn::IfThenElse(hn::Gt(w_front, hn::Set(d, view.near_plane)), depth_back, hn::Mul(length, both));
            }
            hn::StoreU(hn::Compress(length, hit), d, f.length + f.count);
            if constexpr (keyed) {
                const V middle = hn::MulAdd(hn::Set(d, 0.5F), hn::Add(front, back), hn::Set(d, cell.base[k]));
                hn::StoreU(hn::Compress(middle, hit), d, f.key + f.count);
            }
            if constexpr (surfaces) {
                const V base = hn::Set(d, cell.base[k]);
                hn::StoreU(hn::Compress(hn::Add(base, front), hit), d, f.near_front + f.count);
                hn::StoreU(hn::Compress(hn::Add(base, back), hit), d, f.near_back + f.count);
            }
            const int first_pixel = cell.left[k] + x + tile_side * (cell.top[k] + y);
            hn::StoreU(hn::Compress(hn::Add(lane_pixel, hn::Set(di, first_pixel)), hn::RebindMask(di, hit)), di, f.pixel + f.count);
            const V first = hn::Set(d, cell.first_scalar[k]);
            if constexpr (constant) {
                hn::StoreU(first, d, f.front + f.count);
                hn::StoreU(first, d, f.back + f.count);
            } else {
                const V px = hn::Add(step_x, offset_x), py = hn::Add(step_y, offset_y);
                const V across = hn::MulAdd(hn::Set(d, cell.scalar_x[k]), px,
                                            hn::MulAdd(hn::Set(d, cell.scalar_y[k]), py, hn::Set(d, cell.scalar[k])));
                const V along = hn::Set(d, cell.scalar_n[k]);
                const V low = hn::Set(d, cell.lowest[k]), high = hn::Set(d, cell.highest[k]);
                const V s_f = hn::MulAdd(hn::MulAdd(along, front, across), depth_front, first);
                const V s_b = hn::MulAdd(hn::MulAdd(along, back, across), depth_back, first);
                hn::StoreU(hn::Compress(hn::Min(hn::Max(s_f, low), high), hit), d, f.front + f.count);
                hn::StoreU(hn::Compress(hn::Min(hn::Max(s_b, low), high), hit), d, f.back + f.count);
            }
            f.count += hits;
        }
    }
}

// The same for whatever is drawn.
template <bool perspective, bool constant, bool keyed, bool surfaces, class D>
HWY_INLINE void add_cell(D d, const ScreenCells& cells, const CellPlanes& planes, std::size_t k, std::uint32_t item, TileState& tile) {
    if constexpr (surfaces) {
        const std::size_t begin = tile.fragments.count;
        const Precision precision = precision_of(cells, planes, k, item, tile);
        add_fragments<perspective, constant, keyed, true>(d, cells.view, planes, k, tile, margin_of<perspective>(planes, k, precision));
        complete_fragments<perspective>(cells, item, precision, begin, tile);
    } else {
        add_fragments<perspective, constant, keyed, false>(d, cells.view, planes, k, tile);
    }
}

// False when nothing can be seen any more anywhere in the tile.
HWY_INLINE bool close_pixels(TileState& tile, float opaque, int width, int height) {
    bool any_open = false;
    for (int y = 0; y < height; ++y) {
        std::uint32_t open = tile.open[y];
        for (int x = 0; x < width && open != 0; ++x)
            if (tile.rgba[tile_side * y + x][3] > opaque) open &= ~(1U << x);
        tile.some_closed |= open != tile.open[y];
        tile.open[y] = open;
        any_open |= open != 0;
    }
    return any_open;
}

HWY_INLINE bool meets_open_pixel(const TileState& tile, const CellPlanes& cell, std::size_t k) {
    const std::uint32_t columns = (cell.width[k] >= 32 ? ~0U : (1U << cell.width[k]) - 1U) << cell.left[k];
    std::uint32_t open = 0;
    for (int y = 0; y < cell.height[k]; ++y) open |= tile.open[cell.top[k] + y];
    return (open & columns) != 0;
}

HWY_INLINE void prefetch_points(const ScreenCells& cells, const std::uint32_t* items, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        for (const VertexId v : cells.corners(items[i])) hwy::Prefetch(&cells.points[v]);
}

template <bool perspective, bool constant, bool surfaces>
HWY_INLINE std::size_t draw(const ScreenCells& cells, const Shading& shading, const Tile& target,
                            std::span<const std::uint32_t> items, TileState& tile) {
    const hn::CappedTag<float, CellPlanes::columns> d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t fragments = 0, since_closing = 0;
    bool seen = close_pixels(tile, shading.opaque, target.width, target.height);
    // Two groups ahead the corners of cells are asked for, one group ahead their points.
    std::uint32_t group[CellPlanes::columns], next[CellPlanes::columns] = {};  // the last group may be part empty
    std::size_t left = items.size();
    const auto read = [&](std::uint32_t* into) HWY_ATTR {
        const std::size_t count = HWY_MIN(lanes, left);
        for (std::size_t i = 0; i < count; ++i) into[i] = items[--left];
        for (std::size_t i = 0; i < HWY_MIN(lanes, left); ++i) hwy::Prefetch(cells.corners(items[left - 1 - i]).data());
        return count;
    };
    std::size_t next_count = read(next);
    while (seen && next_count > 0) {
        const std::size_t count = next_count;
        std::memcpy(group, next, sizeof group);
        next_count = read(next);
        prefetch_points(cells, next, next_count);
        make_planes<perspective, constant>(d, cells, group, count, tile.x, tile.y, target.width, target.height, tile.corners,
                                           tile.planes);
        for (std::size_t k = 0; k < count; ++k) {
            if (tile.planes.width[k] <= 0 || tile.planes.height[k] <= 0) continue;
            if (tile.some_closed && !meets_open_pixel(tile, tile.planes, k)) continue;
            const auto most = static_cast<std::size_t>(tile.planes.width[k]) * static_cast<std::size_t>(tile.planes.height[k]);
            if (tile.fragments.count + most > Fragments::capacity) {
                fragments += tile.fragments.count;
                since_closing += tile.fragments.count;
                composite_all<perspective, surfaces>(d, cells, shading, tile);
                if (since_closing > 4 * Fragments::capacity) {
                    since_closing = 0;
                    seen = close_pixels(tile, shading.opaque, target.width, target.height);
                }
            }
            add_cell<perspective, constant, false, surfaces>(d, cells, tile.planes, k, group[k], tile);
        }
    }
    fragments += tile.fragments.count;
    composite_all<perspective, surfaces>(d, cells, shading, tile);
    return fragments;
}

// For each group of items, from the last one, which is drawn first: the nearest nearness of it and of all behind it.
HWY_INLINE void find_nearest(const ScreenCells& cells, std::span<const std::uint32_t> items, std::size_t group,
                             std::vector<float>& nearest) {
    const std::size_t groups = (items.size() + group - 1) / group;
    nearest.resize(groups + 1);
    nearest[groups] = -1e30F;
    for (std::size_t g = groups; g-- > 0;) {
        float n = nearest[g + 1];
        const std::size_t end = items.size() - g * group, begin = end - HWY_MIN(group, end);
        for (std::size_t i = begin; i < end; ++i)
            for (const VertexId v : cells.corners(items[i])) n = std::max(n, cells.points[v].nearness + cells.view.base_nearness);
        nearest[g] = n;
    }
}

template <bool surfaces>
HWY_INLINE void move_to_pending(TileState& tile, PendingFragments& to) {
    Fragments& from = tile.fragments;
    const auto append = [&](auto& list, const auto* begin) { list.insert(list.end(), begin, begin + from.count); };
    append(to.front, from.front);
    append(to.back, from.back);
    append(to.length, from.length);
    append(to.key, from.key);
    append(to.pixel, from.pixel);
    if constexpr (surfaces) append_ends(tile, to);
    from.count = 0;
}

// Composites the pending fragments whose key is at least `nearest`, pixel by pixel from front to back; the others stay.
template <bool perspective, bool surfaces, class D>
HWY_NOINLINE void composite_pending(D d, const ScreenCells& cells, const Shading& shading, TileState& tile, PendingFragments& pending,
                                  float nearest) {
    constexpr std::size_t pixels = tile_side * tile_side;
    std::uint32_t first[pixels + 1] = {};
    const std::size_t count = pending.key.size();
    for (std::size_t i = 0; i < count; ++i)
        if (pending.key[i] >= nearest) ++first[static_cast<std::size_t>(pending.pixel[i]) + 1];
    for (std::size_t p = 0; p < pixels; ++p) first[p + 1] += first[p];
    pending.sorted.resize(first[pixels]);
    std::uint32_t next[pixels];
    std::memcpy(next, first, sizeof next);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i)
        if (pending.key[i] >= nearest) pending.sorted[next[static_cast<std::size_t>(pending.pixel[i])]++] = static_cast<std::uint32_t>(i);
    Fragments& f = tile.fragments;
    for (std::size_t p = 0; p < pixels; ++p) {
        std::uint32_t* const begin = pending.sorted.data() + first[p];
        const std::size_t n = first[p + 1] - first[p];
        // Insertion: cells come nearly sorted. Where they do not, a sort that does not mind.
        std::size_t moves = 0;
        for (std::size_t i = 1; i < n && moves <= 8 * n; ++i) {
            const std::uint32_t fragment = begin[i];
            std::size_t j = i;
            for (; j > 0 && pending.key[begin[j - 1]] < pending.key[fragment]; --j) begin[j] = begin[j - 1];
            begin[j] = fragment;
            moves += i - j;
        }
        if (moves > 8 * n)
            std::sort(begin, begin + n, [&](std::uint32_t a, std::uint32_t b) {
                return pending.key[a] != pending.key[b] ? pending.key[a] > pending.key[b] : a < b;
            });
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t fragment = begin[i];
            f.front[f.count] = pending.front[fragment];
            f.back[f.count] = pending.back[fragment];
            f.length[f.count] = pending.length[fragment];
            f.pixel[f.count] = pending.pixel[fragment];
            if constexpr (surfaces) set_ends(pending.ends[fragment], f.count, tile);
            if (++f.count == Fragments::capacity) composite_all<perspective, surfaces>(d, cells, shading, tile);
        }
    }
    composite_all<perspective, surfaces>(d, cells, shading, tile);
    for (std::size_t i = 0; i < count; ++i) {
        if (pending.key[i] >= nearest) continue;
        pending.front[kept] = pending.front[i];
        pending.back[kept] = pending.back[i];
        pending.length[kept] = pending.length[i];
        pending.key[kept] = pending.key[i];
        if constexpr (surfaces) pending.ends[kept] = pending.ends[i];
        pending.pixel[kept++] = pending.pixel[i];
    }
    for (auto* list : {&pending.front, &pending.back, &pending.length, &pending.key}) list->resize(kept);
    pending.pixel.resize(kept);
    if constexpr (surfaces) pending.ends.resize(kept);
}

template <bool perspective, bool constant, bool surfaces>
HWY_INLINE std::size_t draw_by_pixels(const ScreenCells& cells, const Shading& shading, const Tile& target,
                                      std::span<const std::uint32_t> items, TileState& tile, PendingFragments& pending) {
    const hn::CappedTag<float, CellPlanes::columns> d;
    const std::size_t lanes = hn::Lanes(d);
    find_nearest(cells, items, lanes, pending.nearest);
    std::size_t fragments = 0, enough = 8 * Fragments::capacity;
    bool seen = close_pixels(tile, shading.opaque, target.width, target.height);
    std::size_t left = items.size();
    for (std::size_t group = 0; seen && left > 0; ++group) {
        std::uint32_t of_group[CellPlanes::columns];
        const std::size_t count = HWY_MIN(lanes, left);
        for (std::size_t i = 0; i < count; ++i) of_group[i] = items[--left];
        make_planes<perspective, constant>(d, cells, of_group, count, tile.x, tile.y, target.width, target.height, tile.corners,
                                           tile.planes);
        for (std::size_t k = 0; k < count; ++k) {
            if (tile.planes.width[k] <= 0 || tile.planes.height[k] <= 0) continue;
            if (tile.some_closed && !meets_open_pixel(tile, tile.planes, k)) continue;
            const auto most = static_cast<std::size_t>(tile.planes.width[k]) * static_cast<std::size_t>(tile.planes.height[k]);
            if (tile.fragments.count + most > Fragments::capacity) {
                fragments += tile.fragments.count;
                move_to_pending<surfaces>(tile, pending);
            }
            add_cell<perspective, constant, true, surfaces>(d, cells, tile.planes, k, of_group[k], tile);
        }
        if (pending.key.size() < enough) continue;
        fragments += tile.fragments.count;
        move_to_pending<surfaces>(tile, pending);
        composite_pending<perspective, surfaces>(d, cells, shading, tile, pending, pending.nearest[group + 1]);
        seen = close_pixels(tile, shading.opaque, target.width, target.height);
        enough = HWY_MAX(8 * Fragments::capacity, 2 * pending.key.size());
    }
    fragments += tile.fragments.count;
    move_to_pending<surfaces>(tile, pending);
    composite_pending<perspective, surfaces>(d, cells, shading, tile, pending, -1e35F);
    return fragments;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
