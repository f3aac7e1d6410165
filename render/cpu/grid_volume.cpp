// SPDX-License-Identifier: BSD-3-Clause
#include "render/cpu/grid_volume.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "mesh/error.hpp"
#include "render/prepared_surfaces.hpp"

namespace cellproj::cpu {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::size_t brick_side = 4;     // cells, and bricks of the level below
constexpr std::size_t function_bins = 1024;  // of the scalars, in which the transfer function shows something or not

constexpr std::size_t longest_axis = std::size_t{1} << 24;  // the kernels count cells in float32

// A ray that moves less than this across the whole grid [axis units] crosses no plane: about what float32 places are worth.
constexpr double no_movement = 1e-6;

std::size_t bricks_over(std::size_t n) { return (n + brick_side - 1) / brick_side; }

// Whether anything can be seen for scalars in a range, by the number of bins before each that show something.
class Visibility {
public:
    explicit Visibility(const TransferFunction& transfer) : transfer_(transfer), before_(function_bins + 1, 0) {
        for (std::size_t b = 0; b < function_bins; ++b) {
            const double width = 1.0 / static_cast<double>(function_bins), begin = static_cast<double>(b) * width;
            // A little wider: the kernels round nodes to float32.
            before_[b + 1] = before_[b] + (transfer.visible(begin - 1e-6, begin + width + 1e-6) ? 1 : 0);
        }
    }
    bool operator()(float low, float high) const {
        if (before_[bin(high) + 1] == before_[bin(low)]) return false;
        return bin(high) > bin(low) || transfer_.visible(low, high);  // such as exactly 0, where a ramp begins
    }

private:
    static std::size_t bin(float s) {
        return std::min(static_cast<std::size_t>(s * static_cast<float>(function_bins)), function_bins - 1);
    }
    const TransferFunction& transfer_;
    std::vector<std::size_t> before_;
};

}  // namespace

GridVolume::GridVolume(const Grid& grid, const GridUnits& units)
    : units_(units), mean_chord_(cellproj::mean_chord(grid, units_)), constant_(grid.location == FieldLocation::cells) {
    const GridDimensions n = grid.dimensions();
    constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
    if (n.ni * n.nj * n.nk > most) {
        throw Error({ErrorKind::data, "grid", "at most " + std::to_string(most) + " points", std::to_string(n.ni * n.nj * n.nk),
                     "resample it, or cut a part out"});
    }
    for (const GridAxis& axis : grid.axes) {
        if (axis.cells() < longest_axis) continue;
        throw Error({ErrorKind::data, "grid", "fewer than " + std::to_string(longest_axis) + " cells along an axis", std::to_string(axis.cells()),
                     "resample it, or cut a part out"});
    }
    values_.resize(grid.values.size());
    oneapi::tbb::parallel_for(std::size_t{0}, values_.size() / 65536 + 1, [&](std::size_t part) {
        const std::size_t end = std::min(values_.size(), (part + 1) * 65536);
        for (std::size_t i = part * 65536; i < end; ++i) values_[i] = units_.kept(grid.values[i]);
    });
    std::transform(grid.blanked.begin(), grid.blanked.end(), std::back_inserter(present_),
                   [](std::uint8_t blanked) { return blanked ? 0.0F : 1.0F; });
    const bool uniform = std::all_of(grid.axes.begin(), grid.axes.end(), [](const GridAxis& axis) { return axis.spacing.has_value(); });
    std::int32_t stride = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const GridAxis& from = grid.axes[a];
        Axis& axis = axes_[a];
        axis.low = from.coordinates.front();
        axis.high = from.coordinates.back();
        axis.per_unit = static_cast<double>(from.cells()) / (axis.high - axis.low);
        cell_counts_[a] = static_cast<std::int32_t>(from.cells());
        value_strides_[a] = stride;
        stride *= static_cast<std::int32_t>(constant_ ? from.cells() : from.points());
        if (uniform) continue;
        for (const double x : from.coordinates)
            axis.planes.push_back(static_cast<float>((x - axis.low) * axis.per_unit));
        for (std::size_t i = 0; i < from.cells(); ++i) {
            const float width = axis.planes[i + 1] - axis.planes[i];
            axis.per_width.push_back(width > 0 ? 1.0F / width : 0.0F);
        }
    }
    if (!constant_) add_turned_values(n);
    find_ranges(grid);
}

// Behind the values, slice by slice, with rows and columns exchanged: neighbours along y stand side by side as well (grid_walk-inl.hpp).
void GridVolume::add_turned_values(const GridDimensions& n) {
    turned_ = static_cast<std::int32_t>(values_.size());
    values_.resize(2 * values_.size());
    oneapi::tbb::parallel_for(std::size_t{0}, n.nk, [&](std::size_t k) {
        const float* from = &values_[n.ni * n.nj * k];
        float* to = &values_[n.ni * n.nj * (n.nk + k)];
        for (std::size_t i = 0; i < n.ni; ++i)
            for (std::size_t j = 0; j < n.nj; ++j) *to++ = from[i + n.ni * j];
    });
}

