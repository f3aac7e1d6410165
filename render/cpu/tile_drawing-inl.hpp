// SPDX-License-Identifier: BSD-3-Clause
//
// The cells of a tile to its pixels. Cells are small and their pixels few, so lanes are filled anew at each step: blocks of pixels
// against a cell's planes give hits, which are packed; full vectors of hits, of whatever cells of a group, become fragments with their scalars
// and lengths; full vectors of fragments become light; one after the other they are composited. Included once per instruction set,
// behind Highway; private to kernels.cpp.
#if defined(CELLPROJ_TILE_DRAWING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_TILE_DRAWING_INL
#undef CELLPROJ_TILE_DRAWING_INL
#else
#define CELLPROJ_TILE_DRAWING_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Where rays meet the cells of a group.
struct Hits {
    static constexpr std::size_t capacity = 1024;
    static constexpr std::size_t length = capacity + CellPlanes::columns;  // packing writes whole vectors

    HWY_ALIGN float front[length], back[length];  // nearness, relative to that of the cell's first corner
    // The pixel's place in the cell's box, x + tile_side·y, and above that the cell's column.
    HWY_ALIGN std::int32_t place[length];
    std::size_t count = 0;
};
constexpr int column_shift = 10;
static_assert(tile_side == 1 << (column_shift / 2));

// Segments of rays in cells, in drawing order.
struct Fragments {
    static constexpr std::size_t capacity = 1024;
    static constexpr std::size_t length_of_list = capacity + CellPlanes::columns;

    HWY_ALIGN float front[length_of_list], back[length_of_list];  // scalars
    HWY_ALIGN float length[length_of_list];                       // along the axis of the view [scene units]
    HWY_ALIGN float key[length_of_list];                          // for pixels that sort: the middle's nearness
    HWY_ALIGN std::int32_t pixel[length_of_list];                 // x + tile_side·y
    std::size_t count = 0;
    float lowest = 1, highest = 0;  // scalars of all of them

    void clear() {
        count = 0;
        lowest = 1;
        highest = 0;
    }
};

struct SurfaceTile;  // surface_drawing-inl.hpp, as what is declared with it

// What a task needs while it draws a tile.
struct TileState {
    HWY_ALIGN float rgba[tile_side * tile_side][4];  // composited so far
    std::uint32_t open[tile_side];                   // per row: bit x is set while something can still be seen there
    bool some_closed = false;
    float x, y;                                      // the first pixel centre
    Hits hits;
    Fragments fragments;
    CellPlanes planes;
    Corners corners;
    SurfaceTile* surfaces = nullptr;                 // with isosurfaces
    WindowTile* window = nullptr;                    // where rays are cut
};

// The fragments of one cell of the group, with all that isosurfaces want of them.
template <bool perspective, bool keyed, class D>
void add_crossed_cell(D d, const ScreenCells& cells, const CellPlanes& planes, std::size_t k, std::uint32_t item, TileState& tile,
                      const float* nearest = nullptr);
template <bool perspective, class D>
void composite_with_surfaces(D d, const ScreenCells& cells, const Shading& shading, TileState& tile);
void append_ends(const TileState& tile, PendingFragments& pending);
void set_ends(const SurfaceEnds& ends, std::size_t fragment, TileState& tile);

// Puts the light of some of a vector's fragments behind what there is at their pixels, one after the other.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void blend(D d, const LightOf<V>& l, const std::int32_t* pixel, std::size_t count, TileState& tile) {
    HWY_ALIGN float light[4 * CellPlanes::columns];
    hn::StoreInterleaved4(l.r, l.g, l.b, l.opacity, d, light);
    const auto blend_one = [&](std::size_t i) HWY_ATTR {
        float* rgba = tile.rgba[pixel[i]];
        const float transmitted = 1.0F - rgba[3];
        for (std::size_t channel = 0; channel < 4; ++channel) rgba[channel] += transmitted * light[4 * i + channel];
    };
    if (count == hn::Lanes(d)) {
        for (std::size_t i = 0; i < hn::Lanes(d); ++i) blend_one(i);
    } else {
        for (std::size_t i = 0; i < count; ++i) blend_one(i);
    }
}

