// SPDX-License-Identifier: BSD-3-Clause
//
// Isosurfaces in the fragments of a tile: each segment is cut where it crosses one (classify/isosurface.hpp), the medium in front is
// integrated, then the surface composited, lit. Included once per instruction set, behind Highway; private to kernels.cpp.
//
// Met exactly once. A fragment of a cell that no surface crosses has one level at both ends, which no rounding changes. Fragments of
// crossed cells, and of such with faces seen edge-on, are found again in float64, where both cells of a face agree on it bit for bit
// (precise_cell.hpp). And each pixel
// remembers the level at which its last fragment ended: where the next one begins at that place with another level (a cell of no
// thickness lies between, or rounding has its way), the surfaces between are met there. So along a ray levels change without a gap.
#if defined(CELLPROJ_SURFACE_DRAWING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_SURFACE_DRAWING_INL
#undef CELLPROJ_SURFACE_DRAWING_INL
#else
#define CELLPROJ_SURFACE_DRAWING_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What a task needs besides while it draws a tile with isosurfaces.
struct SurfaceTile {
    SurfaceEnds ends[Fragments::capacity];  // of TileState::fragments
    PixelTrail trails[tile_side * tile_side];
    Fragments pieces;                       // what the segments are cut into
    std::int32_t hit[Fragments::capacity];  // that ends the piece: of `hits`, or −1
    ShareLists shares, piece_shares;        // of fragments and pieces, where the medium is lit
    SurfaceHits hits;
    PreciseCell cell;                       // the one at hand, if it needs float64
};

enum class Precision { float32, float64, float64_alone };

// Which cells are found again in float64: those that are crossed, and all with a face so steep that float32 does not tell on which side of
// it a ray is. float32 may have given fragments of the latter to another cell, so that they try every pixel of their box.
HWY_INLINE Precision precision_of(const ScreenCells& cells, const CellPlanes& planes, std::size_t k, std::uint32_t item, TileState& tile) {
    float steepest = 0.0F;
    for (std::size_t face = 0; face < 4; ++face)
        steepest = HWY_MAX(steepest, std::abs(planes.slope_x[face][k]) + std::abs(planes.slope_y[face][k]));
    const bool steep = 1e-4F * steepest > planes.nearest[k] - planes.farthest[k];  // places are rounded to some 1e-5 of a pixel
    if (!steep && cells.surfaces->levels[item] != PreparedSurfaces::crossed_cell) return Precision::float32;
    tile.surfaces->cell = precise_cell(cells, item);
    return steep || tile.surfaces->cell.thin ? Precision::float64_alone : Precision::float64;
}

// How much thinner than nothing a segment of float32 may be, to be tried in float64.
template <bool perspective>
HWY_INLINE float margin_of(const CellPlanes& planes, std::size_t k) {
    return 1e-3F * (planes.nearest[k] - planes.farthest[k]) + 1e-6F * (perspective ? planes.base[k] : 1.0F);
}

// Both ends of segments, a vector each: nearness, scalar and face.
template <class V>
struct PreciseEnds {
    V near[2], scalar[2], face[2];
};

template <bool perspective, class DD, class V = hn::Vec<DD>>
HWY_INLINE PreciseEnds<V> precise_ends(DD dd, const PreciseCell& cell, V x, V y) {
    const V huge = hn::Set(dd, 1e300);
    PreciseEnds<V> ends{{huge, hn::Neg(huge)}, {huge, huge}, {huge, huge}};
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3& anchor = cell.points[static_cast<std::size_t>(face_corners[k][0])];
        const V dx = hn::Sub(x, hn::Set(dd, anchor.x)), dy = hn::Sub(y, hn::Set(dd, anchor.y));
        const auto at = [&](const ScreenPlane& plane) HWY_ATTR {
            return hn::MulAdd(hn::Set(dd, plane.slope_x), dx, hn::MulAdd(hn::Set(dd, plane.slope_y), dy, hn::Set(dd, plane.value)));
        };
        const V n = at(cell.nearness[k]), s = at(cell.scalar[k]);
        const std::size_t end = cell.towards_eye[k] ? 0 : 1;
        const auto closer = end == 0 ? hn::Lt(n, ends.near[0]) : hn::Gt(n, ends.near[1]);
        ends.near[end] = hn::IfThenElse(closer, n, ends.near[end]);
        ends.scalar[end] = hn::IfThenElse(closer, s, ends.scalar[end]);
        ends.face[end] = hn::IfThenElse(closer, hn::Set(dd, static_cast<double>(k)), ends.face[end]);
    }
    if constexpr (perspective)
        for (std::size_t end = 0; end < 2; ++end) ends.scalar[end] = hn::Div(ends.scalar[end], ends.near[end]);
    return ends;
}

