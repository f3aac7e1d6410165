// SPDX-License-Identifier: BSD-3-Clause
#include "render/judge/reference.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <glm/common.hpp>

#include "mesh/error.hpp"
#include "render/judge/ray_light.hpp"

namespace cellproj {

namespace {

// Distances of the values of one kind, collected pixel by pixel.
class Errors {
public:
    void add(std::span<const double> channels) {
        double worst = 0;
        for (const double e : channels) {
            squares_ += e * e;
            worst = std::max(worst, e);
        }
        values_ += channels.size();
        worst_.push_back(worst);
    }

    ErrorMeasure measure() {
        if (worst_.empty()) return {};
        std::sort(worst_.begin(), worst_.end());
        const std::size_t rank = (99 * worst_.size() + 99) / 100;  // nearest rank, 1-based
        return {std::sqrt(squares_ / static_cast<double>(values_)), worst_[rank - 1], worst_.back()};
    }

private:
    double squares_ = 0;
    std::size_t values_ = 0;
    std::vector<double> worst_;
};

double outside(double value, double low, double high) {
    return std::isfinite(value) ? std::max({0.0, low - value, value - high}) : std::numeric_limits<double>::infinity();
}

}  // namespace

Reference::Reference(Scene scene, std::shared_ptr<const RayIndex> index) : scene_(std::move(scene)), index_(std::move(index)) {
    validate(scene_);
    if (!index_) index_ = std::make_shared<RayIndex>(*scene_.mesh);
    const double diagonal = bounds(scene_.mesh->points).diagonal();
    rounding_ = rounding_along_ray(diagonal);
    if (!scene_.surfaces) return;
    const ScalarRange values = range(scene_.field->values);
    weak_ = diagonal > 0 ? weak_gradient * (values.high - values.low) / (0.5 * diagonal) : 0.0;
    if (scene_.surfaces->shading == Shading::flat) gradients_ = cell_gradients(*scene_.mesh, *scene_.field);
    if (scene_.surfaces->shading == Shading::smooth) gradients_ = vertex_gradients(*scene_.mesh, *scene_.field);
}

std::vector<SurfaceHit> Reference::surfaces_along(const ViewRay& ray) const {
    if (!scene_.surfaces) return {};
    const RayWindow window = ray_window(scene_, index_->middle(), ray);
    auto hits = surface_hits(scene_.surfaces->isosurfaces, ray_segments(scene_, index_->cells_along(ray)), rounding_);
    std::erase_if(hits, [&](const SurfaceHit& hit) { return hit.t < window.begin || hit.t > window.end; });
    return hits;
}

glm::dvec3 Reference::gradient_at(const SurfaceHit& hit) const {
    return scene_.surfaces ? gradient(hit.cell, hit.weights) : glm::dvec3(0);
}

// At the place of a cell with these weights of its points.
glm::dvec3 Reference::gradient(CellId cell, const std::array<double, 4>& weights) const {
    if (scene_.surfaces->shading == Shading::unlit) return glm::dvec3(0);
    if (scene_.surfaces->shading == Shading::flat) return gradients_.values[cell];
    glm::dvec3 sum(0);
    for (std::size_t corner = 0; corner < 4; ++corner)
        sum += weights[corner] * gradients_.values[scene_.mesh->tets[cell][corner]];
    return sum;
}

// The surface as a layer of the light that it sends back along the ray.
Light Reference::reflected(const SurfaceHit& hit, const ViewRay& ray) const {
    const SurfaceScene& surfaces = *scene_.surfaces;
    const IsoSurface& surface = surfaces.isosurfaces.surfaces()[hit.surface];
    const glm::dvec3& color = seen_color(surface, hit.rising);
    if (surfaces.shading == Shading::unlit) return layer(color, surface.opacity);
    // The front side is that of the lower scalars.
    return layer(shade(surfaces.lighting, color, -gradient_at(hit), -ray.direction), surface.opacity);
}

Light Reference::reflected(const BodyHit& hit, const ViewRay& ray) const {
    return layer(shade(scene_.bodies->lighting, hit.body->color, hit.normal, -ray.direction), 1.0);
}

// What the medium of a cell sends to the eye where the ray enters and leaves it.
ShareEnds Reference::shares(const RaySegment& segment, const ViewRay& ray) const {
    const auto share = [&](const std::array<double, 4>& weights) {
        const glm::dvec3 over_weak = weak_ > 0 ? gradient(segment.cell, weights) / weak_ : glm::dvec3(0);
        return lit_share(scene_.surfaces->lighting, over_weak, -ray.direction);
    };
    return {share(segment.at_enter), share(segment.at_leave)};
}

Light Reference::light(const ViewRay& ray) const {
    const RayWindow window = ray_window(scene_, index_->middle(), ray);
    const std::vector<RaySegment> along = ray_segments(scene_, index_->cells_along(ray));
    const std::optional<SliceHit> slice = slice_hit(scene_, index_->middle(), ray, window, along, rounding_);
    const bool slice_first = slice && !(window.body && window.body->t <= slice->t);
    const double window_end = slice_first ? slice->t : window.end_of_field();
    const std::vector<SurfaceHit> hits =
        scene_.surfaces ? surface_hits(scene_.surfaces->isosurfaces, along, rounding_) : std::vector<SurfaceHit>{};
    std::vector<double> bounds;
    bounds.reserve(2 * along.size() + hits.size());
    for (const RaySegment& segment : along)
        bounds.insert(bounds.end(), {segment.enter, segment.leave});
    for (const SurfaceHit& hit : hits)
        bounds.push_back(hit.t);
    std::sort(bounds.begin(), bounds.end());
    for (const double cut : {window.begin, window_end})
        if (!bounds.empty() && bounds.front() < cut && cut < bounds.back()) bounds.insert(std::ranges::upper_bound(bounds, cut), cut);
    bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());
    std::erase_if(bounds, [&](double t) { return t < window.begin || t > window_end; });