// The lengths of a vector of fragments, from the axis of the view to the ray.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V length_along_ray(D d, const View& view, const TileState& tile, const Fragments& f, std::size_t begin) {
    const hn::RebindToSigned<D> di;
    const V length = hn::Load(d, f.length + begin);
    if (!view.perspective) return length;
    const V one = hn::Set(d, 1.0F), unit = hn::Set(d, view.unit_per_pixel);
    const auto pixel = hn::Load(di, f.pixel + begin);
    const V x = hn::Add(hn::ConvertTo(d, hn::And(pixel, hn::Set(di, tile_side - 1))), hn::Set(d, tile.x));
    const V y = hn::Add(hn::ConvertTo(d, hn::ShiftRight<5>(pixel)), hn::Set(d, tile.y));
    const V u = hn::Mul(x, unit), v = hn::Mul(y, unit);
    return hn::Mul(length, hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one))));
}

// The last vector of fragments may be part empty.
template <class D>
HWY_INLINE void empty_last_vector(D d, Fragments& f) {
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
        f.front[f.count + i] = f.back[f.count + i] = f.length[f.count + i] = 0.0F;
        f.pixel[f.count + i] = 0;
    }
}

// Composites the fragments behind what is there, in their order. light_of(s_f, s_b, length): scalars 0..1, lengths along the ray.
template <class D, class LightOfSegments>
HWY_INLINE void composite_as(D d, const View& view, TileState& tile, const LightOfSegments& light_of) {
    const Fragments& f = tile.fragments;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t begin = 0; begin < f.count; begin += lanes) {
        const auto length = length_along_ray(d, view, tile, f, begin);
        blend(d, light_of(hn::Load(d, f.front + begin), hn::Load(d, f.back + begin), length), f.pixel + begin, HWY_MIN(lanes, f.count - begin),
              tile);
    }
}

// The piece that all of the fragments lie in, or -1.
HWY_INLINE std::int32_t common_piece(const PieceArrays& table, const Fragments& f) {
    const std::int32_t piece = piece_of(table, f.lowest);
    return f.highest < table.end[static_cast<std::size_t>(piece)] ? piece : -1;
}

// Composites the fragments by the scene's method, and forgets them.
template <class D>
HWY_NOINLINE void composite(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    using V = hn::Vec<D>;
    Fragments& f = tile.fragments;
    if (f.count == 0) return;
    empty_last_vector(d, f);
    const bool constant = !cells.cell_scalars.empty();
    const std::int32_t piece = shading.pieces && shading.pieces->mean_place && !constant && !shading.half_opacity ? common_piece(*shading.pieces, f) : -1;
    if (piece >= 0) {
        const LightInPiece<D> light_in(d, *shading.pieces, piece);
        composite_as(d, cells.view, tile, [&](V s_f, V s_b, V length) HWY_ATTR {
            V depth;
            const LightOf<V> light = light_in(s_f, s_b, length, depth);
            if (HWY_LIKELY(hn::AllTrue(d, hn::Le(depth, hn::Set(d, mean_place_depth))))) return light;
            return light_of_walk(d, *shading.pieces, s_f, s_b, length);
        });
    } else {
        composite_as(d, cells.view, tile, [&](V s_f, V s_b, V length) HWY_ATTR { return shade(d, shading, constant, s_f, s_b, length); });
    }
    f.clear();
}

// The faces of a cell, by the bits of those that look towards the eye: these first.
inline constexpr std::uint8_t faces_by_side[16][4]{{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 0, 2, 3}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 1, 3},
                                                   {1, 2, 0, 3}, {0, 1, 2, 3}, {3, 0, 1, 2}, {0, 3, 1, 2}, {1, 3, 0, 2}, {0, 1, 3, 2},
                                                   {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 3, 0}, {0, 1, 2, 3}};

