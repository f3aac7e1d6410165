// SPDX-License-Identifier: BSD-3-Clause
//
// The judge of regular grids, as reference.hpp is that of meshes: RKE00 Eq. 1 in float64 along the ray through the
// pixel, with the true trilinear scalar in every cell (a cubic along the ray), integrated to convergence
// (cubic_light.hpp).
//
// What counts:
// - Fields on points are trilinear in a cell, fields on cells constant. Blanked cells are empty.
// - Perspective rays begin at the eye, parallel ones at infinity.
// - A ray that runs in a plane of the grid is in the cells above it (towards +x, +y, +z); in the outermost plane there,
//   it is outside.
// - Isosurfaces lie where the trilinear scalar passes their value: all roots of the cubic (cubic.hpp), the medium cut at
//   each. The scalar on a face is one number for both its cells, so that a surface in it is met exactly once. They are
//   lit by the trilinear gradient in the cell (flat) or by the gradients of its corners (mesh/grid_gradient.hpp),
//   trilinear in between (smooth).
// - Where the medium is lit, each cell sends a share of its light to the eye that is linear along the ray, between
//   `lit_share` by these gradients where the ray enters and leaves it; perspective rays enter the cell of the eye there.
//   That is the model, as it is of meshes: the same field on finer cells is lit a little differently, by second order.
//
// Accuracy: 1e-10 absolute for colours within 0..1, besides what it changes to move the axes by 1e-15 times the grid's
// size, its distance from the origin or the eye's distance. Tests: grid_reference_test.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "classify/transfer_function.hpp"
#include "mesh/grid.hpp"
#include "project/camera.hpp"
#include "render/judge/cubic_light.hpp"
#include "render/grid_scene.hpp"
#include "render/judge/reference.hpp"

namespace cellproj {

// A part of a ray inside one cell that is not blanked.
struct GridCrossing {
    GridCell cell;
    double enter, leave;  // lengths along the ray from its origin, enter < leave
};

// The cells along a ray, front to back; only ahead of its origin where `from_origin` (perspective). `direction` has
// unit length. Each crossing begins where the one before ends, but for blanked cells between them.
std::vector<GridCrossing> cells_along(const Grid& grid, const ScreenTransform::Ray& ray, bool from_origin);

// The trilinear scalar of a cell from `enter` to `leave`. Where it leaves one cell and enters the next, it is the same to the bit.
Cubic scalar_along(const Grid& grid, const GridCrossing& crossing, const ScreenTransform::Ray& ray);

// A place where a ray meets an isosurface.
struct GridSurfaceHit {
    std::size_t surface;  // index into the scene's isosurfaces, by ascending value
    double t;             // length along the ray from its origin
    bool rising;          // the front side is seen
    GridCell cell;
    glm::dvec3 u;         // where in it
};

// Immutable: any number of threads may ask at once.
class GridReference {
public:
    // Of a GridScene of these parts. Throws as `validate` of it.
    GridReference(std::shared_ptr<const Grid> grid, std::shared_ptr<const TransferFunction> transfer,
                  std::shared_ptr<const SurfaceScene> surfaces = nullptr);

    Light light(const ScreenTransform::Ray& ray, bool from_origin) const;

    // The isosurfaces that a ray meets, also behind opaque ones, front to back; and the gradient there that their shading
    // takes [scalar / mesh unit]: 0 where there is none, or unlit.
    std::vector<GridSurfaceHit> surfaces_along(const ScreenTransform::Ray& ray, bool from_origin) const;
    glm::dvec3 gradient_at(const GridSurfaceHit& hit) const;

    // The truth of these pixels, in their order (truths_of). Throws Error (option) for an unusable camera or size or a
    // pixel outside the picture.
    std::vector<PixelTruth> pixels(const Camera& camera, ImageSize size, std::span<const PixelId> pixels, double slack = 0) const;

    // `count` different pixels that see a cell of the grid, spread evenly (sample_pixels). Throws as `pixels`.
    std::vector<PixelId> sample(const Camera& camera, ImageSize size, std::size_t count, std::uint64_t seed = 1) const;

private:
    struct Piece;
    std::vector<Piece> pieces_along(const ScreenTransform::Ray& ray, bool from_origin) const;
    Light reflected(const GridSurfaceHit& hit, const glm::dvec3& direction) const;
    glm::dvec3 gradient(const GridCell& cell, const glm::dvec3& u) const;
    ShareEnds shares(const GridCrossing& crossing, const ScreenTransform::Ray& ray) const;

    GridScene scene_;
    double weak_ = 0;  // weak_gradient [scalar / mesh unit]; 0: there is no gradient
};

}  // namespace cellproj
