// SPDX-License-Identifier: BSD-3-Clause
//
// A medium that is lit by the gradient of the scalar (SurfaceScene::lit_medium; EKE01 §5.4, RS00 §8): the share of its light that a
// fragment sends to the eye, at both ends and in between. Included once per instruction set, behind Highway; private to kernels.cpp.
#if defined(CELLPROJ_MEDIUM_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CELLPROJ_MEDIUM_LIGHT_INL
#undef CELLPROJ_MEDIUM_LIGHT_INL
#else
#define CELLPROJ_MEDIUM_LIGHT_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace cellproj::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Shares of as many segments, by channel, where their rays enter and leave.
struct ShareLists {
    HWY_ALIGN float front[3][Fragments::length_of_list], back[3][Fragments::length_of_list];
};

// The gradients of points over one cell of a group, as CellPlanes tells its scalar: linear in the cell, between those of its corners.
template <bool perspective>
class CellGradient {
public:
    HWY_INLINE CellGradient(const ScreenCells& cells, const TileState& tile, std::size_t k) : base_(tile.planes.base[k]) {
        glm::dvec3 place[4];
        glm::vec3 gradient[4];
        for (std::size_t i = 0; i < 4; ++i) {
            const float* p = &tile.corners.points[i][4 * k];
            place[i] = {p[0], p[1], p[2]};
            gradient[i] = cells.surfaces->gradients[tile.corners.ids[4 * k + i]];
        }
        first_ = gradient[0];
        low_ = glm::min(glm::min(gradient[0], gradient[1]), glm::min(gradient[2], gradient[3]));
        high_ = glm::max(glm::max(gradient[0], gradient[1]), glm::max(gradient[2], gradient[3]));
        // F = (g − g₀)/depth is affine in x, y and nearness. Products of float32 differences are exact enough in float64 for any cell.
        const glm::dvec3 edge[3]{place[1] - place[0], place[2] - place[0], place[3] - place[0]};
        const glm::dvec3 normal[3]{glm::cross(edge[1], edge[2]), glm::cross(edge[2], edge[0]), glm::cross(edge[0], edge[1])};
        const double volume = glm::dot(edge[0], normal[0]), per_volume = volume != 0.0 ? 1.0 / volume : 0.0;
        glm::dvec3 slope[3]{};  // along x, y and nearness
        for (std::size_t i = 0; i < 3; ++i) {
            const double weight = per_volume * (perspective ? base_ + edge[i].z : 1.0);
            const glm::dvec3 difference = weight * glm::dvec3(gradient[i + 1] - first_);
            for (int axis = 0; axis < 3; ++axis) slope[axis] += normal[i][axis] * difference;
        }
        const double x = tile.x + static_cast<float>(tile.planes.left[k]) - place[0].x, y = tile.y + static_cast<float>(tile.planes.top[k]) - place[0].y;
        at_first_pixel_ = bounded(slope[0] * x + slope[1] * y);
        for (std::size_t axis = 0; axis < 3; ++axis) slope_[axis] = bounded(slope[axis]);
    }

    // At a pixel of the cell's box, and a nearness relative to the first corner's.
    HWY_INLINE glm::vec3 at(std::int32_t place, float nearness) const {
        const auto x = static_cast<float>(place & (tile_side - 1)), y = static_cast<float>(place >> column_shift / 2 & (tile_side - 1));
        const glm::vec3 f = at_first_pixel_ + x * slope_[0] + y * slope_[1] + nearness * slope_[2];
        return glm::min(glm::max(first_ + (perspective ? f / (base_ + nearness) : f), low_), high_);
    }

private:
    // Of flat cells, whose fragments have no length to be seen by.
    static glm::vec3 bounded(const glm::dvec3& v) { return glm::clamp(v, -1e30, 1e30); }

    float base_;
    glm::vec3 first_, low_, high_, at_first_pixel_, slope_[3];
};

// Of the fragments of one cell of the group, told in float32, of which `hits` tells the places.
template <bool perspective>
HWY_NOINLINE void set_gradients(const ScreenCells& cells, const TileState& tile, std::size_t k, std::uint32_t item, std::span<SurfaceEnds> ends) {
    if (cells.surfaces->shading == SurfaceShading::flat) {
        for (SurfaceEnds& e : ends) e.gradient_front = e.gradient_back = cells.surfaces->gradients[item];
        return;
    }
    const CellGradient<perspective> gradient(cells, tile, k);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        ends[i].gradient_front = gradient.at(tile.hits.place[i], tile.hits.front[i]);
        ends[i].gradient_back = gradient.at(tile.hits.place[i], tile.hits.back[i]);
    }
}

// What the fragments' medium sends to the eye at both ends.
template <class D>
HWY_NOINLINE void find_shares(D d, const ScreenCells& cells, const TileState& tile, const SurfaceEnds* ends, ShareLists& shares) {
    using V = hn::Vec<D>;
    const Fragments& f = tile.fragments;
    const std::size_t lanes = hn::Lanes(d);
    const bool one_gradient = cells.surfaces->shading == SurfaceShading::flat;
    for (std::size_t begin = 0; begin < f.count; begin += lanes) {
        HWY_ALIGN float gradient[2][3][CellPlanes::columns] = {};
        HWY_ALIGN std::int32_t pixel[CellPlanes::columns] = {};
        for (std::size_t i = 0; i < HWY_MIN(lanes, f.count - begin); ++i) {
            pixel[i] = f.pixel[begin + i];
            for (int axis = 0; axis < 3; ++axis) {
                gradient[0][axis][i] = ends[begin + i].gradient_front[axis];
                gradient[1][axis][i] = ends[begin + i].gradient_back[axis];
            }
        }
        const Direction<V> eye = to_eye(d, cells, tile.x, tile.y, pixel);
        V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        for (const bool front : {true, false}) {
            const auto& g = gradient[front ? 0 : 1];
            if (front || !one_gradient)
                lit_share(d, cells.surfaces->lighting, Direction<V>{hn::Load(d, g[0]), hn::Load(d, g[1]), hn::Load(d, g[2])}, eye, sum);
            for (int channel = 0; channel < 3; ++channel) hn::Store(sum[channel], d, (front ? shares.front : shares.back)[channel] + begin);
        }
    }
}

// A vector of segments' light, of which they send these shares.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void light_medium(D d, const ShareLists& shares, std::size_t begin, LightOf<V>& light) {
    const V place = mean_place_of_light(d, light.opacity);
    V* const channels[3]{&light.r, &light.g, &light.b};
    for (int channel = 0; channel < 3; ++channel) {
        const V front = hn::Load(d, shares.front[channel] + begin), back = hn::Load(d, shares.back[channel] + begin);
        *channels[channel] = hn::Mul(*channels[channel], hn::MulAdd(place, hn::Sub(back, front), front));
    }
}

}  // namespace cellproj::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