// The hits of one cell of the group, the one in column k. At least one of its faces looks towards the eye, and one away.
// `margin`, with isosurfaces: how much thinner than nothing a segment may be.
template <bool surfaces>
HWY_INLINE void find_hits(const CellPlanes& cell, std::size_t k, Hits& hits, float margin = 0.0F) {
    // Lanes are pixels: blocks of up to 4 by 2. Of larger ones a cell would miss more, and packing them costs as much more.
    const hn::CappedTag<float, 8> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    constexpr int block_width = HWY_MIN(4, static_cast<int>(hn::MaxLanes(hn::CappedTag<float, 8>())));
    const int block_height = static_cast<int>(hn::Lanes(d)) / block_width;
    const auto lane = hn::Iota(di, 0);
    const auto lane_x = hn::And(lane, hn::Set(di, block_width - 1));
    const auto lane_y = hn::ShiftRight<block_width == 4 ? 2 : 0>(hn::Sub(lane, lane_x));
    const V step_x = hn::ConvertTo(d, lane_x), step_y = hn::ConvertTo(d, lane_y);
    const auto lane_place = hn::Add(hn::Add(lane_x, hn::ShiftLeft<column_shift / 2>(lane_y)), hn::Set(di, static_cast<int>(k) << column_shift));

    // The first face is a front, the last one a back; those between may be either.
    const std::uint32_t fronts = cell.front_faces[k];
    const auto is_front = [&](std::size_t i) HWY_ATTR {
        return hn::RebindMask(d, hn::Ne(hn::Set(di, static_cast<std::int32_t>(fronts >> faces_by_side[fronts][i] & 1U)), hn::Zero(di)));
    };
    const auto front_1 = is_front(1), front_2 = is_front(2), back_1 = hn::Not(front_1), back_2 = hn::Not(front_2);
    V first[4], right[4], down[4];  // nearness in the box's first pixel; its change from pixel to pixel
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t face = faces_by_side[fronts][i];
        right[i] = hn::Set(d, cell.slope_x[face][k]);
        down[i] = hn::Set(d, cell.slope_y[face][k]);
        first[i] = hn::Set(d, cell.nearness[face][k]);
    }
    const V nearest = hn::Set(d, cell.nearest[k]), farthest = hn::Set(d, cell.farthest[k]);

    const int width = cell.width[k], height = cell.height[k];
    std::size_t count = hits.count;
    for (int y = 0; y < height; y += block_height) {
        const V from_top = hn::Add(hn::Set(d, static_cast<float>(y)), step_y);
        const auto in_rows = hn::Lt(lane_y, hn::Set(di, height - y));
        V at_row[4];
        for (std::size_t i = 0; i < 4; ++i) at_row[i] = fused(down[i], from_top, first[i]);  // whatever the block: the same bits
        for (int x = 0; x < width; x += block_width) {
            const V from_left = hn::Add(hn::Set(d, static_cast<float>(x)), step_x);
            const auto on_face = [&](std::size_t i) HWY_ATTR { return fused(right[i], from_left, at_row[i]); };
            const V one = on_face(1), two = on_face(2);
            V front = hn::Min(nearest, on_face(0)), back = hn::Max(farthest, on_face(3));
            front = hn::IfThenElse(front_1, hn::Min(front, one), front);
            back = hn::IfThenElse(back_1, hn::Max(back, one), back);
            front = hn::IfThenElse(front_2, hn::Min(front, two), front);
            back = hn::IfThenElse(back_2, hn::Max(back, two), back);
            const auto in_box = hn::And(hn::Lt(lane_x, hn::Set(di, width - x)), in_rows);
            const auto hit = hn::And(hn::Gt(surfaces ? hn::Add(front, hn::Set(d, margin)) : front, back), hn::RebindMask(d, in_box));
            const LanePacker<decltype(d)> packer(d, hit);
            packer.store(d, front, hits.front + count);
            packer.store(d, back, hits.back + count);
            packer.store(di, hn::Add(lane_place, hn::Set(di, x + tile_side * y)), hits.place + count);
            count += packer.count();
        }
    }
    hits.count = count;
}