HWY_INLINE glm::dvec2 place_of(const TileState& tile, std::int32_t pixel) {
    return glm::dvec2(tile.x + static_cast<float>(pixel & (tile_side - 1)), tile.y + static_cast<float>(pixel / tile_side)) + beside_center;
}

// One fragment, told in float64, as number `to` of the tile; false where it has no length.
template <bool perspective>
HWY_INLINE bool write_precisely(const ScreenCells& cells, const PreciseCell& cell, std::uint32_t item, const double (&near)[2],
                                const double (&scalar)[2], const int (&face)[2], std::int32_t pixel, TileState& tile, std::size_t to) {
    if (!(near[0] > near[1]) || (perspective && !(near[1] > 0.0))) return false;
    Fragments& f = tile.fragments;
    float s[2];
    for (std::size_t end = 0; end < 2; ++end) {
        const auto k = static_cast<std::size_t>(face[end]);
        s[end] = static_cast<float>(std::min<double>(std::max<double>(scalar[end], cell.lowest[k]), cell.highest[k]));
    }
    double length = near[0] - near[1];
    if constexpr (perspective)  // as in add_fragments
        length = near[0] > cells.view.near_plane ? 1.0 / near[1] : length / (near[0] * near[1]);
    f.front[to] = s[0];
    f.back[to] = s[1];
    f.length[to] = static_cast<float>(length);
    f.key[to] = static_cast<float>(0.5 * (near[0] + near[1]));
    f.pixel[to] = pixel;
    SurfaceEnds& ends = tile.surfaces->ends[to];
    const ScreenSurfaces& surfaces = *cells.surfaces;
    ends.item = item;
    ends.level_front = level_of(surfaces.values, s[0]);
    ends.level_back = level_of(surfaces.values, s[1]);
    ends.near_front = static_cast<float>(near[0]);
    ends.near_back = static_cast<float>(near[1]);
    if (ends.level_front == ends.level_back && !surfaces.lit_medium) return true;
    const glm::dvec2 p = place_of(tile, pixel);
    ends.gradient_front = gradient_on_face(surfaces, cell, item, face[0], p, perspective);
    ends.gradient_back = gradient_on_face(surfaces, cell, item, face[1], p, perspective);
    return true;
}

// The item's fragments from number `begin` on, of which only the pixels count, again in float64.
template <bool perspective>
HWY_NOINLINE void find_precisely(const ScreenCells& cells, std::uint32_t item, std::size_t begin, TileState& tile) {
    Fragments& f = tile.fragments;
    const PreciseCell& cell = tile.surfaces->cell;
    const int towards = cell.towards_eye[0] + cell.towards_eye[1] + cell.towards_eye[2] + cell.towards_eye[3];
    const std::size_t end = towards % 4 == 0 ? begin : f.count;  // none where all faces are seen edge-on
    std::size_t kept = begin;
    const hn::CappedTag<double, 8> dd;
    const hn::Rebind<std::int32_t, decltype(dd)> di;
    const std::size_t lanes = hn::Lanes(dd);
    for (std::size_t i = begin; i < end; i += lanes) {
        const auto pixel = hn::LoadU(di, f.pixel + i);
        const auto x = hn::Add(hn::Set(dd, static_cast<double>(tile.x) + beside_center.x), hn::PromoteTo(dd, hn::And(pixel, hn::Set(di, tile_side - 1))));
        const auto y = hn::Add(hn::Set(dd, static_cast<double>(tile.y) + beside_center.y), hn::PromoteTo(dd, hn::ShiftRight<5>(pixel)));
        const auto ends = precise_ends<perspective>(dd, cell, x, y);
        HWY_ALIGN double near[2][8], scalar[2][8], face[2][8];
        HWY_ALIGN std::int32_t pixels[8];
        hn::Store(pixel, di, pixels);
        for (std::size_t k = 0; k < 2; ++k) {
            hn::Store(ends.near[k], dd, near[k]);
            hn::Store(ends.scalar[k], dd, scalar[k]);
            hn::Store(ends.face[k], dd, face[k]);
        }
        for (std::size_t j = 0; j < HWY_MIN(lanes, end - i); ++j)
            kept += write_precisely<perspective>(cells, cell, item, {near[0][j], near[1][j]}, {scalar[0][j], scalar[1][j]},
                                                 {static_cast<int>(face[0][j]), static_cast<int>(face[1][j])}, pixels[j], tile, kept);
    }
    f.count = kept;
}