void GridVolume::find_ranges(const Grid& grid) {
    std::array<std::size_t, 3> n{grid.axes[0].cells(), grid.axes[1].cells(), grid.axes[2].cells()};
    for (std::size_t l = 0; l < brick_levels; ++l) {
        Level& level = levels_[l];
        for (std::size_t a = 0; a < 3; ++a) level.bricks[a] = bricks_over(n[a]);
        level.ranges.resize(level.bricks[0] * level.bricks[1] * level.bricks[2]);
        const Level* below = l > 0 ? &levels_[l - 1] : nullptr;
        // The range of a cell, or of a brick of the level below.
        const auto range_of = [&](const GridCell& c) {
            if (below) return below->ranges[c[0] + n[0] * (c[1] + n[1] * c[2])];
            if (grid.is_blanked(c)) return Range{};
            Range range{1, 0};
            const std::size_t first = c[0] + c[1] * static_cast<std::size_t>(value_strides_[1]) + c[2] * static_cast<std::size_t>(value_strides_[2]);
            range.low = range.high = values_[first];
            if (constant_) return range;
            for (std::size_t corner = 1; corner < 8; ++corner) {
                std::size_t point = first;
                for (std::size_t a = 0; a < 3; ++a)
                    if (corner >> a & 1U) point += static_cast<std::size_t>(value_strides_[a]);
                range.low = std::min(range.low, values_[point]);
                range.high = std::max(range.high, values_[point]);
            }
            return range;
        };
        oneapi::tbb::parallel_for(std::size_t{0}, level.bricks[2], [&](std::size_t z) {
            for (std::size_t y = 0; y < level.bricks[1]; ++y)
                for (std::size_t x = 0; x < level.bricks[0]; ++x) {
                    Range& range = level.ranges[x + level.bricks[0] * (y + level.bricks[1] * z)];
                    for (std::size_t k = brick_side * z; k < std::min(n[2], brick_side * (z + 1)); ++k)
                        for (std::size_t j = brick_side * y; j < std::min(n[1], brick_side * (y + 1)); ++j)
                            for (std::size_t i = brick_side * x; i < std::min(n[0], brick_side * (x + 1)); ++i) {
                                const Range inside = range_of({i, j, k});
                                if (inside.low > inside.high) continue;
                                const bool first = range.low > range.high;
                                range.low = first ? inside.low : std::min(range.low, inside.low);
                                range.high = first ? inside.high : std::max(range.high, inside.high);
                            }
                }
        });
        n = level.bricks;
    }
}

void GridVolume::set_light(const TransferFunction& transfer, std::vector<float> isovalues) {
    isovalues_ = std::move(isovalues);
    const Visibility visible(transfer);
    const auto& bricks = levels_[0].bricks;
    const auto is_crossed = [&](const Range& range) { return range.low <= range.high && level_of(isovalues_, range.low) != level_of(isovalues_, range.high); };
    crossed_.clear();
    if (!isovalues_.empty())
        std::transform(levels_[0].ranges.begin(), levels_[0].ranges.end(), std::back_inserter(crossed_), [&](const Range& range) { return is_crossed(range) ? 1 : 0; });
    empty_.assign(levels_[0].ranges.size(), 0);
    empty_cells_ = 0;
    leaps_ = false;
    const auto is_empty = [&](const Range& range) { return range.low > range.high || (!visible(range.low, range.high) && !is_crossed(range)); };
    for (std::size_t z = 0; z < bricks[2]; ++z)
        for (std::size_t y = 0; y < bricks[1]; ++y)
            for (std::size_t x = 0; x < bricks[0]; ++x) {
                std::array<std::size_t, 3> at{x, y, z};
                std::int32_t level = 0;
                for (; level < brick_levels; ++level) {
                    const Level& l = levels_[static_cast<std::size_t>(level)];
                    if (!is_empty(l.ranges[at[0] + l.bricks[0] * (at[1] + l.bricks[1] * at[2])])) break;
                    for (std::size_t& i : at) i /= brick_side;
                }
                if (level == 0) continue;
                empty_[x + bricks[0] * (y + bricks[1] * z)] = level;
                leaps_ = true;
                std::size_t cells = 1;
                for (std::size_t a = 0; a < 3; ++a) {
                    const std::size_t first = brick_side * (a == 0 ? x : a == 1 ? y : z);
                    cells *= std::min(brick_side, static_cast<std::size_t>(cell_counts_[a]) - first);
                }
                empty_cells_ += cells;
            }
}