// The hits of the group as fragments, of which there is room for as many.
template <bool perspective, bool constant, bool keyed, class D>
HWY_NOINLINE void add_fragments(D d, const View& view, const CellPlanes& cell, Hits& hits, Fragments& fragments) {
    const hn::RebindToSigned<D> di;
    using V = hn::Vec<D>;
    const V one = hn::Set(d, 1.0F);
    const auto low_bits = hn::Set(di, tile_side - 1);
    Fragments& f = fragments;
    const std::size_t lanes = hn::Lanes(d);
    if (hits.count == 0) return;
    const std::int32_t last = hits.place[hits.count - 1];
    for (std::size_t i = 0; i < lanes; ++i) hits.place[hits.count + i] = last;  // the last vector may be part empty
    V lowest = hn::Set(d, f.lowest), highest = hn::Set(d, f.highest);
    for (std::size_t begin = 0, to = f.count; begin < hits.count; begin += lanes, to += lanes) {
        const V front = hn::Load(d, hits.front + begin), back = hn::Load(d, hits.back + begin);
        const auto place = hn::Load(di, hits.place + begin);
        const auto column = hn::IndicesFromVec(d, hn::ShiftRight<column_shift>(place));
        const auto of_cell = [&](const CellPlanes::Row& row) HWY_ATTR { return hn::TableLookupLanes(hn::Load(d, row), column); };
        const auto x = hn::And(place, low_bits), y = hn::And(hn::ShiftRight<column_shift / 2>(place), low_bits);
        const auto first_pixel = hn::TableLookupLanes(hn::Load(di, cell.first_pixel), hn::IndicesFromVec(di, hn::ShiftRight<column_shift>(place)));
        hn::StoreU(hn::Add(first_pixel, hn::And(place, hn::Set(di, tile_side * tile_side - 1))), di, f.pixel + to);

        V length = hn::Sub(front, back), depth_front = one, depth_back = one;
        if constexpr (perspective) {
            const V base = of_cell(cell.base);
            const V w_front = hn::Add(base, front), w_back = hn::Add(base, back);
            const V both = hn::Div(one, hn::Mul(w_front, w_back));
            depth_front = hn::Mul(w_back, both);
            depth_back = hn::Mul(w_front, both);
            // What begins at the near plane has been cut there, and is drawn from the eye on.
            length = hn::IfThenElse(hn::Gt(w_front, hn::Set(d, view.near_plane)), depth_back, hn::Mul(length, both));
        }
        hn::StoreU(length, d, f.length + to);
        if constexpr (keyed) hn::StoreU(fused(hn::Set(d, 0.5F), hn::Add(front, back), of_cell(cell.base)), d, f.key + to);
        const V first = of_cell(cell.first_scalar);
        if constexpr (constant) {
            hn::StoreU(first, d, f.front + to);
            hn::StoreU(first, d, f.back + to);
        } else {
            const V across = fused(of_cell(cell.scalar_x), hn::ConvertTo(d, x),
                                   fused(of_cell(cell.scalar_y), hn::ConvertTo(d, y), of_cell(cell.scalar)));
            const V along = of_cell(cell.scalar_n), low = of_cell(cell.lowest), high = of_cell(cell.highest);
            const V s_f = fused(fused(along, front, across), depth_front, first);
            const V s_b = fused(fused(along, back, across), depth_back, first);
            hn::StoreU(hn::Min(hn::Max(s_f, low), high), d, f.front + to);
            hn::StoreU(hn::Min(hn::Max(s_b, low), high), d, f.back + to);
            lowest = hn::Min(lowest, low);
            highest = hn::Max(highest, high);
        }
    }
    f.lowest = hn::GetLane(hn::MinOfLanes(d, lowest));
    f.highest = hn::GetLane(hn::MaxOfLanes(d, highest));
    f.count += hits.count;
    hits.count = 0;
}