// All pixels of the cell's box, to be tried.
HWY_INLINE void add_box(const CellPlanes& planes, std::size_t k, Fragments& f) {
    for (std::int32_t y = 0; y < planes.height[k]; ++y)
        for (std::int32_t x = 0; x < planes.width[k]; ++x) f.pixel[f.count++] = planes.left[k] + x + tile_side * (planes.top[k] + y);
}

// Hits that begin behind what their pixel holds, beyond the rounding of float32.
HWY_INLINE void leave_hidden_out(const CellPlanes& planes, std::size_t k, const float* nearest, Hits& hits) {
    const std::size_t count = hits.count;
    hits.count = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t place = hits.place[i];
        const float front = hits.front[i], near = planes.base[k] + front;
        hits.front[hits.count] = front;
        hits.back[hits.count] = hits.back[i];
        hits.place[hits.count] = place;
        const float held = nearest[planes.first_pixel[k] + (place & (tile_side * tile_side - 1))];
        hits.count += near + 1e-5F * (1.0F + std::abs(near)) >= held;
    }
}

// `nearest`: where there is no order, the nearness of what each pixel holds.
template <bool perspective, bool keyed, class D>
HWY_NOINLINE void add_crossed_cell(D d, const ScreenCells& cells, const CellPlanes& planes, std::size_t k, std::uint32_t item, TileState& tile,
                                   const float* nearest) {
    Fragments& f = tile.fragments;
    const std::size_t begin = f.count;
    const Precision precision = precision_of(cells, planes, k, item, tile);
    const bool has_volume = planes.front_faces[k] != 0 && planes.front_faces[k] != 15;
    if (precision == Precision::float64_alone || (precision == Precision::float64 && !has_volume)) {
        add_box(planes, k, f);
    } else if (has_volume) {
        find_hits<true>(planes, k, tile.hits, precision == Precision::float64 ? margin_of<perspective>(planes, k) : 0.0F);
        if (nearest) leave_hidden_out(planes, k, nearest, tile.hits);
        add_fragments<perspective, false, keyed>(d, cells.view, planes, tile.hits, f);
    }
    if (precision != Precision::float32) {
        find_precisely<perspective>(cells, item, begin, tile);
        return;
    }
    const std::int32_t level = cells.surfaces->levels[item];
    for (std::size_t i = begin; i < f.count; ++i) {  // tile.hits still holds what they were made of
        SurfaceEnds& ends = tile.surfaces->ends[i];
        ends.item = item;
        ends.level_front = ends.level_back = level;
        ends.near_front = planes.base[k] + tile.hits.front[i - begin];
        ends.near_back = planes.base[k] + tile.hits.back[i - begin];
    }
    if (cells.surfaces->lit_medium) set_gradients<perspective>(cells, tile, k, item, {tile.surfaces->ends + begin, f.count - begin});
}

// For pixels that sort their own fragments.
HWY_INLINE void append_ends(const TileState& tile, PendingFragments& pending) {
    const SurfaceEnds* ends = tile.surfaces->ends;
    pending.ends.insert(pending.ends.end(), ends, ends + tile.fragments.count);
}
HWY_INLINE void set_ends(const SurfaceEnds& ends, std::size_t fragment, TileState& tile) { tile.surfaces->ends[fragment] = ends; }

