// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/ray_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cellproj {

namespace {

// The scalar at a place with these weights. On a face only its three points have a weight. Their products are added in the
// order of their size, and the result lies among their values: so it is the same number for both cells of the face.
double interpolate(const std::array<double, 4>& values, const std::array<double, 4>& weights) {
    std::array<double, 4> products{};
    double low = values[0], high = values[0];
    bool first = true;
    for (std::size_t i = 0; i < 4; ++i) {
        if (weights[i] == 0) continue;
        products[i] = values[i] * weights[i];
        low = first ? values[i] : std::min(low, values[i]);
        high = first ? values[i] : std::max(high, values[i]);
        first = false;
    }
    std::sort(products.begin(), products.end());
    return std::clamp(products[0] + products[1] + products[2] + products[3], low, high);
}

// A field where the ray enters and leaves a cell; nothing where a value is not finite.
std::optional<ScalarEnds> ends_of(const ScalarField& field, const TetMesh& mesh, const Crossing& crossing) {
    std::array<double, 4> values;
    for (int corner = 0; corner < 4; ++corner)
        values[static_cast<std::size_t>(corner)] = field.at(mesh, crossing.cell, corner);
    if (!std::ranges::all_of(values, [](double s) { return std::isfinite(s); })) return std::nullopt;
    return ScalarEnds{interpolate(values, crossing.at_enter), interpolate(values, crossing.at_leave)};
}

double between(const RaySegment& segment, const ScalarEnds& ends, double t) {
    if (t <= segment.enter) return ends.front;
    if (t >= segment.leave) return ends.back;
    const double along = segment.share(t);
    return (1.0 - along) * ends.front + along * ends.back;
}

double middle(const RaySegment& segment) { return 0.5 * (segment.enter + segment.leave); }

// The segments that count, in the ray's order.
std::vector<const RaySegment*> in_order(std::span<const RaySegment> segments, double rounding) {
    std::vector<const RaySegment*> result;
    for (const RaySegment& segment : segments) {
        if (segment.leave - segment.enter > rounding) result.push_back(&segment);
    }
    std::ranges::stable_sort(result, {}, [](const RaySegment* s) { return middle(*s); });
    return result;
}

}  // namespace

double RaySegment::share(double t) const {
    return t <= enter ? 0.0 : t >= leave ? 1.0 : (t - enter) / (leave - enter);
}

double RaySegment::at(double t) const { return between(*this, scalars, t); }

double RaySegment::opacity_at(double t) const { return between(*this, opacity, t); }

std::vector<RaySegment> ray_segments(const Scene& scene, const std::vector<Crossing>& crossings) {
    std::vector<RaySegment> result;
    result.reserve(crossings.size());
    for (const Crossing& crossing : crossings) {
        const auto scalars = ends_of(*scene.field, *scene.mesh, crossing);
        const auto opacity = scene.opacity_field ? ends_of(*scene.opacity_field, *scene.mesh, crossing) : ScalarEnds{};
        if (!scalars || !opacity) continue;
        result.push_back({crossing.cell, crossing.enter, crossing.leave, *scalars, crossing.at_enter, crossing.at_leave, *opacity});
    }
    std::sort(result.begin(), result.end(), [](const RaySegment& a, const RaySegment& b) { return a.enter < b.enter; });
    return result;
}

std::vector<SurfaceHit> surface_hits(const IsoSurfaces& surfaces, std::span<const RaySegment> segments, double rounding) {
    const std::vector<const RaySegment*> along = in_order(segments, rounding);
    // Where cells overlap, it is not told which one continues which.
    std::vector<double> next_enter(along.size() + 1, std::numeric_limits<double>::infinity());
    for (std::size_t i = along.size(); i-- > 0;)
        next_enter[i] = std::min(along[i]->enter, next_enter[i + 1]);
    double left_before = -std::numeric_limits<double>::infinity();  // by all but the last segment
    const auto follows = [&](std::size_t i) {
        return std::abs(along[i]->enter - along[i - 1]->leave) <= rounding && left_before < middle(*along[i - 1]) &&
               next_enter[i + 1] > middle(*along[i]);
    };

    std::vector<SurfaceHit> hits;
    for (std::size_t i = 0; i < along.size(); ++i) {
        const RaySegment& segment = *along[i];
        if (i > 0 && follows(i)) {
            const RaySegment& front = *along[i - 1];
            const IsoCrossings jump = surfaces.crossings(front.scalars.back, segment.scalars.front);
            for (std::size_t k = 0; k < jump.size(); ++k)
                hits.push_back({jump[k].surface, segment.enter, jump[k].rising, front.cell, front.at_leave});
        }
        const IsoCrossings inside = surfaces.crossings(segment.scalars.front, segment.scalars.back);
        for (std::size_t k = 0; k < inside.size(); ++k) {
            const double share = inside[k].t;
            const double t = std::clamp(segment.enter + share * (segment.leave - segment.enter), segment.enter, segment.leave);
            std::array<double, 4> weights;
            for (std::size_t corner = 0; corner < 4; ++corner)
                weights[corner] = (1.0 - share) * segment.at_enter[corner] + share * segment.at_leave[corner];
            hits.push_back({inside[k].surface, t, inside[k].rising, segment.cell, weights});
        }
        if (i > 0) left_before = std::max(left_before, along[i - 1]->leave);
    }
    std::stable_sort(hits.begin(), hits.end(), [](const SurfaceHit& a, const SurfaceHit& b) { return a.t < b.t; });
    return hits;
}

}  // namespace cellproj
