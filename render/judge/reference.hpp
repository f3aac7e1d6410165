// SPDX-License-Identifier: BSD-3-Clause
//
// The judge: what the pixels of a scene should be. RKE00 Eq. 1 in float64 along the ray through the pixel, over every cell
// that the ray crosses, found one by one (ray_index.hpp) and integrated to convergence (ray_light.hpp). It shares with the
// renderers only the camera's ray and the nodes of the transfer function; it knows no order but the ray's, so that cyclic and
// non-convex meshes are like any other.
//
// What counts:
// - Fields on points are linear in a cell, fields on cells constant. Cells that touch a value that is not finite are left out.
// - Where cells overlap, their media are superposed: extinction and emission add up (ray_light.hpp). A renderer that draws one
//   cell after the other gets the same opacity, but the colour of the one it draws last is in front.
// - Isosurfaces lie where the linear scalar of a cell passes their value (ray_surfaces.hpp): the medium is integrated up to
//   them, then they are composited, unlit or lit by the cell's or the points' gradients.
// - Where the medium is lit, each cell sends a share of its light to the eye that is linear along the ray, between `lit_share` by
//   the gradients where the ray enters and leaves it.
// - Of mesh and isosurfaces counts what the clip region keeps (ray_window.hpp): rays are cut at its planes. Bodies are opaque, lit by the
//   normals of their triangles, and stay whole. Slices are opaque and unlit; their scalar is that of the cell which their plane cuts there.
// - Perspective rays begin at the eye, parallel ones at infinity. (The renderers cut at their near plane, a thousandth of the
//   distance to the camera's center.)
// - A ray along a face, an edge or through a vertex is decided as one beside it, the same for all cells (ray_index.hpp).
//
// Accuracy: 1e-9 absolute for colours within 0..1, besides what it changes to move the vertices by 1e-15 times the mesh's
// size, or the distance of the eye where that is larger. Tests: reference_test, ray_index_test, ray_light_test.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "mesh/gradient.hpp"
#include "project/camera.hpp"
#include "render/image.hpp"
#include "render/judge/pixel_truths.hpp"
#include "render/judge/ray_index.hpp"
#include "render/judge/ray_surfaces.hpp"
#include "render/judge/ray_window.hpp"
#include "render/scene.hpp"

namespace cellproj {

// Keeps the index over a scene's mesh for any number of pictures. Immutable: any number of threads may ask at once.
class Reference {
public:
    // Throws Error (data) when the mesh is refused by `validate`, or as `validate` of the scene.
    // `index`: that of the same mesh, when there is one already.
    explicit Reference(Scene scene, std::shared_ptr<const RayIndex> index = nullptr);

    const RayIndex& index() const { return *index_; }
    const std::shared_ptr<const RayIndex>& shared_index() const { return index_; }

    // The light along one ray.
    Light light(const ViewRay& ray) const;

    // The isosurfaces that it meets in the clip region, also behind opaque ones and bodies; and the gradient there that their shading takes
    // [scalar / mesh unit]: 0 where there is none, or unlit.
    std::vector<SurfaceHit> surfaces_along(const ViewRay& ray) const;
    glm::dvec3 gradient_at(const SurfaceHit& hit) const;

    // The truth of these pixels, in their order (truths_of). Throws Error (option) for an unusable camera or size or a pixel outside the
    // picture.
    std::vector<PixelTruth> pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels,
                                   double slack = 0) const;
    // The whole picture, row by row: 104 bytes and, in usual scenes, some 30 µs of one core per pixel and ray.
    std::vector<PixelTruth> picture(const Camera& camera, ImageSize size, double slack = 0) const;

    // `count` different pixels that see the mesh, spread evenly (sample_pixels). Throws as `pixels`.
    std::vector<PixelId> sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed = 1) const;

private:
    Light reflected(const SurfaceHit& hit, const ViewRay& ray) const;
    glm::dvec3 gradient(CellId cell, const std::array<double, 4>& weights) const;
    ShareEnds shares(const RaySegment& segment, const ViewRay& ray) const;

    Scene scene_;
    std::shared_ptr<const RayIndex> index_;
    double rounding_ = 0;  // of places along a ray [mesh units]
    Gradients gradients_;  // of cells (flat) or points (smooth)
    double weak_ = 0;      // weak_gradient [scalar / mesh unit]; 0: there is no gradient
};

// For a single picture of a scene.
std::vector<PixelTruth> reference_pixels(const Scene& scene, const Camera& camera, ImageSize size,
                                         std::span<const PixelId> pixels);

// Every pixel of a picture, row by row.
std::vector<PixelId> all_pixels(ImageSize size);

// The truths as a picture: 0 where there is none.
Image to_image(std::span<const PixelTruth> truths, ImageSize size);

// How far each channel of the picture lies outside of low..high at the truth's pixel, absolute; infinite where it is not
// finite. Throws Error (option) when the pixel lies outside the picture.
glm::dvec4 error_of_pixel(const Image& image, const PixelTruth& truth);

// The same over many pixels.
struct ErrorMeasure {
    double rms = 0;            // root of the mean square, over all channels of all pixels
    double percentile_99 = 0;  // 99 % of the pixels have at most this in their worst channel
    double maximum = 0;
};

struct ImageError {
    std::size_t pixels = 0;  // compared
    ErrorMeasure color;      // R, G and B
    ErrorMeasure opacity;
};

// The picture against the truth, at the truth's pixels. A value that is not finite is an infinite error. Throws Error
// (option) when a pixel lies outside the picture. No pixels: all 0.
ImageError compare(const Image& image, std::span<const PixelTruth> truths);

// The largest error of any channel, opacity included.
double largest(const ImageError& error);

}  // namespace cellproj