// What a pixel holds while surfaces that follow each other in it are added: from one to the next only a product waits, not the memory.
class PixelSum {
public:
    explicit PixelSum(float (*rgba)[4]) : rgba_(rgba) {}
    ~PixelSum() { store(); }
    PixelSum(const PixelSum&) = delete;
    PixelSum& operator=(const PixelSum&) = delete;

    HWY_INLINE void add(std::int32_t pixel, const float* light) {
        if (pixel != pixel_) {
            store();
            pixel_ = pixel;
            std::memcpy(sum_, rgba_[pixel], sizeof sum_);
            transmitted_ = 1.0F - sum_[3];
        }
        for (std::size_t channel = 0; channel < 4; ++channel) sum_[channel] += transmitted_ * light[channel];
        transmitted_ *= 1.0F - light[3];
    }

private:
    HWY_INLINE void store() const {
        if (pixel_ >= 0) std::memcpy(rgba_[pixel_], sum_, sizeof sum_);
    }

    float (*rgba_)[4];
    std::int32_t pixel_ = -1;
    float sum_[4] = {}, transmitted_ = 1.0F;
};

// Composites the pieces and the surfaces that end them behind what is there, and forgets them.
template <class D>
HWY_NOINLINE void composite_pieces(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    SurfaceTile& s = *tile.surfaces;
    const std::size_t lanes = hn::Lanes(d);
    shade_hits(d, cells, tile.x, tile.y, s.hits);
    if (!cells.surfaces->medium) {
        PixelSum sum(tile.rgba);
        for (std::size_t i = 0; i < s.hits.count; ++i) sum.add(s.hits.pixel[i], s.hits.light + 4 * i);
    }
    const auto add = [&](std::int32_t pixel, const float* light) HWY_ATTR {
        float* rgba = tile.rgba[pixel];
        const float transmitted = 1.0F - rgba[3];
        for (std::size_t channel = 0; channel < 4; ++channel) rgba[channel] += transmitted * light[channel];
    };
    HWY_ALIGN float light[4 * CellPlanes::columns] = {};
    if (s.pieces.count > 0) empty_last_vector(d, s.pieces);
    for (std::size_t begin = 0; begin < s.pieces.count; begin += lanes) {
        auto l = shade(d, shading, false, hn::Load(d, s.pieces.front + begin), hn::Load(d, s.pieces.back + begin),
                       length_along_ray(d, cells.view, tile, s.pieces, begin));
        if (cells.surfaces->lit_medium) light_medium(d, s.piece_shares, begin, l);
        hn::StoreInterleaved4(l.r, l.g, l.b, l.opacity, d, light);
        for (std::size_t i = 0; i < HWY_MIN(lanes, s.pieces.count - begin); ++i) {
            const std::int32_t pixel = s.pieces.pixel[begin + i], hit = s.hit[begin + i];
            add(pixel, light + 4 * i);
            if (hit >= 0) add(pixel, s.hits.light + 4 * hit);
        }
    }
    s.pieces.count = s.hits.count = 0;
}

// A stretch of medium, where there is one, and behind it the surface `surface` or none (−1).
struct RayPiece {
    float front, back, length;
    std::int32_t pixel;
    std::size_t fragment = 0;      // whose shares of light are those of the medium, at these places on its way
    float begin = 0.0F, end = 1.0F;
    std::int32_t surface = -1;
    bool rising = false;
    glm::vec3 gradient = glm::vec3(0);
};

HWY_INLINE void add_hit(const glm::vec4& layer, const glm::vec3& gradient, std::int32_t pixel, SurfaceHits& hits) {
    const std::size_t i = hits.count++;
    for (int k = 0; k < 3; ++k) {
        hits.gradient[k][i] = gradient[k];
        hits.color[k][i] = layer[k];
    }
    hits.opacity[i] = layer.a;
    hits.pixel[i] = pixel;
}