    // Between two neighbouring bounds the same segments are there, and no surface.
    RayLight light(*scene_.transfer);
    const bool lit = has_lit_medium(scene_);
    struct LitSegment : RaySegment {
        ShareEnds shares{};  // at both ends of the segment, where the medium is lit
    };
    std::vector<LitSegment> here;
    std::vector<ScalarEnds> media, opacity;
    std::vector<ShareEnds> shares_here;
    auto next = along.begin();
    auto hit = hits.begin();
    for (std::size_t i = 0; i < bounds.size() && !light.opaque(); ++i) {
        const double begin = bounds[i];
        for (; hit != hits.end() && hit->t <= begin; ++hit)
            if (hit->t >= window.begin) light.add(reflected(*hit, ray));
        if (i + 1 == bounds.size()) break;
        const double end = bounds[i + 1];
        for (; next != along.end() && next->enter <= begin; ++next)
            here.push_back({*next, lit ? shares(*next, ray) : ShareEnds{}});
        std::erase_if(here, [&](const RaySegment& segment) { return segment.leave <= begin; });
        media.clear();
        opacity.clear();
        shares_here.clear();
        for (const LitSegment& segment : here) {
            media.push_back({segment.at(begin), segment.at(end)});
            if (scene_.opacity_field) opacity.push_back({segment.opacity_at(begin), segment.opacity_at(end)});
            if (lit) shares_here.push_back(segment.shares.part(segment.share(begin), segment.share(end)));
        }
        light.add(media, opacity, end - begin, shares_here);
    }
    if (slice_first) light.add(layer(*SliceColors(*scene_.slices->colors).at(slice->scalar), 1.0));
    else if (window.body) light.add(reflected(*window.body, ray));
    return light.light();
}

std::vector<PixelTruth> Reference::pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels,
                                          double slack) const {
    validate(camera, "camera");
    validate(size, "size");
    return truths_of(pixels, size, slack,
                     [&](const glm::dvec2& place) { return light(index_->ray(camera, size, place)); });
}

std::vector<PixelTruth> Reference::picture(const Camera& camera, ImageSize size, double slack) const {
    validate(size, "size");
    return pixels(camera, size, all_pixels(size), slack);
}

std::vector<PixelId> Reference::sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed) const {
    validate(camera, "camera");
    validate(size, "size");
    return sample_pixels(size, count, seed,
                         [&](const glm::dvec2& place) { return index_->meets(index_->ray(camera, size, place)); });
}

std::vector<PixelTruth> reference_pixels(const Scene& scene, const Camera& camera, ImageSize size,
                                         std::span<const PixelId> pixels) {
    return Reference(scene).pixels(camera, size, pixels);
}

std::vector<PixelId> all_pixels(ImageSize size) {
    std::vector<PixelId> pixels;
    pixels.reserve(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x)
            pixels.push_back({x, y});
    }
    return pixels;
}

Image to_image(std::span<const PixelTruth> truths, ImageSize size) {
    Image image(size.width, size.height);
    for (const PixelTruth& truth : truths) {
        require_in_picture(truth.pixel, size);
        image.at(truth.pixel.x, truth.pixel.y) = glm::vec4(truth.light.color, truth.light.opacity);
    }
    return image;
}

glm::dvec4 error_of_pixel(const Image& image, const PixelTruth& truth) {
    require_in_picture(truth.pixel, {image.width, image.height});
    const glm::vec4& found = image.at(truth.pixel.x, truth.pixel.y);
    glm::dvec4 error;
    for (int k = 0; k < 3; ++k)
        error[k] = outside(found[k], truth.low.color[k], truth.high.color[k]);
    error.a = outside(found.a, truth.low.opacity, truth.high.opacity);
    return error;
}

ImageError compare(const Image& image, std::span<const PixelTruth> truths) {
    Errors color, opacity;
    for (const PixelTruth& truth : truths) {
        const glm::dvec4 error = error_of_pixel(image, truth);
        color.add(std::array{error.r, error.g, error.b});
        opacity.add(std::array{error.a});
    }
    return {truths.size(), color.measure(), opacity.measure()};
}

double largest(const ImageError& error) { return std::max(error.color.maximum, error.opacity.maximum); }

}  // namespace cellproj