// False when nothing can be seen any more anywhere in the tile.
HWY_INLINE bool close_pixels(TileState& tile, float opaque, int width, int height) {
    if (opaque >= 1.0F) return true;
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

// The fragments of a group of cells, in its order. Calls make_room() when the list is to be emptied.
template <bool perspective, bool constant, bool keyed, bool surfaces, class D, class MakeRoom>
HWY_INLINE void add_group(D d, const ScreenCells& cells, const std::uint32_t* group, std::size_t count, const Tile& target,
                          TileState& tile, const MakeRoom& make_room) {
    make_planes<perspective, constant>(d, cells, group, count, tile.x, tile.y, target.width, target.height, tile.corners,
                                       tile.planes);
    const auto finish_hits = [&]() HWY_ATTR {
        if (tile.fragments.count + tile.hits.count > Fragments::capacity) make_room();
        if (tile.window) cut_hits(d, cells.view, tile.planes, *tile.window, tile.hits);
        const std::size_t begin = tile.fragments.count;
        add_fragments<perspective, constant, keyed>(d, cells.view, tile.planes, tile.hits, tile.fragments);
        if (tile.window) set_cut_lengths(*tile.window, tile.fragments.length, begin);
    };
    for (std::size_t k = 0; k < count; ++k) {
        if (tile.planes.width[k] <= 0 || tile.planes.height[k] <= 0) continue;
        if (!surfaces && (tile.planes.front_faces[k] == 0 || tile.planes.front_faces[k] == 15)) continue;  // no volume
        if (tile.window && !tile.window->may_keep(cells.view, tile.planes, k)) continue;
        if (tile.some_closed && !meets_open_pixel(tile, tile.planes, k)) continue;
        const auto most = static_cast<std::size_t>(tile.planes.width[k]) * static_cast<std::size_t>(tile.planes.height[k]);
        if constexpr (surfaces) {
            if (tile.fragments.count + most > Fragments::capacity) make_room();
            add_crossed_cell<perspective, keyed>(d, cells, tile.planes, k, group[k], tile);
            continue;
        }
        if (tile.hits.count + most > Hits::capacity) finish_hits();
        find_hits<false>(tile.planes, k, tile.hits);
    }
    finish_hits();
}

template <bool perspective, bool surfaces, class D>
HWY_INLINE void composite_any(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    if constexpr (surfaces) {
        composite_with_surfaces<perspective>(d, cells, shading, tile);
    } else {
        composite(d, cells, shading, tile);
    }
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
    const auto composite_all = [&]() HWY_ATTR {
        fragments += tile.fragments.count;
        since_closing += tile.fragments.count;
        composite_any<perspective, surfaces>(d, cells, shading, tile);
    };
    std::size_t next_count = read(next);
    while (seen && next_count > 0) {
        const std::size_t count = next_count;
        std::memcpy(group, next, sizeof group);
        next_count = read(next);
        prefetch_points(cells, next, next_count);
        add_group<perspective, constant, false, surfaces>(d, cells, group, count, target, tile, composite_all);
        if (since_closing > 4 * Fragments::capacity) {
            since_closing = 0;
            seen = close_pixels(tile, shading.opaque, target.width, target.height);
        }
    }
    composite_all();
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
    from.clear();
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
            f.lowest = HWY_MIN(f.lowest, HWY_MIN(f.front[f.count], f.back[f.count]));
            f.highest = HWY_MAX(f.highest, HWY_MAX(f.front[f.count], f.back[f.count]));
            if constexpr (surfaces) set_ends(pending.ends[fragment], f.count, tile);
            if (++f.count == Fragments::capacity) composite_any<perspective, surfaces>(d, cells, shading, tile);
        }
    }
    composite_any<perspective, surfaces>(d, cells, shading, tile);
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
    const auto keep = [&]() HWY_ATTR {
        fragments += tile.fragments.count;
        move_to_pending<surfaces>(tile, pending);
    };
    std::size_t left = items.size();
    for (std::size_t group = 0; seen && left > 0; ++group) {
        std::uint32_t of_group[CellPlanes::columns];
        const std::size_t count = HWY_MIN(lanes, left);
        for (std::size_t i = 0; i < count; ++i) of_group[i] = items[--left];
        add_group<perspective, constant, true, surfaces>(d, cells, of_group, count, target, tile, keep);
        if (pending.key.size() < enough) continue;
        keep();
        composite_pending<perspective, surfaces>(d, cells, shading, tile, pending, pending.nearest[group + 1]);
        seen = close_pixels(tile, shading.opaque, target.width, target.height);
        enough = HWY_MAX(8 * Fragments::capacity, 2 * pending.key.size());
    }
    keep();
    composite_pending<perspective, surfaces>(d, cells, shading, tile, pending, -1e35F);
    return fragments;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