HWY_INLINE glm::vec4 layer_at(const SurfaceRun& run, std::size_t place) {
    return {run.red[place], run.green[place], run.blue[place], run.opacity[place]};
}

HWY_INLINE glm::vec4 layer_of(const ScreenSurfaces& surfaces, std::int32_t surface, bool rising) {
    return layer_at(rising ? surfaces.rising : surfaces.falling, surfaces.place(surface, rising));
}

// Its stretch of medium.
template <class D>
HWY_INLINE void add_medium(D d, const ScreenCells& cells, const Shading& shading, TileState& tile, const RayPiece& piece) {
    SurfaceTile& s = *tile.surfaces;
    if (s.pieces.count == Fragments::capacity) composite_pieces(d, cells, shading, tile);
    const std::size_t i = s.pieces.count++;
    s.pieces.front[i] = piece.front;
    s.pieces.back[i] = piece.back;
    s.pieces.length[i] = piece.length;
    s.pieces.pixel[i] = piece.pixel;
    s.hit[i] = -1;
    if (!cells.surfaces->lit_medium) return;
    for (int channel = 0; channel < 3; ++channel) {
        const float first = s.shares.front[channel][piece.fragment], change = s.shares.back[channel][piece.fragment] - first;
        s.piece_shares.front[channel][i] = first + piece.begin * change;
        s.piece_shares.back[channel][i] = first + piece.end * change;
    }
}

template <class D>
HWY_INLINE void add_piece(D d, const ScreenCells& cells, const Shading& shading, TileState& tile, const RayPiece& piece) {
    SurfaceTile& s = *tile.surfaces;
    if (!cells.surfaces->medium) {
        if (piece.surface < 0) return;
        if (s.hits.count == SurfaceHits::capacity) composite_pieces(d, cells, shading, tile);
        add_hit(layer_of(*cells.surfaces, piece.surface, piece.rising), piece.gradient, piece.pixel, s.hits);
        return;
    }
    add_medium(d, cells, shading, tile, piece);
    if (piece.surface < 0) return;
    s.hit[s.pieces.count - 1] = static_cast<std::int32_t>(s.hits.count);
    add_hit(layer_of(*cells.surfaces, piece.surface, piece.rising), piece.gradient, piece.pixel, s.hits);
}

// Calls visit(surface, rising) for the surfaces between two levels in the order in which a ray meets them, while it says so.
template <class Visit>
HWY_INLINE void for_each_crossing(std::int32_t level_front, std::int32_t level_back, const Visit& visit) {
    for (std::int32_t i = level_front; i < level_back; ++i)
        if (!visit(i, true)) return;
    for (std::int32_t i = level_front; i > level_back; --i)
        if (!visit(i - 1, false)) return;
}

// Whether a fragment begins where the last one ended: by places rounded to float32, and planes of slivers.
template <bool perspective>
HWY_INLINE bool follows(float left, float entered) {
    const float rounding = perspective ? 4e-6F * left * (1.0F + left) : 4e-6F;  // 4e-6 of the depth, and of the mesh
    return std::abs(left - entered) <= rounding;
}

// Share of the way from s_f to s_b at which v lies, 0..1.
HWY_INLINE float share_of_way(float s_f, float s_b, float v) {
    const float way = s_b - s_f;
    return way != 0.0F ? HWY_MIN(HWY_MAX((v - s_f) / way, 0.0F), 1.0F) : 0.0F;
}

// The surfaces in a jump of the scalar, from where the pixel's last fragment ended to where the next begins. They belong to the cell on
// the lower side, as they do where the scalar reaches their value just at the face.
template <class D>
HWY_NOINLINE void add_jump(D d, const ScreenCells& cells, const Shading& shading, TileState& tile, std::int32_t pixel,
                           const SurfaceEnds& ends, PixelTrail& trail) {
    const glm::dvec2 p = place_of(tile, pixel);
    const bool rises = trail.level < ends.level_front;
    const glm::vec3 gradient = gradient_at_end(cells, rises ? trail.item : ends.item, p, !rises);
    for_each_crossing(trail.level, ends.level_front, [&](std::int32_t surface, bool rising) HWY_ATTR {
        add_piece(d, cells, shading, tile, {.front = 0.0F, .back = 0.0F, .length = 0.0F, .pixel = pixel, .surface = surface, .rising = rising, .gradient = gradient});
        const bool opaque = cells.surfaces->is_opaque(surface);
        if (opaque) trail.level = PixelTrail::closed;
        return !opaque;
    });
}

