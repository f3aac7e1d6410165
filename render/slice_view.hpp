// SPDX-License-Identifier: BSD-3-Clause
//
// Slices as the pixels of a picture see them: where each ray meets their planes, and the colour there. Private to depth_window.
//
// The depth is that of the plane, by the same operations as that of a clipping plane: a cap lies just where the clip region begins. The triangles
// of a mesh say where it is covered, and mix the scalar; in a grid it is found at the point.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/grid.hpp"
#include "render/depth_window.hpp"
#include "render/eye_rays.hpp"
#include "render/slice_scene.hpp"

namespace cellproj {

class SliceView {
public:
    // All must outlive this. `grid`: null for slices of a mesh, which have their cuts.
    SliceView(const SliceScene& scene, const Grid* grid, const EyeRays& rays);

    // The nearest slice of each pixel of a band, row by row, of those in its ray's interval; of several at one depth, the first.
    struct Hits {
        std::vector<double> depth;  // infinite: none
        std::vector<glm::vec3> color;
    };
    Hits nearest(int band, std::span<const DepthInterval> kept) const;

private:
    struct Band;
    struct View {
        EyePlane plane;
        std::vector<PixelCover> covers;                // of the triangles
        std::vector<std::vector<std::size_t>> bands;  // by_bands
    };
    void add_triangles(std::size_t slice, Band& band) const;
    void add_grid(std::size_t slice, Band& band) const;

    const SliceScene& scene_;
    const Grid* grid_;
    const EyeRays& rays_;
    SliceColors colors_;
    std::vector<View> views_;  // one for each slice
};

}  // namespace cellproj
