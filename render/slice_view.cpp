// SPDX-License-Identifier: BSD-3-Clause
#include "render/slice_view.hpp"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

namespace cellproj {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

EyeCorners corners_of(const CutTriangle& triangle, const EyeRays& rays) {
    return {rays.place(triangle.corners[0]), rays.place(triangle.corners[1]), rays.place(triangle.corners[2])};
}

// Within the corners' scalars: rounding makes no other value of equal ones.
double mixed(const std::array<double, 3>& shares, const std::array<double, 3>& scalars) {
    const auto [low, high] = std::ranges::minmax(scalars);
    return std::clamp(shares[0] * scalars[0] + shares[1] * scalars[1] + shares[2] * scalars[2], low, high);
}

}  // namespace

// The rows in hand and what is found on them.
struct SliceView::Band {
    int number;
    Rows rows;
    int width;
    std::span<const DepthInterval> kept;
    Hits hits;

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - rows.top) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    // Whether a slice at that depth is seen there, nearer than those so far.
    bool wants(std::size_t pixel, double z, bool perspective) const {
        return std::isfinite(z) && z >= kept[pixel].near && z <= kept[pixel].far && z < hits.depth[pixel] && !(perspective && z <= 0);
    }
};

SliceView::SliceView(const SliceScene& scene, const Grid* grid, const EyeRays& rays) : scene_(scene), grid_(grid), rays_(rays), colors_(*scene.colors) {
    assert(grid || scene.cuts.size() == scene.slices.size());
    for (std::size_t i = 0; i < scene.slices.size(); ++i) {
        View view{EyePlane(scene.slices[i].plane, rays), {}, {}};
        if (!grid) {
            const std::vector<CutTriangle>& cut = scene.cuts[i];
            view.covers.resize(cut.size());
            oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, cut.size(), 1024), [&](const auto& range) {
                for (std::size_t t = range.begin(); t != range.end(); ++t) view.covers[t] = cover_of(corners_of(cut[t], rays), rays);
            });
            view.bands = by_bands(view.covers, rays.size().height);
        }
        views_.push_back(std::move(view));
    }
}

SliceView::Hits SliceView::nearest(int number, std::span<const DepthInterval> kept) const {
    Band band{number, rows_of_band(number, rays_.size().height), rays_.size().width, kept,
              {std::vector<double>(kept.size(), infinity), std::vector<glm::vec3>(kept.size())}};
    for (std::size_t slice = 0; slice < views_.size(); ++slice) grid_ ? add_grid(slice, band) : add_triangles(slice, band);
    return std::move(band.hits);
}

void SliceView::add_triangles(std::size_t slice, Band& band) const {
    const View& view = views_[slice];
    for (const std::size_t t : view.bands[static_cast<std::size_t>(band.number)]) {
        const CutTriangle& cut = scene_.cuts[slice][t];
        const TriangleOnRays triangle(corners_of(cut, rays_), rays_.perspective());
        const PixelCover& cover = view.covers[t];
        for (int y = std::max(band.rows.top, cover.top); y <= std::min(band.rows.bottom, cover.bottom); ++y)
            for (int x = cover.left; x <= cover.right; ++x) {
                const glm::dvec2 uv = rays_.slope(x, y);
                const double z = view.plane.along(uv).root();
                const std::size_t pixel = band.index(x, y);
                if (!band.wants(pixel, z, rays_.perspective())) continue;
                const auto shares = triangle.shares(uv);
                if (!shares || !std::isfinite((*shares)[0] + (*shares)[1] + (*shares)[2])) continue;
                const auto color = colors_.at(mixed(*shares, cut.scalars));
                if (!color) continue;
                band.hits.depth[pixel] = z;
                band.hits.color[pixel] = *color;
            }
    }
}

void SliceView::add_grid(std::size_t slice, Band& band) const {
    for (int y = band.rows.top; y <= band.rows.bottom; ++y)
        for (int x = 0; x < band.width; ++x) {
            const glm::dvec2 uv = rays_.slope(x, y);
            const double z = views_[slice].plane.along(uv).root();
            const std::size_t pixel = band.index(x, y);
            if (!band.wants(pixel, z, rays_.perspective())) continue;
            const auto scalar = scalar_at(*grid_, scene_.slices[slice], rays_.point(uv, z));
            const auto color = scalar ? colors_.at(*scalar) : std::nullopt;
            if (!color) continue;
            band.hits.depth[pixel] = z;
            band.hits.color[pixel] = *color;
        }
}

}  // namespace cellproj