// All surfaces in a fragment, where nothing lies between them and nothing is cut: vectors of them, so that many cost little more than few; in
// one layer where one light falls on all. True behind an opaque one.
template <class D>
HWY_INLINE bool add_layers(D d, const ScreenCells& cells, const Shading& shading, TileState& tile, std::size_t fragment) {
    SurfaceHits& hits = tile.surfaces->hits;
    const ScreenSurfaces& surfaces = *cells.surfaces;
    const SurfaceEnds& ends = tile.surfaces->ends[fragment];
    const std::int32_t pixel = tile.fragments.pixel[fragment];
    const bool rises = ends.level_front < ends.level_back;
    const SurfaceRun& run = rises ? surfaces.rising : surfaces.falling;
    const std::size_t first = surfaces.place(rises ? ends.level_front : ends.level_front - 1, rises);
    const std::size_t end = first + static_cast<std::size_t>(std::abs(ends.level_back - ends.level_front));
    if (surfaces.shading != SurfaceShading::smooth) {
        if (hits.count == SurfaceHits::capacity) composite_pieces(d, cells, shading, tile);
        glm::vec4 sum(0.0F);
        float transmitted = 1.0F;
        for (std::size_t i = first; i < end && transmitted > 0.0F; ++i) {
            sum += transmitted * layer_at(run, i);
            transmitted *= 1.0F - run.opacity[i];
        }
        add_hit(sum, ends.gradient_front, pixel, hits);
        return !(transmitted > 0.0F);
    }
    const auto s_f = hn::Set(d, tile.fragments.front[fragment]), zero = hn::Zero(d), one = hn::Set(d, 1.0F);
    const float way = tile.fragments.back[fragment] - tile.fragments.front[fragment];
    const auto per_way = hn::Set(d, std::abs(way) > 1e-30F ? 1.0F / way : 0.0F);
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        if (hits.count + hn::Lanes(d) > SurfaceHits::capacity) composite_pieces(d, cells, shading, tile);
        const auto at = hn::Min(hn::Max(hn::Mul(hn::Sub(hn::LoadU(d, &run.value[i]), s_f), per_way), zero), one);
        for (int axis = 0; axis < 3; ++axis)
            hn::StoreU(hn::MulAdd(at, hn::Set(d, ends.gradient_back[axis] - ends.gradient_front[axis]), hn::Set(d, ends.gradient_front[axis])), d,
                       hits.gradient[axis] + hits.count);
        hn::StoreU(hn::LoadU(d, &run.red[i]), d, hits.color[0] + hits.count);
        hn::StoreU(hn::LoadU(d, &run.green[i]), d, hits.color[1] + hits.count);
        hn::StoreU(hn::LoadU(d, &run.blue[i]), d, hits.color[2] + hits.count);
        const auto opacity = hn::LoadU(d, &run.opacity[i]);
        hn::StoreU(opacity, d, hits.opacity + hits.count);
        const hn::RebindToSigned<D> di;
        hn::StoreU(hn::Set(di, pixel), di, hits.pixel + hits.count);
        const auto some = HWY_MIN(hn::Lanes(d), end - i);
        const auto opaque = hn::FindFirstTrue(d, hn::Ge(opacity, one));
        const bool closed = opaque >= 0 && static_cast<std::size_t>(opaque) < some;
        hits.count += closed ? static_cast<std::size_t>(opaque) + 1 : some;
        if (closed) return true;
    }
    return false;
}