GridSurfaces GridVolume::surfaces() const {
    GridSurfaces surfaces;
    surfaces.count = static_cast<std::int32_t>(isovalues_.size());
    surfaces.values = isovalues_.data();
    surfaces.crossed = crossed_.data();
    for (std::size_t a = 0; a < 3; ++a) surfaces.per_length[a] = static_cast<float>(axes_[a].per_unit * units_.length);
    return surfaces;
}

GridCells GridVolume::cells() const {
    GridCells grid;
    std::int32_t cell_stride = 1, brick_stride = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        const Axis& axis = axes_[a];
        const std::int32_t turned_stride = a == 0 ? cell_counts_[1] + 1 : a == 1 ? 1 : value_strides_[2];
        grid.axes[a] = {cell_counts_[a], value_strides_[a], turned_stride, cell_stride, brick_stride,
                        axis.planes.empty() ? nullptr : axis.planes.data(), axis.per_width.empty() ? nullptr : axis.per_width.data()};
        cell_stride *= cell_counts_[a];
        brick_stride *= static_cast<std::int32_t>(levels_[0].bricks[a]);
    }
    grid.values = values_.data();
    grid.turned = turned_;
    grid.constant = constant_;
    grid.present = present_.empty() ? nullptr : present_.data();
    grid.empty = leaps_ ? empty_.data() : nullptr;
    return grid;
}

// In float64: a far eye and a far origin of the coordinates cost the kernels no digits. Rays are affine over the screen:
// in parallel views their origins, in perspective their directions, when these reach equally far along the axis of the view.
void GridVolume::find_rays(const ScreenTransform& transform, int x, int y, int width, int height, std::span<const DepthInterval> window,
                           GridRays& rays) const {
    const bool perspective = transform.perspective();
    const glm::dvec3 forward = transform.ray(transform.principal_point()).direction;
    const auto ray_at = [&](double px, double py) {
        const ScreenTransform::Ray ray = transform.ray({x + px, y + py});
        return perspective ? ray.direction / glm::dot(ray.direction, forward) : ray.origin;
    };
    const glm::dvec3 first = ray_at(0.5, 0.5), per_column = (ray_at(width + 0.5, 0.5) - first) / double(width),
                     per_row = (ray_at(0.5, height + 0.5) - first) / double(height);
    const glm::dvec3 eye = transform.ray({x + 0.5, y + 0.5}).origin;
    const Direction parallel(forward, units_.length);
    const auto columns = static_cast<std::size_t>(transform.size().width);
    rays.cut = !window.empty();
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const glm::dvec3 place = first + double(column) * per_column + double(row) * per_row;
            // Lengths along these directions are depths.
            DepthInterval kept{perspective ? 0.0 : -infinity, infinity};
            if (!window.empty()) {
                const DepthInterval& pixel = window[static_cast<std::size_t>(y + row) * columns + static_cast<std::size_t>(x + column)];
                kept = {std::max(kept.near, pixel.near * units_.length), std::min(kept.far, pixel.far * units_.length)};
            }
            find_ray(perspective ? eye : place, perspective ? Direction(place, units_.length) : parallel, kept, static_cast<std::size_t>(tile_side * row + column), rays);
        }
}

void GridVolume::find_ray(const glm::dvec3& origin, const Direction& direction, const DepthInterval& kept, std::size_t pixel, GridRays& rays) const {
    double enter = kept.near, leave = kept.far;
    for (int a = 0; a < 3; ++a) {
        const Axis& axis = axes_[static_cast<std::size_t>(a)];
        const double to_low = axis.low - origin[a], to_high = axis.high - origin[a];
        if (direction.along[a] == 0) {
            if (to_low > 0 || to_high <= 0) leave = -infinity;
            continue;
        }
        const double low = to_low * direction.inverse[a], high = to_high * direction.inverse[a];
        enter = std::max(enter, std::min(low, high));
        leave = std::min(leave, std::max(low, high));
    }
    if (!(leave > enter)) {
        rays.length[pixel] = 0;
        return;
    }
    rays.length[pixel] = static_cast<float>((leave - enter) * direction.speed);
    for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        const Axis& axis = axes_[i];
        const double place = ((origin[a] - axis.low) + enter * direction.along[a]) * axis.per_unit;
        const double change = direction.along[a] * axis.per_unit;  // per unit of `enter`
        rays.origin[i][pixel] = static_cast<float>(std::clamp(place, 0.0, static_cast<double>(cell_counts_[i])));
        rays.direction[i][pixel] = std::abs(change) * (leave - enter) > no_movement ? static_cast<float>(change * direction.per_speed) : 0.0F;
    }
}

}  // namespace cellproj::cpu