// Composites the fragments behind what is there, in their order, with the surfaces in them, and forgets them.
template <bool perspective, class D>
HWY_NOINLINE void composite_with_surfaces(D d, const ScreenCells& cells, const Shading& shading, TileState& tile) {
    Fragments& f = tile.fragments;
    SurfaceTile& s = *tile.surfaces;
    const ScreenSurfaces& surfaces = *cells.surfaces;
    if (surfaces.lit_medium) find_shares(d, cells, tile, s.ends, s.shares);
    for (std::size_t i = 0; i < f.count; ++i) {
        const SurfaceEnds& ends = s.ends[i];
        const std::int32_t pixel = f.pixel[i];
        PixelTrail& trail = s.trails[pixel];
        if (trail.level >= 0 && trail.level != ends.level_front && follows<perspective>(trail.nearness, ends.near_front) &&
            (!tile.window || is_kept(cells.view, *tile.window, pixel, ends.near_front)))
            add_jump(d, cells, shading, tile, pixel, ends, trail);
        if (trail.level == PixelTrail::closed) continue;
        trail = {ends.level_back, ends.near_back, ends.item};
        if (!surfaces.medium && !tile.window) {
            if (ends.level_front != ends.level_back && add_layers(d, cells, shading, tile, i)) trail.level = PixelTrail::closed;
            continue;
        }
        if (ends.level_front == ends.level_back && !tile.window) {
            add_medium(d, cells, shading, tile, {f.front[i], f.back[i], f.length[i], pixel, i});
            continue;
        }
        // What begins at the near plane has the way from the eye as well, which belongs to the first piece.
        float before = perspective && ends.near_front > cells.view.near_plane ? 1.0F / ends.near_front : 0.0F;
        const float way = HWY_MAX(f.length[i] - before, 0.0F);
        FragmentCut cut{.before = before};
        if (tile.window) cut = cut_fragment<perspective>(cells.view, *tile.window, pixel, ends.near_front, ends.near_back, before);
        if (!cut.any) continue;
        before = cut.before;
        const auto scalar_at = [&](float of_way) HWY_ATTR { return f.front[i] + of_way * (f.back[i] - f.front[i]); };
        float front = cut.from > 0.0F ? scalar_at(cut.from) : f.front[i], share = cut.from;
        for_each_crossing(ends.level_front, ends.level_back, [&](std::int32_t surface, bool rising) HWY_ATTR {
            const float v = surfaces.values[static_cast<std::size_t>(surface)];
            const float at = share_of_way(f.front[i], f.back[i], v);
            if (at < cut.from) return true;
            if (at > cut.to) return false;
            const glm::vec3 gradient = ends.gradient_front + at * (ends.gradient_back - ends.gradient_front);
            add_piece(d, cells, shading, tile, {front, v, before + way * (at - share), pixel, i, share, at, surface, rising, gradient});
            before = 0.0F;
            front = v;
            share = at;
            const bool opaque = surfaces.is_opaque(surface);
            if (opaque) trail.level = PixelTrail::closed;
            return !opaque;
        });
        if (trail.level == PixelTrail::closed) continue;
        const float back = cut.to < 1.0F ? scalar_at(cut.to) : f.back[i];
        add_piece(d, cells, shading, tile, {front, back, before + way * (cut.to - share), pixel, i, share, cut.to});
    }
    f.clear();
    composite_pieces(d, cells, shading, tile);
}

// ---- Opaque surfaces alone: the nearest one of each pixel, whatever the order.

struct NearestHits {
    float nearness[tile_side * tile_side];
    std::int32_t surface[tile_side * tile_side];  // −1: none
    bool rising[tile_side * tile_side];
    glm::vec3 gradient[tile_side * tile_side];
};

// Only the first surface of a fragment, of those that are kept, can be the nearest one.
template <bool perspective>
HWY_INLINE void keep_nearest(const ScreenSurfaces& surfaces, const TileState& tile, std::size_t i, float first_near, NearestHits& nearest) {
    const Fragments& f = tile.fragments;
    const SurfaceEnds& ends = tile.surfaces->ends[i];
    const std::int32_t pixel = f.pixel[i];
    for_each_crossing(ends.level_front, ends.level_back, [&](std::int32_t surface, bool rising) HWY_ATTR {
        const float at = share_of_way(f.front[i], f.back[i], surfaces.values[static_cast<std::size_t>(surface)]);
        // The scalar is linear in depth.
        const float near = perspective ? ends.near_front * ends.near_back / (ends.near_back + at * (ends.near_front - ends.near_back))
                                       : ends.near_front + at * (ends.near_back - ends.near_front);
        if (near > first_near) return true;
        if (!(near > nearest.nearness[pixel])) return false;
        nearest.nearness[pixel] = near;
        nearest.surface[pixel] = surface;
        nearest.rising[pixel] = rising;
        nearest.gradient[pixel] = ends.gradient_front + at * (ends.gradient_back - ends.gradient_front);
        return false;
    });
}

// Whether every pixel of the cell's box has a surface in front of it.
HWY_INLINE bool is_hidden(const CellPlanes& planes, std::size_t k, const NearestHits& nearest) {
    const float front = planes.base[k] + planes.nearest[k];
    for (int y = 0; y < planes.height[k]; ++y) {
        const float* row = nearest.nearness + tile_side * (planes.top[k] + y) + planes.left[k];
        for (int x = 0; x < planes.width[k]; ++x)
            if (row[x] <= front) return false;
    }
    return true;
}

// Items come back to front, by and large: taken from the last one on, most of them are hidden.
template <bool perspective>
HWY_INLINE std::size_t draw_nearest(const ScreenCells& cells, const Tile& target, std::span<const std::uint32_t> items, TileState& tile) {
    const hn::CappedTag<float, CellPlanes::columns> d;
    const std::size_t lanes = hn::Lanes(d);
    SurfaceTile& s = *tile.surfaces;
    NearestHits nearest;
    for (int p = 0; p < tile_side * tile_side; ++p) {
        nearest.nearness[p] = s.trails[p].level == PixelTrail::none ? -1e30F : s.trails[p].nearness;
        nearest.surface[p] = -1;
        if (tile.window) nearest.nearness[p] = HWY_MAX(nearest.nearness[p], tile.window->far[p] + cells.view.base_nearness);
    }
    const auto first_near = [&](std::int32_t pixel) HWY_ATTR {
        return tile.window ? tile.window->near[pixel] + cells.view.base_nearness : NearnessInterval::unbounded;
    };
    std::size_t fragments = 0;
    for (std::size_t left = items.size(); left > 0;) {
        std::uint32_t group[CellPlanes::columns];
        const std::size_t count = HWY_MIN(lanes, left);
        for (std::size_t i = 0; i < count; ++i) group[i] = items[--left];
        const std::size_t next = HWY_MIN(lanes, left);
        prefetch_points(cells, items.data() + left - next, next);
        make_planes<perspective, false>(d, cells, group, count, tile.x, tile.y, target.width, target.height, tile.corners, tile.planes);
        for (std::size_t k = 0; k < count; ++k) {
            if (tile.planes.width[k] <= 0 || tile.planes.height[k] <= 0 || is_hidden(tile.planes, k, nearest)) continue;
            if (tile.window && !tile.window->may_keep(cells.view, tile.planes, k)) continue;
            add_crossed_cell<perspective, false>(d, cells, tile.planes, k, group[k], tile, nearest.nearness);
            fragments += tile.fragments.count;
            for (std::size_t i = 0; i < tile.fragments.count; ++i)
                keep_nearest<perspective>(*cells.surfaces, tile, i, first_near(tile.fragments.pixel[i]), nearest);
            tile.fragments.clear();
        }
    }

    for (std::int32_t p = 0; p < tile_side * tile_side; ++p) {
        if (nearest.surface[p] < 0) continue;
        add_hit(layer_of(*cells.surfaces, nearest.surface[p], nearest.rising[p]), nearest.gradient[p], p, s.hits);
        s.trails[p] = {PixelTrail::closed, nearest.nearness[p], 0};
    }
    shade_hits(d, cells, tile.x, tile.y, s.hits);
    for (std::size_t i = 0; i < s.hits.count; ++i) std::memcpy(tile.rgba[s.hits.pixel[i]], s.hits.light + 4 * i, 4 * sizeof(float));
    return fragments;
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
